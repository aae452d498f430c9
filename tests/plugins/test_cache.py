"""Compiled code is cached on disk, and never used for sources that have changed since."""

import errno
import os
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import tribo
from tribo.compiler import source_stamps
from tribo.compiler.jit import is_compiled, time_loop
from tribo.compiler.numba_private import NATIVE
from tribo.compiler.source_stamps import COMPILED, code_stamp, package_stamp
from tribo.kernels.probe import contact_probe

if NATIVE:
    from tribo.compiler.cache import CodeFiles, KernelCache

# The plain way keeps code in numba's own files.
own_files = pytest.mark.skipif(not NATIVE, reason="numba keeps the files")

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
# A whole run compiles a time loop.  The contact force alone goes the same way to the cache, and
# compiles in a tenth of the time.
RUN = """
import sys, tribo
for scene in sys.argv[1:]:
    print(tribo.simulate(tribo.load_scene(scene))["upper"].theta[-1, 0])
"""
FORCE = """
import sys
import numpy as np
import tribo
from tribo.report_card.scan import PotentialScan
for scene in sys.argv[1:]:
    (interaction,) = tribo.load_scene(scene).interactions
    print(PotentialScan(interaction.potential).compiled(np.array([1.3]))[1][0])
"""
# The energy alone, which goes this way too, takes a tenth of that time again.
ENERGY = """
import ctypes, sys
from numba import types
import tribo
from tribo.compiler.units import memory_of
from tribo.kernels.potential_units import energy_unit
from tribo.threads.model_units import Known
scene = tribo.load_scene(sys.argv[1])
potential = scene.interactions[0].potential
known = Known(potential)
numbers = types.float64, types.float64, types.float64, types.int64
address = known.job(energy_unit, (known.kind, *numbers)).address()
double, word = ctypes.c_double, ctypes.c_int64
unit = ctypes.CFUNCTYPE(double, word, double, double, double, word)(address)
memory, (place,) = memory_of((potential,))
print(unit(int(place), 1.3, 1.0, 1.0, 0))
"""


class Workplace:
    """Folders with a scene and a plug-in each, and a cache of their own for what is compiled."""

    def __init__(self, root, server):
        self.root = root
        self.server = server
        self.cache = root / "cache"

    def write(self, name, plugin):
        """A scene beside its plug-in."""
        folder = self.root / name
        folder.mkdir(exist_ok=True)
        (folder / "scene.toml").write_text(SCENE)
        (folder / "own.py").write_text(plugin)

    def run(self, *names, code=FORCE):
        """The contact force in each scene, or what `code` prints of it, by one new process."""
        scenes = [self.root / name / "scene.toml" for name in names]
        told = self.server.run(code, *scenes, folders=[self.root], NUMBA_CACHE_DIR=self.cache)
        return [float(word) for word in told.split()]

    @property
    def compiled(self):
        """The files of compiled code, with their ages."""
        return {path.name: path.stat().st_mtime_ns for path in self.cache.rglob("*.nbc")}


@pytest.fixture
def place(tmp_path, server):
    """An empty workplace."""
    return Workplace(tmp_path, server)


@pytest.mark.parametrize(
    "code",
    [pytest.param(RUN, marks=pytest.mark.slow, id="run"), pytest.param(FORCE, id="force")],
)
def test_edited_plugin_is_compiled_again(place, code):
    """An unchanged plug-in comes from the cache; one whose helper has changed does not."""
    place.write("one", PLUGIN)
    first = place.run("one", code=code)
    compiled = place.compiled
    assert compiled

    assert place.run("one", code=code) == first
    assert place.compiled == compiled

    place.write("one", PLUGIN.replace("POWER = 1", "POWER = 2"))
    assert place.run("one", code=code) != first
    compiled = place.compiled

    place.write("one", PLUGIN)
    assert place.run("one", code=code) == first
    assert place.compiled == compiled


def test_moved_plugin_is_found(place):
    """A scene and its plug-in can be copied elsewhere, and run with what is compiled already."""
    place.write("one", PLUGIN)
    first = place.run("one")
    place.write("two", PLUGIN)
    assert place.run("two") == first
    assert place.run("two", "one") == first * 2


def test_edited_import_of_a_plugin_is_seen(place):
    """A change of a file that a plug-in imports is a change of the plug-in."""
    plugin = PLUGIN.replace("POWER = 1", "from powers import POWER")
    place.write("one", plugin)
    found = []
    for power in (1, 2):
        (place.root / "powers.py").write_text(f"POWER = {power}\n")
        found += place.run("one")
    assert found[0] != found[1]


def test_same_name_in_another_file(place):
    """Two plug-ins with classes of one name are two, in one process and in the cache."""
    place.write("one", PLUGIN)
    place.write("two", PLUGIN.replace("self.s / r", "-self.s / r"))
    one, two = place.run("one", "two")
    compiled = place.compiled
    assert one > 0.0 > two
    assert place.run("two", "one") == [two, one]
    assert place.compiled == compiled


def test_edited_module_is_seen(place):
    """So is a change in the package of a class that is given by its module's name."""
    package = place.root / "own_package"
    (package / "deep").mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "deep" / "__init__.py").touch()
    (package / "deep" / "own.py").write_text(
        PLUGIN.replace("POWER = 1", "from ..powers import POWER")
    )
    place.write("one", "")
    scene = place.root / "one" / "scene.toml"
    scene.write_text(SCENE.replace("own.py:Own", "own_package.deep.own:Own"))
    found = []
    for power in (1, 2, 1):
        (package / "powers.py").write_text(f"POWER = {power}\n")
        found += place.run("one")
    assert found[0] == found[2] != found[1]


def test_expressions_are_kept_apart(place):
    """Another expression is another class; the same is found in the cache by a new process."""
    found = []
    for text in ("s/r", "s/r**2", "s/r"):
        place.write("one", "")
        scene = place.root / "one" / "scene.toml"
        scene.write_text(SCENE.replace("own.py:Own", text))
        found += place.run("one")
    compiled = place.compiled
    assert found[0] == found[2] != found[1]
    assert place.run("one") == found[2:]
    assert place.compiled == compiled


TYPED_IN = """
import numpy as np
from tribo.potentials import as_potential
from tribo.report_card.scan import PotentialScan
{plugin}
print(PotentialScan(as_potential(Own(0.2))).compiled(np.array([1.3]))[1][0])
"""


def test_a_class_that_is_typed_in(place):
    """It works, edited or not, and leaves no compiled code on disk."""
    place.write("one", PLUGIN)
    expected = place.run("one")
    place.write("one", PLUGIN.replace("POWER = 1", "POWER = 2"))
    expected += place.run("one")
    compiled = place.compiled
    found = []
    for power in (1, 2):
        plugin = PLUGIN.replace("POWER = 1", f"POWER = {power}")
        told = subprocess.run(
            [sys.executable, "-"],
            input=TYPED_IN.format(plugin=plugin),
            env=os.environ | {"NUMBA_CACHE_DIR": str(place.cache)},
            check=True,
            capture_output=True,
            text=True,
        )
        found.append(float(told.stdout))
    assert found == expected
    assert place.compiled == compiled


CASE_A = """
import sys
from dataclasses import replace
import tribo
from tribo import paper
from tribo.potentials import named
for strength in map(float, sys.argv[2:]):
    potential = named(sys.argv[1], strength=strength)
    scene = replace(paper.scene("A"), interactions=potential, output=tribo.Output(samples=2))
    result = tribo.simulate(scene, accuracy=1e-10)
    for works in (result["upper"], result["lower"]):
        print(*(works[name][-1, 0] for name in ("w1", "w2", "wL", "wR", "w1_ps", "w2_ps")))
"""


def test_an_energy_of_ones_own_has_the_works_of_case_a(tmp_path, server):
    """To 1e-8; and edited to half its strength, those of half the strength."""

    def works(potential, *strengths):
        """All works of case A of the paper, by a new process."""
        return [float(word) for word in server.run(CASE_A, potential, *strengths).split()]

    path = tmp_path / "own.py"
    text = (
        "from typing import NamedTuple\n"
        "class Own(NamedTuple):\n"
        "    strength: float\n"
        "    def energy(self, r): return self.strength / r\n"
    )
    path.write_text(text)
    full = works(f"{path}:Own", 0.2)
    path.write_text(text.replace("self.strength / r", "self.strength / (2.0 * r)"))
    half = works(f"{path}:Own", 0.2)
    expected = works("coulomb", 0.2, 0.1)
    assert full + half == pytest.approx(expected, abs=1e-8)
    assert max(abs(one - other) for one, other in zip(full, half, strict=True)) > 1e-2


@pytest.fixture
def copy(monkeypatch, tmp_path):
    """A copy of the package's sources, of which the stamp is made."""
    package = tmp_path / "tribo"
    shutil.copytree(
        Path(tribo.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__")
    )
    monkeypatch.setattr(source_stamps, "__file__", str(package / "kernels" / "stamps.py"))
    return package


@pytest.mark.parametrize(
    ("stamp", "others"),
    [(code_stamp, ()), (package_stamp, ("model/scene.py", "plotting/style.py"))],
)
def test_edited_package_is_another(copy, stamp, others):
    """An edit of a compiled source changes the stamp of machine code, and of others it does not."""
    stamps = [stamp.__wrapped__()]
    edited = ["kernels/contact.py", "potentials/charges.py", "model/fields.py", *others]
    for name in edited:
        with (copy / name).open("a") as source:
            source.write("\n")
        stamps.append(stamp.__wrapped__())
    (copy / "kernels" / "another.py").touch()
    stamps.append(stamp.__wrapped__())
    assert len(set(stamps)) == len(edited) + 2


def test_edited_docstring_compiles_nothing(copy):
    """An edit of a file that is not compiled leaves machine code in use."""
    with (copy / "plotting" / "style.py").open("a") as source:
        source.write("\n")
    assert code_stamp.__wrapped__() == code_stamp()


def test_all_compiled_sources_are_in_the_stamp():
    """Kernels, and classes whose methods numba compiles, are in the folders that are hashed."""
    root = Path(tribo.__file__).parent
    marks = re.compile(
        r"^@(\w*kernel|inlined|expanded|intrinsic|overload|register_jitable)\b"
        r"|def (energy\(self, r\b|(energy_at|force_on_bar|end_forces)\(self)",
        re.MULTILINE,
    )
    for path in root.rglob("*.py"):
        name = path.relative_to(root).as_posix()
        if marks.search(path.read_text("utf-8")) and "scenes/" not in name:
            # Live pages compile modules of their own, which have their own stamp.
            assert name.startswith((*COMPILED, "live_pages")), name


def test_stamp_is_of_this_package(copy):
    """An identical copy in another folder has the same stamp."""
    assert package_stamp.__wrapped__() == package_stamp()
    assert code_stamp.__wrapped__() == code_stamp()


def test_stamps_leave_out_what_is_kept_beside_compiled_code(copy):
    """Speeds that were measured are in a file there."""
    before = package_stamp.__wrapped__(), code_stamp.__wrapped__()
    kept = copy / "pair" / "__pycache__"
    kept.mkdir()
    (kept / "speeds.json").write_text("{}")
    assert (package_stamp.__wrapped__(), code_stamp.__wrapped__()) == before


@own_files
def test_damaged_files_are_compiled_again(place):
    """By two processes at once; afterwards the files are whole again."""
    place.write("one", PLUGIN)
    (first,) = place.run("one")
    files = sorted(place.cache.rglob("*.nbc"))
    whole = {path: path.stat().st_size for path in files}
    assert files
    for path in files:
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    scene = place.root / "one" / "scene.toml"
    environment = os.environ | {"NUMBA_CACHE_DIR": str(place.cache)}
    command = [sys.executable, "-W", "error", "-c", FORCE, str(scene)]
    both = [
        subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
        for _ in range(2)
    ]
    assert [float(process.communicate()[0]) for process in both] == [first, first]
    again = {path: path.stat().st_size for path in place.cache.rglob("*.nbc")}
    assert again.keys() == whole.keys() and all(again[path] > 0.9 * whole[path] for path in whole)


@own_files
def test_no_damage_goes_unnoticed(tmp_path):
    """A file with any bit changed, cut short or of another function is not used."""
    index = SimpleNamespace(_cache_path=tmp_path, _index_name="loop-1.nbi", _source_stamp=(1, 2))
    files = CodeFiles(index)
    key = (("float64",), "x86")
    code = (b"machine code" * 20, {"a": 1})
    assert files.load(key) is None
    files.save(key, code)
    assert files.load(key) == code and files.load((("int64",), "x86")) is None
    (path,) = tmp_path.iterdir()
    content = path.read_bytes()
    rng = random.Random(0)
    for _ in range(300):
        damaged = bytearray(content)
        damaged[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
        path.write_bytes(damaged[: rng.choice([len(content), rng.randrange(len(content))])])
        assert files.load(key) is None
    index._source_stamp = (1, 3)
    path.write_bytes(content)
    assert CodeFiles(index).load(key) is None


@own_files
def test_no_folder_for_files(monkeypatch):
    """Loops are compiled without a cache where none can be written."""

    def nowhere(function):
        raise RuntimeError("cannot cache function: no locator available")

    monkeypatch.setattr("tribo.compiler.jit.KernelCache", nowhere)
    loop = time_loop.__wrapped__(contact_probe)
    assert loop.stats.cache_path is None and not is_compiled(loop)


@own_files
def test_full_disk(monkeypatch):
    """Code that can no longer be written is used from memory."""

    def full(cache, signature, data):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(KernelCache.__base__, "_save_overload", full)
    KernelCache(contact_probe).save_overload(None, None)


# Where a plug-in takes its factor from: what stands before the class, and in place of `factor()`.
SOURCES = {
    "file": ("A = float((HERE / 'a.txt').read_text())", "A"),
    "array": ("A = np.array([float((HERE / 'a.txt').read_text())])", "A[0]"),
    "environment": ("import os\nA = float(os.environ['FACTOR'])", "A"),
    "helper": ("import reads", "reads.A"),
    "jitted": ("from reads import factor", "factor()"),
    "default": ("from reads import scaled", "scaled(1.0)"),
    "closure": ("from reads import enclosed", "enclosed(1.0)"),
    "installed": ("from upgraded import factor", "factor()"),
}
READS = """
import pathlib
import numba
A = float((pathlib.Path(__file__).parent / "a.txt").read_text())
@numba.njit(cache=True)
def factor():
    return A
@numba.njit
def scaled(x, by=A):
    return x * by
def made(a):
    @numba.njit
    def inner(x):
        return x * a
    return inner
enclosed = made(A)
"""
READER = """
import pathlib
from typing import NamedTuple
import numpy as np
HERE = pathlib.Path(__file__).parent
{before}
class Own(NamedTuple):
    s: float
    def energy(self, r):
        return {factor} * self.s / r
    def force(self, r):
        return {factor} * self.s / (r * r)
"""


@pytest.mark.parametrize("source", SOURCES)
def test_values_that_are_compiled_are_seen(place, source):
    """Each process reads it again: other values are other code, and the same are found again."""
    before, factor = SOURCES[source]
    place.write("one", READER.format(before=before, factor=factor))
    folder = place.root / "one"
    site = place.root / "site-packages"
    site.mkdir()
    (folder / "reads.py").write_text(READS)
    found = []
    for value in (1.0, 2.0, 1.0):
        (folder / "a.txt").write_text(str(value))
        (site / "upgraded.py").write_text(
            f"import numba\n@numba.njit(cache=True)\ndef factor():\n    return {value}\n"
        )
        found.append(
            place.server.run(
                ENERGY,
                folder / "scene.toml",
                folders=[site],
                NUMBA_CACHE_DIR=place.cache,
                FACTOR=value,
                PYTHONDONTWRITEBYTECODE=1,
            )
        )
    assert float(found[1]) == pytest.approx(2.0 * float(found[0]), rel=1e-14)
    assert found[2] == found[0]


IN_PROCESS = """
import numpy as np, numba, sys
from typing import NamedTuple
from tribo.potentials import as_potential
from tribo.report_card.scan import PotentialScan
A = 1.0
@numba.njit
def helper(r):
    return A / r
class Own(NamedTuple):
    s: float
    def energy(self, r):
        return self.s * helper(r)
    def force(self, r):
        return self.s * helper(r) / r
for A in (1.0, 2.0, 1.0):
    print(PotentialScan(as_potential(Own(1.0))).compiled(np.array([2.0]))[1][0])
"""


def test_a_changed_global_is_seen_in_one_process(server):
    """Through a compiled function that a plug-in calls."""
    assert server.run(IN_PROCESS).split() == ["0.25", "0.5", "0.25"]
