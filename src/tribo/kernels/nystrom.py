"""Adaptive Runge-Kutta-Nystrom: for M q'' = F(q, t), whose forces know places and time alone.

Stages are places, and carry no velocities; but the powers of the ledger are forces times
velocities.  Once all forces of a step are known, so are velocities at its stages,

    V_i = v + h sum_j r_ij f_j,

with a full matrix r, and the ledger's quadrature sum_i v_i P(Q_i, V_i) is of the method's own
order: see :func:`tribo.kernels.nystrom_tableaux.stage_velocities`.  Forces are therefore kept,
stage by stage, until the step is complete.
"""

import math

import numpy as np

from tribo.kernels.compiled import kernel
from tribo.kernels.motion import equations_of_motion
from tribo.kernels.powers import all_powers
from tribo.kernels.records import BAR, BOB
from tribo.kernels.samples import blank, copy_state, write_sample
from tribo.kernels.status import COMPLETED, NOT_FINITE, PAUSED, STEP_UNDERFLOW
from tribo.kernels.stepping import (
    EPSILON,
    all_finite,
    begin,
    end_of_step,
    go_on,
    growth_of,
    nearness,
    next_step,
    rates,
    time_left,
    turn_back,
)
from tribo.kernels.sums import add, add_twice, combine, combine_twice, largest


@kernel
def keep(model, bobs, bars, i):
    """Keep the forces in place as those of stage i."""
    for m in range(model.bobs.size):
        bobs[i, m] = model.bobs[m]
        bars[i, m] = model.bars[m]


@kernel
def put_back(model, bobs, bars, i):
    """Put the forces of stage i in place."""
    for m in range(model.bobs.size):
        model.bobs[m] = bobs[i, m]
        model.bars[m] = bars[i, m]


@kernel
def try_step(model, neighbours, tableau, t, h, end, y, places, slopes, bobs, bars, trial, power):
    """Forces at all stages, the state at the end of the step and, last of all, forces there."""
    n = y.size // 2
    stages = tableau.c.size
    q = y[:n]
    v = y[n:]
    for i in range(1, stages):
        combine_twice(q, h, tableau.c[i], v, tableau.a[i, :i], slopes, places[i])
        neighbours = equations_of_motion(
            model, neighbours, t + tableau.c[i] * h, places[i], v, slopes[i]
        )
        keep(model, bobs, bars, i)
    add_twice(trial.y[:n], trial.y_low[:n], h, v, trial.y_low[n:], tableau.b, slopes)
    add(trial.y[n:], trial.y_low[n:], h, tableau.v, slopes)
    neighbours = rates(model, neighbours, end, trial.y, slopes[stages], power)
    keep(model, bobs, bars, 0)
    return neighbours


@kernel
def book(model, tableau, t, h, y, places, slopes, bobs, bars, rate, powers_):
    """The powers at all stages that count; the forces at the end of the step are in place again."""
    n = y.size // 2
    for m in range(tableau.booked.size):
        i = tableau.booked[m]
        put_back(model, bobs, bars, i)
        combine(y[n:], h, tableau.r[i], slopes, rate)
        all_powers(model, t + tableau.c[i] * h, places[i], rate, powers_[i])
    put_back(model, bobs, bars, 0)


@kernel
def error_of(tableau, h, state, slopes, powers_, tolerance):
    """The step's error by the embedded method, in units of the tolerance."""
    n = state.y.size // 2
    places = largest(h * h, tableau.eb, slopes, state.y[:n], tolerance.y[:n])
    velocities = largest(h, tableau.ev, slopes, state.y[n:], tolerance.y[n:])
    accounts = largest(h, tableau.ev, powers_, state.s, tolerance.s)
    return places + velocities + accounts  # keeps nan


def nystrom_steps(model, neighbours, tableau, tolerance, clocks, state, times, record, budget):
    """March through the samples with steps whose local errors stay within `tolerance`.

    As :func:`tribo.kernels.runge_kutta.chosen_steps`, encounters and statuses included.
    """
    clock = clocks[0]
    n = state.y.size // 2
    stages = tableau.c.size
    trial = blank(state)
    places = np.empty((stages, n))
    rate = np.empty(n)
    slopes = np.empty((stages + 1, n))  # the last at the end of the step
    powers_ = np.zeros((stages + 1, state.s.size))
    bobs = np.empty((stages, model.bobs.size), BOB)  # the first at the end of the step
    bars = np.empty((stages, model.bobs.size), BAR)
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
        left = time_left(clock, goal)
        if left <= 0.0:
            write_sample(model, neighbours, clock, state, record)
            continue
        if done == budget:
            return PAUSED
        done += 1
        h, landing = next_step(clock, encounter, left)
        if h < 16.0 * EPSILON * times[-1] and not landing:
            return STEP_UNDERFLOW if finite else NOT_FINITE

        t = clock.t
        end = end_of_step(clock, goal, h, landing)
        copy_state(state, trial)
        neighbours = try_step(
            model,
            neighbours,
            tableau,
            t,
            h,
            end,
            state.y,
            places,
            slopes,
            bobs,
            bars,
            trial,
            powers_[stages],
        )
        clock.evaluations += stages
        book(model, tableau, t, h, state.y, places, slopes, bobs, bars, rate, powers_)
        error = error_of(tableau, h, state, slopes, powers_, tolerance)
        finite = math.isfinite(error)
        if not error <= 1.0:
            turn_back(clock, h * growth_of(error, tableau.order))
            continue
        next_encounter, _ = nearness(model, neighbours, end, trial.y, speeds)
        finite = all_finite(slopes[stages]) and all_finite(powers_[stages])
        if not finite or h * next_encounter > 1.0:
            turn_back(clock, 0.5 * h)
            continue

        add(trial.s, trial.s_low, h, tableau.v, powers_)
        go_on(clock, end, h, landing, growth_of(error, tableau.order))
        copy_state(trial, state)
        slopes[0] = slopes[stages]
        powers_[0] = powers_[stages]
        encounter = next_encounter
    return COMPLETED
