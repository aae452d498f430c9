"""Members of a pair in the lanes of vector registers, by an explicit Nystrom method.

Each lane holds one member, with a step of its own.  All arithmetic acts on every lane by itself, so
that a member has the same bits in any lane and company.  Several registers are in flight, because
the operations of one wait for one another.

Only the motion is integrated.  The accounts follow from it by conservation of energy: see
:func:`write_end`.
"""

import math

import numpy as np

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import (
    LANES,
    absolute,
    any_below,
    broadcast,
    lane,
    sqrt,
    sum_of_lanes,
    where_less,
    with_lane,
)
from tribo.compiler.lanes_functions import near_zero, reduced
from tribo.compiler.lanes_memory import load, rows_of, store
from tribo.compiler.numbers_in_lanes import numbers_at_lane, numbers_in_lanes
from tribo.integrators.nystrom import Nystrom
from tribo.kernels.status import COMPLETED, PAUSED
from tribo.lanes.refill import leave_member, next_member
from tribo.pair.forces import PairScene, contact_of, distance, swing_accelerations
from tribo.pair.loop import ENERGY
from tribo.pair.step_rows import Q1, Q2, V1, V2, X1, X2, Y1, Y2, J, K, S

# Registers in flight.
GROUPS = 2
# Rows of a register's memory, behind Q1 to J: the time, the next step, the numbers of steps that
# were tried and accepted, and the accelerations at the stages, three rows each.
T, H, TRIALS, ACCEPTED, F = range(J + 1, J + 6)
# Largest swing whose sine and cosine need no reduction [rad].
QUARTER_PI = 0.785
# Largest swing of a member in a lane [rad]: up to a million quarter turns are reduced exactly.
LARGEST_SWING = 1e6
# Bounds on the ratio of a step to the one before it.
LEAST_GROWTH, MOST_GROWTH = 0.2, 4.0
# Parts of the growth that an error allows: of those from 0.75 to 0.92 they take the fewest
# evaluations on cases A and C of the paper.
CAUTION, CAUTION_AT_HIGH_ORDER = 0.75, 0.8
# Stages from which on the error is taken to grow as h^16, and not as h^8: other roots take
# longer than what they save.
HIGH_ORDER = 12
# A step is rejected if it is longer than this times the way to an encounter at its end.  Its start
# limits it too, and the error estimate sees the force at its end.
LARGEST_APPROACH = 4.0
# Places in the limits: reciprocal tolerances of the rates, the first step, the largest part of the
# way to an encounter, the time of the end, and the largest number of steps that are tried.
UNIT1, UNIT2, UNITK, FIRST, NEAR, END, MOST_TRIALS = range(7)
# Column of a record where the accelerations at the start stand until its member is loaded.
START = J + 1


def coefficients(method: Nystrom) -> np.ndarray:
    """The table of a method, in the order in which a step reads it."""
    stages = method.c.size
    rows = [np.append(method.c[i], method.a[i, :i]) for i in range(1, stages)]
    return np.concatenate(
        [*rows, *np.column_stack([method.b, method.v, method.ev[:-1]]), method.ev[-1:]]
    )


# Numbers of a pair in a row of scenes; those of the potential are behind them.
PAIR_NUMBERS = len(PairScene._fields)


@inlined
def own_scenes(pair, potential, work, at, scenes):
    """The pairs and potentials of the members in a register, or those of all members.

    `at` is the first row of their numbers.
    """
    own = numbers_in_lanes(pair, scenes, work, at)
    return own, numbers_in_lanes(potential, scenes, work, at + PAIR_NUMBERS)


@kernel
def load_scene(work, at, i, m, scenes):
    """Put the numbers of member m into lane i."""
    if scenes is not None:
        for number in range(scenes.shape[1]):
            work[at + number, i] = scenes[m, number]


@inlined
def accelerations(pair, potential, t, q1, q2, k):
    """q1'', q2'', k'' and the distance."""
    near = where_less(absolute(q1), QUARTER_PI, absolute(q2), QUARTER_PI)
    if any_below(0, LANES, 0.0 - near, -QUARTER_PI):
        sin1, cos1, _ = reduced(q1)
        sin2, cos2, _ = reduced(q2)
    else:  # the same bits, in half the time
        sin1, cos1, _ = near_zero(q1)
        sin2, cos2, _ = near_zero(q2)
    contact = contact_of(pair, potential, t, k, sin1, cos1, sin2, cos2)
    f1, f2 = swing_accelerations(pair, contact, q1, q2)
    return f1, f2, contact.fx, contact.r


@inlined
def step_length(work, base, limits):
    """The step of each lane that is tried next."""
    h = load(work, base + H)
    left = limits[0, END] - load(work, base + T)
    return where_less(left, 1.0001 * h, left, h)


@inlined
def evaluate_stage(pair, potential, scenes, work, base, limits, table, at, stages, i):
    """The accelerations at stage i, whose coefficients begin at `at`."""
    pair, potential = own_scenes(pair, potential, work, base + F + 3 * stages, scenes)
    h = step_length(work, base, limits)
    sum1, sum2, sumk = broadcast(0.0), broadcast(0.0), broadcast(0.0)
    for j in range(i):
        weight = table[0, at + 1 + j]
        sum1 = sum1 + weight * load(work, base + F + 3 * j)
        sum2 = sum2 + weight * load(work, base + F + 3 * j + 1)
        sumk = sumk + weight * load(work, base + F + 3 * j + 2)
    ahead = table[0, at] * h
    square = h * h
    q1 = load(work, base + Q1) + (ahead * load(work, base + V1) + square * sum1)
    q2 = load(work, base + Q2) + (ahead * load(work, base + V2) + square * sum2)
    k = load(work, base + K) + (ahead * load(work, base + J) + square * sumk)
    f1, f2, fk, _ = accelerations(pair, potential, load(work, base + T) + ahead, q1, q2, k)
    store(work, base + F + 3 * i, f1)
    store(work, base + F + 3 * i + 1, f2)
    store(work, base + F + 3 * i + 2, fk)


@inlined
def rate_of_encounters(pair, potential, r, q1, q2, v1, v2, j):
    """Rates of encounters [1 / time]; see :func:`tribo.pair.forces.encounter_rate_of`."""
    omega1 = absolute(v1) + math.sqrt(pair.omega_squared1) * absolute(q1)
    omega2 = absolute(v2) + math.sqrt(pair.omega_squared2) * absolute(q2)
    speed = absolute(pair.velocity_x + pair.mobility * j)
    speed = speed + (abs(pair.arm1) * omega1 + abs(pair.arm2) * omega2)
    clear = r
    for i in range(LANES):
        clear = with_lane(clear, i, numbers_at_lane(potential, i).clearance(lane(r, i)))
    return speed / clear


@inlined
def end_step(pair, potential, scenes, work, base, limits, table, at, stages):
    """Accept the steps whose errors are small, and choose the next ones.

    Returns Lanes that are above zero where a member is at its end, or cannot continue.
    """
    pair, potential = own_scenes(pair, potential, work, base + F + 3 * stages, scenes)
    h = step_length(work, base, limits)
    twice1, twice2, twicek = broadcast(0.0), broadcast(0.0), broadcast(0.0)
    once1, once2, oncek = broadcast(0.0), broadcast(0.0), broadcast(0.0)
    error1, error2, errork = broadcast(0.0), broadcast(0.0), broadcast(0.0)
    for j in range(stages):
        f1 = load(work, base + F + 3 * j)
        f2 = load(work, base + F + 3 * j + 1)
        fk = load(work, base + F + 3 * j + 2)
        b, v, e = table[0, at + 3 * j], table[0, at + 3 * j + 1], table[0, at + 3 * j + 2]
        twice1, twice2, twicek = twice1 + b * f1, twice2 + b * f2, twicek + b * fk
        once1, once2, oncek = once1 + v * f1, once2 + v * f2, oncek + v * fk
        error1, error2, errork = error1 + e * f1, error2 + e * f2, errork + e * fk
    t = load(work, base + T)
    q1, q2, k = load(work, base + Q1), load(work, base + Q2), load(work, base + K)
    v1, v2, j = load(work, base + V1), load(work, base + V2), load(work, base + J)
    new1 = q1 + h * (v1 + h * twice1)
    new2 = q2 + h * (v2 + h * twice2)
    newk = k + h * (j + h * twicek)
    rate1, rate2, ratek = v1 + h * once1, v2 + h * once2, j + h * oncek
    landing = limits[0, END] - t
    end = where_less(landing, 1.0001 * load(work, base + H), limits[0, END], t + h)
    f1, f2, fk, r = accelerations(pair, potential, end, new1, new2, newk)
    last = table[0, at + 3 * stages]
    error = absolute(h * (error1 + last * f1)) * limits[0, UNIT1]
    error = error + absolute(h * (error2 + last * f2)) * limits[0, UNIT2]
    error = error + absolute(h * (errork + last * fk)) * limits[0, UNITK]
    later = rate_of_encounters(pair, potential, r, new1, new2, rate1, rate2, ratek)
    # An encounter that the step would jump counts as an error; NaN is less than nothing.
    error = where_less(h * later, LARGEST_APPROACH, error, 1e30)
    root = sqrt(sqrt(sqrt(error + 1e-30)))
    growth = (CAUTION if stages < HIGH_ORDER else CAUTION_AT_HIGH_ORDER) / (
        root if stages < HIGH_ORDER else sqrt(root)
    )
    growth = where_less(broadcast(LEAST_GROWTH), growth, growth, LEAST_GROWTH)  # of NaN too
    growth = where_less(growth, MOST_GROWTH, growth, MOST_GROWTH)
    longest = limits[0, NEAR] / later
    longest = where_less(longest, growth * h, longest, growth * h)
    store(work, base + H, where_less(error, 1.0, longest, growth * h))
    store(work, base + T, where_less(error, 1.0, end, t))
    store(work, base + Q1, where_less(error, 1.0, new1, q1))
    store(work, base + Q2, where_less(error, 1.0, new2, q2))
    store(work, base + K, where_less(error, 1.0, newk, k))
    store(work, base + V1, where_less(error, 1.0, rate1, v1))
    store(work, base + V2, where_less(error, 1.0, rate2, v2))
    store(work, base + J, where_less(error, 1.0, ratek, j))
    store(work, base + F, where_less(error, 1.0, f1, load(work, base + F)))
    store(work, base + F + 1, where_less(error, 1.0, f2, load(work, base + F + 1)))
    store(work, base + F + 2, where_less(error, 1.0, fk, load(work, base + F + 2)))
    trials = load(work, base + TRIALS) + 1.0
    store(work, base + TRIALS, trials)
    store(work, base + ACCEPTED, load(work, base + ACCEPTED) + (error < 1.0))
    outside = (absolute(new1) > LARGEST_SWING) + (absolute(new2) > LARGEST_SWING)
    return (load(work, base + T) >= limits[0, END]) + outside + (trials > limits[0, MOST_TRIALS])


@kernel
def energy_at(pair, potential, t, q1, q2, k):
    """Energy of the contact."""
    r = distance(pair, t, q1, q2, k)
    return potential.energy_between(r, pair.charge1, pair.charge2) if r < potential.range() else 0.0


@kernel
def prepare_starts(pair, potential, work, at, scenes, starts, samples):
    """Write the first samples, with the accelerations at the start in place of accounts."""
    members, n = starts.shape[0], starts.shape[1] // 2
    for first in range(0, members, LANES):
        q1, q2 = broadcast(starts[first, 0]), broadcast(starts[first, 1])
        for i in range(LANES):
            load_scene(work, at, i, min(first + i, members - 1), scenes)
        pairs, potentials = own_scenes(pair, potential, work, at, scenes)
        for i in range(min(LANES, members - first)):
            q1 = with_lane(q1, i, starts[first + i, 0])
            q2 = with_lane(q2, i, starts[first + i, 1])
        zero = broadcast(0.0)
        f1, f2, fk, _ = accelerations(pairs, potentials, zero, q1, q2, zero)
        for i in range(min(LANES, members - first)):
            m = first + i
            for column in range(ENERGY):
                samples[0, m, column] = 0.0
            samples[0, m, Q1], samples[0, m, Q2] = starts[m, 0], starts[m, 1]
            samples[0, m, V1], samples[0, m, V2] = starts[m, n], starts[m, n + 1]
            samples[0, m, START], samples[0, m, START + 1] = lane(f1, i), lane(f2, i)
            samples[0, m, START + 2] = lane(fk, i)
            one, its = numbers_at_lane(pairs, i), numbers_at_lane(potentials, i)
            samples[0, m, ENERGY] = energy_at(one, its, 0.0, lane(q1, i), lane(q2, i), 0.0)


@kernel
def load_member(work, base, i, m, limits, samples):
    """Put member m into lane i, at its start."""
    for row in range(J + 1):
        work[base + row, i] = samples[0, m, row]
    for row in range(3):
        work[base + F + row, i] = samples[0, m, START + row]
        samples[0, m, START + row] = 0.0
    work[base + T, i] = 0.0
    work[base + H, i] = limits[0, FIRST]
    work[base + TRIALS, i] = 0.0
    work[base + ACCEPTED, i] = 0.0


@kernel
def clear_lane(work, base, i):
    """Let a lane rest, for which there is no member."""
    work[base + T, i] = 0.0
    work[base + H, i] = 0.0
    work[base + TRIALS, i] = -math.inf
    for row in (V1, V2, J, Q1, Q2, K):
        work[base + row, i] = 0.0


@kernel
def write_end(pair, potential, work, base, i, m, limits, samples):
    """Write the end of member m, in lane i, and its accounts; returns the code of its status.

    With G_i the change of q_i'^2 / 2 + omega_i^2 q_i^2 / 2, G_i = lever_x X_i + lever_y Y_i.  Of a
    forced asperite, whose levers are equal, that is X_i + Y_i, which alone is reported.  With U
    the energy of the contact, -dU = velocity_x J + mobility S + arm1 (X1 + Y1) - arm2 (X2 + Y2),
    where S = J^2 / 2.
    """
    first, last = samples[0, m], samples[1, m]
    for row in range(J + 1):
        last[row] = work[base + row, i]
    for row in range(J + 1, ENERGY):
        last[row] = 0.0
    end = limits[0, END]
    last[ENERGY] = energy_at(pair, potential, end, last[Q1], last[Q2], last[K])
    gain1 = half_square_gain(last[V1], first[V1])
    gain1 += pair.omega_squared1 * half_square_gain(last[Q1], first[Q1])
    gain2 = half_square_gain(last[V2], first[V2])
    gain2 += pair.omega_squared2 * half_square_gain(last[Q2], first[Q2])
    slide = 0.5 * last[J] * last[J]
    released = (first[ENERGY] - last[ENERGY]) - pair.velocity_x * last[J] - pair.mobility * slide
    both1, both2 = gain1 / pair.lever_x1, gain2 / pair.lever_x2
    account = J + 1
    last[account + S] = slide
    if pair.lever_x1 == pair.lever_y1:
        last[account + X1] = both1
    else:
        both1 = (released + pair.arm2 * both2) / pair.arm1
        y = (gain1 - pair.lever_x1 * both1) / (pair.lever_y1 - pair.lever_x1)
        last[account + X1], last[account + Y1] = both1 - y, y
    if pair.lever_x2 == pair.lever_y2:
        last[account + X2] = both2
    else:
        both2 = (pair.arm1 * both1 - released) / pair.arm2
        y = (gain2 - pair.lever_x2 * both2) / (pair.lever_y2 - pair.lever_x2)
        last[account + X2], last[account + Y2] = both2 - y, y
    swings = max(abs(last[Q1]), abs(last[Q2]))
    whole = work[base + T, i] >= end and swings <= LARGEST_SWING and math.isfinite(gain1 + gain2)
    return COMPLETED if whole else PAUSED


@inlined
def fill_lane(work, base, k, own, limits, scenes, samples, queue):
    """Begin the next member that waits in lane k of all, or let the lane rest."""
    i = k % LANES
    m = next_member(queue, k)
    clear_lane(work, base, i)
    if m >= 0:
        load_scene(work, base + own, i, m, scenes)
        load_member(work, base, i, m, limits, samples)


@kernel
def end_member(pairs, potentials, work, base, k, limits, samples, queue, stages):
    """Write the end of the member in lane k of all, and let the lane be free."""
    i, m = k % LANES, queue.held[k]
    one, its = numbers_at_lane(pairs, i), numbers_at_lane(potentials, i)
    code = write_end(one, its, work, base, i, m, limits, samples)
    steps, trials = int(work[base + ACCEPTED, i]), int(work[base + TRIALS, i])
    leave_member(queue, k, code, steps, trials * stages)


@inlined
def half_square_gain(x, before):
    """(x^2 - before^2) / 2."""
    return 0.5 * (x - before) * (x + before)


def pair_members_in_lanes(
    pair, potential, scenes, memory, tables, bounds, starts, samples, queue, stages
):
    """Integrate members from their starts to the end, GROUPS * LANES at a time.

    `scenes` (members, numbers) has the numbers of each member's pair, and of its potential if that
    has floats alone; with None all have those of `pair` and `potential`.  `memory` has GROUPS * (F
    + 3 stages + numbers) rows of zeros, `tables` the :func:`coefficients`, `bounds` UNIT1 to
    MOST_TRIALS.  `starts` are (members, 2 coordinates) y of the scene's layout.  `samples` (2,
    members, COLUMNS) become those at the start and at the end; J_Y and the integrals of q are 0.
    """
    work, table, limits = rows_of(memory), rows_of(tables), rows_of(bounds)
    members = starts.shape[0]
    size = memory.shape[0] // GROUPS
    own = F + 3 * stages
    prepare_starts(pair, potential, work, own, scenes, starts, samples)
    for k in range(GROUPS * LANES):
        base = k // LANES * size
        load_scene(work, base + own, k % LANES, members - 1, scenes)
        fill_lane(work, base, k, own, limits, scenes, samples, queue)
    left = members
    while left > 0:
        at = 0
        for i in range(1, stages):
            for g in range(GROUPS):
                evaluate_stage(
                    pair, potential, scenes, work, g * size, limits, table, at, stages, i
                )
            at += 1 + i
        for g in range(GROUPS):
            base = g * size
            ended = end_step(pair, potential, scenes, work, base, limits, table, at, stages)
            if sum_of_lanes(ended) > 0.0:
                pairs, potentials = own_scenes(pair, potential, work, base + own, scenes)
                for i in range(LANES):
                    k = g * LANES + i
                    if queue.held[k] >= 0 and lane(ended, i) > 0.0:
                        end_member(pairs, potentials, work, base, k, limits, samples, queue, stages)
                        left -= 1
                        fill_lane(work, base, k, own, limits, scenes, samples, queue)
