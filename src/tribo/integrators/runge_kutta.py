"""Explicit Runge-Kutta methods, with equal steps and with an error estimate.

The accounts of the ledger are integrated beside the state, by the method's own quadrature.  Every
step's increment is added with compensation, so that round-off does not accumulate.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import expanded
from tribo.compiler.lanes_memory import room
from tribo.integrators import step_control as control
from tribo.integrators.linear_combinations import add, combine, largest
from tribo.kernels.model import Model
from tribo.kernels.samples import State, copy, copy_state
from tribo.kernels.status import COMPLETED


class Stages(NamedTuple):
    """Rates of change at the stages of a step; those of stage 0 are the state's own."""

    derivatives: np.ndarray  # (stages, 2 coordinates) y' = (v, q'')
    powers: np.ndarray  # (stages, accounts) s'
    y: np.ndarray  # (2 coordinates,) at the present stage


class RungeKutta(NamedTuple):
    """k_i = f(t + c_i h, y + h sum_j a_ij k_j); the step ends at y + h sum_i b_i k_i.

    Adaptive methods have the weights of two error estimates, of orders 5 and 3.  E. Hairer, S. P.
    Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993, II.10,
    for their combination.
    """

    a: np.ndarray  # (stages, stages), strictly lower triangular
    b: np.ndarray  # (stages,)
    c: np.ndarray  # (stages,)
    e5: Any = None  # (stages,)
    e3: Any = None  # (stages,)
    order: float = 8.0  # of the combined error estimate as a power of h
    most_growth: float = control.MAX_GROWTH

    def workspace(self, model: Model, state: State) -> Stages:
        """Arrays for the stages of a step."""
        stages = self.b.size
        coordinates = state.y.size
        accounts = state.s.size
        return Stages(room((stages, coordinates)), room((stages, accounts)), room((coordinates,)))

    def begin(self, model, neighbours, clock, state, work, speeds):
        """Rates of change and the encounter rate at the start of a run; a status."""
        return control.initialize(model, neighbours, clock, state, speeds)

    def arrive(self, model, neighbours, clock, state, work):
        """Nothing is left to be done for a sample: each step ends with a complete state."""

    def stays_finite(self, model, state, updated):
        """Whether the state and its rates of change are finite."""
        return control.is_finite(state)

    def step(self, model, neighbours, clock, h, end, state, work, noise):
        """Advance the state to the time `end`."""
        evaluate_stages(self, model, neighbours, clock, h, state, work)
        complete_step(self, model, neighbours, clock, h, end, state, work)
        return COMPLETED

    def trial(self, model, neighbours, clock, attempt, state, tolerance, work):
        """Try a step; see :mod:`tribo.integrators.time_loops`.

        The error is that of order 5, damped where the one of order 3 is larger.
        """
        h = attempt.h
        evaluate_stages(self, model, neighbours, clock, h, state, work)
        fifth = largest_error(self.e5, h, state, work, tolerance)
        third = largest_error(self.e3, h, state, work, tolerance)
        error = fifth
        if fifth > 0.0:
            error = fifth * (fifth / math.hypot(fifth, 0.1 * third))
        if error <= 1.0:
            copy_state(state, attempt.new)
            complete_step(self, model, neighbours, clock, h, attempt.end, attempt.new, work)
        return error, math.isfinite(error)


@expanded
def evaluate_stages(method, model, neighbours, clock, h, state, work):
    """Rates of change at all stages of a step from `state`, powers included."""
    n = state.acceleration.size
    copy(state.y[n:], work.derivatives[0][:n])
    copy(state.acceleration, work.derivatives[0][n:])
    copy(state.power, work.powers[0])
    y = work.y
    for i in range(1, method.b.size):
        combine(state.y, h, method.a[i][:i], work.derivatives, y)
        derivative = work.derivatives[i]
        copy(y[n:], derivative[:n])
        control.evaluate_rates(
            model, neighbours, clock.t + method.c[i] * h, y, derivative[n:], work.powers[i]
        )
    clock.evaluations += method.b.size - 1


@expanded
def complete_step(method, model, neighbours, clock, h, end, state, work):
    """From the state at the start of the step to the state at its end, in place."""
    add(state.y, state.y_low, h, method.b, work.derivatives)
    add(state.s, state.s_low, h, method.b, work.powers)
    control.evaluate_rates(model, neighbours, end, state.y, state.acceleration, state.power)
    clock.evaluations += 1


@expanded
def largest_error(weights, h, state, work, tolerance):
    """Largest error that these weights estimate, in units of the tolerance."""
    return max(
        largest(h, weights, work.derivatives, state.y, tolerance.y),
        largest(h, weights, work.powers, state.s, tolerance.s),
    )
