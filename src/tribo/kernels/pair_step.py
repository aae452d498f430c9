"""A step of two asperites by collocation: all nodes side by side.

What :mod:`tribo.kernels.collocation` does node by node and asperite by asperite is done here to
eight nodes at once, in registers.

Lane 0 stands for the end of the step, whose forces are those of the next one's start, and the
others for the nodes within.  Slopes and powers have those of the start in lane 0 instead.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from tribo.kernels.collocation import FARTHEST, SWEEPS
from tribo.kernels.collocation_tableaux import Collocation
from tribo.kernels.compiled import inlined
from tribo.kernels.lanes import LANES, highest, lane, load, magnitude, put, store, total
from tribo.kernels.pair_forces import encounter_of, seen, slopes
from tribo.kernels.stepping import EPSILON, GROW, SHRINK

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

# Rows of a method's table.
AT, NODES, POLE, B, V, LAST, A, AA, R = 0, 1, 2, 3, 4, 5, 6, 14, 22


class Nodes(NamedTuple):
    """What an iteration finds at the nodes, in Lanes."""

    f1: Any  # q1''
    f2: Any
    fk: Any  # k''
    q1: Any
    q2: Any
    sight: Any


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
def units(h, work, tolerance):
    """What the tolerances of v1, v2 and j allow their slopes to be off by, as reciprocals."""
    unit1 = h / (tolerance[0, 0] + 2.0 * EPSILON * abs(work[PLACE, V1]))
    unit2 = h / (tolerance[0, 1] + 2.0 * EPSILON * abs(work[PLACE, V2]))
    unitk = h / (tolerance[0, 2] + 2.0 * EPSILON * abs(work[PLACE, J]))
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
    """Whether another sweep would change less than SHARE, or this one stalled below 1."""
    return change <= SHARE or change * change <= SHARE * before or 0.0 < before <= change <= 1.0


@inlined
def solve(pair, potential, method, clock, h, tolerance, work):
    """Sweep until another would change less than SHARE of the tolerance.

    Returns whether that came about, and the Nodes; leaves the slopes at the end of the step in
    POWERS.
    """
    f1, f2, fk = foretell(method, clock, h, work)
    start1, start2, startk = work[START, Q1], work[START, Q2], work[START, K]
    unit1, unit2, unitk = units(h, work, tolerance)
    ahead = h * load(method, AT)
    t = clock.t + ahead
    square = h * h
    springs1 = square * pair.square1
    springs2 = square * pair.square2
    rest1, rest2, restk = coasting(work, ahead)
    place1 = rest1 + square * summed(method, A, f1)
    place2 = rest2 + square * summed(method, A, f2)
    placek = restk + square * summed(method, A, fk)
    before = 0.0
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
        if enough(change, before):
            return True, Nodes(f1, f2, fk, place1, place2, sight)
        if not math.isfinite(change):
            break
        before = change
        place1 = place1 + square * (off1 - springs1 * summed(method, AA, late1))
        place2 = place2 + square * (off2 - springs2 * summed(method, AA, late2))
        placek = placek + square * summed(method, A, latek)
    return False, Nodes(f1, f2, fk, rest1, rest2, sight)


@inlined
def book(method, h, work, nodes):
    """Powers at the nodes into POWERS, and those at the end of the step, account by account."""
    sight = nodes.sight
    omega1 = work[PLACE, V1] + h * summed(method, R, nodes.f1)
    omega2 = work[PLACE, V2] + h * summed(method, R, nodes.f2)
    j = work[PLACE, J] + h * summed(method, R, nodes.fk)
    end = nodes.f1
    for account, power in (
        (J_Y, sight.fy),
        (X1, sight.fx * omega1 * sight.cos1),
        (Y1, sight.fy * omega1 * sight.sin1),
        (X2, sight.fx * omega2 * sight.cos2),
        (Y2, sight.fy * omega2 * sight.sin2),
        (T1, nodes.q1),
        (T2, nodes.q2),
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
def error_of(method, h, work, tolerance, nodes):
    """The integrals of the polynomials' highest terms, in units of the tolerances."""
    last = load(method, LAST)
    worst = miss(h * total(last * nodes.f1), work[PLACE, V1], tolerance[0, 0])
    worst = max(worst, miss(h * total(last * nodes.f2), work[PLACE, V2], tolerance[0, 1]))
    worst = max(worst, miss(h * total(last * nodes.fk), work[PLACE, J], tolerance[0, 2]))
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
def finish(method, h, work, nodes, once):
    """Places, rates and accounts at the end of the step, rounding errors kept.

    `once` is what the rates gain, but for h.
    """
    b = load(method, B)
    v = load(method, V)
    twice = total(b * nodes.f1), total(b * nodes.f2), total(b * nodes.fk)
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
def attempt(pair, potential, method, clock, h, tolerance, sharpness, work):
    """Try a step of h, whose error is `sharpness` times what the highest terms come to.

    Returns whether it was taken, by what to multiply h for the next, the rate of encounters at
    its end if it was taken, and whether all was finite.
    """
    converged, nodes = solve(pair, potential, method, clock, h, tolerance, work)
    if not converged:
        return False, 0.5, 0.0, math.isfinite(total(nodes.f1 + nodes.f2 + nodes.fk))
    start = work[POWERS, 0], work[POWERS, 1], work[POWERS, 2]
    end = book(method, h, work, nodes)
    error = sharpness * error_of(method, h, work, tolerance, nodes)
    finite = math.isfinite(error) and math.isfinite(total(end) + (start[0] + start[1]))
    growth = growth_of_eighth(error)
    if not error <= 1.0 or not finite:
        return False, growth, 0.0, finite
    v = load(method, V)
    once = total(v * nodes.f1), total(v * nodes.f2), total(v * nodes.fk)
    encounter = encounter_after(pair, potential, h, work, nodes, once)
    if h * encounter > 1.0:
        return False, 0.5, 0.0, True
    finish(method, h, work, nodes, once)
    remember(work, nodes, start, end)
    return True, growth, encounter, True
