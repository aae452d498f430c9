"""Explicit Runge-Kutta time loops: one with a fixed step, one that chooses its own.

Both carry the accounts of the ledger beside the state, each account by the method's own
quadrature, and add every step's increment with compensation, so that round-off does not build up.
"""

import math

import numpy as np

from tribo.kernels.compiled import kernel
from tribo.kernels.neighbours import crowded
from tribo.kernels.samples import blank, copy_state, write_sample
from tribo.kernels.status import (
    COMPLETED,
    ENCOUNTER_JUMPED,
    NOT_FINITE,
    PAUSED,
    STEP_UNDERFLOW,
)
from tribo.kernels.stepping import (
    EPSILON,
    advance,
    all_finite,
    begin,
    end_of_step,
    equal_step,
    glance,
    go_on,
    growth_of,
    looks,
    nearness,
    next_step,
    rates,
    time_left,
    turn_back,
)
from tribo.kernels.sums import add, combine, largest


@kernel
def slopes_at(model, neighbours, t, y, slope, power):
    """y' = (v, q'') and s' at one instant."""
    n = y.size // 2
    for m in range(n):
        slope[m] = y[n + m]
    rates(model, neighbours, t, y, slope[n:], power)


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
    n = state.y.size // 2
    status, encounter = begin(model, neighbours, clock, state, slopes[0, n:], powers_[0], speeds)
    slopes[0, :n] = state.y[n:]
    if status != COMPLETED:
        return status
    unseen = 0.0  # time since the encounters were looked at
    stride = looks(model)
    done = 0
    while clock.sample < times.size:
        goal = times[clock.sample]
        left = time_left(clock, goal)
        if left <= 0.0:
            write_sample(model, neighbours, clock, state, record)
            continue
        if done == budget or crowded(neighbours):
            return PAUSED
        h = equal_step(left, step)
        if h < EPSILON * times[-1]:
            return STEP_UNDERFLOW
        if h * encounter > 1.0:
            return ENCOUNTER_JUMPED
        for i in range(1, stages):
            combine(state.y, h, tableau.a[i], slopes, y)
            slopes_at(model, neighbours, clock.t + tableau.c[i] * h, y, slopes[i], powers_[i])
        add(state.y, state.y_low, h, tableau.b, slopes)
        add(state.s, state.s_low, h, tableau.b, powers_)
        advance(clock, end_of_step(clock, goal, h, h == left), h, h == left)
        slopes_at(model, neighbours, clock.t, state.y, slopes[0], powers_[0])
        clock.evaluations += stages
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
    trial = blank(state)
    slopes = np.empty((stages, state.y.size))
    powers_ = np.empty((stages, state.s.size))
    next_slope = np.empty(state.y.size)
    next_power = np.empty(state.s.size)
    speeds = np.empty((model.asperites.size, 3))
    n = state.y.size // 2
    status, encounter = begin(model, neighbours, clock, state, slopes[0, n:], powers_[0], speeds)
    slopes[0, :n] = state.y[n:]
    if status != COMPLETED:
        return status
    done = 0
    finite = True
    while clock.sample < times.size:
        goal = times[clock.sample]
        left = time_left(clock, goal)
        if left <= 0.0:
            write_sample(model, neighbours, clock, state, record)
            continue
        if done == budget or crowded(neighbours):
            return PAUSED
        done += 1
        h, landing = next_step(clock, encounter, left)
        if h < 16.0 * EPSILON * times[-1] and not landing:
            return STEP_UNDERFLOW if finite else NOT_FINITE

        for i in range(1, stages):
            combine(state.y, h, tableau.a[i], slopes, y)
            slopes_at(model, neighbours, clock.t + tableau.c[i] * h, y, slopes[i], powers_[i])
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
            turn_back(clock, h * growth_of(error, 8.0))
            continue

        copy_state(state, trial)
        add(trial.y, trial.y_low, h, tableau.b, slopes)
        add(trial.s, trial.s_low, h, tableau.b, powers_)
        t = end_of_step(clock, goal, h, landing)
        slopes_at(model, neighbours, t, trial.y, next_slope, next_power)
        clock.evaluations += 1
        next_encounter, _ = nearness(model, neighbours, t, trial.y, speeds)
        finite = all_finite(next_slope) and all_finite(next_power)
        if not finite or h * next_encounter > 1.0:
            turn_back(clock, 0.5 * h)
            continue

        go_on(clock, t, h, landing, growth_of(error, 8.0))
        copy_state(trial, state)
        slopes[0] = next_slope
        powers_[0] = next_power
        encounter = next_encounter
    return COMPLETED
