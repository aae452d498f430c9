"""What all time loops share: samples that are due, encounters ahead, steps chosen and refused."""

import math
from typing import NamedTuple

import numpy as np

from tribo.kernels.compiled import kernel
from tribo.kernels.contact import encounter_rate, widest_rate
from tribo.kernels.equations_of_motion import equations_of_motion, top_speeds, update_neighbours
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

EPSILON = 2.0**-52
SHRINK, GROW = 0.2, 6.0  # bounds on the ratio of two steps
CROSSED = 0.25  # of the way to an encounter, after which equal steps look again


class Tolerance(NamedTuple):
    """The largest local error wanted in each component of y and of s."""

    y: np.ndarray
    s: np.ndarray
    level: float  # what these are of the scales of their components
    near: float = 0.5  # how far of the way to the next encounter a step may go


@kernel
def nearness(model, neighbours, t, y, speeds):
    """Rate at which the nearest encounter comes, and the smallest distance; bobs in place."""
    n = y.size // 2
    top_speeds(model, t, y[:n], y[n:], speeds)
    return encounter_rate(model, neighbours, speeds)


@kernel
def look_interval(model):
    """Every how many steps to look for encounters at least: bobs at rest may be about to fall."""
    return 1 if model.asperites.size <= 64 else 8


@kernel
def encounter_bound(model, neighbours, t, y, speeds, h):
    """Rate at which the nearest encounter comes, looked at pair by pair only where it matters.

    If the fastest bobs could not cross a potential's feature in a quarter of the step h, no pair
    need be looked at.
    """
    n = y.size // 2
    top_speeds(model, t, y[:n], y[n:], speeds)
    bound = widest_rate(model, speeds)
    if h * bound <= CROSSED:
        return bound
    rate, _ = encounter_rate(model, neighbours, speeds)
    return rate


@kernel
def all_finite(x):
    """Whether every component is a number."""
    for m in range(x.size):
        if not math.isfinite(x[m]):
            return False
    return True


@kernel
def rates(model, neighbours, t, y, slope, power):
    """q'' and s' at one instant."""
    n = y.size // 2
    equations_of_motion(model, neighbours, t, y[:n], y[n:], slope)
    all_powers(model, t, y[:n], y[n:], power)


@kernel
def initialize(model, neighbours, clock, state, slope, power, speeds):
    """q'' and s' at the place where a run starts or goes on, and whether it can."""
    n = state.y.size // 2
    if not update_neighbours(model, neighbours, clock.t, state.y[:n]):
        return PAUSED, 0.0
    rates(model, neighbours, clock.t, state.y, slope, power)
    if clock.evaluations == 0:  # going on after a pause costs one more, which is nobody's business
        clock.evaluations = 1
    encounter, closest = nearness(model, neighbours, clock.t, state.y, speeds)
    clock.unseen = 0.0
    status = COMPLETED
    if closest == 0.0:
        status = BOBS_COINCIDE
    elif not (all_finite(state.y) and all_finite(slope) and all_finite(power)):
        status = NOT_FINITE
    return status, encounter


@kernel
def time_left(clock, goal):
    """How long it is until the next sample."""
    return (goal - clock.t) - clock.t_low


@kernel
def record_due(model, neighbours, clock, state, times, record):
    """Record every sample that is due; returns the time left until the next, 0 after the last."""
    while clock.sample < times.size:
        left = time_left(clock, times[clock.sample])
        if left > 0.0:
            return left
        write_sample(model, neighbours, clock, state, record)
    return 0.0


@kernel
def equal_step(left, step):
    """The step, at most `step`, that divides what is left until the next sample."""
    return left / max(1.0, np.ceil(left / step - 1e-9))


@kernel
def equal_step_status(h, encounter, end):
    """Why an equal step cannot be taken; COMPLETED if it can."""
    if h < EPSILON * end:
        return STEP_UNDERFLOW
    return ENCOUNTER_JUMPED if h * encounter > 1.0 else COMPLETED


@kernel
def update_encounter(model, neighbours, clock, y, speeds, h, encounter):
    """The encounter rate after an equal step: seen anew every few steps, or where it is near."""
    clock.unseen += h
    if clock.steps % look_interval(model) != 0 and (clock.unseen + h) * encounter <= CROSSED:
        return encounter
    clock.unseen = 0.0
    return encounter_bound(model, neighbours, clock.t, y, speeds, h)


@kernel
def next_step(clock, encounter, left):
    """The step to try, and whether it ends with the sample that is `left` ahead.

    No step may carry a pair of bobs nearer to its next encounter than the clock has it.
    """
    h = clock.h
    if h * encounter > clock.near:
        h = clock.near / encounter
    if h >= left:
        return left, True
    if 2.0 * h > left:
        h = 0.5 * left
    return h, False


@kernel
def step_underflows(h, landing, end):
    """Whether a step is lost in the spacing of times; the last before a sample may be."""
    return h < 16.0 * EPSILON * end and not landing


@kernel
def underflow_status(clock):
    """What a run ends with whose steps became too short."""
    return NOT_FINITE if clock.lost == 1 else STEP_UNDERFLOW


@kernel
def growth_factor(error, order):
    """What a step is to be multiplied by, whose error was found and grows as h^order."""
    if not math.isfinite(error):
        return SHRINK
    if error == 0.0:
        return GROW
    return min(GROW, max(SHRINK, 0.9 * error ** (-1.0 / order)))


@kernel
def reject_step(clock, h):
    """The step that was tried is not taken; the next may be no longer than h."""
    clock.h = h
    clock.rejected += 1
    clock.held = 1


@kernel
def error_too_large(clock, error, h, order):
    """Whether a step is turned back for its error, in units of what is tolerated."""
    clock.lost = 0 if math.isfinite(error) else 1
    if error <= 1.0:
        return False
    reject_step(clock, h * growth_factor(error, order))
    return True


@kernel
def check_arrival(model, neighbours, clock, t, y, slope, power, speeds, h):
    """The encounter rate where the step h ends; negative where it must not end there.

    Then there are no numbers, or bobs passed an encounter by the speeds they have now.
    """
    encounter, _ = nearness(model, neighbours, t, y, speeds)
    clock.lost = 0 if all_finite(slope) and all_finite(power) else 1
    if clock.lost == 1 or h * encounter > 1.0:
        reject_step(clock, 0.5 * h)
        return -1.0
    return encounter


@kernel
def end_of_step(clock, goal, h, landing):
    """The time at which the step ends."""
    return goal if landing else clock.t + (h + clock.t_low)


@kernel
def advance(clock, t, h, landing):
    """The step h that ends at t is taken; what rounding takes from t is kept."""
    clock.t_low = 0.0 if landing else (h + clock.t_low) - (t - clock.t)
    clock.t = t
    clock.steps += 1


@kernel
def accept_step(clock, t, h, landing, growth):
    """The step h that ends at t is taken; the next may be `growth` times as long."""
    advance(clock, t, h, landing)
    if clock.held == 1:
        growth = min(growth, 1.0)
    clock.h = max(clock.h, h * growth) if h < clock.h and growth > 1.0 else h * growth
    clock.held = 0
