"""Mutants that no check catches."""

# No result changes: mutant -> why.
EQUIVALENT: dict[str, str] = {}

# Results, costs or statuses may change, and no check notices: each of these is a gap.
OPEN: set[str] = set()

# Functions that uncompiled code cannot reach -> where they are tested.
NEEDS_COMPILER = {
    "call_outside": "tests/potentials/test_live_calculators.py",
    "add_calculated": "tests/potentials/test_live_calculators.py",
    "calculated_energy": "tests/potentials/test_live_calculators.py",
}
