"""Two asperites and nothing else, by collocation: the time loop.

The method of :func:`tribo.integrators.collocation.Collocation` for the commonest scene: one
asperite on one, forced or free, bars clamped at rest.
"""

import math

from tribo.integrators.collocation import MAX_EXTRAPOLATION, error_weight
from tribo.integrators.step_control import (
    accept_step,
    end_of_step,
    next_step,
    reject_step,
    step_underflows,
    time_left,
    underflow_status,
)
from tribo.kernels.compiled import kernel
from tribo.kernels.simd import LANES, lane, lanes_of, rows_of, store, total
from tribo.kernels.status import BOBS_COINCIDE, COMPLETED, NOT_FINITE, PAUSED
from tribo.pair.forces import distance, encounter_of, seen, slopes
from tribo.pair.step import (
    ACCOUNTS,
    BEGINNING,
    FIRST,
    LEVEL,
    LIMITS,
    PLACE,
    Q1,
    Q2,
    RATE,
    ROWS,
    START,
    STATE,
    V1,
    V2,
    J,
    K,
    Nodes,
    at_end,
    attempt,
    powers,
)

# Columns of a record: PLACE's first six, the accounts, and
ENERGY = J + 1 + LANES  # of the contact.
COLUMNS = ENERGY + 1
# The row of a record behind all samples says what the run took, and how far it came.
STEPS, EVALUATIONS, SAMPLES, REACHED = range(4)


@kernel
def apart(pair, t, work):
    """Distance of the bobs now."""
    return distance(pair, t, work[PLACE, Q1], work[PLACE, Q2], work[PLACE, K])


@kernel
def encounter_now(pair, potential, t, work):
    """The rate of encounters as things are."""
    r = apart(pair, t, work)
    q1, q2 = work[PLACE, Q1], work[PLACE, Q2]
    v1, v2, j = work[PLACE, V1], work[PLACE, V2], work[PLACE, J]
    return encounter_of(pair, potential, r, q1, q2, v1, v2, j)


@kernel
def write(pair, potential, clock, work, record):
    """Record the state as the next sample."""
    k = clock.sample
    for m in range(J + 1):
        record[k, m] = work[PLACE, m]
    for account in range(LANES):
        record[k, J + 1 + account] = work[ACCOUNTS, account]
    r = apart(pair, clock.t, work)
    record[k, ENERGY] = 0.0
    if r < potential.range():
        record[k, ENERGY] = potential.energy_between(r, pair.charge1, pair.charge2)
    clock.sample += 1


@kernel
def conclude(clock, record, last):
    """What the run took, and how far it came, into the last row of a record."""
    record[last, STEPS] = clock.steps
    record[last, EVALUATIONS] = clock.evaluations
    record[last, SAMPLES] = clock.sample
    record[last, REACHED] = clock.t


@kernel
def wind(clock, h):
    """Set a clock to the start of a run, whose first step is to be h."""
    clock.t = 0.0
    clock.t_low = 0.0
    clock.h = h
    clock.last_step = 0.0
    clock.sample = 0
    clock.steps = 0
    clock.rejected = 0
    clock.after_rejection = 0
    clock.not_finite = 0


@kernel
def initialize(pair, potential, clock, start, work):
    """Slopes and powers at the very start, and whether it is one."""
    if clock.evaluations > 0:
        return COMPLETED
    for row in range(STATE, ROWS):
        for i in range(LANES):
            work[row, i] = 0.0
    wind(clock, work[LIMITS, FIRST])
    n = start.size // 2
    work[PLACE, Q1], work[PLACE, Q2] = start[0], start[1]
    work[PLACE, V1], work[PLACE, V2] = start[n], start[n + 1]
    if apart(pair, clock.t, work) == 0.0:
        return BOBS_COINCIDE
    q1, q2 = lanes_of(work[PLACE, Q1]), lanes_of(work[PLACE, Q2])
    sight = seen(pair, potential, lanes_of(clock.t), q1, q2, lanes_of(work[PLACE, K]))
    f1, f2 = slopes(pair, sight, q1, q2)
    work[START, Q1] = lane(f1, 0)
    work[START, Q2] = lane(f2, 0)
    work[START, K] = lane(sight.fx, 0)
    end = at_end(powers(0.0, work, Nodes(f1, f2, sight.fx, q1, q2, sight)))
    store(work, BEGINNING, end)
    work[START, RATE] = encounter_now(pair, potential, clock.t, work)
    clock.evaluations = 1
    return COMPLETED if math.isfinite(total(f1 + f2)) and math.isfinite(total(end)) else NOT_FINITE


def pair_collocation(pairs, potential, rows, start, clocks, times, record, budget):
    """March through the samples with steps whose local errors stay within limits.

    `rows` (ROWS, 8) is all that the loop keeps but for the clock: the method's table, the limits,
    and the state that it goes on from; `start` is y of the scene's layout at t = 0, where a clock
    without evaluations begins; `record` (times + 1, COLUMNS) is filled in row by row, and where
    the run stops is its last sample.  As `adaptive_steps` else.
    """
    pair = pairs[0]
    clock = clocks[0]
    work = rows_of(rows)
    status = initialize(pair, potential, clock, start, work)
    sharpness = error_weight(work[LIMITS, LEVEL])
    done = 0
    while status == COMPLETED and clock.sample < times.size:
        goal = times[clock.sample]
        left = time_left(clock, goal)
        if left <= 0.0:
            write(pair, potential, clock, work, record)
            continue
        if done == budget:
            return PAUSED
        done += 1
        encounter = work[START, RATE]
        h, landing = next_step(clock, encounter, left)
        if step_underflows(h, landing, times[-1]):
            status = underflow_status(clock)
            continue
        taken, factor, finite = attempt(pair, potential, clock, h, encounter, sharpness, work)
        clock.not_finite = 0 if finite else 1
        if not taken:
            reject_step(clock, h * factor)
            continue
        end = end_of_step(clock, goal, h, landing)
        accept_step(clock, end, h, landing, min(MAX_EXTRAPOLATION, factor))
    conclude(clock, record, times.size)
    if status != COMPLETED:
        write(pair, potential, clock, work, record)
    return status
