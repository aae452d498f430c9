"""Compiled code is kept on disk, and never served for a source that has changed since."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import tribo

PLUGIN = """
from typing import NamedTuple

POWER = 1

class Own(NamedTuple):
    s: float
    def energy(self, r):
        return self.s / r**POWER
"""
SCENE = """
duration = 1.0
interaction = { potential = "own.py:Own", s = 0.2 }
numerics = { method = "midpoint", step = 0.01 }
output = { samples = 2 }
[[surface]]
name = "upper"
bob = [-1.0, 0.0]
velocity = [0.5, 0.0]
[[surface]]
name = "lower"
facing = "up"
"""
RUN = """
import sys, tribo
for scene in sys.argv[1:]:
    print(tribo.simulate(tribo.load_scene(scene))["upper"].theta[-1, 0])
"""
STAMP = "from tribo.kernels.compiled import package_stamp; print(package_stamp())"


def python(code, *arguments, **environment):
    """What a new process prints."""
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        env=os.environ | {key: str(value) for key, value in environment.items()},
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split()


class Workplace:
    """Folders with a scene and a plug-in each, and a cache of their own for what is compiled."""

    def __init__(self, root):
        self.root = root
        self.cache = root / "cache"

    def write(self, name, plugin):
        """A scene beside its plug-in."""
        folder = self.root / name
        folder.mkdir(exist_ok=True)
        (folder / "scene.toml").write_text(SCENE)
        (folder / "own.py").write_text(plugin)

    def run(self, *names, **environment):
        """theta at the end of each scene, all of them run by one new process."""
        scenes = [self.root / name / "scene.toml" for name in names]
        words = python(RUN, *scenes, NUMBA_CACHE_DIR=self.cache, **environment)
        return [float(word) for word in words]

    @property
    def compiled(self):
        """The files of compiled code, with their ages."""
        return {path.name: path.stat().st_mtime_ns for path in self.cache.rglob("*.nbc")}


@pytest.fixture
def place(tmp_path):
    """An empty workplace."""
    return Workplace(tmp_path)


def test_edited_plugin_is_compiled_again(place):
    """An unchanged plug-in comes from the cache; one whose helper has changed does not."""
    place.write("one", PLUGIN)
    first = place.run("one")
    compiled = place.compiled
    assert compiled

    assert place.run("one") == first
    assert place.compiled == compiled

    place.write("one", PLUGIN.replace("POWER = 1", "POWER = 2"))
    assert place.run("one") != first
    compiled = place.compiled

    place.write("one", PLUGIN)
    assert place.run("one") == first
    assert place.compiled == compiled


def test_moved_plugin_is_found(place):
    """A scene and its plug-in can be copied elsewhere, and run with what is compiled already."""
    place.write("one", PLUGIN)
    first = place.run("one")
    place.write("two", PLUGIN)
    assert place.run("two") == first
    assert place.run("two", "one") == first * 2


def test_edited_import_of_a_plugin_is_seen(place):
    """What a plug-in imports from a file of the user's own is part of it."""
    plugin = PLUGIN.replace("POWER = 1", "from powers import POWER")
    place.write("one", plugin)
    found = []
    for power in (1, 2):
        (place.root / "powers.py").write_text(f"POWER = {power}\n")
        found += place.run("one", PYTHONPATH=os.pathsep.join([str(place.root), *sys.path]))
    assert found[0] != found[1]


def test_same_name_in_another_file(place):
    """Two plug-ins with classes of one name are two, in one process and in the cache."""
    place.write("one", PLUGIN)
    place.write("two", PLUGIN.replace("self.s / r", "-self.s / r"))
    one, two = place.run("one", "two")
    compiled = place.compiled
    assert one < 0.0 < two
    assert place.run("two", "one") == [two, one]
    assert place.compiled == compiled


def test_edited_package_is_another(tmp_path):
    """An edit of any source of the package changes the stamp that its kernels are kept under."""
    package = tmp_path / "tribo"
    shutil.copytree(
        Path(tribo.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__")
    )

    def stamp():
        return python(STAMP, PYTHONPATH=tmp_path)

    stamps = [stamp()]
    assert stamp() == stamps[0]
    for name in ("kernels/contact.py", "potentials/coulomb.py", "scene.py"):
        with (package / name).open("a") as source:
            source.write("\n")
        stamps.append(stamp())
    (package / "kernels" / "another.py").touch()
    stamps.append(stamp())
    assert len({word for (word,) in stamps}) == len(stamps)


def test_stamp_is_of_this_package(tmp_path):
    """A copy that differs in nothing has the same stamp, wherever it lies."""
    shutil.copytree(Path(tribo.__file__).parent, tmp_path / "tribo")
    assert python(STAMP, PYTHONPATH=tmp_path) == python(STAMP)
