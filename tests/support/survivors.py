"""Mutants that no check catches."""

# No result changes: mutant -> why.
EQUIVALENT = {
    "kernels/equations_of_motion.py: accelerate: a.dof_y >= 0 -> a.dof_y >= 1": (
        "the first slots are those of the swings; none of y is 0"
    ),
    "kernels/neighbours.py: sort_into_cells: max(extent_z / nz, reach) -> "
    "max(extent_z * nz, reach)": (
        "wider cells hold all pairs within reach, which are then sorted: only the cost changes"
    ),
    "run/accounts.py: accounts: -1 -> -2": "any negative slot is absent",
    "run/accounts.py: accounts: (column(a.acc_contact, k) for k in range(4)) -> "
    "(column(k, a.acc_contact) for k in range(4))": (
        "slot and number are added, and every asperite has the account of contact"
    ),
    "kernels/samples.py: initial_state: 0 if splits else n -> 1 if splits else n": (
        "splitting methods do not read the acceleration of a state: one number of memory"
    ),
}

# Results, costs or statuses may change, and no check notices: each of these is a gap.
OPEN: set[str] = set()

# Functions that uncompiled code cannot reach -> where they are tested.
NEEDS_COMPILER = {
    "call_calculator": "tests/potentials/test_live_calculators.py",
    "add_calculated": "tests/potentials/test_live_calculators.py",
    "calculated_energy": "tests/potentials/test_live_calculators.py",
}
