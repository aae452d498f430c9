"""The program of a page: a run of a pair, its quantities, and their errors."""

import math

from tribo.compiler.jit import apart, kernel
from tribo.compiler.lanes import broadcast, lane, with_lane
from tribo.compiler.lanes_functions import sine_cosine
from tribo.live_pages import inputs
from tribo.live_pages.limits import guess, measured, set_limits
from tribo.live_pages.quantities import MEMBERS, OfAsperite, write_quantities
from tribo.live_pages.setup import bodies_of, set_times, sides_of
from tribo.pair.bodies import pair_of
from tribo.pair.loop import integrate_pair

# Places in the options of a run.  GIVEN is 1 where the limits stand in the loop's memory and the
# times are given; ESTIMATE is 1 for a second run, at COARSER times the level.  The program writes
# the number of samples that were REACHED, that of evaluations, and what `passing` returns.
GIVEN, LEVEL, NEAR, ESTIMATE, MOST_STEPS, REACHED, EVALUATIONS, PASSED, NEEDED = range(9)
# With an AMPLITUDE above 0 [rad] both pendulums begin a free swing of it, at their own phases.
AMPLITUDE, PHASE1, PHASE2 = range(9, 12)
OPTIONS = 12
# Level of the run that measures scales, and the largest part of the way to an encounter in it.
PILOT = 1e-4
PILOT_NEAR = 0.5
# Level of the coarser run, relative to that of the run that is shown; see tribo.accuracy.levels.
COARSER = 10.0
# An estimate is this times the difference from the coarser run; see tribo.accuracy.comparison.
SAFETY = 3.0
ROUNDING = 256.0 * 2.0**-52
# The largest part of the way to an encounter in the run that is shown, and its level in units of
# the accuracy that is wanted; see tribo.accuracy.search.
NEAR_FINE = 0.5 * 0.1 ** (1.0 / 15.0)
LEVEL_OF_ACCURACY = 0.1 * 100.0 * 2.0 / 3.0
X_BOB, VX_CM = (OfAsperite._fields.index(name) for name in ("x_bob", "vx_cm"))
# Part of the bobs' distance at the start from which on an encounter is over: 0.19 in case B of the
# paper.
APART = 0.15
# Samples of the run that measures scales, at most; and those of the coarser run: every fourth, so
# that it has steps of its own.
PILOT_SAMPLES = 65
EVERY = 4


def level_of(accuracy: float) -> float:
    """The level of the run that is shown."""
    return LEVEL_OF_ACCURACY * accuracy


@apart  # once for all runs
def integrate(pair, potential, memory, clocks, start, times, record, near, most):
    """One run from the start; returns its status and the number of samples that it reached."""
    clocks[0].evaluations = 0
    clocks[0].sample = 0
    clocks[0].encounter_fraction = near
    status = integrate_pair((pair,), potential, memory, clocks, start, times, record, most)
    return status, clocks[0].sample


@kernel
def passing(pair, series, count):
    """Whether the encounter is over, and a duration after which it is at the surfaces' velocities.

    It is over where the bobs are again APART of their distance along x at the start away from each
    other, or more, and the centres of mass part.  The duration carries the surfaces as far apart on
    the other side; it is 0 where they do not approach at the start.
    """
    last = count - 1
    begins = series[X_BOB, 0] - series[MEMBERS + X_BOB, 0]
    ends = series[X_BOB, last] - series[MEMBERS + X_BOB, last]
    parting = ends * (series[VX_CM, last] - series[MEMBERS + VX_CM, last])
    if begins * pair.velocity_x >= 0.0:
        return 1.0, 0.0
    over = 1.0 if abs(ends) >= APART * abs(begins) and parting > 0.0 else 0.0
    return over, 2.0 * abs(begins / pair.velocity_x)


@kernel
def begin_swings(pair, options, start):
    """Begin both pendulums at phases of a free swing, which all have one amplitude."""
    amplitude = options[AMPLITUDE]
    phases = with_lane(broadcast(options[PHASE1]), 1, options[PHASE2])
    sin, cos = sine_cosine(phases)
    start[0] = amplitude * lane(cos, 0)
    start[1] = amplitude * lane(cos, 1)
    start[2] = -amplitude * math.sqrt(pair.omega_squared1) * lane(sin, 0)
    start[3] = -amplitude * math.sqrt(pair.omega_squared2) * lane(sin, 1)


def live_pair(
    potential, numbers, options, memory, clocks, start, times, record, coarse, series, other, errors
):
    """Run a pair with the `numbers` of `tribo.live_pages.inputs`; returns the code of a status.

    `memory` has the method's table; `record` and `coarse` are records of the loop, `series` and
    `other` (QUANTITIES, times) the quantities of both runs, and `errors` (QUANTITIES,) a bound on
    the error of each in the first run.
    """
    bodies = bodies_of(numbers)
    one, second = bodies
    pair = pair_of(one, second)
    at = inputs.OF_SURFACE
    start[0] = numbers[inputs.SWING]
    start[1] = numbers[at + inputs.SWING]
    start[2] = numbers[inputs.OMEGA]
    start[3] = numbers[at + inputs.OMEGA]
    if options[AMPLITUDE] > 0.0:
        begin_swings(pair, options, start)
    bar_lengths = numbers[inputs.BAR_LENGTH], numbers[at + inputs.BAR_LENGTH]
    sides = sides_of(numbers, bodies, numbers[inputs.OBSERVER_X], numbers[inputs.OBSERVER_Y])
    most = int(options[MOST_STEPS])
    near = options[NEAR]
    level = options[LEVEL]
    duration = numbers[inputs.DURATION]
    scales = guess(bodies, start)
    if options[GIVEN] == 0.0:
        mean_x = 0.5 * (numbers[inputs.VELOCITY_X] + numbers[at + inputs.VELOCITY_X])
        mean_y = 0.5 * (numbers[inputs.VELOCITY_Y] + numbers[at + inputs.VELOCITY_Y])
        few = times[: min(times.size, PILOT_SAMPLES)]
        set_times(duration, few)
        set_limits(bodies, bar_lengths, scales, duration, PILOT, memory)
        status, count = integrate(
            pair, potential, memory, clocks, start, few, coarse, PILOT_NEAR, most
        )
        if count > 0:
            of_mean = sides_of(numbers, bodies, mean_x, mean_y)
            write_quantities(pair, potential, of_mean, few, coarse, count, other)
            scales = measured(bodies, coarse, other, count, scales)
        set_limits(bodies, bar_lengths, scales, duration, level, memory)
        set_times(duration, times)
    status, count = integrate(pair, potential, memory, clocks, start, times, record, near, most)
    options[REACHED] = count
    options[EVALUATIONS] = clocks[0].evaluations
    if count > 0:
        write_quantities(pair, potential, sides, times, record, count, series)
        options[PASSED], options[NEEDED] = passing(pair, series, count)
    if options[ESTIMATE] == 0.0 or count == 0:
        return status
    every = EVERY if (times.size - 1) % EVERY == 0 else 1
    few = times[: (times.size - 1) // every + 1]
    set_times(duration, few)
    set_limits(bodies, bar_lengths, scales, duration, COARSER * level, memory)
    _, reached = integrate(pair, potential, memory, clocks, start, few, coarse, PILOT_NEAR, most)
    if reached > 0:
        write_quantities(pair, potential, sides, few, coarse, reached, other)
    set_times(duration, times)
    compared = min((count - 1) // every + 1, reached)
    for name in range(series.shape[0]):
        top = gap = 0.0
        for k in range(compared):
            top = max(top, abs(series[name, every * k]))
            gap = max(gap, abs(series[name, every * k] - other[name, k]))
        errors[name] = SAFETY * gap + ROUNDING * top
    return status
