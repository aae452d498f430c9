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
from tribo.compiler.lanes import LANES, absolute, broadcast, lane, maximum, sum_of_lanes
from tribo.compiler.lanes_memory import load, store
from tribo.integrators.collocation import (
    MAX_EXTRAPOLATION,
    MAX_SWEEPS,
    SWEEP_TOLERANCE,
    Collocation,
)
from tribo.integrators.step_control import MAX_GROWTH, MIN_GROWTH, growth_by_roots
from tribo.pair import step_rows as rows
from tribo.pair.forces import accelerations_of, contact_at, encounter_rate_of
from tribo.pair.step_rows import Q1, Q2, V1, K
from tribo.pair.step_sums import (
    end_values,
    error_of,
    powers,
    sums_of,
    tolerance_of,
    update_state,
    weighted_sum,
    weighted_sums,
)
from tribo.pair.triples import plus, set_three_in, store_three, three_in, times, with_first

# Part of the growth of a step that its error allows: a rejected step costs as much as an
# accepted one.
CAUTION = 0.65
# Square roots of an error, which grows as h^8, that grow as h.
ROOTS = 3

# Part of the way to an encounter that a step may go, at the rate expected at its end.
CLEAR = 0.75


class Nodes(NamedTuple):
    """Accelerations, places and contact at the nodes, in Lanes."""

    f: Any  # q1'', q2'' and k''
    q1: Any
    q2: Any
    contact: Any


def table(method: Collocation) -> np.ndarray:
    """The coefficients of a method whose eight nodes begin with 0, row by row."""
    found = np.empty((rows.R + LANES, LANES))
    found[rows.AT] = np.append(1.0, method.c[1:])
    found[rows.NODES] = method.c
    found[rows.POLE] = method.pole
    found[rows.B] = method.b
    found[rows.V] = method.v
    found[rows.LAST] = method.last
    for j in range(LANES):
        found[rows.A + j] = np.append(method.b[j], method.a[1:, j])
        found[rows.R + j] = np.append(method.v[j], method.r[1:, j])
    found[rows.AA : rows.AA + LANES] = (found[rows.A : rows.A + LANES].T[:, 1:] @ method.a[1:]).T
    return found


@inlined
def lagrange(work, x):
    """Lagrange's polynomials of the nodes, at eight places x."""
    d0 = x - work[rows.NODES, 0]
    d1 = x - work[rows.NODES, 1]
    d2 = x - work[rows.NODES, 2]
    d3 = x - work[rows.NODES, 3]
    d4 = x - work[rows.NODES, 4]
    d5 = x - work[rows.NODES, 5]
    d6 = x - work[rows.NODES, 6]
    d7 = x - work[rows.NODES, 7]
    d01 = d0 * d1
    d23 = d2 * d3
    d45 = d4 * d5
    d67 = d6 * d7
    front = d01 * d23
    back = d45 * d67
    but01 = d23 * back
    but23 = d01 * back
    but45 = front * d67
    but67 = front * d45
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
    start1, start2, startk = three_in(work, rows.START, Q1)
    if ratio <= MAX_EXTRAPOLATION:
        weights = lagrange(work, 1.0 + ratio * load(work, rows.AT))
        f1 = weighted_sum(weights, work, rows.MEMORY)
        f2 = weighted_sum(weights, work, rows.MEMORY + 1)
        fk = weighted_sum(weights, work, rows.MEMORY + 2)
        return with_first((f1, f2, fk), (start1, start2, startk))
    return broadcast(start1), broadcast(start2), broadcast(startk)


@inlined
def solve(pair, potential, clock, h, work):
    """Solve for the accelerations at the nodes, to SWEEP_TOLERANCE of the tolerance.

    Returns whether the sweeps converged, and the Nodes.  Leaves the accelerations at the end of the
    step in SCRATCH.
    """
    f = predict(clock, h, work)
    start = three_in(work, rows.START, Q1)
    unit1 = h / tolerance_of(work, 0)
    unit2 = h / tolerance_of(work, 1)
    unitk = h / tolerance_of(work, 2)
    ahead = h * load(work, rows.AT)
    t = clock.t + ahead
    square = h * h
    springs1 = square * pair.omega_squared1
    springs2 = square * pair.omega_squared2
    without_forces = plus(
        three_in(work, rows.PLACE, Q1), times(ahead, three_in(work, rows.PLACE, V1))
    )
    q1 = without_forces[0] + square * weighted_sums(work, rows.A, f[0])
    q2 = without_forces[1] + square * weighted_sums(work, rows.A, f[1])
    k = without_forces[2] + square * weighted_sums(work, rows.A, f[2])
    before = 0.0
    for _ in range(MAX_SWEEPS):
        contact = contact_at(pair, potential, t, q1, q2, k)
        new1, new2, newk = accelerations_of(pair, contact, q1, q2)
        found = with_first((new1, new2, newk), start)
        change1 = found[0] - f[0]
        change2 = found[1] - f[1]
        changek = found[2] - f[2]
        shift1 = weighted_sums(work, rows.A, change1)
        shift2 = weighted_sums(work, rows.A, change2)
        new = new1 - springs1 * shift1, new2 - springs2 * shift2, newk
        set_three_in(work, rows.SCRATCH, new)
        change = maximum(
            unit1 * absolute(change1) + unit2 * absolute(change2) + unitk * absolute(changek)
        )
        clock.evaluations += LANES
        f = with_first(new, start)
        # A sweep more would change less, or this one stalled below the tolerance.
        converged = change <= SWEEP_TOLERANCE or change * change <= SWEEP_TOLERANCE * before
        if converged or 0.0 < before <= change <= 1.0:
            return True, Nodes(f, q1, q2, contact)
        if not math.isfinite(change):
            break
        before = change
        q1 = q1 + square * (shift1 - springs1 * weighted_sums(work, rows.AA, change1))
        q2 = q2 + square * (shift2 - springs2 * weighted_sums(work, rows.AA, change2))
        k = k + square * weighted_sums(work, rows.A, changek)
    return False, Nodes(f, q1, q2, contact)


@inlined
def growth_factor(error):
    """Factor for the next step, of an error that grows as h^8."""
    return growth_by_roots(error, ROOTS, CAUTION, MAX_GROWTH)


@inlined
def bounded_growth(error, most):
    """The same, but at most `most`; without roots, which are slow, where that is the result."""
    most = min(MAX_EXTRAPOLATION, most)
    fourth = (most / CAUTION) ** 4
    return most if error * (fourth * fourth) <= 1.0 else growth_factor(error)


@inlined
def try_step(pair, potential, clock, h, encounter, sharpness, work):
    """Try a step of length h.

    Its error is `sharpness` times the integrals of the highest terms; `encounter` is the rate of
    encounters at its start.  Returns whether the step was accepted, the factor for the next one,
    and whether all values were finite.
    """
    converged, nodes = solve(pair, potential, clock, h, work)
    if not converged:
        f1, f2, fk = nodes.f
        return False, 0.5, math.isfinite(sum_of_lanes(f1 + f2 + fk))
    start = three_in(work, rows.SCRATCH, Q1)
    power = powers(h, work, nodes)
    end = end_values(power)
    sums = sums_of(work, nodes, power)
    error = sharpness * error_of(h, work, sums)
    finite = math.isfinite(error) and math.isfinite(sum_of_lanes(end) + (start[0] + start[1]))
    if not error <= 1.0 or not finite:
        return False, growth_factor(error), finite
    r = math.sqrt(lane(nodes.contact.square, 0))
    q1 = lane(nodes.q1, 0)
    q2 = lane(nodes.q2, 0)
    v1, v2, j = plus(three_in(work, rows.PLACE, V1), times(h, sums.once))
    later = encounter_rate_of(pair, potential, r, q1, q2, v1, v2, j)
    if h * later > 1.0:
        return False, max(MIN_GROWTH, CLEAR / (h * later)), True
    update_state(h, work, sums)
    store_three(work, rows.MEMORY, nodes.f)
    store(work, rows.BEGINNING, end)
    work[rows.START, Q1], work[rows.START, Q2], work[rows.START, K] = start
    work[rows.START, rows.RATE] = later
    clear = clock.encounter_fraction
    if later > encounter:  # the rate is taken to grow on as much
        clear = min(clear, CLEAR * later / (2.0 * later - encounter))
    return True, bounded_growth(error, clear / (h * later)), True
