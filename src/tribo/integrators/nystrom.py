"""Adaptive Runge-Kutta-Nystrom methods: M q'' = F(q, t), whose forces do not depend on velocities.

A stage has coordinates, but no velocities.  The powers of the ledger are forces times velocities.
Once all forces of a step are known, so are the velocities at its stages,

    V_i = v + h sum_j r_ij f_j,

with a full matrix r, and the ledger's quadrature sum_i v_i P(Q_i, V_i) is of the method's own
order: see :func:`tribo.integrators.tableaux.stage_velocities`.  Forces are therefore
stored, stage by stage, until the step is complete.
"""

import math
from typing import NamedTuple

import numpy as np

from tribo.compiler.jit import expanded, kernel
from tribo.compiler.lanes_memory import room
from tribo.integrators.linear_combinations import add, add_twice, combine, combine_twice, largest
from tribo.integrators.step_control import MAX_GROWTH, evaluate_rates
from tribo.kernels.equations_of_motion import equations_of_motion
from tribo.kernels.model import Model
from tribo.kernels.packs import absent, halves
from tribo.kernels.powers import all_powers
from tribo.kernels.samples import State, copy, copy_state


class Stages(NamedTuple):
    """Stages of a step; accelerations and powers have one more row, for its end."""

    q: np.ndarray  # (stages, coordinates)
    accelerations: np.ndarray  # (stages + 1, coordinates)
    powers: np.ndarray  # (stages + 1, accounts)
    forces: np.ndarray  # (stages, rows, asperites) in all tables; [0] is those of the end
    v: np.ndarray  # (coordinates,) at the present stage


class Nystrom(NamedTuple):
    """f_i at t + c_i h from q + c_i h v + h^2 sum_j a_ij f_j, weights, and an error estimate.

    The step ends at q + h v + h^2 sum_i b_i f_i and v + h sum_i v_i f_i.
    """

    a: np.ndarray  # (stages, stages), strictly lower triangular
    b: np.ndarray  # (stages,) of coordinates
    v: np.ndarray  # (stages,) of velocities and accounts
    c: np.ndarray  # (stages,)
    r: np.ndarray  # (stages, stages): velocities at the stages are v + h sum_j r_ij f_j
    with_power: np.ndarray  # the stages, but for the first, whose powers have a weight
    eb: np.ndarray  # (stages,) weights of the error of coordinates
    ev: np.ndarray  # (stages + 1,) of velocities and accounts; the last at the end of the step
    order: float  # of the error estimate as a power of h
    most_growth: float = MAX_GROWTH

    def workspace(self, model: Model, state: State) -> Stages:
        """Arrays for a step; the stages' forces include bobs and directions, which powers need."""
        count = self.c.size
        n = state.acceleration.size
        tables = model.bobs, model.directions, model.f1, model.drive
        tables += model.inner, model.external, model.internal
        rows = sum(len(table) for table in tables if table.shape[1] > 0)
        return Stages(
            room((count, n)),
            room((count + 1, n)),
            room((count + 1, state.s.size)),
            room((count, rows, model.bobs.shape[1])),
            room((n,)),
        )

    def trial(self, model, neighbours, clock, attempt, state, tolerance, work):
        """Try a step; see :mod:`tribo.integrators.time_loops`."""
        error = try_step(self, model, neighbours, attempt, state, tolerance, work)
        clock.evaluations += self.c.size
        return error, math.isfinite(error)


@kernel
def exchange_table(table, stored, row, restore):
    """Store a table, if there is one, from a row on, or restore it; returns the row after it."""
    if absent(table):
        return row
    for k in range(table.shape[0]):
        if restore:
            copy(stored[row + k], table[k])
        else:
            copy(table[k], stored[row + k])
    return row + table.shape[0]


@kernel
def exchange_forces(model, work, i, restore):
    """Store the forces that are in place as those of stage i, or put those in place."""
    stored = work.forces[i]
    row = exchange_table(model.bobs, stored, 0, restore)
    row = exchange_table(model.directions, stored, row, restore)
    row = exchange_table(model.f1, stored, row, restore)
    row = exchange_table(model.drive, stored, row, restore)
    row = exchange_table(model.inner, stored, row, restore)
    row = exchange_table(model.external, stored, row, restore)
    exchange_table(model.internal, stored, row, restore)


@expanded
def try_step(method, model, neighbours, attempt, state, tolerance, work):
    """Set the new state; returns the error in units of the tolerance, Lanes of members."""
    new = attempt.new
    copy(state.acceleration, work.accelerations[0])
    copy(state.power, work.powers[0])
    copy_state(state, new)
    evaluate_stages(method, model, neighbours, attempt, state, work)
    evaluate_powers(method, model, attempt.t, attempt.h, state, work)
    error = estimate_error(method, attempt.h, state, work, tolerance)
    add(new.s, new.s_low, attempt.h, method.v, work.powers)
    return error


@expanded
def evaluate_stages(method, model, neighbours, attempt, state, work):
    """Forces at all stages; coordinates, velocities and their rates of change at the end."""
    t = attempt.t
    h = attempt.h
    new = attempt.new
    n = state.acceleration.size
    last = method.c.size
    q, v = halves(state.y)
    f = work.accelerations
    for i in range(1, last):
        place = work.q[i]
        combine_twice(q, h, method.c[i], v, method.a[i][:i], f, place)
        equations_of_motion(model, neighbours, t + method.c[i] * h, place, v, f[i])
        exchange_forces(model, work, i, False)
    add_twice(new.y[:n], new.y_low[:n], h, v, new.y_low[n:], method.b, f)
    add(new.y[n:], new.y_low[n:], h, method.v, f)
    evaluate_rates(model, neighbours, attempt.end, new.y, f[last], work.powers[last])
    exchange_forces(model, work, 0, False)
    copy(f[last], new.acceleration)
    copy(work.powers[last], new.power)


@expanded
def evaluate_powers(method, model, t, h, state, work):
    """Powers at all stages where they have a weight; leaves the forces at the end in place."""
    if model.ledger:
        n = state.acceleration.size
        for m in range(method.with_power.size):
            i = method.with_power[m]
            exchange_forces(model, work, i, True)
            combine(state.y[n:], h, method.r[i], work.accelerations, work.v)
            now = t + method.c[i] * h
            all_powers(model, now, work.q[i], work.v, work.powers[i])
        exchange_forces(model, work, 0, True)


@expanded
def estimate_error(method, h, state, work, tolerance):
    """The step's error by the embedded method, in units of the tolerance; nan where one is."""
    n = state.acceleration.size
    q = state.y[:n]
    v = state.y[n:]
    f = work.accelerations
    coordinates = largest(h * h, method.eb, f, q, tolerance.y[:n])
    velocities = largest(h, method.ev, f, v, tolerance.y[n:])
    accounts = largest(h, method.ev, work.powers, state.s, tolerance.s)
    return coordinates + velocities + accounts
