"""Mutants that no check catches."""

# No result changes: mutant -> why.
EQUIVALENT = {
    "kernels/equations_of_motion.py: accelerate: a.dof_y >= 0 -> a.dof_y >= 1": (
        "the first slots are those of the swings; none of y is 0"
    ),
    "kernels/equations_of_motion.py: stretch: yi - yj + bond.y -> yi - yj + bond.x": (
        "both are 0 unless the lattice is turned: tests/run/test_invariances.py, test_rotation"
    ),
}

# Results, costs or statuses may change, and no check notices: each of these is a gap.
OPEN: set[str] = set()

# Functions that uncompiled code cannot reach -> where they are tested.
NEEDS_COMPILER = {
    "call_outside": "tests/potentials/test_live_calculators.py",
    "add_calculated": "tests/potentials/test_live_calculators.py",
    "calculated_energy": "tests/potentials/test_live_calculators.py",
}
