"""The program of a page: a run of a pair, its quantities, and their errors."""

import math
from typing import Any, NamedTuple

from tribo.compiler.jit import apart, kernel
from tribo.compiler.lanes import broadcast, lane, with_lane
from tribo.compiler.lanes_functions import sine_cosine
from tribo.live_pages import inputs
from tribo.live_pages.accounts import DIMENSIONS
from tribo.live_pages.limits import guess, largest, measured, set_limits
from tribo.live_pages.quantities import DIMENSION, MEMBERS, OF_ASPERITE, write_quantities
from tribo.live_pages.setup import bodies_of, move_times, set_times, sides_of
from tribo.pair.bodies import pair_of
from tribo.pair.loop import integrate_pair

# Places in the options of a run.  GIVEN is 1 where the limits stand in the loop's memory and the
# times are given; ESTIMATE is 1 for coarser runs, and ROUGH is 1 where a derivative of the force
# jumps.  The program writes the number of samples that were REACHED, that of evaluations, and what
# `passing` returns.
GIVEN, LEVEL, NEAR, ESTIMATE, MOST_STEPS, REACHED, EVALUATIONS, PASSED, NEEDED = range(9)
# With an AMPLITUDE above 0 [rad] both pendulums begin a free swing of it, at their own phases; with
# a TEMPERATURE above 0, swings whose energies a canonical ensemble has.  For these, DRAWN1 and
# DRAWN2 are random numbers from 0 to 1.
AMPLITUDE, PHASE1, PHASE2, ROUGH, TEMPERATURE, DRAWN1, DRAWN2 = range(9, 16)
OPTIONS = 16
# Level of the run that measures scales, and the largest part of the way to an encounter in it.
PILOT = 1e-4
PILOT_NEAR = 0.5
# Level of the coarser run, relative to that of the run that is shown; see tribo.accuracy.levels.
COARSER = 10.0
# An estimate is this times the difference from coarser runs, each plus a fraction of the largest
# difference in units of the scales; see tribo.accuracy.comparison.
SAFETY = 3.0
POOLED = 0.02
# Where a derivative of the force jumps, errors of a run are random: an estimate is larger, and made
# with two further runs.  Of 100 random pairs with each of four such potentials, the largest error
# was 0.42 of its estimate; with the first coarser run and SAFETY alone, 46 of 240 were above it.
OF_ROUGH = 2.0
NEAR_ROUGH = (0.3, 0.2)
LEVEL_ROUGH = (10.0, 30.0)
# Every other time of these is off by this part of the time between samples, so that even steps
# from sample to sample differ.  At times that are not, all samples are compared: powers have peaks.
MOVED = (0.0, 0.38)
ROUNDING = 256.0 * 2.0**-52
# The largest part of the way to an encounter in the run that is shown, and its level in units of
# the accuracy that is wanted; see tribo.accuracy.search.
NEAR_FINE = 0.5 * 0.1 ** (1.0 / 15.0)
LEVEL_OF_ACCURACY = 0.1 * 100.0 * 2.0 / 3.0
X_BOB, VX_CM = (OF_ASPERITE.index(name) for name in ("x_bob", "vx_cm"))
# Part of the bobs' distance at the start from which on an encounter is over: 0.19 in case B of the
# paper.
APART = 0.15
# Samples of the run that measures scales, at most.
PILOT_SAMPLES = 65
# The coarser run has every fifth sample, or as many as divide them, so that it has its own steps.
EVERY = (5, 4, 3, 2)


def level_of(accuracy: float) -> float:
    """The level of the run that is shown."""
    return LEVEL_OF_ACCURACY * accuracy


@apart  # once for all runs
def integrate(pair, potential, loop, times, record, near, most):
    """One run from the start; returns its status and the number of samples that it reached."""
    memory, clocks, start = loop
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
def amplitude_of(body, options, drawn):
    """The amplitude of a free swing: that of the options, or of an energy that is drawn.

    Of a harmonic swing at a temperature, energies are distributed exponentially.
    """
    temperature = options[TEMPERATURE]
    if temperature == 0.0:
        return options[AMPLITUDE]
    return math.sqrt(-2.0 * temperature * math.log(1.0 - drawn) / body.kappa)


@kernel
def begin_swings(bodies, pair, options, start):
    """Begin both pendulums at phases of a free swing."""
    amplitude1 = amplitude_of(bodies[0], options, options[DRAWN1])
    amplitude2 = amplitude_of(bodies[1], options, options[DRAWN2])
    phases = with_lane(broadcast(options[PHASE1]), 1, options[PHASE2])
    sin, cos = sine_cosine(phases)
    start[0] = amplitude1 * lane(cos, 0)
    start[1] = amplitude2 * lane(cos, 1)
    start[2] = -amplitude1 * math.sqrt(pair.omega_squared1) * lane(sin, 0)
    start[3] = -amplitude2 * math.sqrt(pair.omega_squared2) * lane(sin, 1)


class Coarser(NamedTuple):
    """What the limits of coarser runs follow from, and the most steps of each."""

    bodies: Any
    bar_lengths: Any
    scales: Any
    duration: Any
    most: Any


@apart
def widen(series, other, count, reached, steps, errors):
    """Raise the errors to the largest differences from a run with `reached` samples.

    Sample n times the first of `steps` of one run is sample n times the second of the other.  Of a
    run that stopped before these, the errors are infinite.
    """
    own, its = steps
    compared = (count - 1) // own + 1
    for name in range(series.shape[0]):
        if (compared - 1) * its >= reached:
            errors[name] = math.inf
            continue
        for n in range(compared):
            errors[name] = max(errors[name], abs(series[name, n * own] - other[name, n * its]))


@kernel
def add_run(pair, potential, given, level, near, times, loop, arrays):
    """Widen the errors by a run at other times, whose samples `steps` relates to the first's."""
    memory, _, _ = loop
    sides, coarse, series, other, errors, count, steps = arrays
    set_limits(given.bodies, given.bar_lengths, given.scales, given.duration, level, memory)
    _, reached = integrate(pair, potential, loop, times, coarse, near, given.most)
    if reached > 0:
        write_quantities(pair, potential, sides, times, coarse, reached, other)
    widen(series, other, count, reached, steps, errors)


@kernel
def estimate(pair, potential, given, level, rough, times, loop, arrays):
    """Bounds on the errors of `count` samples, from coarser runs; two more if forces are rough."""
    _, _, series, other, errors, count = arrays
    errors[:] = 0.0
    every = 1
    for each in EVERY:
        if every == 1 and (times.size - 1) % each == 0:
            every = each
    few = times[: (times.size - 1) // every + 1]
    set_times(given.duration, few)
    own = COARSER * level
    add_run(pair, potential, given, own, PILOT_NEAR, few, loop, (*arrays, (every, 1)))
    if rough:
        for n in range(len(MOVED)):
            set_times(given.duration, times)
            move_times(times, MOVED[n])
            own = LEVEL_ROUGH[n] * level
            each = 1 if MOVED[n] == 0.0 else 2
            steps = each, each
            add_run(pair, potential, given, own, NEAR_ROUGH[n], times, loop, (*arrays, steps))
    set_times(given.duration, times)
    factor = SAFETY * OF_ROUGH if rough else SAFETY
    pool(series, count, factor, DIMENSION, other, errors)


@kernel
def pool(series, count, factor, dimension, scratch, errors):
    """From the largest differences of runs to bounds on errors.

    A difference may be small by chance: each bound includes POOLED of the largest in units of the
    scales, which are the largest values of quantities of one `dimension` (rows,).
    """
    for each in range(len(DIMENSIONS)):
        scratch[each, 0] = 0.0
    for name in range(series.shape[0]):
        top = largest(series[name], count)
        scratch[dimension[name], 0] = max(scratch[dimension[name], 0], top)
    relative = 0.0
    for name in range(series.shape[0]):
        scale = scratch[dimension[name], 0]
        if scale > 0.0:
            relative = max(relative, errors[name] / scale)
    for name in range(series.shape[0]):
        top = largest(series[name], count)
        pooled = POOLED * relative * scratch[dimension[name], 0] if top > 0.0 else 0.0
        errors[name] = factor * (errors[name] + pooled) + ROUNDING * top


@kernel
def set_start(numbers, options, bodies, pair, start):
    """Set the swings at the start, and their rates, from the numbers or as the options say."""
    at = inputs.OF_SURFACE
    start[0] = numbers[inputs.SWING]
    start[1] = numbers[at + inputs.SWING]
    start[2] = numbers[inputs.OMEGA]
    start[3] = numbers[at + inputs.OMEGA]
    if options[AMPLITUDE] > 0.0 or options[TEMPERATURE] > 0.0:
        begin_swings(bodies, pair, options, start)


@kernel
def scales_of(pair, potential, numbers, given, times, loop, arrays):
    """Scales of a run, measured in one with few samples; the guess of `given` if it has none."""
    memory, _, _ = loop
    coarse, other = arrays
    bodies = given.bodies
    set_times(given.duration, times)
    set_limits(bodies, given.bar_lengths, given.scales, given.duration, PILOT, memory)
    _, count = integrate(pair, potential, loop, times, coarse, PILOT_NEAR, given.most)
    if count == 0:
        return given.scales
    at = inputs.OF_SURFACE
    mean_x = 0.5 * (numbers[inputs.VELOCITY_X] + numbers[at + inputs.VELOCITY_X])
    mean_y = 0.5 * (numbers[inputs.VELOCITY_Y] + numbers[at + inputs.VELOCITY_Y])
    of_mean = sides_of(numbers, bodies, mean_x, mean_y)
    write_quantities(pair, potential, of_mean, times, coarse, count, other)
    return measured(bodies, coarse, other, count, given.scales)


def live_pair(potential, numbers, options, loop, times, records, found, errors):
    """Run a pair with the `numbers` of `tribo.live_pages.inputs`; returns the code of a status.

    The `loop` has its memory, with the method's table, its clocks and its start.  There are two
    runs: the `records` of the loop, and what is `found`, (QUANTITIES, times) of quantities, are
    those of the first and of coarser ones.  `errors` (QUANTITIES,) become bounds on the errors in
    the first.
    """
    memory, clocks, start = loop
    record, coarse = records
    series, other = found
    bodies = bodies_of(numbers)
    one, second = bodies
    pair = pair_of(one, second)
    set_start(numbers, options, bodies, pair, start)
    at = inputs.OF_SURFACE
    bar_lengths = numbers[inputs.BAR_LENGTH], numbers[at + inputs.BAR_LENGTH]
    most = int(options[MOST_STEPS])
    near = options[NEAR]
    level = options[LEVEL]
    duration = numbers[inputs.DURATION]
    scales = guess(bodies, start)
    if options[GIVEN] == 0.0:
        given = Coarser(bodies, bar_lengths, scales, duration, most)
        few = times[: min(times.size, PILOT_SAMPLES)]
        scales = scales_of(pair, potential, numbers, given, few, loop, (coarse, other))
        set_limits(bodies, bar_lengths, scales, duration, level, memory)
        set_times(duration, times)
    status, count = integrate(pair, potential, loop, times, record, near, most)
    options[REACHED] = count
    options[EVALUATIONS] = clocks[0].evaluations
    if count == 0:
        return status
    sides = sides_of(numbers, bodies, numbers[inputs.OBSERVER_X], numbers[inputs.OBSERVER_Y])
    write_quantities(pair, potential, sides, times, record, count, series)
    options[PASSED], options[NEEDED] = passing(pair, series, count)
    if options[ESTIMATE] == 1.0:
        given = Coarser(bodies, bar_lengths, scales, duration, most)
        rough = options[ROUGH] == 1.0
        arrays = sides, coarse, series, other, errors, count
        estimate(pair, potential, given, level, rough, times, loop, arrays)
    return status
