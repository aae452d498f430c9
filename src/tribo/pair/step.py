"""A step of two asperites by collocation: all nodes side by side.

What :mod:`tribo.integrators.collocation` does node by node and asperite by asperite is done here to
eight nodes at once, in registers.

Lane 0 stands for the end of the step, whose forces are those of the next one's start, and the
others for the nodes within.  Slopes and powers have those of the start in lane 0 instead.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from tribo.integrators.collocation import (
    MAX_EXTRAPOLATION,
    MAX_SWEEPS,
    SWEEP_TOLERANCE,
    Collocation,
)
from tribo.integrators.step_control import EPSILON, MAX_GROWTH, MIN_GROWTH
from tribo.kernels.compiled import inlined
from tribo.kernels.simd import (
    LANES,
    highest,
    lane,
    lanes_of,
    load,
    magnitude,
    put,
    store,
    total,
    totals,
)
from tribo.pair.forces import encounter_of, seen, slopes

CAUTION = 0.65  # of the growth that an error allows: a step turned back costs as much as one taken
CLEAR = 0.75  # of the way to an encounter, that a step shall go by the rate expected at its end

# Rows of what a pair's loop keeps, eight numbers each: first the method's table,
AT, NODES, POLE, B, V, LAST, A, AA, R = 0, 1, 2, 3, 4, 5, 6, 14, 22
# then what is tolerated of the rates, with the level and the first step, and of the accounts as
# reciprocals,
LIMITS, ALLOWED = R + LANES, R + LANES + 1
OF_V1, OF_V2, OF_J, LEVEL, FIRST = range(5)
# then the state, with the rate of encounters behind the slopes of START.
STATE = ALLOWED + 1
RATE = 3
PLACE, LOW, START, ACCOUNTS, REMAINDERS, BEGINNING, SCRATCH, MEMORY = range(STATE, STATE + 8)
ROWS = MEMORY + 3
Q1, Q2, K, V1, V2, J = range(6)  # in PLACE; LOW has what rounding took; START q1'', q2'' and k''
# Accounts, before which a record has PLACE's first six: integrals of the force on the first bob.
# J_Y of f_y; X1 of f_x omega1 cos q1, Y1 of f_y omega1 sin q1, X2, Y2; T1 of q1, T2; S of f_x j.
J_Y, X1, Y1, X2, Y2, T1, T2, S = range(8)


class Nodes(NamedTuple):
    """What an iteration finds at the nodes, in Lanes."""

    f1: Any  # q1''
    f2: Any
    fk: Any  # k''
    q1: Any
    q2: Any
    sight: Any


class Sums(NamedTuple):
    """What a step comes to, in units of it: numbers of the motion, and Lanes of the accounts."""

    twice: Any  # q'' integrated twice, for q1, q2 and k
    once: Any
    highest: Any  # integral of the highest term of q''
    gain: Any  # of the accounts
    highest_gain: Any


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
def summed(work, first, f):
    """sum_j a_ij f_j in lane i; `first` is the row of a_i0."""
    one = load(work, first) * lane(f, 0) + load(work, first + 4) * lane(f, 4)
    two = load(work, first + 1) * lane(f, 1) + load(work, first + 5) * lane(f, 5)
    three = load(work, first + 2) * lane(f, 2) + load(work, first + 6) * lane(f, 6)
    four = load(work, first + 3) * lane(f, 3) + load(work, first + 7) * lane(f, 7)
    return (one + two) + (three + four)


@inlined
def combined(weights, work, row):
    """sum_j w_j f_j, with the eight f_j in a row."""
    w0, w1, w2, w3, w4, w5, w6, w7 = weights
    one = w0 * work[row, 0] + w4 * work[row, 4]
    two = w1 * work[row, 1] + w5 * work[row, 5]
    three = w2 * work[row, 2] + w6 * work[row, 6]
    four = w3 * work[row, 3] + w7 * work[row, 7]
    return (one + two) + (three + four)


@inlined
def lagrange(work, x):
    """Lagrange's polynomials of the nodes, at eight places x."""
    d0, d1 = x - work[NODES, 0], x - work[NODES, 1]
    d2, d3 = x - work[NODES, 2], x - work[NODES, 3]
    d4, d5 = x - work[NODES, 4], x - work[NODES, 5]
    d6, d7 = x - work[NODES, 6], x - work[NODES, 7]
    d01, d23, d45, d67 = d0 * d1, d2 * d3, d4 * d5, d6 * d7
    front, back = d01 * d23, d45 * d67
    but01, but23, but45, but67 = d23 * back, d01 * back, front * d67, front * d45
    return (
        work[POLE, 0] * d1 * but01,
        work[POLE, 1] * d0 * but01,
        work[POLE, 2] * d3 * but23,
        work[POLE, 3] * d2 * but23,
        work[POLE, 4] * d5 * but45,
        work[POLE, 5] * d4 * but45,
        work[POLE, 6] * d7 * but67,
        work[POLE, 7] * d6 * but67,
    )


@inlined
def predict(clock, h, work):
    """Slopes at the nodes to begin with: those of the last step's polynomials, or of the start."""
    ratio = h * (1.0 / clock.last_step) if clock.last_step > 0.0 else math.inf
    c = load(work, AT)
    if ratio <= MAX_EXTRAPOLATION:
        weights = lagrange(work, 1.0 + ratio * c)
        f1 = put(combined(weights, work, MEMORY), 0, work[START, Q1])
        f2 = put(combined(weights, work, MEMORY + 1), 0, work[START, Q2])
        fk = put(combined(weights, work, MEMORY + 2), 0, work[START, K])
        return f1, f2, fk
    return lanes_of(work[START, Q1]), lanes_of(work[START, Q2]), lanes_of(work[START, K])


@inlined
def units(h, work):
    """What the tolerances of v1, v2 and j allow their slopes to be off by, as reciprocals."""
    unit1 = h / (work[LIMITS, OF_V1] + 2.0 * EPSILON * abs(work[PLACE, V1]))
    unit2 = h / (work[LIMITS, OF_V2] + 2.0 * EPSILON * abs(work[PLACE, V2]))
    unitk = h / (work[LIMITS, OF_J] + 2.0 * EPSILON * abs(work[PLACE, J]))
    return unit1, unit2, unitk


@inlined
def coasting(work, ahead):
    """q1, q2 and k at times so far ahead, if nothing pushed."""
    q1 = work[PLACE, Q1] + work[PLACE, V1] * ahead
    q2 = work[PLACE, Q2] + work[PLACE, V2] * ahead
    k = work[PLACE, K] + work[PLACE, J] * ahead
    return q1, q2, k


@inlined
def enough(change, before):
    """Whether another sweep would change less than SWEEP_TOLERANCE, or this one stalled below 1."""
    return (
        change <= SWEEP_TOLERANCE
        or change * change <= SWEEP_TOLERANCE * before
        or 0.0 < before <= change <= 1.0
    )


@inlined
def solve(pair, potential, clock, h, work):
    """Sweep until another would change less than SWEEP_TOLERANCE of the tolerance.

    Returns whether that came about, and the Nodes; leaves the slopes at the end of the step in
    SCRATCH.
    """
    f1, f2, fk = predict(clock, h, work)
    start1, start2, startk = work[START, Q1], work[START, Q2], work[START, K]
    unit1, unit2, unitk = units(h, work)
    ahead = h * load(work, AT)
    t = clock.t + ahead
    square = h * h
    springs1 = square * pair.square1
    springs2 = square * pair.square2
    rest1, rest2, restk = coasting(work, ahead)
    place1 = rest1 + square * summed(work, A, f1)
    place2 = rest2 + square * summed(work, A, f2)
    placek = restk + square * summed(work, A, fk)
    before = 0.0
    for _ in range(MAX_SWEEPS):
        sight = seen(pair, potential, t, place1, place2, placek)
        new1, new2 = slopes(pair, sight, place1, place2)
        newk = put(sight.fx, 0, startk)
        late1 = put(new1, 0, start1) - f1
        late2 = put(new2, 0, start2) - f2
        latek = newk - fk
        off1 = summed(work, A, late1)
        off2 = summed(work, A, late2)
        new1 = new1 - springs1 * off1
        new2 = new2 - springs2 * off2
        work[SCRATCH, Q1] = lane(new1, 0)
        work[SCRATCH, Q2] = lane(new2, 0)
        work[SCRATCH, K] = lane(sight.fx, 0)
        change = highest(
            unit1 * magnitude(late1) + unit2 * magnitude(late2) + unitk * magnitude(latek)
        )
        clock.evaluations += LANES
        f1 = put(new1, 0, start1)
        f2 = put(new2, 0, start2)
        fk = newk
        if enough(change, before):
            return True, Nodes(f1, f2, fk, place1, place2, sight)
        if not math.isfinite(change):
            break
        before = change
        place1 = place1 + square * (off1 - springs1 * summed(work, AA, late1))
        place2 = place2 + square * (off2 - springs2 * summed(work, AA, late2))
        placek = placek + square * summed(work, A, latek)
    return False, Nodes(f1, f2, fk, rest1, rest2, sight)


@inlined
def powers(h, work, nodes):
    """Account by account, at the nodes; those at the end of the step in lane 0."""
    sight = nodes.sight
    omega1 = work[PLACE, V1] + h * summed(work, R, nodes.f1)
    omega2 = work[PLACE, V2] + h * summed(work, R, nodes.f2)
    j = work[PLACE, J] + h * summed(work, R, nodes.fk)
    return (
        sight.fy,
        sight.fx * omega1 * sight.cos1,
        sight.fy * omega1 * sight.sin1,
        sight.fx * omega2 * sight.cos2,
        sight.fy * omega2 * sight.sin2,
        nodes.q1,
        nodes.q2,
        sight.fx * j,
    )


@inlined
def at_end(power):
    """Lane 0 of each account."""
    first = power[0]
    for account in range(1, LANES):
        first = put(first, account, lane(power[account], 0))
    return first


@inlined
def each(weights, power):
    """The powers of all accounts with weights."""
    p0, p1, p2, p3, p4, p5, p6, p7 = power
    return (
        weights * p0,
        weights * p1,
        weights * p2,
        weights * p3,
        weights * p4,
        weights * p5,
        weights * p6,
        weights * p7,
    )


@inlined
def sums_of(work, nodes, power):
    """What the polynomials through the nodes come to over the step."""
    b = load(work, B)
    v = load(work, V)
    last = load(work, LAST)
    f1, f2, fk = nodes.f1, nodes.f2, nodes.fk
    motion = totals((b * f1, b * f2, b * fk, v * f1, v * f2, v * fk, last * f1, last * f2))
    twice = lane(motion, 0), lane(motion, 1), lane(motion, 2)
    once = lane(motion, 3), lane(motion, 4), lane(motion, 5)
    ends = lane(motion, 6), lane(motion, 7), total(last * fk)
    at_start = load(work, BEGINNING)
    within, rest = put(v, 0, 0.0), put(last, 0, 0.0)
    gain = totals(each(within, power)) + lane(v, 0) * at_start
    high = totals(each(rest, power)) + lane(last, 0) * at_start
    return Sums(twice, once, ends, gain, high)


@inlined
def miss(x, v, tolerance):
    """|x| in units of the tolerance of v (never below round-off)."""
    return abs(x) / (tolerance + 2.0 * EPSILON * abs(v))


@inlined
def error_of(h, work, sums):
    """The integrals of the polynomials' highest terms, in units of the tolerances."""
    worst = miss(h * sums.highest[0], work[PLACE, V1], work[LIMITS, OF_V1])
    worst = max(worst, miss(h * sums.highest[1], work[PLACE, V2], work[LIMITS, OF_V2]))
    worst = max(worst, miss(h * sums.highest[2], work[PLACE, J], work[LIMITS, OF_J]))
    return worst + highest(h * magnitude(sums.highest_gain) * load(work, ALLOWED))


@inlined
def growth_of_eighth(error):
    """As :func:`tribo.integrators.step_control.growth_factor` of an error that grows as h^8."""
    growth = CAUTION / math.sqrt(math.sqrt(math.sqrt(error)))
    if not growth >= MIN_GROWTH:  # nan too
        return MIN_GROWTH
    return min(MAX_GROWTH, growth)


@inlined
def growth_within(error, most):
    """The same, but not above `most`: whether it is, is told without roots, which take long."""
    most = min(MAX_EXTRAPOLATION, most)
    fourth = (most / CAUTION) ** 4
    return most if error * (fourth * fourth) <= 1.0 else growth_of_eighth(error)


@inlined
def plus(x, low, step):
    """x + step, and what rounding took, of which `low` was left before."""
    step = step + low
    new = x + step
    return new, step - (new - x)


@inlined
def finish(h, work, sums):
    """Places, rates and accounts at the end of the step, rounding errors kept."""
    for m in range(3):
        rate = work[PLACE, m + 3] + (work[LOW, m + 3] + h * sums.twice[m])
        new = plus(work[PLACE, m], work[LOW, m], h * rate)
        work[PLACE, m], work[LOW, m] = new
        new = plus(work[PLACE, m + 3], work[LOW, m + 3], h * sums.once[m])
        work[PLACE, m + 3], work[LOW, m + 3] = new
    new, left = plus(load(work, ACCOUNTS), load(work, REMAINDERS), h * sums.gain)
    store(work, ACCOUNTS, new)
    store(work, REMAINDERS, left)


@inlined
def encounter_after(pair, potential, h, work, nodes, once):
    """The rate of encounters at the end of the step."""
    return encounter_of(
        pair,
        potential,
        lane(nodes.sight.r, 0),
        lane(nodes.q1, 0),
        lane(nodes.q2, 0),
        work[PLACE, V1] + h * once[0],
        work[PLACE, V2] + h * once[1],
        work[PLACE, J] + h * once[2],
    )


@inlined
def remember(work, nodes, start, end):
    """What the next step begins with: slopes and powers at its start, and this one's slopes."""
    store(work, MEMORY, nodes.f1)
    store(work, MEMORY + 1, nodes.f2)
    store(work, MEMORY + 2, nodes.fk)
    work[START, Q1], work[START, Q2], work[START, K] = start
    store(work, BEGINNING, end)


@inlined
def attempt(pair, potential, clock, h, encounter, sharpness, work):
    """Try a step of h, whose error is `sharpness` times what the highest terms come to.

    `encounter` is the rate of encounters at its start.  Returns whether it was taken, by what to
    multiply h for the next, and whether all was finite.
    """
    converged, nodes = solve(pair, potential, clock, h, work)
    if not converged:
        return False, 0.5, math.isfinite(total(nodes.f1 + nodes.f2 + nodes.fk))
    start = work[SCRATCH, Q1], work[SCRATCH, Q2], work[SCRATCH, K]
    power = powers(h, work, nodes)
    end = at_end(power)
    sums = sums_of(work, nodes, power)
    error = sharpness * error_of(h, work, sums)
    finite = math.isfinite(error) and math.isfinite(total(end) + (start[0] + start[1]))
    if not error <= 1.0 or not finite:
        return False, growth_of_eighth(error), finite
    later = encounter_after(pair, potential, h, work, nodes, sums.once)
    if h * later > 1.0:
        return False, max(MIN_GROWTH, CLEAR / (h * later)), True
    finish(h, work, sums)
    remember(work, nodes, start, end)
    work[START, RATE] = later
    clear = clock.encounter_fraction
    if later > encounter:  # and will go on like that
        clear = min(clear, CLEAR * later / (2.0 * later - encounter))
    return True, growth_within(error, clear / (h * later)), True
