"""Explicit Runge-Kutta time loops: one with a fixed step, one that chooses its own.

Both carry the accounts of the ledger beside the state, each account by the method's own
quadrature, and add every step's increment with compensation, so that round-off does not build up.
"""

import math
from typing import NamedTuple

import numpy as np

from tribo.kernels.compiled import kernel
from tribo.kernels.motion import equations_of_motion
from tribo.kernels.powers import all_powers
from tribo.kernels.samples import write_sample
from tribo.kernels.status import (
    BOBS_COINCIDE,
    COMPLETED,
    ENCOUNTER_JUMPED,
    NOT_FINITE,
    PAUSED,
    STEP_UNDERFLOW,
)
from tribo.kernels.stepping import EPSILON, all_finite, glance, looks, nearness


class Tolerance(NamedTuple):
    """The largest local error wanted in each component of y and of s."""

    y: np.ndarray
    s: np.ndarray


@kernel
def rates(model, neighbours, t, y, slope, power):
    """y' = (v, q'') and s' at one instant; returns the neighbours."""
    n = y.size // 2
    q = y[:n]
    v = y[n:]
    slope[:n] = v
    neighbours = equations_of_motion(model, neighbours, t, q, v, slope[n:])
    all_powers(model, t, q, v, power)
    return neighbours


@kernel
def combine(y, h, row, slopes, out):
    """out = y + h sum_j row_j slopes_j."""
    out[:] = y
    for j in range(row.size):
        if row[j] != 0.0:
            weight = h * row[j]
            for m in range(y.size):
                out[m] += weight * slopes[j, m]


@kernel
def add(x, low, h, weights, slopes):
    """x += h sum_j weights_j slopes_j, with the rounding error kept in `low`."""
    for m in range(x.size):
        total = 0.0
        for j in range(weights.size):
            total += weights[j] * slopes[j, m]
        step = h * total + low[m]
        new = x[m] + step
        low[m] = step - (new - x[m])
        x[m] = new


@kernel
def largest(h, weights, slopes, scale_of, tolerance):
    """Largest |h sum_j weights_j slopes_j| in units of the tolerance (never below round-off)."""
    worst = 0.0
    for m in range(scale_of.size):
        total = 0.0
        for j in range(weights.size):
            total += weights[j] * slopes[j, m]
        error = abs(h * total) / (tolerance[m] + 2.0 * EPSILON * abs(scale_of[m]))
        if not error <= worst:  # keeps nan
            worst = error
    return worst


@kernel
def begin(model, neighbours, clock, state, slope, power, speeds):
    """Rates at the place where a run starts or goes on, and whether it can."""
    neighbours = rates(model, neighbours, clock.t, state.y, slope, power)
    if clock.evaluations == 0:  # going on after a pause costs one more, which is nobody's business
        clock.evaluations = 1
    encounter, closest = nearness(model, neighbours, clock.t, state.y, speeds)
    status = COMPLETED
    if closest == 0.0:
        status = BOBS_COINCIDE
    elif not (all_finite(slope) and all_finite(power)):
        status = NOT_FINITE
    return status, encounter, neighbours


def fixed_steps(model, neighbours, tableau, step, clocks, state, times, record, budget):
    """March through the samples in equal steps of at most `step`; return a status.

    Between two samples the steps are equal, and as few as `step` allows.  The step is obeyed
    until it would jump an encounter.  PAUSED after `budget` steps: call again to go on.
    """
    clock = clocks[0]
    stages = tableau.b.size
    y = np.empty_like(state.y)
    slopes = np.empty((stages, state.y.size))
    powers_ = np.empty((stages, state.s.size))
    speeds = np.empty((model.asperites.size, 3))
    status, encounter, neighbours = begin(
        model, neighbours, clock, state, slopes[0], powers_[0], speeds
    )
    if status != COMPLETED:
        return status
    unseen = 0.0  # time since the encounters were looked at
    stride = looks(model)
    done = 0
    while clock.sample < times.size:
        goal = times[clock.sample]
        left = goal - clock.t
        if left <= 0.0:
            write_sample(model, neighbours, clock, state, record)
            continue
        if done == budget:
            return PAUSED
        h = left / max(1.0, np.ceil(left / step - 1e-9))
        if h < EPSILON * times[-1]:
            return STEP_UNDERFLOW
        if h * encounter > 1.0:
            return ENCOUNTER_JUMPED
        for i in range(1, stages):
            combine(state.y, h, tableau.a[i], slopes, y)
            neighbours = rates(
                model, neighbours, clock.t + tableau.c[i] * h, y, slopes[i], powers_[i]
            )
        add(state.y, state.y_low, h, tableau.b, slopes)
        add(state.s, state.s_low, h, tableau.b, powers_)
        clock.t = goal if h == left else clock.t + h
        neighbours = rates(model, neighbours, clock.t, state.y, slopes[0], powers_[0])
        clock.evaluations += stages
        clock.steps += 1
        done += 1
        if not all_finite(slopes[0]) or not all_finite(state.s):
            return NOT_FINITE
        unseen += h
        if clock.steps % stride == 0 or (unseen + h) * encounter > 0.25:
            encounter = glance(model, neighbours, clock.t, state.y, speeds, h)
            unseen = 0.0
    return COMPLETED


def chosen_steps(model, neighbours, tableau, tolerance, clocks, state, times, record, budget):
    """March through the samples with steps whose local errors stay within `tolerance`.

    No step may carry a pair of bobs more than half way to its next encounter, by the speeds at
    its start, nor past it by the speeds at its end.  PAUSED after `budget` steps.
    """
    clock = clocks[0]
    stages = tableau.b.size
    y = np.empty_like(state.y)
    s = np.empty_like(state.s)
    y_low = np.empty_like(state.y)
    s_low = np.empty_like(state.s)
    slopes = np.empty((stages, state.y.size))
    powers_ = np.empty((stages, state.s.size))
    next_slope = np.empty(state.y.size)
    next_power = np.empty(state.s.size)
    speeds = np.empty((model.asperites.size, 3))
    status, encounter, neighbours = begin(
        model, neighbours, clock, state, slopes[0], powers_[0], speeds
    )
    if status != COMPLETED:
        return status
    done = 0
    finite = True
    while clock.sample < times.size:
        goal = times[clock.sample]
        left = (goal - clock.t) - clock.t_low
        if left <= 0.0:
            write_sample(model, neighbours, clock, state, record)
            continue
        if done == budget:
            return PAUSED
        done += 1
        h = clock.h
        if h * encounter > 0.5:
            h = 0.5 / encounter
        landing = h >= left
        if landing:
            h = left
        elif 2.0 * h > left:
            h = 0.5 * left
        if h < 16.0 * EPSILON * times[-1] and not landing:
            return STEP_UNDERFLOW if finite else NOT_FINITE

        for i in range(1, stages):
            combine(state.y, h, tableau.a[i], slopes, y)
            neighbours = rates(
                model, neighbours, clock.t + tableau.c[i] * h, y, slopes[i], powers_[i]
            )
        clock.evaluations += stages - 1
        fifth = max(
            largest(h, tableau.e5, slopes, state.y, tolerance.y),
            largest(h, tableau.e5, powers_, state.s, tolerance.s),
        )
        third = max(
            largest(h, tableau.e3, slopes, state.y, tolerance.y),
            largest(h, tableau.e3, powers_, state.s, tolerance.s),
        )
        error = fifth
        if fifth > 0.0:
            error = fifth * (fifth / math.hypot(fifth, 0.1 * third))
        finite = math.isfinite(error)
        if not error <= 1.0:
            clock.h = h * (max(0.2, 0.9 * error**-0.125) if finite else 0.2)
            clock.rejected += 1
            clock.held = 1
            continue

        y[:] = state.y
        s[:] = state.s
        y_low[:] = state.y_low
        s_low[:] = state.s_low
        add(y, y_low, h, tableau.b, slopes)
        add(s, s_low, h, tableau.b, powers_)
        t = goal if landing else clock.t + (h + clock.t_low)
        neighbours = rates(model, neighbours, t, y, next_slope, next_power)
        clock.evaluations += 1
        next_encounter, _ = nearness(model, neighbours, t, y, speeds)
        finite = all_finite(next_slope) and all_finite(next_power)
        if not finite or h * next_encounter > 1.0:
            clock.h = 0.5 * h
            clock.rejected += 1
            clock.held = 1
            continue

        clock.t_low = 0.0 if landing else (h + clock.t_low) - (t - clock.t)
        clock.t = t
        clock.steps += 1
        state.y[:] = y
        state.s[:] = s
        state.y_low[:] = y_low
        state.s_low[:] = s_low
        slopes[0] = next_slope
        powers_[0] = next_power
        encounter = next_encounter
        growth = 6.0
        if error > 0.0:
            growth = min(6.0, max(0.2, 0.9 * error**-0.125))
        if clock.held == 1:
            growth = min(growth, 1.0)
        clock.h = max(clock.h, h * growth) if h < clock.h and growth > 1.0 else h * growth
        clock.held = 0
    return COMPLETED
