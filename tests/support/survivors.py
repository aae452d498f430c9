"""Mutants that no check catches."""

OWN_DRIVE = (
    "slot and number are added; where a drive has no account, the column is another one, not used"
)
AFTER_SWINGS = "the first slots are those of the swings; no other coordinate has slot 0"
# No result changes: mutant -> why.
EQUIVALENT = {
    "kernels/contact.py: fastest_approach: fastest = 0.0 -> fastest = 1.0": (
        "a bound on the rate that is too high: only the cost changes"
    ),
    "kernels/equations_of_motion.py: bar_angles: s.dof_phi >= 0 -> s.dof_phi >= 1": AFTER_SWINGS,
    "kernels/equations_of_motion.py: accelerate_block: s.dof_phi >= 0 -> s.dof_phi >= 1": (
        AFTER_SWINGS
    ),
    "kernels/equations_of_motion.py: accelerate_block: s.dof_phi >= 0 -> s.dof_phi >= 1 (2)": (
        AFTER_SWINGS
    ),
    "kernels/equations_of_motion.py: accelerate_block: s.dof_x >= 0 -> s.dof_x >= 1": AFTER_SWINGS,
    "kernels/equations_of_motion.py: accelerate_block: s.dof_y >= 0 -> s.dof_y >= 1": AFTER_SWINGS,
    "kernels/equations_of_motion.py: add_end_torques: s.acc_user_ends >= 0 -> "
    "s.acc_user_ends >= 1": "the first slots are those of contact; no user's ends have slot 0",
    "kernels/neighbours.py: sort_into_cells: max(extent_z / nz, reach) -> "
    "max(extent_z * nz, reach)": (
        "wider cells hold all pairs within reach, which are then sorted: only the cost changes"
    ),
    "run/accounts.py: accounts: -1 -> -2": "any negative slot is absent",
    "run/accounts.py: accounts: (column(a.acc_contact, k) for k in range(4)) -> "
    "(column(k, a.acc_contact) for k in range(4))": (
        "slot and number are added, and every asperite has the account of contact"
    ),
    "run/accounts.py: accounts: a.acc_drive >= 0 -> a.acc_drive >= 1": (
        "the first slots are those of contact; no drive has slot 0"
    ),
    "run/accounts.py: accounts: -a.l2 * column(a.acc_drive, 2) -> "
    "-a.l2 * column(2, a.acc_drive)": OWN_DRIVE,
    "run/accounts.py: accounts: np.where(own, column(a.acc_drive, 0), -held * jx) -> "
    "np.where(own, column(0, a.acc_drive), -held * jx)": OWN_DRIVE,
    "run/accounts.py: accounts: np.where(own, column(a.acc_drive, 1), -jy) -> "
    "np.where(own, column(1, a.acc_drive), -jy)": OWN_DRIVE,
    "run/accounts.py: accounts: "
    "np.where(own, column(a.acc_drive, 3), -(held * slide_x + slide_y)) -> "
    "np.where(own, column(3, a.acc_drive), -(held * slide_x + slide_y))": OWN_DRIVE,
    "run/accounts.py: accounts: range(8) -> range(9)": (
        "the column after is not used; it exists, since the surface of such bars has an account"
    ),
    "run/totals.py: block_table: record.acc_block >= 0 -> record.acc_block >= 1": (
        "the first slots are those of contact; no surface has slot 0"
    ),
    "run/totals.py: system_table: field.account >= 0 -> field.account >= 1": (
        "the first slots are those of contact; no field has slot 0"
    ),
    "integrators/time_loops.py: equal_steps: zero_rows(3, model.asperites.shape[1]) -> "
    "zero_rows(4, model.asperites.shape[1])": "one more row of memory, not used",
    "integrators/time_loops.py: adaptive_steps: zero_rows(3, model.asperites.shape[1]) -> "
    "zero_rows(4, model.asperites.shape[1])": "one more row of memory, not used",
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
