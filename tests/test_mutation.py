"""The tool that changes the equations has checks that pass, and tables that fit the source."""

import subprocess
import sys
from pathlib import Path

import pytest

from support.reference import compiler

ROOT = Path(__file__).parents[1]
# Checks of scenes that take a second, one of each kind.
QUICK = ("midpoint, open", "friction, midpoint", "encounters, slid", "verlet, pushed")
TABLES = """
from tools.mutation import judge
from tools.mutation.__main__ import stale

judge.uncompiled()
assert not (left := list(stale())), left
assert not (said := judge.CHECKS["friction, midpoint"]()), said
"""
QUICK_CHECKS = f"""
from types import FunctionType

from tools.mutation import judge

judge.uncompiled()
for name, check in judge.CHECKS.items():
    if isinstance(check, FunctionType) or name in {QUICK}:
        assert not (said := check()), (name, said)
"""
ALL_CHECKS = """
from tools.mutation import judge

judge.uncompiled()
assert not (said := judge.complaints()), said
"""

pytestmark = pytest.mark.skipif(compiler() is None, reason="there is no C compiler")


@pytest.mark.parametrize(
    "code",
    [
        pytest.param(TABLES, id="tables"),
        pytest.param(QUICK_CHECKS, marks=pytest.mark.thorough, id="quick"),
        pytest.param(ALL_CHECKS, marks=pytest.mark.slow, id="all"),
    ],
)
def test_checks_pass_without_a_mutant(code):
    """Uncompiled, in a process of their own."""
    found = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
