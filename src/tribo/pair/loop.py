"""The time loop for one asperite on one, by collocation.

The method is that of :func:`tribo.integrators.collocation.Collocation`, for the most common
scene: one asperite on one, forced, free or on driven bars, clamped at rest.  This loop is separate
because it is more than ten times faster: the eight nodes of a step are computed side by side in
vector registers, and neither arrays nor records of asperites are read on the way.
"""

import math

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import LANES, broadcast, sum_of_lanes
from tribo.compiler.lanes_memory import rows_of, store
from tribo.integrators import step_control as control
from tribo.integrators.collocation import MAX_EXTRAPOLATION, error_weight
from tribo.kernels import status as codes
from tribo.pair import step_rows as rows
from tribo.pair.forces import accelerations_of, contact_at, distance, encounter_rate_of, energy_at
from tribo.pair.potential import with_numbers
from tribo.pair.step import Nodes, try_step
from tribo.pair.step_rows import Q1, Q2, V1, V2, J
from tribo.pair.step_sums import end_values, powers
from tribo.pair.triples import set_three_in, three_in

# Column of a record with the contact energy, behind the first six of PLACE and the accounts.
ENERGY = J + 1 + LANES

# Number of columns of a record.
COLUMNS = ENERGY + 1


@kernel
def write_sample(pair, potential, clock, work, record):
    """Record coordinates, velocities, accounts and the contact energy as the next sample."""
    k = clock.sample
    for m in range(J + 1):
        record[k, m] = work[rows.PLACE, m]
    for account in range(LANES):
        record[k, J + 1 + account] = work[rows.ACCOUNTS, account]
    q1, q2, x = three_in(work, rows.PLACE, Q1)
    record[k, ENERGY] = energy_at(pair, potential, clock.t, q1, q2, x, 0)
    clock.sample += 1


@kernel
def begin(pair, potential, clock, start, work):
    """Compute accelerations and powers at the start, if a run starts; returns a status."""
    if clock.evaluations > 0:
        return codes.COMPLETED
    for m in range(rows.STATE, rows.ROWS):
        for i in range(LANES):
            work[m, i] = 0.0
    clock.t = 0.0
    clock.t_low = 0.0
    clock.h = work[rows.LIMITS, rows.FIRST]
    clock.last_step = 0.0
    clock.sample = 0
    clock.steps = 0
    clock.rejected = 0
    clock.after_rejection = 0
    clock.not_finite = 0
    n = start.size // 2
    work[rows.PLACE, Q1] = start[0]
    work[rows.PLACE, Q2] = start[1]
    work[rows.PLACE, V1] = start[n]
    work[rows.PLACE, V2] = start[n + 1]
    q1, q2, k = three_in(work, rows.PLACE, Q1)
    r = distance(pair, clock.t, q1, q2, k)
    if r == 0.0:
        return codes.BOBS_COINCIDE
    v1, v2, j = three_in(work, rows.PLACE, V1)
    work[rows.START, rows.RATE] = encounter_rate_of(pair, potential, r, q1, q2, v1, v2, j)
    swing1 = broadcast(q1)
    swing2 = broadcast(q2)
    contact = contact_at(pair, potential, broadcast(clock.t), swing1, swing2, broadcast(k))
    f = accelerations_of(pair, contact, swing1, swing2)
    set_three_in(work, rows.START, f)
    end = end_values(powers(0.0, work, Nodes(f, swing1, swing2, contact)))
    store(work, rows.BEGINNING, end)
    clock.evaluations = 1
    finite = math.isfinite(sum_of_lanes(f[0] + f[1])) and math.isfinite(sum_of_lanes(end))
    return codes.COMPLETED if finite else codes.NOT_FINITE


def pair_collocation(pairs, potential, memory, clocks, start, times, record, budget):
    """Integrate from sample to sample with steps whose local errors stay within limits.

    `memory` (ROWS, 8) has the method's table, the limits, and the state, from which a later call
    continues; a clock without evaluations begins a run from `start`, y of the scene's layout.
    `record` (times + 1, COLUMNS) has the counts in its last row.  Returns a code of a status;
    PAUSED after `budget` steps.
    """
    pair = pairs[0]
    clock = clocks[0]
    work = rows_of(memory)
    status = begin(pair, potential, clock, start, work)
    sharpness = error_weight(work[rows.LIMITS, rows.LEVEL])
    done = 0
    while status == codes.COMPLETED and clock.sample < times.size:
        goal = times[clock.sample]
        left = control.time_left(clock, goal)
        if left <= 0.0:
            write_sample(pair, potential, clock, work, record)
            continue
        if done == budget:
            status = codes.PAUSED
            break
        done += 1
        encounter = work[rows.START, rows.RATE]
        h, landing = control.next_step(clock, encounter, left)
        if control.step_underflows(h, landing, times[-1]):
            status = control.underflow_status(clock)
            continue
        taken, factor, finite = try_step(pair, potential, clock, h, encounter, sharpness, work)
        clock.not_finite = 0 if finite else 1
        if not taken:
            control.reject_step(clock, h * factor)
            continue
        end = control.end_of_step(clock, goal, h, landing)
        control.accept_step(clock, end, h, landing, min(MAX_EXTRAPOLATION, factor))
    record[times.size, codes.CODE] = status
    record[times.size, codes.STEPS] = clock.steps
    record[times.size, codes.EVALUATIONS] = clock.evaluations
    return status


# The loop of one run, for callers that are compiled.  As part of its caller it takes 5 % less time,
# but those with several calls would have as many copies.
integrate_pair = kernel(pair_collocation)
inlined_pair = inlined(pair_collocation)


def pair_members(potential, members, memory, clocks, starts, times, records, budget):
    """Run members one after another by :func:`pair_collocation`; a run is a member alone.

    The `members` have pairs (members or 1,) of PAIR, and addresses (members or 1,) of the
    potential's numbers, of each or of all.  `starts` are (members, 2 coordinates); `records`
    (members x (times + 1), COLUMNS) are those of one member after another.  Only the first member
    can have begun before.  Returns the code of the last one's status.
    """
    pairs, numbers = members
    rows = times.size + 1
    status = codes.COMPLETED
    for m in range(starts.shape[0]):
        if m > 0:
            clocks[0].evaluations = 0
        own = min(m, pairs.size - 1)
        mine = with_numbers(potential, numbers[own])
        record = records[m * rows : (m + 1) * rows]
        status = inlined_pair(pairs[own:], mine, memory, clocks, starts[m], times, record, budget)
    return status
