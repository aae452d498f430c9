"""Mutation testing: the package with one small change in one function, and tests that catch it.

A mutant is made in the syntax tree (`mutants`), and judged by tests that run uncompiled (`judge`).
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
