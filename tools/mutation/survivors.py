"""Mutants that no check catches."""

AFTER_SWINGS = "the first slots are those of the swings; no other coordinate has slot 0"
WIDER = "more cells are searched for boxes within reach: only the cost changes"
ROUNDED = "only a place that is rounded up to the period is not below the number of cells"
# No result changes: mutant -> why.
EQUIVALENT = {
    "kernels/encounters.py: fastest_approach: fastest = 0.0 -> fastest = 1.0": (
        "a bound on the rate that is too high: only the cost changes"
    ),
    "kernels/packs.py: keeps_velocity: s.dof_x < 0 -> s.dof_x < 1": AFTER_SWINGS,
    "kernels/packs.py: keeps_velocity: s.dof_y < 0 -> s.dof_y < 1": AFTER_SWINGS,
    "integrators/kicks.py: drive_in_kick: s.acc_drive >= 0 -> s.acc_drive >= 1": (
        "the first slots are those of contact; no drive has slot 0"
    ),
    "kernels/equations_of_motion.py: bar_angles: s.dof_phi >= 0 -> s.dof_phi >= 1": AFTER_SWINGS,
    "kernels/equations_of_motion.py: accelerations: s.dof_phi >= 0 -> s.dof_phi >= 1": (
        AFTER_SWINGS
    ),
    "kernels/equations_of_motion.py: accelerations: s.dof_phi >= 0 -> s.dof_phi >= 1 (2)": (
        AFTER_SWINGS
    ),
    "integrators/bar_pushes.py: push_bars: slot < 0 -> slot < 1": (
        "the first slots are those of contact; no bath and no reservoir has slot 0"
    ),
    "kernels/powers.py: add_drive_powers: s.acc_drive >= 0 -> s.acc_drive >= 1": (
        "the first slots are those of contact; no drive has slot 0"
    ),
    "kernels/powers.py: powers_unit: "
    "powers_of_pack(model, s, i, 1.0, t, q, velocities, power) -> "
    "powers_of_pack(model, s, i, 2.0, t, q, velocities, power)": (
        "only whether the torsion springs count matters: any number but 0 says that they do"
    ),
    "kernels/cells.py: adjacent: cell - 1 -> cell - 2 (2)": WIDER,
    "kernels/cells.py: adjacent: cell + 2 -> cell + 3 (2)": WIDER,
    "kernels/cells.py: cell_of: min(int(place / cells.widths[axis]), cells.counts[axis] - 1) -> "
    "min(int(place / cells.widths[axis]), cells.counts[axis])": ROUNDED,
    "kernels/cells.py: cell_of: min(int(place / cells.widths[axis]), cells.counts[axis] - 1) -> "
    "min(int(place / cells.widths[axis]), cells.counts[axis] + 1)": ROUNDED,
    "kernels/cells.py: set_boxes: model.bobs[X + axis] -> model.bobs[X - axis]": (
        "of two rows, row -1 is row 1"
    ),
    "kernels/cells.py: set_boxes: range(first + 1, min(first + LANES, s.end)) -> "
    "range(first, min(first + LANES, s.end))": "the first place is among the extremes already",
    "kernels/cells.py: sort_boxes: most = 2.0 * n + 16.0 -> most = 2.0 * n": (
        "fewer cells: only the cost changes"
    ),
    "integrators/inactive.py: longest_paths: broadcast(0.0) -> broadcast(1.0)": (
        "rigid asperites have less to reach than this says: only the cost changes"
    ),
    "integrators/inactive.py: longest_paths: s.dof_phi >= 0 -> s.dof_phi >= 1": AFTER_SWINGS,
    "integrators/inactive.py: longest_paths: "
    "where_less(0.0, frequency, pack(v, i) / frequency, 1.0) -> "
    "where_less(0.0, frequency, pack(v, i) / frequency, 2.0)": ("amplitudes above 1 count as 1"),
    "ledger/accounts.py: account_columns: -1 -> -2": "any negative slot is absent",
    "ledger/accounts.py: _drive: a.acc_drive >= 0 -> a.acc_drive >= 1": (
        "the first slots are those of contact; no drive has slot 0"
    ),
    "ledger/totals.py: SurfaceSeries.pseudowork: slot >= 0 -> slot >= 1": (
        "the first slots are those of contact; no surface has slot 0"
    ),
    "kernels/samples.py: initial_state: 0 if splits else n -> 1 if splits else n": (
        "splitting methods do not read the acceleration of a state: one number of memory"
    ),
}

# Functions that these checks cannot reach -> where they are tested.
NEEDS_COMPILER = {
    "call_calculator": "tests/potentials/test_live_calculators.py",
    "add_calculated": "tests/potentials/test_live_calculators.py",
    "calculated_energy": "tests/potentials/test_live_calculators.py",
    "share_rows": "tests/loops/test_threads.py",
    "add_lane_by_lane": "tests/ensembles/test_lanes.py",
    "own_number": "tests/ensembles/test_own_numbers.py",
    "next_row": "tests/ensembles/test_lanes.py",
    "spread_of_travel": "tests/integrators/test_mobility.py",
    "_normals_of_members": "tests/ensembles/test_lanes.py",
    "complete": "tests/potentials/test_composed.py",
}
