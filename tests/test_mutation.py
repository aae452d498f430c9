"""The tool that changes the equations: its tables fit the source, and it tells mutants apart."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from support.reference import compiler

ROOT = Path(__file__).parents[1]
TABLES = """
from tools.mutation.__main__ import stale

assert not (left := list(stale())), left
"""
# Judged by the tests of two functions alone, which take less than a second.
VERDICTS = """
import ast
from tools.mutation import judge
from tools.mutation.mutants import mutants, parsed

judge.uncompiled()
judge.TESTS = [test for test in judge.TESTS if test.startswith("kernels/test_kinematics")]
file = "kernels/kinematics.py"
functions = ("nearest_image", "rod_position")
chosen = [mutant for mutant in mutants(file) if mutant.function in functions]
assert len(chosen) > 10
missed = [str(m) for m in chosen if not judge.verdict(m.file, m.function, m.source())]
assert not missed, missed
unchanged = ast.unparse(parsed(file))
for function in functions:
    assert judge.verdict(file, function, unchanged) == "", function
endless = "def nearest_image(difference, period):\\n    while True:\\n        pass"
assert "Hangs" in judge.verdict(file, "nearest_image", endless)
"""


@pytest.mark.parametrize(
    "code", [pytest.param(TABLES, id="tables"), pytest.param(VERDICTS, id="verdicts")]
)
def test_tool(code):
    """In a process of its own, whose kernels are plain Python."""
    found = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert found.returncode == 0, found.stderr


@pytest.mark.skipif(compiler() is None, reason="there is no C compiler")
@pytest.mark.parametrize(
    "files",
    [
        pytest.param(
            ["test_steps.py", "test_reservoirs.py"], id="steps", marks=pytest.mark.thorough
        ),
        pytest.param(
            ["test_lists.py", "test_cells.py", "test_starts.py"],
            id="lists and starts",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            ["test_scenes.py", "-k", "not test_accuracy"],
            id="scenes",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            ["test_scenes.py", "-k", "test_accuracy"], id="accuracy", marks=pytest.mark.slow
        ),
    ],
)
def test_uncompiled(files):
    """The tests by which the tool judges pass when nothing is changed."""
    folder = ROOT / "tests" / "uncompiled"
    chosen = [str(folder / each) if each.endswith(".py") else each for each in files]
    found = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "", *chosen],
        cwd=ROOT,
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
    )
    assert found.returncode == 0, found.stdout[-4000:]
