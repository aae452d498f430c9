"""A step of two asperites by collocation: all nodes side by side.

The step is that of :mod:`tribo.integrators.collocation`, which goes node by node and asperite by
asperite; here eight nodes are computed at once, in vector registers.

Lane 0 is the end of the step, whose forces are those at the start of the next step; the other
lanes are the nodes within.  Accelerations and powers have those at the start in lane 0 instead.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import inlined
from tribo.compiler.lanes import LANES, absolute, broadcast, lane, maximum, sum_of_lanes, with_lane
from tribo.compiler.lanes_memory import load, store
from tribo.integrators.collocation import (
    MAX_EXTRAPOLATION,
    MAX_SWEEPS,
    SWEEP_TOLERANCE,
    Collocation,
)
from tribo.integrators.step_control import EPSILON, MAX_GROWTH, MIN_GROWTH
from tribo.pair import step_rows as rows
from tribo.pair.forces import contact_at, encounter_rate_of, swing_accelerations
from tribo.pair.step_rows import Q1, Q2, V1, V2, J, K
from tribo.pair.step_sums import (
    end_values,
    error_of,
    powers,
    sums_of,
    update_state,
    weighted_sum,
    weighted_sums,
)

# Part of the growth of a step that its error allows: a rejected step costs as much as an
# accepted one.
CAUTION = 0.65

# Part of the way to an encounter that a step may go, at the rate expected at its end.
CLEAR = 0.75


class Nodes(NamedTuple):
    """Accelerations, places and contact at the nodes, in Lanes."""

    f1: Any  # q1''
    f2: Any
    fk: Any  # k''
    q1: Any
    q2: Any
    contact: Any


def table(method: Collocation) -> np.ndarray:
    """The coefficients of a method whose eight nodes begin with 0, row by row."""
    found = np.empty((rows.R + LANES, LANES))
    found[rows.AT] = np.append(1.0, method.c[1:])
    found[rows.NODES], found[rows.POLE] = method.c, method.pole
    found[rows.B], found[rows.V], found[rows.LAST] = method.b, method.v, method.last
    for j in range(LANES):
        found[rows.A + j] = np.append(method.b[j], method.a[1:, j])
        found[rows.R + j] = np.append(method.v[j], method.r[1:, j])
    found[rows.AA : rows.AA + LANES] = (found[rows.A : rows.A + LANES].T[:, 1:] @ method.a[1:]).T
    return found


@inlined
def lagrange(work, x):
    """Lagrange's polynomials of the nodes, at eight places x."""
    d0, d1 = x - work[rows.NODES, 0], x - work[rows.NODES, 1]
    d2, d3 = x - work[rows.NODES, 2], x - work[rows.NODES, 3]
    d4, d5 = x - work[rows.NODES, 4], x - work[rows.NODES, 5]
    d6, d7 = x - work[rows.NODES, 6], x - work[rows.NODES, 7]
    d01, d23, d45, d67 = d0 * d1, d2 * d3, d4 * d5, d6 * d7
    front, back = d01 * d23, d45 * d67
    but01, but23, but45, but67 = d23 * back, d01 * back, front * d67, front * d45
    return (
        work[rows.POLE, 0] * d1 * but01,
        work[rows.POLE, 1] * d0 * but01,
        work[rows.POLE, 2] * d3 * but23,
        work[rows.POLE, 3] * d2 * but23,
        work[rows.POLE, 4] * d5 * but45,
        work[rows.POLE, 5] * d4 * but45,
        work[rows.POLE, 6] * d7 * but67,
        work[rows.POLE, 7] * d6 * but67,
    )


@inlined
def predict(clock, h, work):
    """Accelerations at the nodes: the last step's polynomials there, or those at the start."""
    ratio = h * (1.0 / clock.last_step) if clock.last_step > 0.0 else math.inf
    c = load(work, rows.AT)
    start1, start2, startk = work[rows.START, Q1], work[rows.START, Q2], work[rows.START, K]
    if ratio <= MAX_EXTRAPOLATION:
        weights = lagrange(work, 1.0 + ratio * c)
        f1 = with_lane(weighted_sum(weights, work, rows.MEMORY), 0, start1)
        f2 = with_lane(weighted_sum(weights, work, rows.MEMORY + 1), 0, start2)
        fk = with_lane(weighted_sum(weights, work, rows.MEMORY + 2), 0, startk)
        return f1, f2, fk
    return broadcast(start1), broadcast(start2), broadcast(startk)


@inlined
def reciprocal_tolerances(h, work):
    """Reciprocals of the tolerances of q1'', q2'' and k'' that follow from those of the rates."""
    unit1 = h / (work[rows.LIMITS, rows.OF_V1] + 2.0 * EPSILON * abs(work[rows.PLACE, V1]))
    unit2 = h / (work[rows.LIMITS, rows.OF_V2] + 2.0 * EPSILON * abs(work[rows.PLACE, V2]))
    unitk = h / (work[rows.LIMITS, rows.OF_J] + 2.0 * EPSILON * abs(work[rows.PLACE, J]))
    return unit1, unit2, unitk


@inlined
def uniform_motion(work, ahead):
    """q1, q2 and k a time `ahead`, without forces."""
    q1 = work[rows.PLACE, Q1] + work[rows.PLACE, V1] * ahead
    q2 = work[rows.PLACE, Q2] + work[rows.PLACE, V2] * ahead
    k = work[rows.PLACE, K] + work[rows.PLACE, J] * ahead
    return q1, q2, k


@inlined
def has_converged(change, before):
    """Whether a sweep more would change less than SWEEP_TOLERANCE, or this one stalled below 1."""
    return (
        change <= SWEEP_TOLERANCE
        or change * change <= SWEEP_TOLERANCE * before
        or 0.0 < before <= change <= 1.0
    )


@inlined
def solve(pair, potential, clock, h, work):
    """Solve for the accelerations at the nodes, to SWEEP_TOLERANCE of the tolerance.

    Returns whether the sweeps converged, and the Nodes.  Leaves the accelerations at the end of the
    step in SCRATCH.
    """
    f1, f2, fk = predict(clock, h, work)
    start1, start2, startk = work[rows.START, Q1], work[rows.START, Q2], work[rows.START, K]
    unit1, unit2, unitk = reciprocal_tolerances(h, work)
    ahead = h * load(work, rows.AT)
    t = clock.t + ahead
    square = h * h
    springs1 = square * pair.omega_squared1
    springs2 = square * pair.omega_squared2
    rest1, rest2, restk = uniform_motion(work, ahead)
    place1 = rest1 + square * weighted_sums(work, rows.A, f1)
    place2 = rest2 + square * weighted_sums(work, rows.A, f2)
    placek = restk + square * weighted_sums(work, rows.A, fk)
    before = 0.0
    for _ in range(MAX_SWEEPS):
        contact = contact_at(pair, potential, t, place1, place2, placek)
        new1, new2 = swing_accelerations(pair, contact, place1, place2)
        newk = with_lane(contact.fx, 0, startk)
        change1 = with_lane(new1, 0, start1) - f1
        change2 = with_lane(new2, 0, start2) - f2
        changek = newk - fk
        shift1 = weighted_sums(work, rows.A, change1)
        shift2 = weighted_sums(work, rows.A, change2)
        new1 = new1 - springs1 * shift1
        new2 = new2 - springs2 * shift2
        work[rows.SCRATCH, Q1] = lane(new1, 0)
        work[rows.SCRATCH, Q2] = lane(new2, 0)
        work[rows.SCRATCH, K] = lane(contact.fx, 0)
        change = maximum(
            unit1 * absolute(change1) + unit2 * absolute(change2) + unitk * absolute(changek)
        )
        clock.evaluations += LANES
        f1 = with_lane(new1, 0, start1)
        f2 = with_lane(new2, 0, start2)
        fk = newk
        if has_converged(change, before):
            return True, Nodes(f1, f2, fk, place1, place2, contact)
        if not math.isfinite(change):
            break
        before = change
        place1 = place1 + square * (shift1 - springs1 * weighted_sums(work, rows.AA, change1))
        place2 = place2 + square * (shift2 - springs2 * weighted_sums(work, rows.AA, change2))
        placek = placek + square * weighted_sums(work, rows.A, changek)
    return False, Nodes(f1, f2, fk, rest1, rest2, contact)


@inlined
def growth_factor(error):
    """Factor for the next step, of an error that grows as h^8.

    As :func:`tribo.integrators.step_control.growth_factor`, by roots, which are faster than powers.
    """
    growth = CAUTION / math.sqrt(math.sqrt(math.sqrt(error)))
    if not growth >= MIN_GROWTH:  # nan too
        return MIN_GROWTH
    return min(MAX_GROWTH, growth)


@inlined
def bounded_growth(error, most):
    """The same, but at most `most`; without roots, which are slow, where that is the result."""
    most = min(MAX_EXTRAPOLATION, most)
    fourth = (most / CAUTION) ** 4
    return most if error * (fourth * fourth) <= 1.0 else growth_factor(error)


@inlined
def encounter_after(pair, potential, h, work, nodes, once):
    """The rate of encounters at the end of the step."""
    return encounter_rate_of(
        pair,
        potential,
        lane(nodes.contact.r, 0),
        lane(nodes.q1, 0),
        lane(nodes.q2, 0),
        work[rows.PLACE, V1] + h * once[0],
        work[rows.PLACE, V2] + h * once[1],
        work[rows.PLACE, J] + h * once[2],
    )


@inlined
def store_start(work, nodes, start, end):
    """Store accelerations and powers at the start of the next step, and those of this one."""
    store(work, rows.MEMORY, nodes.f1)
    store(work, rows.MEMORY + 1, nodes.f2)
    store(work, rows.MEMORY + 2, nodes.fk)
    work[rows.START, Q1], work[rows.START, Q2], work[rows.START, K] = start
    store(work, rows.BEGINNING, end)


@inlined
def try_step(pair, potential, clock, h, encounter, sharpness, work):
    """Try a step of length h.

    Its error is `sharpness` times the integrals of the highest terms; `encounter` is the rate of
    encounters at its start.  Returns whether the step was accepted, the factor for the next one,
    and whether all values were finite.
    """
    converged, nodes = solve(pair, potential, clock, h, work)
    if not converged:
        return False, 0.5, math.isfinite(sum_of_lanes(nodes.f1 + nodes.f2 + nodes.fk))
    start = work[rows.SCRATCH, Q1], work[rows.SCRATCH, Q2], work[rows.SCRATCH, K]
    power = powers(h, work, nodes)
    end = end_values(power)
    sums = sums_of(work, nodes, power)
    error = sharpness * error_of(h, work, sums)
    finite = math.isfinite(error) and math.isfinite(sum_of_lanes(end) + (start[0] + start[1]))
    if not error <= 1.0 or not finite:
        return False, growth_factor(error), finite
    later = encounter_after(pair, potential, h, work, nodes, sums.once)
    if h * later > 1.0:
        return False, max(MIN_GROWTH, CLEAR / (h * later)), True
    update_state(h, work, sums)
    store_start(work, nodes, start, end)
    work[rows.START, rows.RATE] = later
    clear = clock.encounter_fraction
    if later > encounter:  # the rate is taken to grow on as much
        clear = min(clear, CLEAR * later / (2.0 * later - encounter))
    return True, bounded_growth(error, clear / (h * later)), True
