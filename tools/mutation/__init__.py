"""Mutation testing: the package with one small change in one function, and checks that catch it.

A mutant is made in the syntax tree (`mutants`).  The checks compare runs with independent
solutions, and run uncompiled (`judge`).  They use the solvers of tests/support.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
