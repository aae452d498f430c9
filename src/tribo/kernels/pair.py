"""Two asperites and nothing else, by collocation: the time loop.

The method of :func:`tribo.kernels.collocation.chosen_collocation` for the commonest scene: one
asperite on one, forced or free, bars clamped at rest.
"""

import math

from tribo.kernels.collocation import FARTHEST, SHARP
from tribo.kernels.compiled import kernel
from tribo.kernels.lanes import LANES, lane, load, rows_of, store, total
from tribo.kernels.pair_forces import distance, encounter_of, seen, slopes
from tribo.kernels.pair_step import (
    ACCOUNTS,
    AT,
    BEGINNING,
    PLACE,
    Q1,
    Q2,
    ROWS,
    START,
    V1,
    V2,
    J,
    K,
    Nodes,
    attempt,
    book,
)
from tribo.kernels.status import BOBS_COINCIDE, COMPLETED, NOT_FINITE, PAUSED, STEP_UNDERFLOW
from tribo.kernels.stepping import EPSILON, end_of_step, go_on, next_step, time_left, turn_back

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
        record[k, J + 1 + account] = total(load(work, ACCOUNTS + account))
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
    clock.last = 0.0
    clock.sample = 0
    clock.steps = 0
    clock.rejected = 0
    clock.held = 0


@kernel
def begin(pair, potential, method, tolerance, clock, start, work):
    """Slopes and powers at the very start, and whether it is one."""
    if clock.evaluations > 0:
        return COMPLETED
    for row in range(ROWS):
        for i in range(LANES):
            work[row, i] = 0.0
    wind(clock, tolerance[0, 4])
    n = start.size // 2
    work[PLACE, Q1], work[PLACE, Q2] = start[0], start[1]
    work[PLACE, V1], work[PLACE, V2] = start[n], start[n + 1]
    if apart(pair, clock.t, work) == 0.0:
        return BOBS_COINCIDE
    nothing = 0.0 * load(method, AT)
    q1 = nothing + work[PLACE, Q1]
    q2 = nothing + work[PLACE, Q2]
    sight = seen(pair, potential, nothing + clock.t, q1, q2, nothing + work[PLACE, K])
    f1, f2 = slopes(pair, sight, q1, q2)
    work[START, Q1] = lane(f1, 0)
    work[START, Q2] = lane(f2, 0)
    work[START, K] = lane(sight.fx, 0)
    end = book(method, 0.0, work, Nodes(f1, f2, sight.fx, q1, q2, sight))
    store(work, BEGINNING, end)
    clock.evaluations = 1
    return COMPLETED if math.isfinite(total(f1 + f2)) and math.isfinite(total(end)) else NOT_FINITE


def pair_collocation(pairs, potential, tables, limits, start, clocks, state, times, record, budget):
    """March through the samples with steps whose local errors stay within `limits`.

    `limits` (2, 8) has the tolerances of omega1, omega2 and j, the level and the first step, then
    the accounts' reciprocals; `tables` is the method's; `start` is y of the scene's layout at
    t = 0, where a clock without evaluations begins, and `state` (ROWS, 8) what it goes on from;
    `record` (times + 1, COLUMNS) is filled in row by row, and where the run stops is its last
    sample.
    As :func:`tribo.kernels.collocation.chosen_collocation` else.
    """
    pair = pairs[0]
    clock = clocks[0]
    method = rows_of(tables)
    tolerance = rows_of(limits)
    work = rows_of(state)
    status = begin(pair, potential, method, tolerance, clock, start, work)
    encounter = encounter_now(pair, potential, clock.t, work)
    sharpness = math.sqrt(tolerance[0, 3]) / SHARP
    done = 0
    finite = True
    while status == COMPLETED and clock.sample < times.size:
        goal = times[clock.sample]
        left = time_left(clock, goal)
        if left <= 0.0:
            write(pair, potential, clock, work, record)
            continue
        if done == budget:
            return PAUSED
        done += 1
        h, landing = next_step(clock, encounter, left)
        if h < 16.0 * EPSILON * times[-1] and not landing:
            status = STEP_UNDERFLOW if finite else NOT_FINITE
            continue
        taken, factor, next_encounter, finite = attempt(
            pair, potential, method, clock, h, tolerance, sharpness, work
        )
        if not taken:
            turn_back(clock, h * factor)
            continue
        go_on(clock, end_of_step(clock, goal, h, landing), h, landing, min(FARTHEST, factor))
        clock.last = h
        encounter = next_encounter
    conclude(clock, record, times.size)
    if status != COMPLETED:
        write(pair, potential, clock, work, record)
    return status
