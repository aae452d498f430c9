"""Explicit Runge-Kutta time loops: one with a fixed step, one that chooses its own.

Both carry the accounts of the ledger beside the state, each account by the method's own
quadrature, and add every step's increment with compensation, so that round-off does not build up.
"""

import math

import numpy as np

from tribo.integrators.linear_combinations import add, combine, largest
from tribo.integrators.step_control import (
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
    step_underflows,
    underflow_status,
    update_encounter,
)
from tribo.kernels.compiled import kernel
from tribo.kernels.neighbours import crowded
from tribo.kernels.samples import blank, copy, copy_state
from tribo.kernels.status import (
    COMPLETED,
    NOT_FINITE,
    PAUSED,
)


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
    status, encounter = initialize(
        model, neighbours, clock, state, slopes[0, n:], powers_[0], speeds
    )
    copy(state.y[n:], slopes[0, :n])
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
        for i in range(1, stages):
            combine(state.y, h, tableau.a[i], slopes, y)
            slopes_at(model, neighbours, clock.t + tableau.c[i] * h, y, slopes[i], powers_[i])
        add(state.y, state.y_low, h, tableau.b, slopes)
        add(state.s, state.s_low, h, tableau.b, powers_)
        advance(clock, end_of_step(clock, goal, h, h == left), h, h == left)
        slopes_at(model, neighbours, clock.t, state.y, slopes[0], powers_[0])
        clock.evaluations += stages
        if not all_finite(slopes[0]) or not all_finite(state.s):
            return NOT_FINITE
        encounter = update_encounter(model, neighbours, clock, state.y, speeds, h, encounter)
    return PAUSED


def chosen_steps(model, neighbours, tableau, tolerance, clocks, state, times, record, budget):
    """March through the samples with steps whose local errors stay within `tolerance`.

    No step may carry a pair of bobs farther towards its next encounter than the clock allows, by
    the speeds at its start, nor past it by the speeds at its end.  PAUSED after `budget` tries.
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
    status, encounter = initialize(
        model, neighbours, clock, state, slopes[0, n:], powers_[0], speeds
    )
    copy(state.y[n:], slopes[0, :n])
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
        if error_too_large(clock, error, h, 8.0):
            continue

        copy_state(state, trial)
        add(trial.y, trial.y_low, h, tableau.b, slopes)
        add(trial.s, trial.s_low, h, tableau.b, powers_)
        t = end_of_step(clock, goal, h, landing)
        slopes_at(model, neighbours, t, trial.y, next_slope, next_power)
        clock.evaluations += 1
        ahead = check_arrival(
            model, neighbours, clock, t, trial.y, next_slope, next_power, speeds, h
        )
        if ahead < 0.0:
            continue

        accept_step(clock, t, h, landing, growth_factor(error, 8.0))
        copy_state(trial, state)
        copy(next_slope, slopes[0])
        copy(next_power, powers_[0])
        encounter = ahead
    return PAUSED
