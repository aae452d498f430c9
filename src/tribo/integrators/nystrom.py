"""Adaptive Runge-Kutta-Nystrom: for M q'' = F(q, t), whose forces know places and time alone.

Stages are places, and carry no velocities; but the powers of the ledger are forces times
velocities.  Once all forces of a step are known, so are velocities at its stages,

    V_i = v + h sum_j r_ij f_j,

with a full matrix r, and the ledger's quadrature sum_i v_i P(Q_i, V_i) is of the method's own
order: see :func:`tribo.integrators.nystrom_tableaux.stage_velocities`.  Forces are therefore kept,
stage by stage, until the step is complete.
"""

from typing import NamedTuple

import numpy as np

from tribo.integrators.linear_combinations import add, add_twice, combine, combine_twice, largest
from tribo.integrators.step_control import (
    accept_step,
    check_arrival,
    end_of_step,
    error_too_large,
    growth_factor,
    initialize,
    next_step,
    rates,
    record_due,
    step_underflows,
    underflow_status,
)
from tribo.kernels.compiled import kernel
from tribo.kernels.equations_of_motion import equations_of_motion
from tribo.kernels.neighbours import crowded
from tribo.kernels.powers import all_powers
from tribo.kernels.records import BAR, BOB
from tribo.kernels.samples import blank, copy, copy_state
from tribo.kernels.status import COMPLETED, PAUSED


class Stages(NamedTuple):
    """What is known of a step's stages; slopes and powers have one row more, for its end."""

    places: np.ndarray  # (stages, coordinates)
    slopes: np.ndarray  # (stages + 1, coordinates) q''
    powers: np.ndarray  # (stages + 1, accounts)
    bobs: np.ndarray  # (stages, asperites) of BOB; the first row is that of the end
    bars: np.ndarray  # (stages, asperites) of BAR; the first row is that of the end


@kernel
def keep(model, stages, i):
    """Keep the forces in place as those of stage i."""
    for m in range(model.bobs.size):
        stages.bobs[i, m] = model.bobs[m]
        stages.bars[i, m] = model.bars[m]


@kernel
def put_back(model, stages, i):
    """Put the forces of stage i in place."""
    for m in range(model.bobs.size):
        model.bobs[m] = stages.bobs[i, m]
        model.bars[m] = stages.bars[i, m]


@kernel
def try_step(model, neighbours, tableau, t, h, end, y, stages, trial):
    """Forces at all stages, places and rates at the end of the step, forces and powers there."""
    n = y.size // 2
    last = tableau.c.size
    for i in range(1, last):
        place = stages.places[i]
        combine_twice(y[:n], h, tableau.c[i], y[n:], tableau.a[i, :i], stages.slopes, place)
        equations_of_motion(model, neighbours, t + tableau.c[i] * h, place, y[n:], stages.slopes[i])
        keep(model, stages, i)
    add_twice(trial.y[:n], trial.y_low[:n], h, y[n:], trial.y_low[n:], tableau.b, stages.slopes)
    add(trial.y[n:], trial.y_low[n:], h, tableau.v, stages.slopes)
    rates(model, neighbours, end, trial.y, stages.slopes[last], stages.powers[last])
    keep(model, stages, 0)


@kernel
def book(model, tableau, t, h, y, stages, rate):
    """The powers at all stages that count; the forces at the end of the step are in place again."""
    n = y.size // 2
    for m in range(tableau.booked.size):
        i = tableau.booked[m]
        put_back(model, stages, i)
        combine(y[n:], h, tableau.r[i], stages.slopes, rate)
        all_powers(model, t + tableau.c[i] * h, stages.places[i], rate, stages.powers[i])
    put_back(model, stages, 0)


@kernel
def error_of(tableau, h, state, stages, tolerance):
    """The step's error by the embedded method, in units of the tolerance."""
    n = state.y.size // 2
    places = largest(h * h, tableau.eb, stages.slopes, state.y[:n], tolerance.y[:n])
    velocities = largest(h, tableau.ev, stages.slopes, state.y[n:], tolerance.y[n:])
    accounts = largest(h, tableau.ev, stages.powers, state.s, tolerance.s)
    return places + velocities + accounts  # keeps nan


def nystrom_steps(model, neighbours, tableau, tolerance, clocks, state, times, record, budget):
    """March through the samples with steps whose local errors stay within `tolerance`.

    As :func:`tribo.integrators.runge_kutta.chosen_steps`, encounters and statuses included.
    """
    clock = clocks[0]
    n = state.y.size // 2
    last = tableau.c.size
    stages = Stages(
        np.empty((last, n)),
        np.empty((last + 1, n)),
        np.zeros((last + 1, state.s.size)),
        np.empty((last, model.bobs.size), BOB),
        np.empty((last, model.bobs.size), BAR),
    )
    trial = blank(state)
    rate = np.empty(n)
    speeds = np.empty((model.asperites.size, 3))
    status, encounter = initialize(
        model, neighbours, clock, state, stages.slopes[0], stages.powers[0], speeds
    )
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

        end = end_of_step(clock, goal, h, landing)
        copy_state(state, trial)
        try_step(model, neighbours, tableau, clock.t, h, end, state.y, stages, trial)
        clock.evaluations += last
        book(model, tableau, clock.t, h, state.y, stages, rate)
        error = error_of(tableau, h, state, stages, tolerance)
        if error_too_large(clock, error, h, tableau.order):
            continue
        slope, power = stages.slopes[last], stages.powers[last]
        ahead = check_arrival(model, neighbours, clock, end, trial.y, slope, power, speeds, h)
        if ahead < 0.0:
            continue

        add(trial.s, trial.s_low, h, tableau.v, stages.powers)
        accept_step(clock, end, h, landing, growth_factor(error, tableau.order))
        copy_state(trial, state)
        copy(slope, stages.slopes[0])
        copy(power, stages.powers[0])
        encounter = ahead
    return PAUSED
