"""Step control of all time loops: samples that are due, encounters ahead, steps accepted or not."""

import math
from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable

from tribo.compiler.jit import NUMPY_ERRORS, apart, expanded, inlined, kernel
from tribo.compiler.lanes import LANES, absolute, broadcast, sum_of_lanes
from tribo.compiler.lanes_memory import pack
from tribo.kernels import status as codes
from tribo.kernels.encounters import fastest_approach, least_clearance, next_encounter
from tribo.kernels.equations_of_motion import equations_of_motion, place_bobs
from tribo.kernels.neighbours import crowded, is_empty, refresh
from tribo.kernels.packs import ONE_RUN, active_of, halves
from tribo.kernels.powers import all_powers
from tribo.kernels.samples import write_row
from tribo.kernels.speeds import top_speeds

# Spacing of floating-point numbers at 1.
EPSILON = 2.0**-52
# Bounds on the ratio of a step to the one before it: an error estimate is valid close to its step.
MIN_GROWTH = 0.2
MAX_GROWTH = 6.0
# Factor on the step that an error estimate allows, so that few steps are rejected.
SAFETY = 0.9
# Factor on a step whose equations were not solved, so that there is no estimate of its error.
NOT_SOLVED = 0.5
# Fraction of the way to an encounter, after which equal steps compute the encounter rate again.
ENCOUNTER_UPDATE = 0.25
# Steps after which equal steps compute the encounter rate again, since bobs at rest may begin to
# move.
UPDATE_INTERVAL = 8
# Largest component of a state or of its rates of change, in any unit: energies have squares of it.
LARGEST = 1e150
# Smallest step, in units of the spacing of floating-point numbers at the end time.
MIN_STEP = 16.0


class Tolerance(NamedTuple):
    """The largest local error of a step in each component of y and of s."""

    y: np.ndarray
    s: np.ndarray
    level: float  # ratio of these to the scales of their components
    encounter_fraction: float = 0.5  # of the way to the next encounter that a step may go


def stricter(tolerance: Tolerance, factor: float) -> Tolerance:
    """All of a tolerance times a factor below 1."""
    y, s, level, fraction = tolerance
    return Tolerance(factor * y, factor * s, factor * level, factor * fraction)


@apart
def current_encounter(model, neighbours, t, y, speeds):
    """The encounter rate [1 / time] and the smallest distance of two bobs, for bobs in place."""
    top_speeds(model, neighbours, t, y, speeds)
    found = next_encounter(model, neighbours, speeds, ONE_RUN)
    return found.rate, found.closest


@apart
def encounter_bound(model, neighbours, clock, y, speeds, h):
    """An upper bound on the encounter rate, pair by pair only where it matters for a step h.

    No pair can have moved farther towards its next encounter than the fastest bobs of all have.
    """
    top_speeds(model, neighbours, clock.t, y, speeds)
    speed = fastest_approach(model, active_of(neighbours), speeds)
    clock.clearance -= speed * clock.encounter_age
    clearance = least_clearance(model, clock.clearance)
    if clearance > 0.0 and h * speed <= ENCOUNTER_UPDATE * clearance:
        return speed / clearance
    found = next_encounter(model, neighbours, speeds, ONE_RUN)
    clock.clearance = found.clearance
    if h * found.ignored > 1.0:
        clock.passages += 1
        clock.passing = found.one
        clock.passed = found.other
    return found.rate


@inlined
def all_finite(x):
    """Whether every component is finite, and its square."""
    outside = broadcast(0.0)
    for m in range(0, x.size, LANES):
        outside = outside + (1.0 - (absolute(pack(x, m)) <= LARGEST))
    return sum_of_lanes(outside) == 0.0


@inlined
def is_finite(state):
    """The same of a state and its rates of change."""
    rates = all_finite(state.acceleration) and all_finite(state.power)
    return all_finite(state.y) and all_finite(state.s) and rates


@expanded
def evaluate_rates(model, neighbours, t, y, acceleration, power):
    """Compute q'' and s' at one instant."""
    q, v = halves(y)
    equations_of_motion(model, neighbours, t, q, v, acceleration)
    all_powers(model, t, q, v, power)


@apart
def initialize(model, neighbours, clock, state, speeds):
    """Rates of change and the encounter rate at the start of a run; a status.

    After a pause only the bobs are placed again: whatever else is computed there, such as a
    neighbour list, could differ from that of a run without the pause.
    """
    place_bobs(model, broadcast(clock.t), halves(state.y)[0])
    if is_empty(neighbours):
        refresh(model, neighbours)
        if crowded(neighbours):
            return codes.PAUSED
    if clock.evaluations > 0:
        return codes.COMPLETED
    evaluate_rates(model, neighbours, clock.t, state.y, state.acceleration, state.power)
    clock.evaluations = 1
    clock.encounter_rate, closest = current_encounter(model, neighbours, clock.t, state.y, speeds)
    if closest == 0.0:
        return codes.BOBS_COINCIDE
    return codes.COMPLETED if is_finite(state) else codes.NOT_FINITE


@kernel
def time_left(clock, goal):
    return (goal - clock.t) - clock.t_low


@inlined
def record_due(model, neighbours, clock, state, times, record):
    """Record every sample that is due; returns the time left until the next, 0 after the last."""
    while clock.sample < times.size:
        left = time_left(clock, times[clock.sample])
        if left > 0.0:
            return left
        write_row(model, neighbours, clock.t, state, record, clock.sample, ONE_RUN)
        clock.sample += 1
    return 0.0


@register_jitable(**NUMPY_ERRORS)
def count_of_steps(time: Any, step: float) -> Any:
    """Number of equal steps of at most `step` in a time: as few as round-off allows."""
    return np.maximum(1.0, np.ceil(time / step - 1e-9))


@kernel
def equal_step(clock, left, step):
    """The step, and whether it ends with the next sample, which is `left` ahead.

    Between two samples all steps are the same: the largest up to `step` that divides the time.
    """
    if clock.h == 0.0:
        clock.h = left / count_of_steps(left, step)
    return clock.h, left < 1.5 * clock.h


@kernel
def equal_step_status(clock, h, end):
    """The status with which an equal step stops the run; COMPLETED if it can be taken."""
    if h < EPSILON * end:
        return codes.STEP_UNDERFLOW
    return codes.ENCOUNTER_JUMPED if h * clock.encounter_rate > 1.0 else codes.COMPLETED


@inlined
def update_encounter(model, neighbours, clock, y, speeds, h):
    """Compute the encounter rate after an equal step if one is near or it is old; whether so."""
    clock.encounter_age += h
    near = (clock.encounter_age + h) * clock.encounter_rate > ENCOUNTER_UPDATE
    if clock.steps % UPDATE_INTERVAL != 0 and not near:
        return False
    clock.encounter_rate = encounter_bound(model, neighbours, clock, y, speeds, h)
    clock.encounter_age = 0.0
    return True


@kernel
def next_step(clock, encounter_rate, left):
    """The step to try, and whether it ends with the sample that is `left` ahead.

    No step may carry a pair of bobs farther towards its next encounter than the clock allows.
    """
    h = clock.h
    if h * encounter_rate > clock.encounter_fraction:
        h = clock.encounter_fraction / encounter_rate
    if h >= left:
        return left, True
    if 2.0 * h > left:  # two equal steps, not a long one and a very short one
        h = 0.5 * left
    return h, False


@kernel
def step_underflows(h, landing, end):
    """Whether a step is lost in the spacing of times; the last before a sample may be short."""
    return h < MIN_STEP * EPSILON * end and not landing


@kernel
def underflow_status(clock):
    return codes.NOT_FINITE if clock.not_finite == 1 else codes.STEP_UNDERFLOW


@inlined
def within_bounds(growth, most):
    """A factor on a step, or on those of all lanes, from MIN_GROWTH, of nan too, to `most`."""
    return min(most, max(MIN_GROWTH, growth))


@kernel
def growth_factor(error, order, most):
    """The factor from a step to the next, at most `most`, from its error, which grows as h^order.

    An infinite error is that of a step whose equations were not solved.
    """
    if error == math.inf:
        return NOT_SOLVED
    if error == 0.0:
        return most
    return within_bounds(SAFETY * error ** (-1.0 / order), most)


@inlined
def growth_by_roots(error, roots, caution, most):
    """The same of an error that grows as h^(2^roots), with `caution` in place of SAFETY.

    Square roots are faster than powers, and errors may be those of the steps of all lanes.
    """
    for _ in range(roots):
        error = math.sqrt(error)
    return within_bounds(caution / error, most)


@kernel
def reject_step(clock, h):
    """The step that was tried is not taken; the next is h at most."""
    clock.h = h
    clock.rejected += 1
    clock.after_rejection = 1


@kernel
def check_error(clock, h, error, growth):
    """Whether the error of a step h, in units of the tolerance, is at most 1; if not, reject it."""
    if error <= 1.0:
        return True
    reject_step(clock, h * growth)
    return False


@kernel
def check_arrival(clock, h, encounter_rate, finite):
    """Whether a step h may end with this encounter rate, which the clock has then.

    If not, because its end is not finite or because bobs passed an encounter by the speeds they
    have there, reject it.
    """
    if finite and h * encounter_rate <= 1.0:
        clock.encounter_rate = encounter_rate
        return True
    clock.not_finite = 0 if finite else 1
    reject_step(clock, 0.5 * h)
    return False


@kernel
def end_of_step(clock, goal, h, landing):
    return goal if landing else clock.t + (h + clock.t_low)


@kernel
def advance(clock, t, h, landing):
    """Take the step h that ends at t, and keep the rounding error of t."""
    clock.t_low = 0.0 if landing else (h + clock.t_low) - (t - clock.t)
    clock.t = t
    clock.last_step = h
    clock.steps += 1


@kernel
def advance_equally(clock, goal, h, landing):
    """Take an equal step, the last before the next sample at `goal` if it is `landing`."""
    advance(clock, end_of_step(clock, goal, h, landing), h, landing)
    if landing:
        clock.h = 0.0


@kernel
def accept_step(clock, t, h, landing, growth):
    """Take the step h that ends at t; the next may be `growth` times as long."""
    advance(clock, t, h, landing)
    if clock.after_rejection == 1:
        growth = min(growth, 1.0)
    grown = h * growth
    if h < clock.h and growth > 1.0:
        # It was cut to end at a sample or before an encounter, which does not shorten the next one.
        grown = max(clock.h, grown)
    clock.h = grown
    clock.after_rejection = 0
