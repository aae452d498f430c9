"""Two asperites and nothing else, by collocation: all nodes of a step side by side.

The method of :func:`tribo.kernels.collocation.chosen_collocation` for the commonest scene: one
asperite on one, forced or free, bars clamped at rest.  What the general loop does node by node
and asperite by asperite is done here to eight nodes at once, in registers.

Coordinates are the swings q1 and q2, and k with k'' = f_x, the contact force on the first bob:
k' = j is its impulse, and centres of mass that are free to slide are at ease * k from their
uniform motion, where ease is 1 / mass (of the second: minus that), and 0 for a forced one.

Lane 0 stands for the end of the step, whose forces are those of the next one's start, and the
others for the nodes within.  Slopes and powers have those of the start in lane 0 instead.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.errors import NumbaError
from numba.extending import overload

from tribo.kernels.collocation import FARTHEST, SHARP, SWEEPS
from tribo.kernels.collocation_tableaux import Collocation
from tribo.kernels.compiled import inlined, kernel
from tribo.kernels.contact import separation
from tribo.kernels.lanes import (
    LANES,
    highest,
    lane,
    lanes,
    load,
    magnitude,
    put,
    root,
    rows_of,
    sine_cosine,
    store,
    total,
    where_less,
)
from tribo.kernels.status import BOBS_COINCIDE, COMPLETED, NOT_FINITE, PAUSED, STEP_UNDERFLOW
from tribo.kernels.stepping import (
    EPSILON,
    GROW,
    SHRINK,
    end_of_step,
    go_on,
    next_step,
    time_left,
    turn_back,
)

PAIR = np.dtype(
    [
        ("gap_x", "f8"),  # from the second centre of mass to the first, at t = 0
        ("gap_y", "f8"),
        ("square_z", "f8"),  # square of what the bobs are apart in z
        ("speed_x", "f8"),  # of the first surface, seen from the second
        ("speed_y", "f8"),
        ("ease", "f8"),  # both asperites': the gap is the given one and ease * k
        ("charge1", "f8"),
        ("charge2", "f8"),
        ("arm1", "f8"),  # l1 times facing: the bob is at arm (sin q, -cos q) from the centre
        ("arm2", "f8"),
        ("turn_x1", "f8"),  # q1'' = cos q1 turn_x1 f_x + sin q1 turn_y1 f_y - square1 q1
        ("turn_y1", "f8"),
        ("square1", "f8"),
        ("turn_x2", "f8"),  # with f_x and f_y on the first bob here too
        ("turn_y2", "f8"),
        ("square2", "f8"),
    ],
    align=True,
)

CAUTION = 0.65  # of the growth that an error allows: a step turned back costs as much as one taken
SHARE = 1e-3  # of the tolerance, for what an iteration leaves: no sweep follows its last

# Rows of a pair's state: eight numbers each.
PLACE, LOW, START, BEGINNING, MEMORY = 0, 1, 2, 3, 4
ACCOUNTS, REMAINDERS, POWERS = 7, 15, 23
ROWS = 31
Q1, Q2, K, V1, V2, J = range(6)  # in PLACE; LOW has what rounding took; START q1'', q2'' and k''
# Accounts, before which a record has PLACE's first six: integrals of the force on the first bob.
# J_Y of f_y; X1 of f_x omega1 cos q1, Y1 of f_y omega1 sin q1, X2, Y2; T1 of q1, T2; S of f_x j.
J_Y, X1, Y1, X2, Y2, T1, T2, S = range(8)
ENERGY = J + 1 + LANES  # of the contact, the last column of a record
COLUMNS = ENERGY + 1
# The row of a record behind all samples says what the run took, and how far it came.
STEPS, EVALUATIONS, SAMPLES, REACHED = range(4)

# Rows of a method's table.
AT, NODES, POLE, B, V, LAST, A, AA, R = 0, 1, 2, 3, 4, 5, 6, 14, 22


class Sight(NamedTuple):
    """What the forces at eight places come from, and they, in Lanes."""

    sin1: Any
    cos1: Any
    sin2: Any
    cos2: Any
    fx: Any
    fy: Any
    r: Any


def table(method: Collocation) -> np.ndarray:
    """The coefficients of a method whose eight nodes begin with 0, row by row."""
    rows = np.empty((R + LANES, LANES))
    rows[AT] = np.append(1.0, method.c[1:])
    rows[NODES], rows[POLE] = method.c, method.pole
    rows[B], rows[V], rows[LAST] = method.b, method.v, method.last
    for j in range(LANES):
        rows[A + j] = np.append(method.b[j], method.a[1:, j])
        rows[R + j] = np.append(method.v[j], method.r[1:, j])
    rows[AA : AA + LANES] = (rows[A : A + LANES].T[:, 1:] @ method.a[1:]).T
    return rows


@inlined
def summed(method, first, f):
    """sum_j a_ij f_j in lane i; `first` is the row of a_i0."""
    even = load(method, first) * lane(f, 0)
    odd = load(method, first + 1) * lane(f, 1)
    for j in range(2, LANES, 2):
        even = even + load(method, first + j) * lane(f, j)
        odd = odd + load(method, first + j + 1) * lane(f, j + 1)
    return even + odd


def forces_at(potential, r, one, other):
    """The force at eight distances: as its formula stands where that is arithmetic alone."""
    raise NotImplementedError


@overload(forces_at, strict=False)
def _forces_at(potential, r, one, other):
    formula = njit(error_model="numpy")(potential.instance_class.force_between)
    try:
        formula.compile((potential, lanes, types.float64, types.float64))
    except NumbaError:
        return _one_by_one
    return lambda potential, r, one, other: potential.force_between(r, one, other)


def _one_by_one(potential, r, one, other):
    f = r
    for i in range(LANES):
        f = put(f, i, potential.force_between(lane(r, i), one, other))
    return f


@inlined
def pushes(pair, potential, r, inverse):
    """Contact force over distance."""
    end = potential.range()
    push = forces_at(potential, r, pair.charge1, pair.charge2) * inverse
    return where_less(r, end, push, 0.0)


@inlined
def seen(pair, potential, t, q1, q2, k):
    """The contact force at eight times and places."""
    sin1, cos1 = sine_cosine(q1)
    sin2, cos2 = sine_cosine(q2)
    dx = (pair.gap_x + pair.speed_x * t + pair.ease * k) + (pair.arm1 * sin1 - pair.arm2 * sin2)
    dy = (pair.gap_y + pair.speed_y * t) - (pair.arm1 * cos1 - pair.arm2 * cos2)
    square = dx * dx + (dy * dy + pair.square_z)
    r = root(square)
    f = pushes(pair, potential, r, r * (1.0 / square))
    return Sight(sin1, cos1, sin2, cos2, f * dx, f * dy, r)


@inlined
def slopes(pair, sight, q1, q2):
    """q1'' and q2''; k'' is f_x."""
    one = sight.cos1 * (pair.turn_x1 * sight.fx) + sight.sin1 * (pair.turn_y1 * sight.fy)
    two = sight.cos2 * (pair.turn_x2 * sight.fx) + sight.sin2 * (pair.turn_y2 * sight.fy)
    return one - pair.square1 * q1, two - pair.square2 * q2


@inlined
def foretell(method, clock, h, work):
    """Slopes at the nodes to begin with: those of the last step's polynomials, or of the start."""
    ratio = h / clock.last if clock.last > 0.0 else math.inf
    c = load(method, AT)
    f1 = 0.0 * c + work[START, Q1]
    f2 = 0.0 * c + work[START, Q2]
    fk = 0.0 * c + work[START, K]
    if ratio <= FARTHEST:
        x = 1.0 + ratio * c
        front = 0.0 * c + 1.0
        for j in range(LANES):  # Lagrange's polynomials: the factors before j, then those behind
            store(work, POWERS + j, front * method[POLE, j])
            front = front * (x - method[NODES, j])
        back = 0.0 * c + 1.0
        f1 = 0.0 * c
        f2 = 0.0 * c
        fk = 0.0 * c
        for i in range(LANES):
            j = LANES - 1 - i
            weight = load(work, POWERS + j) * back
            f1 = f1 + weight * work[MEMORY, j]
            f2 = f2 + weight * work[MEMORY + 1, j]
            fk = fk + weight * work[MEMORY + 2, j]
            back = back * (x - method[NODES, j])
        f1 = put(f1, 0, work[START, Q1])
        f2 = put(f2, 0, work[START, Q2])
        fk = put(fk, 0, work[START, K])
    return f1, f2, fk


@inlined
def solve(pair, potential, method, clock, h, tolerance, work, f1, f2, fk):
    """Sweep until another would change less than SHARE of the tolerance.

    Returns whether that came about, slopes, places and what was seen there; leaves the slopes at
    the end of the step in POWERS.
    """
    q1, q2, k = work[PLACE, Q1], work[PLACE, Q2], work[PLACE, K]
    v1, v2, j = work[PLACE, V1], work[PLACE, V2], work[PLACE, J]
    start1, start2, startk = work[START, Q1], work[START, Q2], work[START, K]
    unit1 = h / (tolerance[0, 0] + 2.0 * EPSILON * abs(v1))
    unit2 = h / (tolerance[0, 1] + 2.0 * EPSILON * abs(v2))
    unitk = h / (tolerance[0, 2] + 2.0 * EPSILON * abs(j))
    ahead = h * load(method, AT)
    t = clock.t + ahead
    square = h * h
    rest1 = q1 + v1 * ahead
    rest2 = q2 + v2 * ahead
    restk = k + j * ahead
    before = 0.0
    springs1 = square * pair.square1
    springs2 = square * pair.square2
    place1 = rest1 + square * summed(method, A, f1)
    place2 = rest2 + square * summed(method, A, f2)
    placek = restk + square * summed(method, A, fk)
    for _ in range(SWEEPS):
        sight = seen(pair, potential, t, place1, place2, placek)
        new1, new2 = slopes(pair, sight, place1, place2)
        newk = put(sight.fx, 0, startk)
        late1 = put(new1, 0, start1) - f1
        late2 = put(new2, 0, start2) - f2
        latek = newk - fk
        off1 = summed(method, A, late1)
        off2 = summed(method, A, late2)
        new1 = new1 - springs1 * off1
        new2 = new2 - springs2 * off2
        work[POWERS, 0] = lane(new1, 0)
        work[POWERS, 1] = lane(new2, 0)
        work[POWERS, 2] = lane(sight.fx, 0)
        change = highest(
            unit1 * magnitude(late1) + unit2 * magnitude(late2) + unitk * magnitude(latek)
        )
        clock.evaluations += LANES
        f1 = put(new1, 0, start1)
        f2 = put(new2, 0, start2)
        fk = newk
        if change <= SHARE or change * change <= SHARE * before or 0.0 < before <= change <= 1.0:
            return True, f1, f2, fk, place1, place2, sight
        if not math.isfinite(change):
            break
        before = change
        place1 = place1 + square * (off1 - springs1 * summed(method, AA, late1))
        place2 = place2 + square * (off2 - springs2 * summed(method, AA, late2))
        placek = placek + square * summed(method, A, latek)
    return False, f1, f2, fk, rest1, rest2, sight


@inlined
def book(method, h, work, f1, f2, fk, q1, q2, sight):
    """Powers at the nodes into POWERS, and those at the end of the step, account by account."""
    omega1 = work[PLACE, V1] + h * summed(method, R, f1)
    omega2 = work[PLACE, V2] + h * summed(method, R, f2)
    j = work[PLACE, J] + h * summed(method, R, fk)
    end = f1
    for account, power in (
        (J_Y, sight.fy),
        (X1, sight.fx * omega1 * sight.cos1),
        (Y1, sight.fy * omega1 * sight.sin1),
        (X2, sight.fx * omega2 * sight.cos2),
        (Y2, sight.fy * omega2 * sight.sin2),
        (T1, q1),
        (T2, q2),
        (S, sight.fx * j),
    ):
        end = put(end, account, lane(power, 0))
        store(work, POWERS + account, put(power, 0, work[BEGINNING, account]))
    return end


@inlined
def miss(x, v, tolerance):
    """|x| in units of the tolerance of v (never below round-off)."""
    return abs(x) / (tolerance + 2.0 * EPSILON * abs(v))


@inlined
def error_of(method, h, work, tolerance, f1, f2, fk):
    """The integrals of the polynomials' highest terms, in units of the tolerances."""
    last = load(method, LAST)
    worst = miss(h * total(last * f1), work[PLACE, V1], tolerance[0, 0])
    worst = max(worst, miss(h * total(last * f2), work[PLACE, V2], tolerance[0, 1]))
    worst = max(worst, miss(h * total(last * fk), work[PLACE, J], tolerance[0, 2]))
    wrong = last
    for account in range(LANES):
        wrong = put(wrong, account, total(last * load(work, POWERS + account)))
    return worst + highest(h * magnitude(wrong) * load(tolerance, 1))


@inlined
def growth_of_eighth(error):
    """As :func:`tribo.kernels.stepping.growth_of` of an error that grows as h^8."""
    growth = CAUTION / math.sqrt(math.sqrt(math.sqrt(error)))
    if not growth >= SHRINK:  # nan too
        return SHRINK
    return min(GROW, growth)


@inlined
def plus(x, low, step):
    """x + step, and what rounding took, of which `low` was left before."""
    step = step + low
    new = x + step
    return new, step - (new - x)


@inlined
def finish(method, h, work, f1, f2, fk, once):
    """Places, rates and accounts at the end of the step, rounding errors kept."""
    b = load(method, B)
    v = load(method, V)
    twice = total(b * f1), total(b * f2), total(b * fk)
    for m in range(3):
        rate = work[PLACE, m + 3] + (work[LOW, m + 3] + h * twice[m])
        new = plus(work[PLACE, m], work[LOW, m], h * rate)
        work[PLACE, m], work[LOW, m] = new
        new = plus(work[PLACE, m + 3], work[LOW, m + 3], h * once[m])
        work[PLACE, m + 3], work[LOW, m + 3] = new
    for account in range(LANES):
        step = h * (v * load(work, POWERS + account))
        new, left = plus(load(work, ACCOUNTS + account), load(work, REMAINDERS + account), step)
        store(work, ACCOUNTS + account, new)
        store(work, REMAINDERS + account, left)


@inlined
def encounter_of(pair, potential, r, q1, q2, v1, v2, j):
    """As :func:`tribo.kernels.contact.encounter_rate`, of bobs that are r apart."""
    swing1 = math.sqrt(v1 * v1 + pair.square1 * q1 * q1)
    swing2 = math.sqrt(v2 * v2 + pair.square2 * q2 * q2)
    speed_x = pair.speed_x + pair.ease * j
    speed = math.sqrt(speed_x * speed_x + pair.speed_y * pair.speed_y)
    speed += abs(pair.arm1) * swing1 + abs(pair.arm2) * swing2
    return speed / potential.clearance(r)


@kernel
def distance(pair, t, work):
    """Distance of the bobs."""
    q1, q2 = work[PLACE, Q1], work[PLACE, Q2]
    dx = pair.gap_x + pair.speed_x * t + pair.ease * work[PLACE, K]
    dx += pair.arm1 * math.sin(q1) - pair.arm2 * math.sin(q2)
    dy = pair.gap_y + pair.speed_y * t
    dy -= pair.arm1 * math.cos(q1) - pair.arm2 * math.cos(q2)
    return separation(dx, dy, math.sqrt(pair.square_z))


@kernel
def write(pair, potential, clock, work, record):
    """Record the state as the next sample."""
    k = clock.sample
    for m in range(J + 1):
        record[k, m] = work[PLACE, m]
    for account in range(LANES):
        record[k, J + 1 + account] = total(load(work, ACCOUNTS + account))
    r = distance(pair, clock.t, work)
    record[k, ENERGY] = 0.0
    if r < potential.range():
        record[k, ENERGY] = potential.energy_between(r, pair.charge1, pair.charge2)
    clock.sample += 1


@kernel
def begin(pair, potential, method, tolerance, clock, start, work):
    """Slopes and powers at the very start, and whether it is one."""
    if clock.evaluations > 0:
        return COMPLETED
    for row in range(ROWS):
        for i in range(LANES):
            work[row, i] = 0.0
    clock.t = 0.0
    clock.t_low = 0.0
    clock.h = tolerance[0, 4]
    clock.last = 0.0
    clock.sample = 0
    clock.steps = 0
    clock.rejected = 0
    clock.held = 0
    n = start.size // 2
    work[PLACE, Q1], work[PLACE, Q2] = start[0], start[1]
    work[PLACE, V1], work[PLACE, V2] = start[n], start[n + 1]
    if distance(pair, clock.t, work) == 0.0:
        return BOBS_COINCIDE
    nothing = 0.0 * load(method, AT)
    q1 = nothing + work[PLACE, Q1]
    q2 = nothing + work[PLACE, Q2]
    sight = seen(pair, potential, nothing + clock.t, q1, q2, nothing + work[PLACE, K])
    f1, f2 = slopes(pair, sight, q1, q2)
    work[START, Q1] = lane(f1, 0)
    work[START, Q2] = lane(f2, 0)
    work[START, K] = lane(sight.fx, 0)
    end = book(method, 0.0, work, f1, f2, sight.fx, q1, q2, sight)
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
    r = distance(pair, clock.t, work)
    encounter = encounter_of(
        pair,
        potential,
        r,
        work[PLACE, Q1],
        work[PLACE, Q2],
        work[PLACE, V1],
        work[PLACE, V2],
        work[PLACE, J],
    )
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

        f1, f2, fk = foretell(method, clock, h, work)
        converged, f1, f2, fk, q1, q2, sight = solve(
            pair, potential, method, clock, h, tolerance, work, f1, f2, fk
        )
        if not converged:
            finite = math.isfinite(total(f1 + f2 + fk))
            turn_back(clock, 0.5 * h)
            continue
        next1, next2, nextk = work[POWERS, 0], work[POWERS, 1], work[POWERS, 2]
        end = book(method, h, work, f1, f2, fk, q1, q2, sight)
        error = sharpness * error_of(method, h, work, tolerance, f1, f2, fk)
        finite = math.isfinite(error) and math.isfinite(total(end) + (next1 + next2))
        if not error <= 1.0 or not finite:
            turn_back(clock, h * growth_of_eighth(error))
            continue

        v = load(method, V)
        once = total(v * f1), total(v * f2), total(v * fk)
        next_encounter = encounter_of(
            pair,
            potential,
            lane(sight.r, 0),
            lane(q1, 0),
            lane(q2, 0),
            work[PLACE, V1] + h * once[0],
            work[PLACE, V2] + h * once[1],
            work[PLACE, J] + h * once[2],
        )
        if h * next_encounter > 1.0:
            turn_back(clock, 0.5 * h)
            continue
        finish(method, h, work, f1, f2, fk, once)
        t = end_of_step(clock, goal, h, landing)
        go_on(clock, t, h, landing, min(FARTHEST, growth_of_eighth(error)))
        clock.last = h
        store(work, MEMORY, f1)
        store(work, MEMORY + 1, f2)
        store(work, MEMORY + 2, fk)
        work[START, Q1], work[START, Q2], work[START, K] = next1, next2, nextk
        store(work, BEGINNING, end)
        encounter = next_encounter
    record[times.size, STEPS] = clock.steps
    record[times.size, EVALUATIONS] = clock.evaluations
    record[times.size, SAMPLES] = clock.sample
    record[times.size, REACHED] = clock.t
    if status != COMPLETED:
        write(pair, potential, clock, work, record)
    return status
