"""Every effect acts beside every other, with noise and without."""

import os
import subprocess
import sys
from pathlib import Path

from support.package import SOURCE

TESTS = Path(__file__).parents[1]


def test_pairs_of_effects():
    """In all pairs of effects both act as by rk4, and the ledger closes; see support/crossed.py."""
    path = os.pathsep.join([str(SOURCE.parent), str(TESTS)])
    run = subprocess.run(
        [sys.executable, "-W", "ignore", "-m", "support.crossed"],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (run.returncode, run.stdout) == (0, ""), run.stdout + run.stderr
