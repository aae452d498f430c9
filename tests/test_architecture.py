"""The house: imports run downward only, kernels stand on nothing, and `import tribo` is light."""

import ast
import importlib.util
import re
import runpy
import subprocess
import sys
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import tribo
from tribo.potentials import BUILT_IN

ROOT = Path(tribo.__file__).parent


def modules():
    """Every module's name below `tribo`, and its file; the package itself is the empty name."""
    for path in sorted(ROOT.rglob("*.py")):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        yield "" if name == "__init__" else name.removesuffix(".__init__"), path


FILES = dict(modules())


def imported(tree):
    """Full names that a file imports, inside functions and for type checkers included."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute here"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@cache
def tree_of(path):
    """The syntax of a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


def of_this_package(name):
    """The modules of this package that a module imports, inside functions or not."""
    for full in imported(tree_of(FILES[name])):
        top, _, inner = full.partition(".")
        if top == "tribo":
            while inner not in FILES:
                inner = inner.rpartition(".")[0]
            yield inner


# Folders and files at the top level, from the top down: each may import those below it, and
# `validation` may be imported by all.
ORDER = [
    "__main__",
    "commands",
    "paper",
    "report_card",
    "atlas",
    "fitting",
    "derivatives",
    "sweeps",
    "work_precision",
    "ensembles",
    "sliders",
    "live_pages",
    "simulation",
    "prepared",
    "result",
    "explanation",
    "viewer",
    "export",
    "plotting",
    "accuracy",
    "results",
    "analysis",
    "loops",
    "ledger",
    "threads",
    "layout",
    "pair",
    "lanes",
    "integrators",
    "model",
    "potentials",
    "plugins",
    "kernels",
    "compiler",
    "starters",
    "units",
    "decimal_commas",
    "files",
    "seals",
    "first_read",
    "progress",
    "interrupts",
    "system",
    "validation",
]


def room(name):
    """The folder of a module, or the module itself at the top level."""
    return name.partition(".")[0]


def test_folders_import_downward():
    """The graph of folders has the order above; every folder and top-level file has a place."""
    assert set(ORDER) == {room(name) for name in FILES if name}
    for name in filter(None, FILES):
        below = ORDER[ORDER.index(room(name)) :]
        above = [other for other in of_this_package(name) if other and room(other) not in below]
        assert not above, f"{name} imports {above}"


def test_modules_have_no_cycle():
    """Nor do the modules inside a folder import one another in a circle, lazily or not."""
    graph = {name: set(of_this_package(name)) - {name} for name in FILES if name}
    TopologicalSorter(graph).prepare()  # raises CycleError


def test_no_module_is_imported_by_a_string():
    """But for the public names; plug-ins and calculators that users name are of other packages."""
    for name in FILES.keys() - {""}:
        text = FILES[name].read_text(encoding="utf-8")
        assert not re.search(r"import_module\(\s*f?[\"']tribo", text), name


COMPILED = [name for name in FILES if name.startswith(("kernels", "compiler"))]


@pytest.mark.parametrize("name", COMPILED)
def test_kernels_see_no_scene(name):
    """Compiled code imports compiled code, numpy and numba: floats and arrays, nothing above.

    Compilation holds interrupts, says that it goes on, refuses settings, and asks what the system
    can do; those modules import nothing above them.
    """
    own = ("kernels", "compiler")
    inner = {other for other in of_this_package(name) if not other.startswith(own)}
    assert inner <= {"interrupts", "progress", "system", "validation"}
    assert set(of_this_package("interrupts")) <= {"system"}
    assert not {*of_this_package("system"), *of_this_package("validation")}
    tree = tree_of(FILES[name])
    tops = {full.partition(".")[0] for full in imported(tree)}
    assert tops - set(sys.stdlib_module_names) <= {"tribo", "numpy", "numba", "llvmlite"}


def test_undocumented_names_of_numba_are_in_one_file():
    """No other file imports more than what the manuals of numba and llvmlite describe."""
    documented = (
        *(
            "numba.extending",
            "llvmlite.ir",
            "llvmlite.binding",
            "numba.njit",
            "numba.jit",
            "numba.cfunc",
            "numba.config",
        ),
        *(
            "numba.core.event.",
            "numba.types",
            "numba.typeof",
            "numba.literal_unroll",
            "numba.from_dtype",
            "numba.get_num_threads",
        ),
        *("numba.NumbaError", "numba.TypingError", "numba.UnsupportedBytecodeError"),
    )
    for name in FILES.keys() - {"compiler.numba_private"}:
        for full in imported(tree_of(FILES[name])):
            if full.partition(".")[0] in ("numba", "llvmlite"):
                assert full.startswith(documented) or full == "numba", f"{name} imports {full}"


FORMULAE = sorted({cls.__module__.rpartition(".")[2] for cls in BUILT_IN.values()})


@pytest.mark.parametrize("name", [*FORMULAE, "cutoff"])
def test_potentials_are_formulae(name):
    """A potential is what a user could have written: it needs its bases, and no more."""
    bases = {"potentials.potential"} | ({"potentials.combined"} if name == "cutoff" else set())
    assert set(of_this_package(f"potentials.{name}")) == bases


def test_derivatives_need_nothing():
    """Formulas are differentiated from their text alone."""
    assert not list(of_this_package("potentials.derivative"))


HEAVY = {"ase", "matplotlib", "xarray", "netCDF4", "scipy", "tqdm", "numba", "tomli_w"}


@pytest.mark.parametrize(
    ("statement", "loaded"),
    [
        ("import tribo", set()),
        ("import tribo; tribo.Asperite, tribo.load_scene, tribo.Scene, tribo.Coulomb", set()),
        ("from tribo.commands.cli import main", set()),
        ("from tribo import *", {"numba", "scipy"}),  # numba itself loads scipy
    ],
)
def test_what_an_import_loads(statement, loaded):
    """A scene can be described without waiting for a compiler, or for what draws and saves."""
    code = f"{statement}\nimport sys; print(*{HEAVY} & sys.modules.keys())"
    words = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert set(words.stdout.split()) <= loaded


def test_public_names():
    """Every name in __all__ is there, has its home in the package, and nothing else is."""
    for name in tribo.__all__:
        assert getattr(tribo, name) is not None
    assert sorted(dir(tribo)) == sorted(tribo.__all__)
    assert len(set(tribo.__all__)) == len(tribo.__all__)
    assert not hasattr(tribo, "no_such_name")


def test_every_module_says_what_it_is():
    """One sentence at least at the head of each file that is not empty."""
    for name, path in FILES.items():
        tree = tree_of(path)
        assert not tree.body or ast.get_docstring(tree), f"{name} has no docstring"


TESTS = sorted(Path(__file__).parent.rglob("*.py"))


def test_no_test_module_is_imported():
    """Functions that two test modules share stand in tests/support."""
    for path in TESTS:
        tops = {full.partition(".")[0] for full in imported(tree_of(path))}
        found = {top for top in tops if top == "conftest" or top.startswith("test")}
        assert not found, f"{path.name} imports {found}"


def test_slow_tests_are_tests():
    """Each name in the list of slow tests is that of a test."""
    folder = Path(__file__).parent
    for name in (folder / "slow_tests.txt").read_text(encoding="utf-8").splitlines():
        file, _, test = name.partition("::")
        source = (folder.parent / file).read_text(encoding="utf-8")
        assert f"def {test.partition('[')[0]}(" in source, name


# Programs beside the package, most of which no test runs.
PROGRAMS = [
    path
    for folder in ("benchmarks", "docs", "examples", "tools")
    for path in sorted((Path(__file__).parents[1] / folder).rglob("*.py"))
]


def is_there(full):
    """Whether a module or a name in one exists."""
    module, _, name = full.rpartition(".")
    owner = importlib.import_module(module)
    is_package = hasattr(owner, "__path__")
    return hasattr(owner, name) or (is_package and importlib.util.find_spec(full) is not None)


def test_programs_import_what_is_there():
    """A name that a program imports from the package has not been renamed or removed."""
    assert len(PROGRAMS) > 50
    for path in PROGRAMS:
        names = [full for full in imported(tree_of(path)) if full.startswith("tribo.")]
        missing = [full for full in names if not is_there(full)]
        assert not missing, f"{path.parent.name}/{path.name} imports {missing}"


# LAMMPS has styles for some potentials, which replace the formula that serves for all of them.
ALLOWED = {"export.lammps_pairs": ["Coulomb", "Shifted", "Truncated", "WeeksChandlerAndersen"]}

# Folders below which the classes of scenes' parts are defined.
DESCRIBE_SCENES = ("model", "potentials", "plugins")


def classes_in(name):
    """The names of the classes that a module defines."""
    tree = tree_of(FILES[name])
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.ClassDef)}


def classes_asked_for(name):
    """The names in the second argument of each isinstance, and in comparisons with a type."""
    for node in ast.walk(tree_of(FILES[name])):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "isinstance":
            kinds = node.args[1]
        elif isinstance(node, ast.Compare) and ast.unparse(node.left).startswith("type("):
            kinds = node
        else:
            continue
        yield from (each.id for each in ast.walk(kinds) if isinstance(each, ast.Name))
        yield from (each.attr for each in ast.walk(kinds) if isinstance(each, ast.Attribute))


def test_what_a_part_of_a_scene_is_is_declared_by_its_class():
    """Nothing outside of the folders that define them asks for the class of a drive or a field."""
    describing = {name for name in FILES if name and room(name) in DESCRIBE_SCENES}
    parts = set().union(*map(classes_in, describing))
    found = {
        name: sorted(parts & set(classes_asked_for(name)))
        for name in FILES
        if name and name not in describing
    }
    assert {name: kinds for name, kinds in found.items() if kinds} == ALLOWED


def test_tests_use_public_names_where_there_are_some():
    """tools/internals.py says which name takes the place of another."""
    tool = runpy.run_path(str(Path(__file__).parents[1] / "tools" / "internals.py"))
    found = {
        path.name: names
        for path in sorted(Path(__file__).parent.rglob("test_*.py"))
        if path != Path(__file__)
        and (names := tool["REPLACEABLE"].keys() & set(tool["used"](path)))
    }
    # Values that no file can hold.
    assert found == {"test_input_errors.py": {"tribo.model.scene_file.scene_from"}}
