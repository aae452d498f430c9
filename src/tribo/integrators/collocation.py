"""Collocation: over a step q'' is a polynomial whose values at nodes are found by iteration.

Velocities are known at every node, so that powers are booked there, and forces may depend on
velocities.  With Gauss nodes and equal steps a step back undoes a step; with Radau nodes steps are
chosen by the polynomial's highest term.

J. C. Butcher, Math. Comput. 18 (1964) 50; E. Hairer, R. I. McLachlan, A. Razakarivony, BIT 48
(2008) 231, on iterating down to round-off; E. Everhart, in Dynamics of Comets, Reidel 1985, p. 185;
H. Rein, D. S. Spiegel, Mon. Not. R. Astron. Soc. 446 (2015) 1424.
"""

import math

import numpy as np

from tribo.integrators.linear_combinations import add, add_twice, combine, combine_twice, largest
from tribo.integrators.step_control import (
    EPSILON,
    accept_step,
    advance,
    all_finite,
    check_arrival,
    end_of_step,
    equal_step,
    equal_step_status,
    error_too_large,
    growth_factor,
    initialize,
    next_step,
    rates,
    record_due,
    reject_step,
    step_underflows,
    underflow_status,
    update_encounter,
)
from tribo.kernels.compiled import kernel
from tribo.kernels.equations_of_motion import equations_of_motion
from tribo.kernels.neighbours import crowded
from tribo.kernels.powers import all_powers
from tribo.kernels.samples import blank, copy, copy_state
from tribo.kernels.status import (
    COMPLETED,
    NOT_CONVERGED,
    NOT_FINITE,
    PAUSED,
)

SWEEPS = 40  # through the nodes, after which an iteration is given up
ROUNDED = 1e6  # times round-off: an iteration that stalls below has converged
FARTHEST = 4.0  # steps, that a polynomial is continued beyond its own
SHARE = 1e-4  # of the tolerance, for what an iteration leaves
SHARP = 10.0  # highest term of q'' that goes with a level of 1, in units of the scales


@kernel
def unknowns(method):
    """How many nodes there are but the start."""
    return method.c.size - 1 if method.c[0] == 0.0 else method.c.size


@kernel
def predict(method, clock, h, memory, slopes):
    """Values at the nodes to begin with: those of the last step's polynomial, or of the start."""
    ratio = h / clock.last if clock.last > 0.0 else math.inf
    for i in range(method.c.size):
        if ratio > FARTHEST:
            copy(slopes[0], slopes[i])
        elif method.c[i] > 0.0:
            x = 1.0 + ratio * method.c[i]
            whole = 1.0
            for k in range(method.c.size):
                whole *= x - method.c[k]
            for m in range(slopes.shape[1]):
                slopes[i, m] = 0.0
            for j in range(method.c.size):
                weight = whole * method.pole[j] / (x - method.c[j])
                for m in range(slopes.shape[1]):
                    slopes[i, m] += weight * memory[j, m]


@kernel
def remember(slopes, memory):
    """Keep the values at all nodes for the next step."""
    for i in range(slopes.shape[0]):
        copy(slopes[i], memory[i])


@kernel
def round_off(v, h, slope, unit):
    """The round-off of the fastest rate, as the unit of all."""
    fastest = 0.0
    steepest = 0.0
    for m in range(v.size):
        fastest = max(fastest, abs(v[m]))
        steepest = max(steepest, abs(slope[m]))
    for m in range(v.size):
        unit[m] = EPSILON * (fastest + h * steepest)


@kernel
def at_node(model, neighbours, method, i, t, h, y, slopes, node, slope):
    """q'' at node i, from the values so far; `node` becomes (q, v) there."""
    n = y.size // 2
    combine_twice(y[:n], h, method.c[i], y[n:], method.a[i], slopes, node[:n])
    combine(y[n:], h, method.r[i], slopes, node[n:])
    equations_of_motion(model, neighbours, t + method.c[i] * h, node[:n], node[n:], slope)


@kernel
def sweep(model, neighbours, method, t, h, y, slopes, node, slope, unit):
    """Renew the values at all nodes; returns by how much, times h, in units of `unit`."""
    change = 0.0
    for i in range(method.c.size):
        if method.c[i] > 0.0:
            at_node(model, neighbours, method, i, t, h, y, slopes, node, slope)
            for m in range(slope.size):
                new = h * abs(slope[m] - slopes[i, m]) / unit[m]
                if not new <= change:  # keeps nan
                    change = new
            copy(slope, slopes[i])
    return change


@kernel
def solve(model, neighbours, method, clock, h, y, slopes, node, slope, unit, enough, stall):
    """Sweep until another would change less than `enough`, or less than `stall` no more.

    Returns whether that came about.
    """
    before = 0.0
    for _ in range(SWEEPS):
        change = sweep(model, neighbours, method, clock.t, h, y, slopes, node, slope, unit)
        clock.evaluations += unknowns(method)
        if change <= enough or change * change <= enough * before:
            return True
        if 0.0 < before <= change <= stall:
            return True
        if not math.isfinite(change):
            return False
        before = change
    return False


@kernel
def book(model, neighbours, method, t, h, y, slopes, node, slope, powers_):
    """A last sweep, which looks at the powers as well."""
    n = y.size // 2
    for i in range(method.c.size):
        if method.c[i] > 0.0:
            at_node(model, neighbours, method, i, t, h, y, slopes, node, slope)
            all_powers(model, t + method.c[i] * h, node[:n], node[n:], powers_[i])
            copy(slope, slopes[i])


@kernel
def finish(method, h, state, slopes, powers_):
    """The state at the end of the step."""
    n = state.y.size // 2
    add_twice(state.y[:n], state.y_low[:n], h, state.y[n:], state.y_low[n:], method.b, slopes)
    add(state.y[n:], state.y_low[n:], h, method.v, slopes)
    add(state.s, state.s_low, h, method.v, powers_)


def equal_collocation(model, neighbours, method, step, clocks, state, times, record, budget):
    """March through the samples in equal steps of at most `step`; return a status.

    As :func:`tribo.integrators.runge_kutta.fixed_steps`.  Every step is solved to round-off.
    """
    clock = clocks[0]
    n = state.y.size // 2
    node = np.empty_like(state.y)
    slopes = np.empty((method.c.size, n))
    powers_ = np.empty((method.c.size, state.s.size))
    slope = np.empty(n)
    power = np.empty(state.s.size)
    unit = np.empty(n)
    speeds = np.empty((model.asperites.size, 3))
    status, encounter = initialize(model, neighbours, clock, state, slope, power, speeds)
    if status != COMPLETED:
        return status
    for _ in range(budget):
        left = record_due(model, neighbours, clock, state, times, record)
        if left == 0.0:
            return COMPLETED
        if crowded(neighbours):
            return PAUSED
        goal = times[clock.sample]
        h = equal_step(left, step)
        status = equal_step_status(h, encounter, times[-1])
        if status != COMPLETED:
            return status
        round_off(state.y[n:], h, slope, unit)
        copy(slope, slopes[0])
        predict(method, clock, h, state.memory, slopes)
        converged = solve(
            model, neighbours, method, clock, h, state.y, slopes, node, slope, unit, 0.0, ROUNDED
        )
        if not converged:
            return NOT_CONVERGED if all_finite(slope) else NOT_FINITE
        book(model, neighbours, method, clock.t, h, state.y, slopes, node, slope, powers_)
        finish(method, h, state, slopes, powers_)
        remember(slopes, state.memory)
        clock.last = h
        advance(clock, end_of_step(clock, goal, h, h == left), h, h == left)
        rates(model, neighbours, clock.t, state.y, slope, power)
        clock.evaluations += unknowns(method) + 1
        if not all_finite(slope) or not all_finite(state.s):
            return NOT_FINITE
        encounter = update_encounter(model, neighbours, clock, state.y, speeds, h, encounter)
    return PAUSED


def chosen_collocation(model, neighbours, method, tolerance, clocks, state, times, record, budget):
    """March through the samples with steps whose local errors stay within `tolerance`.

    As :func:`tribo.integrators.runge_kutta.chosen_steps`, encounters and statuses included.  The
    first node is the start of the step.  Errors are about as the square of the polynomial's
    highest term, both in units of the scales of velocities and of accounts.
    """
    clock = clocks[0]
    n = state.y.size // 2
    nodes = method.c.size
    trial = blank(state)
    node = np.empty_like(state.y)
    slopes = np.empty((nodes, n))
    powers_ = np.empty((nodes, state.s.size))
    slope = np.empty(n)
    next_slope = np.empty(n)
    next_power = np.empty(state.s.size)
    unit = np.empty(n)
    speeds = np.empty((model.asperites.size, 3))
    sharpness = math.sqrt(tolerance.level) / SHARP
    status, encounter = initialize(model, neighbours, clock, state, slopes[0], powers_[0], speeds)
    if status != COMPLETED:
        return status
    for _ in range(budget):
        left = record_due(model, neighbours, clock, state, times, record)
        if left == 0.0:
            return COMPLETED
        if crowded(neighbours):
            return PAUSED
        goal = times[clock.sample]
        h, landing = next_step(clock, encounter, left)
        if step_underflows(h, landing, times[-1]):
            return underflow_status(clock)

        for m in range(n):
            unit[m] = tolerance.y[n + m] + 2.0 * EPSILON * abs(state.y[n + m])
        predict(method, clock, h, state.memory, slopes)
        converged = solve(
            model, neighbours, method, clock, h, state.y, slopes, node, slope, unit, SHARE, 1.0
        )
        if not converged:
            clock.lost = 0 if all_finite(slope) else 1
            reject_step(clock, 0.5 * h)
            continue
        book(model, neighbours, method, clock.t, h, state.y, slopes, node, slope, powers_)
        clock.evaluations += unknowns(method)
        error = sharpness * (
            largest(h, method.last, slopes, state.y[n:], tolerance.y[n:])
            + largest(h, method.last, powers_, state.s, tolerance.s)
        )
        if error_too_large(clock, error, h, nodes):
            continue

        copy_state(state, trial)
        finish(method, h, trial, slopes, powers_)
        t = end_of_step(clock, goal, h, landing)
        rates(model, neighbours, t, trial.y, next_slope, next_power)
        clock.evaluations += 1
        ahead = check_arrival(
            model, neighbours, clock, t, trial.y, next_slope, next_power, speeds, h
        )
        if ahead < 0.0:
            continue

        accept_step(clock, t, h, landing, min(FARTHEST, growth_factor(error, nodes)))
        clock.last = h
        copy_state(trial, state)
        remember(slopes, state.memory)
        copy(next_slope, slopes[0])
        copy(next_power, powers_[0])
        encounter = ahead
    return PAUSED
