"""Plug-ins in files: what they import, where they lie, and processes that lack their files."""

import json
import pickle
import shutil
import sys
import zipfile

import pytest

from support.command import main
from tribo import InputError, load_scene
from tribo.model.identity import as_sent, received
from tribo.plugins.sources import is_installed, place_of

OWN = """
from typing import NamedTuple
from factors import FACTOR

class Own(NamedTuple):
    s: float
    def energy(self, r):
        return FACTOR * self.s / r
"""
SCENE = """
duration = 1.0
interaction = { potential = "own.py:Own", s = 0.2 }
[[surface]]
name = "upper"
[[surface]]
name = "lower"
facing = "up"
"""


def written(folder, factor):
    """A scene beside a plug-in that imports a file."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(SCENE)
    (folder / "own.py").write_text(OWN)
    (folder / "factors.py").write_text(f"FACTOR = {factor}\n")
    return folder / "scene.toml"


def energy(scene):
    return scene.interactions[0].potential.energy(1.0)


def test_each_plugin_imports_the_files_beside_it(tmp_path):
    """Of the same names in two folders, and the search for modules is as before."""
    path = list(sys.path)
    one, two = (load_scene(written(tmp_path / name, f)) for name, f in (("one", 1.0), ("two", 3.0)))
    assert (energy(one), energy(two)) == (0.2, pytest.approx(0.6))
    assert sys.path == path


@pytest.mark.parametrize(
    ("file", "installed"),
    [
        ("{0}/lib/python3.11/site-packages/package/module.py", True),
        (json.__file__, True),
        ("{0}_work/own.py", False),
        ("{0}/project/own.py", False),
    ],
)
def test_what_is_installed(file, installed):
    """Not a project beside its environment, or in its folder."""
    assert is_installed(file.format(sys.prefix)) is installed


def test_a_plugin_within_installed_packages_is_named_by_its_file(tmp_path):
    """If it was loaded from it: its module has a name that no one else can load."""
    scene = load_scene(written(tmp_path / "site-packages", 1.0))
    place = place_of(type(scene.interactions[0].potential))
    assert place == str(tmp_path / "site-packages" / "own.py")


def test_a_process_without_the_file(tmp_path, server):
    """It gets the source, and is told how it gets what that imports."""
    scene = load_scene(written(tmp_path / "mine", 2.0))
    content = tmp_path / "sent"
    content.write_bytes(pickle.dumps(as_sent(scene)))
    expected = energy(scene)
    shutil.move(tmp_path / "mine", tmp_path / "uploaded")
    program = """
import pickle, sys
from pathlib import Path
from tribo.model.identity import received
try:
    scene = received(*pickle.loads(Path(sys.argv[1]).read_bytes()))
    print(scene.interactions[0].potential.energy(1.0))
except Exception as error:
    print(error)
"""
    assert float(server.run(program, content, folders=[tmp_path / "uploaded"])) == expected
    assert "client.upload_file" in server.run(program, content)
    (tmp_path / "uploaded" / "factors.py").write_text("FACTOR = 5.0\n")
    assert "reads other values" in server.run(program, content, folders=[tmp_path / "uploaded"])


def test_code_without_sources_is_reported_as_it_was(tmp_path):
    """The hint on workers is given only where sources were sent."""
    text, _, stamps = as_sent(load_scene(written(tmp_path, 1.0)))
    (tmp_path / "own.py").unlink()
    with pytest.raises(InputError, match="there is no file") as caught:
        received(text, {}, stamps)
    assert "worker" not in str(caught.value)


def test_a_bundle_holds_what_a_plugin_imports(tmp_path, monkeypatch, capsys):
    """Files and packages beside it, and what these import."""
    scene = written(tmp_path, 1.0)
    (tmp_path / "factors.py").write_text("from deep.more import FACTOR\n")
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "__init__.py").touch()
    (tmp_path / "deep" / "more.py").write_text("FACTOR = 1.0\n")
    (tmp_path / "unrelated.py").touch()
    assert main(["bundle", str(scene), "-o", str(tmp_path / "all.zip")]) == 0
    names = set(zipfile.ZipFile(tmp_path / "all.zip").namelist())
    assert {"own.py", "factors.py", "deep/__init__.py", "deep/more.py"} <= names
    assert "unrelated.py" not in names
