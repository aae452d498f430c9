"""The time loop for one asperite on one, by collocation.

The method is that of :func:`tribo.integrators.collocation.Collocation`, for the most common
scene: one asperite on one, forced, free or on driven bars, clamped at rest.  This loop is separate
because it is more than ten times faster: the eight nodes of a step are computed side by side in
vector registers, and neither arrays nor records of asperites are read on the way.
"""

import math

from tribo.compiler.jit import kernel
from tribo.compiler.lanes import LANES, broadcast, lane, sum_of_lanes
from tribo.compiler.lanes_memory import rows_of, store
from tribo.compiler.numbers_in_lanes import with_numbers
from tribo.integrators import step_control as control
from tribo.integrators.collocation import MAX_EXTRAPOLATION, error_weight
from tribo.kernels import status as codes
from tribo.pair import step_rows as rows
from tribo.pair.forces import contact_at, distance, encounter_rate_of, swing_accelerations
from tribo.pair.step import Nodes, try_step
from tribo.pair.step_rows import Q1, Q2, V1, V2, J, K
from tribo.pair.step_sums import end_values, powers

# Column of a record with the contact energy, behind the first six of PLACE and the accounts.
ENERGY = J + 1 + LANES

# Number of columns of a record.
COLUMNS = ENERGY + 1


@kernel
def current_distance(pair, t, work):
    """Distance of the bobs in the present state."""
    return distance(pair, t, work[rows.PLACE, Q1], work[rows.PLACE, Q2], work[rows.PLACE, K])


@kernel
def current_encounter_rate(pair, potential, t, work):
    """Rate of encounters in the present state [1 / time]."""
    r = current_distance(pair, t, work)
    q1, q2 = work[rows.PLACE, Q1], work[rows.PLACE, Q2]
    v1, v2, j = work[rows.PLACE, V1], work[rows.PLACE, V2], work[rows.PLACE, J]
    return encounter_rate_of(pair, potential, r, q1, q2, v1, v2, j)


@kernel
def write_sample(pair, potential, clock, work, record):
    """Record the state as the next sample."""
    k = clock.sample
    for m in range(J + 1):
        record[k, m] = work[rows.PLACE, m]
    for account in range(LANES):
        record[k, J + 1 + account] = work[rows.ACCOUNTS, account]
    r = current_distance(pair, clock.t, work)
    record[k, ENERGY] = 0.0
    if r < potential.range():
        record[k, ENERGY] = potential.energy_between(r, pair.charge1, pair.charge2)
    clock.sample += 1


@kernel
def begin(pair, potential, clock, start, work):
    """Compute accelerations and powers at the start, if a run starts; returns a status."""
    if clock.evaluations > 0:
        return codes.COMPLETED
    for m in range(rows.STATE, rows.ROWS):
        for i in range(LANES):
            work[m, i] = 0.0
    clock.t, clock.t_low, clock.h, clock.last_step = 0.0, 0.0, work[rows.LIMITS, rows.FIRST], 0.0
    clock.sample, clock.steps, clock.rejected = 0, 0, 0
    clock.after_rejection, clock.not_finite = 0, 0
    n = start.size // 2
    work[rows.PLACE, Q1], work[rows.PLACE, Q2] = start[0], start[1]
    work[rows.PLACE, V1], work[rows.PLACE, V2] = start[n], start[n + 1]
    if current_distance(pair, clock.t, work) == 0.0:
        return codes.BOBS_COINCIDE
    q1, q2 = broadcast(work[rows.PLACE, Q1]), broadcast(work[rows.PLACE, Q2])
    contact = contact_at(
        pair, potential, broadcast(clock.t), q1, q2, broadcast(work[rows.PLACE, K])
    )
    f1, f2 = swing_accelerations(pair, contact, q1, q2)
    work[rows.START, Q1] = lane(f1, 0)
    work[rows.START, Q2] = lane(f2, 0)
    work[rows.START, K] = lane(contact.fx, 0)
    end = end_values(powers(0.0, work, Nodes(f1, f2, contact.fx, q1, q2, contact)))
    store(work, rows.BEGINNING, end)
    work[rows.START, rows.RATE] = current_encounter_rate(pair, potential, clock.t, work)
    clock.evaluations = 1
    finite = math.isfinite(sum_of_lanes(f1 + f2)) and math.isfinite(sum_of_lanes(end))
    return codes.COMPLETED if finite else codes.NOT_FINITE


def pair_collocation(pairs, potential, memory, clocks, start, times, record, budget):
    """Integrate from sample to sample with steps whose local errors stay within limits.

    `memory` (ROWS, 8) has the method's table, the limits, and the state, from which a later call
    continues; a clock without evaluations begins a run from `start`, y of the scene's layout.
    `record` (times + 1, COLUMNS) has a summary in its last row.  Returns a code of a status; PAUSED
    after `budget` steps.
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
            return codes.PAUSED
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
    record[times.size, codes.STEPS], record[times.size, codes.EVALUATIONS] = (
        clock.steps,
        clock.evaluations,
    )
    return status


# The loop of a single run, for callers that are compiled.
integrate_pair = kernel(pair_collocation)


def pair_members(
    potential, pairs, numbers, memory, clocks, starts, start, times, record, samples, counts, budget
):
    """Run members one after another with the steps of :func:`pair_collocation`.

    `pairs` (members or 1,) of PAIR, and `numbers` (members or 1, fields) of the potential, without
    columns if it has others, are those of each member, or of all.  `starts` are (members, 2
    coordinates); `start` and `record` are room for one member.  `samples` (times, members,
    COLUMNS) have no meaning for members that did not complete; `counts` (members, COUNTS) are
    PAUSED after `budget` steps.
    """
    clock = clocks[0]
    for member in range(starts.shape[0]):
        for i in range(start.size):
            start[i] = starts[member, i]
        clock.evaluations = 0
        own = member if pairs.size > 1 else 0
        mine = with_numbers(potential, numbers, own)
        code = integrate_pair(pairs[own:], mine, memory, clocks, start, times, record, budget)
        counts[member, codes.CODE] = code
        counts[member, codes.STEPS], counts[member, codes.EVALUATIONS] = (
            clock.steps,
            clock.evaluations,
        )
        for k in range(times.size):
            for m in range(COLUMNS):
                samples[k, member, m] = record[k, m]
