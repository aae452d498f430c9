"""Collocation: over a step q'' is a polynomial whose values at nodes are found by iteration.

Velocities are known at every node, so that powers are evaluated there, and forces may depend on
velocities.  With Gauss nodes and equal steps, a step back undoes a step.  With Radau nodes, which
begin with the start of the step, its length is chosen by the polynomial's highest term.

J. C. Butcher, Math. Comput. 18 (1964) 50; E. Hairer, R. I. McLachlan, A. Razakarivony, BIT 48
(2008) 231, on iterating down to round-off; E. Everhart, in Dynamics of Comets, Reidel 1985, p. 185;
H. Rein, D. S. Spiegel, Mon. Not. R. Astron. Soc. 446 (2015) 1424.
"""

import math
from typing import NamedTuple

import numpy as np

from tribo.compiler.jit import expanded, kernel
from tribo.compiler.lanes_memory import room
from tribo.integrators import step_control as control
from tribo.integrators.linear_combinations import add, add_twice, combine, combine_twice, largest
from tribo.kernels.equations_of_motion import equations_of_motion
from tribo.kernels.model import Model
from tribo.kernels.packs import halves
from tribo.kernels.powers import all_powers
from tribo.kernels.samples import State, copy, copy_rows, copy_state
from tribo.kernels.status import COMPLETED, NOT_CONVERGED, NOT_FINITE

# Sweeps through the nodes after which an iteration has not converged.
MAX_SWEEPS = 40
# Change of a sweep, in units of round-off, below which an iteration that stalls has converged.
STALL_LIMIT = 1e6
# Change of a sweep, in units of the tolerance, below which an iteration has converged.
SWEEP_TOLERANCE = 1e-4
# Ratio of a step to the last one, above which the last polynomial is not continued into it.
MAX_EXTRAPOLATION = 4.0
# The polynomial's highest term may be this times the root of the tolerance's level, in units of the
# scales of velocities and accounts: the error of a step is about as the square of that term.
HIGHEST_TERM = 10.0
# The smallest positive double of full precision: the unit of a change where nothing moves.
SMALLEST = 2.0**-1022


class Nodes(NamedTuple):
    """Values at the nodes of a step, and room for one node."""

    accelerations: np.ndarray  # (nodes, coordinates)
    powers: np.ndarray  # (nodes, accounts)
    y: np.ndarray  # (2 coordinates,) at the present node
    acceleration: np.ndarray  # (coordinates,) there
    unit: np.ndarray  # (coordinates,) of velocity, in which a sweep's change is measured


class Collocation(NamedTuple):
    """q'' is the polynomial through its values f_i at the nodes t + c_i h.

    At the nodes, velocities are v + h sum_j r_ij f_j and coordinates q + c_i h v + h^2 sum_j a_ij
    f_j; at the end of the step v + h sum_j v_j f_j and q + h v + h^2 sum_j b_j f_j.
    """

    c: np.ndarray  # (nodes,)
    r: np.ndarray  # (nodes, nodes)
    a: np.ndarray  # (nodes, nodes)
    v: np.ndarray  # (nodes,)
    b: np.ndarray  # (nodes,)
    pole: np.ndarray  # (nodes,) 1 / product over k of c_j - c_k, of the barycentric formula
    last: np.ndarray  # (nodes,) weights of the integral of the polynomial's highest term
    order: float  # of the highest term as a power of h: the number of nodes
    most_growth: float = MAX_EXTRAPOLATION

    def workspace(self, model: Model, state: State) -> Nodes:
        """Arrays for the nodes of a step."""
        count = self.c.size
        n = state.acceleration.size
        powers = room((count, state.s.size))
        return Nodes(room((count, n)), powers, room((2 * n,)), room((n,)), room((n,)))

    def begin(self, model, neighbours, clock, state, work, speeds):
        """Rates of change and the encounter rate at the start of a run; a status."""
        return control.initialize(model, neighbours, clock, state, speeds)

    def arrive(self, model, neighbours, clock, state, work):
        """Nothing is left to be done for a sample: each step ends with a complete state."""

    def stays_finite(self, model, state, updated):
        """Whether the state and its rates of change are finite."""
        return control.is_finite(state)

    def step(self, model, neighbours, clock, h, end, state, work, noise):
        """Advance the state to the time `end`, the polynomial found to round-off."""
        set_round_off(state, h, work.unit)
        copy(state.acceleration, work.accelerations[0])
        limits = 0.0, STALL_LIMIT
        if not solve(self, model, neighbours, clock, h, state, work, limits):
            return NOT_CONVERGED if computable(work.acceleration) else NOT_FINITE
        evaluate_powers(self, model, neighbours, clock, h, state, work)
        complete_step(self, model, neighbours, clock, h, end, state, work)
        return COMPLETED

    def trial(self, model, neighbours, clock, attempt, state, tolerance, work):
        """Try a step; see :mod:`tribo.integrators.time_loops`.  The first node is its start."""
        h = attempt.h
        n = state.acceleration.size
        for m in range(n, 2 * n):  # not less than the round-off of each velocity
            work.unit[m - n] = tolerance.y[m] + 2.0 * control.EPSILON * abs(state.y[m])
        copy(state.acceleration, work.accelerations[0])
        copy(state.power, work.powers[0])
        limits = SWEEP_TOLERANCE, 1.0
        if not solve(self, model, neighbours, clock, h, state, work, limits):
            return math.inf, control.all_finite(work.acceleration)
        evaluate_powers(self, model, neighbours, clock, h, state, work)
        error = estimate_error(self, h, state, work, tolerance)
        if error <= 1.0:
            copy_state(state, attempt.new)
            complete_step(self, model, neighbours, clock, h, attempt.end, attempt.new, work)
        return error, math.isfinite(error)


@kernel
def set_round_off(state, h, unit):
    """The round-off of the largest velocity, as the unit of all; positive also if all rest."""
    n = state.acceleration.size
    velocity = 0.0
    acceleration = 0.0
    for m in range(n):
        velocity = max(velocity, abs(state.y[n + m]))
        acceleration = max(acceleration, abs(state.acceleration[m]))
    for m in range(n):
        unit[m] = control.EPSILON * (velocity + h * acceleration) + SMALLEST


@kernel
def predict(method, clock, h, memory, accelerations):
    """First values at the nodes: by the last step's polynomial, or those at the start, in row 0."""
    ratio = h / clock.last_step if clock.last_step > 0.0 else math.inf
    for i in range(method.c.size):
        if ratio > MAX_EXTRAPOLATION:
            copy(accelerations[0], accelerations[i])
        elif method.c[i] > 0.0:
            x = 1.0 + ratio * method.c[i]
            product = 1.0
            for k in range(method.c.size):
                product *= x - method.c[k]
            for m in range(accelerations.shape[1]):
                accelerations[i, m] = 0.0
            for j in range(method.c.size):
                weight = product * method.pole[j] / (x - method.c[j])
                for m in range(accelerations.shape[1]):
                    accelerations[i, m] += weight * memory[j, m]


@expanded
def evaluate_node(model, neighbours, method, i, clock, h, y, work):
    """q'' at node i, and (q, v) there, from the present values at all nodes."""
    q, v = halves(work.y)
    q_start, v_start = halves(y)
    combine_twice(q_start, h, method.c[i], v_start, method.a[i], work.accelerations, q)
    combine(v_start, h, method.r[i], work.accelerations, v)
    equations_of_motion(model, neighbours, clock.t + method.c[i] * h, q, v, work.acceleration)
    clock.evaluations += 1


@expanded
def sweep(model, neighbours, method, clock, h, y, work):
    """Replace the values at all nodes; returns their largest change, times h, in their units."""
    change = 0.0
    for i in range(method.c.size):
        if method.c[i] > 0.0:
            evaluate_node(model, neighbours, method, i, clock, h, y, work)
            for m in range(work.acceleration.size):
                new = h * abs(work.acceleration[m] - work.accelerations[i, m]) / work.unit[m]
                if not new <= change:  # keeps nan
                    change = new
            copy(work.acceleration, work.accelerations[i])
    return change


@expanded
def solve(method, model, neighbours, clock, h, state, work, limits):
    """Whether sweeps converge: the next change is below a first limit, or stalls below a second."""
    tolerance, stall = limits
    predict(method, clock, h, state.memory, work.accelerations)
    before = 0.0
    for _ in range(MAX_SWEEPS):
        change = sweep(model, neighbours, method, clock, h, state.y, work)
        if change <= tolerance or change * change <= tolerance * before:
            return True
        if 0.0 < before <= change <= stall:
            return True
        if not math.isfinite(change):
            return False
        before = change
    return False


@expanded
def evaluate_powers(method, model, neighbours, clock, h, state, work):
    """A last sweep, with the powers at all nodes."""
    for i in range(method.c.size):
        if method.c[i] > 0.0:
            evaluate_node(model, neighbours, method, i, clock, h, state.y, work)
            t = clock.t + method.c[i] * h
            all_powers(model, t, *halves(work.y), work.powers[i])
            copy(work.acceleration, work.accelerations[i])


@kernel
def computable(x):
    """Whether every component is a number, if large: an iteration that diverges ends with such."""
    for m in range(x.size):
        if not math.isfinite(x[m]):
            return False
    return True


@kernel
def error_weight(level):
    """What a step's highest term is multiplied by for its error; see HIGHEST_TERM."""
    return math.sqrt(level) / HIGHEST_TERM


@expanded
def estimate_error(method, h, state, work, tolerance):
    """The error that goes with the polynomials' highest terms, in units of the tolerance."""
    n = state.acceleration.size
    velocities = largest(h, method.last, work.accelerations, state.y[n:], tolerance.y[n:])
    accounts = largest(h, method.last, work.powers, state.s, tolerance.s)
    return error_weight(tolerance.level) * (velocities + accounts)


@expanded
def complete_step(method, model, neighbours, clock, h, end, state, work):
    """From the state at the start of the step to the state at its end, in place."""
    n = state.acceleration.size
    f = work.accelerations
    add_twice(state.y[:n], state.y_low[:n], h, state.y[n:], state.y_low[n:], method.b, f)
    add(state.y[n:], state.y_low[n:], h, method.v, f)
    add(state.s, state.s_low, h, method.v, work.powers)
    copy_rows(f, state.memory)
    control.evaluate_rates(model, neighbours, end, state.y, state.acceleration, state.power)
    clock.evaluations += 1
