"""Members of a pair in the lanes of vector registers, by an explicit Nystrom method.

Each lane holds one member, with a step of its own.  All arithmetic acts on every lane by itself, so
that a member has the same bits in any lane and company.  Several registers are in flight, because
the operations of one wait for one another.

Only the motion is integrated.  The accounts follow from it by conservation of energy: see
:func:`end_member`.
"""

import math
from typing import Any, NamedTuple

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
from tribo.compiler.lanes_memory import address_at, load, rows_of, store
from tribo.compiler.numbers_in_lanes import numbers_at_lane, numbers_in_lanes
from tribo.compiler.pointers import pointers
from tribo.integrators.nystrom import Nystrom
from tribo.integrators.step_control import growth_by_roots
from tribo.kernels.status import COMPLETED, PAUSED
from tribo.lanes.refill import leave_member, next_member
from tribo.pair.forces import PAIR_NUMBERS, PairScene, accelerations_of, contact_of, energy_at
from tribo.pair.loop import ENERGY
from tribo.pair.potential import PotentialUnits, clearances_of, with_numbers
from tribo.pair.step_rows import Q1, Q2, V1, V2, X1, X2, Y1, Y2, J, K, S
from tribo.pair.triples import load_three, plus, store_three, times

# Registers in flight.
GROUPS = 2
# Rows of a register's memory, behind Q1 to J: the time, the next step, the numbers of steps that
# were tried and accepted, and the accelerations at the stages, three rows each.
T, H, TRIALS, ACCEPTED, F = range(J + 1, J + 6)
# Largest swing whose sine and cosine need no reduction [rad].
QUARTER_PI = 0.785
# Largest swing of a member in a lane [rad]: up to a million quarter turns are reduced exactly.
LARGEST_SWING = 1e6
# Largest ratio of a step to the one before it.
MOST_GROWTH = 4.0
# Parts of the growth that an error allows: of those from 0.75 to 0.92 they take the fewest
# evaluations on cases A and C of the paper.
CAUTION = 0.75
CAUTION_AT_HIGH_ORDER = 0.8
# Stages from which on the error is taken to grow as h^16, and not as h^8: other roots take
# longer than what they save.
HIGH_ORDER = 12
# Square roots of such errors that grow as h.
ROOTS = 3
ROOTS_AT_HIGH_ORDER = 4
# Steps that would end so close before the end of the run end with it.
LANDING = 1.0001
# Error of a step that jumps an encounter.
REFUSED = 1e30
# A step is rejected if it is longer than this times the way to an encounter at its end.  Its start
# limits it too, and the error estimate sees the force at its end.
LARGEST_APPROACH = 4.0
# Places in the limits: reciprocal tolerances of the rates, the first step, the largest part of the
# way to an encounter, the time of the end, and the largest number of steps that are tried.
UNIT1, UNIT2, UNITK, FIRST, NEAR, END, MOST_TRIALS = range(7)
# Column of a record where the accelerations at the start stand until its member is loaded.
START = J + 1


class Common(NamedTuple):
    """What the members of a call have in common."""

    pair: PairScene  # that of members without numbers of their own
    potential: PotentialUnits
    scenes: Any  # (members, numbers) of their own, or None
    limits: np.ndarray  # UNIT1 to MOST_TRIALS
    table: np.ndarray  # the coefficients
    stages: int
    numbers: int  # first row of a member's own numbers in a register's memory


def coefficients(method: Nystrom) -> np.ndarray:
    """The coefficients of a method, in the order in which a step reads them."""
    stages = method.c.size
    rows = [[method.c[i], *method.a[i, :i]] for i in range(1, stages)]
    return np.concatenate(
        [*rows, *np.column_stack([method.b, method.v, method.ev[:-1]]), method.ev[-1:]]
    )


@inlined
def own_scenes(pair, potential, work, at, scenes):
    """The pairs and potentials of the members in a register, or those of all members.

    `at` is the first row of their numbers.
    """
    own = numbers_in_lanes(pair, scenes, work, at)
    if scenes is not None and scenes.shape[1] > PAIR_NUMBERS:
        potential = with_numbers(potential, address_at(work[at + PAIR_NUMBERS], 0))
    return own, potential


@inlined
def scenes_in(common, work):
    """The same of a register in a step."""
    return own_scenes(common.pair, common.potential, work, common.numbers, common.scenes)


@kernel
def load_scene(work, at, i, m, scenes):
    if scenes is not None:
        for number in range(scenes.shape[1]):
            work[at + number, i] = scenes[m, number]


@inlined
def accelerations(pair, potential, t, q1, q2, k):
    """q1'', q2'' and k'', and the distance."""
    near = where_less(absolute(q1), QUARTER_PI, absolute(q2), QUARTER_PI)
    if any_below(0, LANES, 0.0 - near, -QUARTER_PI):
        sin1, cos1, _ = reduced(q1)
        sin2, cos2, _ = reduced(q2)
    else:  # the same bits, in half the time
        sin1, cos1, _ = near_zero(q1)
        sin2, cos2, _ = near_zero(q2)
    contact = contact_of(pair, potential, t, k, sin1, cos1, sin2, cos2)
    return accelerations_of(pair, contact, q1, q2), sqrt(contact.square)


@inlined
def step_length(work, limits):
    h = load(work, H)
    left = limits[END] - load(work, T)
    return where_less(left, LANDING * h, left, h)


@inlined
def evaluate_stage(common, work, at, i):
    """The accelerations at stage i, whose coefficients begin at `at`."""
    pair, potential = scenes_in(common, work)
    table = common.table
    h = step_length(work, common.limits)
    sums = broadcast(0.0), broadcast(0.0), broadcast(0.0)
    for j in range(i):
        sums = plus(sums, times(table[at + 1 + j], load_three(work, F + 3 * j)))
    ahead = table[at] * h
    moved = plus(times(ahead, load_three(work, V1)), times(h * h, sums))
    q1, q2, k = plus(load_three(work, Q1), moved)
    f, _ = accelerations(pair, potential, load(work, T) + ahead, q1, q2, k)
    store_three(work, F + 3 * i, f)


@inlined
def rate_of_encounters(pair, potential, r, q1, q2, rates):
    """Rates of encounters [1 / time]; see :func:`tribo.pair.forces.encounter_rate_of`."""
    v1, v2, j = rates
    omega1 = absolute(v1) + math.sqrt(pair.omega_squared1) * absolute(q1)
    omega2 = absolute(v2) + math.sqrt(pair.omega_squared2) * absolute(q2)
    speed = absolute(pair.velocity_x + pair.mobility * j)
    speed = speed + (abs(pair.arm1) * omega1 + abs(pair.arm2) * omega2)
    return speed / clearances_of(potential, r, pair.charge1, pair.charge2)


@inlined
def take(work, row, new, error):
    """Set a row to new values in lanes whose errors are small."""
    store(work, row, where_less(error, 1.0, new, load(work, row)))


@inlined
def take_three(work, row, new, error):
    """The same for three rows."""
    take(work, row, new[0], error)
    take(work, row + 1, new[1], error)
    take(work, row + 2, new[2], error)


@inlined
def end_step(common, work, at):
    """Accept the steps whose errors are small, and choose the next ones.

    The method's weights begin at `at`.  Returns Lanes that are above zero where a member is at its
    end, or cannot continue.
    """
    pair, potential = scenes_in(common, work)
    stages = common.stages
    limits = common.limits
    table = common.table
    h = step_length(work, limits)
    twice = once = errors = broadcast(0.0), broadcast(0.0), broadcast(0.0)
    for j in range(stages):
        f = load_three(work, F + 3 * j)
        twice = plus(twice, times(table[at + 3 * j], f))
        once = plus(once, times(table[at + 3 * j + 1], f))
        errors = plus(errors, times(table[at + 3 * j + 2], f))
    t = load(work, T)
    rates = load_three(work, V1)
    places = plus(load_three(work, Q1), times(h, plus(rates, times(h, twice))))
    rates = plus(rates, times(h, once))
    q1, q2, k = places
    landing = limits[END] - t
    end = where_less(landing, LANDING * load(work, H), limits[END], t + h)
    f, r = accelerations(pair, potential, end, q1, q2, k)
    missed = times(h, plus(errors, times(table[at + 3 * stages], f)))
    error = absolute(missed[0]) * limits[UNIT1]
    error = error + absolute(missed[1]) * limits[UNIT2]
    error = error + absolute(missed[2]) * limits[UNITK]
    later = rate_of_encounters(pair, potential, r, q1, q2, rates)
    # An encounter that the step would jump counts as an error; NaN is less than nothing.
    error = where_less(h * later, LARGEST_APPROACH, error, REFUSED)
    high = stages >= HIGH_ORDER
    roots = ROOTS_AT_HIGH_ORDER if high else ROOTS
    caution = CAUTION_AT_HIGH_ORDER if high else CAUTION
    growth = growth_by_roots(error, roots, caution, MOST_GROWTH)
    longest = limits[NEAR] / later
    longest = where_less(longest, growth * h, longest, growth * h)
    store(work, H, where_less(error, 1.0, longest, growth * h))
    take(work, T, end, error)
    take_three(work, Q1, places, error)
    take_three(work, V1, rates, error)
    take_three(work, F, f, error)
    trials = load(work, TRIALS) + 1.0
    store(work, TRIALS, trials)
    store(work, ACCEPTED, load(work, ACCEPTED) + (error < 1.0))
    outside = (absolute(q1) > LARGEST_SWING) + (absolute(q2) > LARGEST_SWING)
    return (load(work, T) >= limits[END]) + outside + (trials > limits[MOST_TRIALS])


@kernel
def prepare_starts(pair, potential, work, at, scenes, starts, samples):
    """Write the first samples, with the accelerations at the start in place of accounts."""
    members = starts.shape[0]
    n = starts.shape[1] // 2
    for first in range(0, members, LANES):
        q1 = q2 = zero = broadcast(0.0)
        for i in range(LANES):
            m = min(first + i, members - 1)
            load_scene(work, at, i, m, scenes)
            q1 = with_lane(q1, i, starts[m, 0])
            q2 = with_lane(q2, i, starts[m, 1])
        pairs, potentials = own_scenes(pair, potential, work, at, scenes)
        f, _ = accelerations(pairs, potentials, zero, q1, q2, zero)
        for i in range(min(LANES, members - first)):
            m = first + i
            own = samples[0, m]
            for column in range(ENERGY):
                own[column] = 0.0
            own[Q1] = starts[m, 0]
            own[Q2] = starts[m, 1]
            own[V1] = starts[m, n]
            own[V2] = starts[m, n + 1]
            own[START] = lane(f[0], i)
            own[START + 1] = lane(f[1], i)
            own[START + 2] = lane(f[2], i)
            one = numbers_at_lane(pairs, i)
            own[ENERGY] = energy_at(one, potentials, 0.0, own[Q1], own[Q2], 0.0, i)


@inlined
def gain_of(first, last, q, v, omega_squared):
    """The change of q'^2 / 2 + omega^2 q^2 / 2."""
    kinetic = 0.5 * (last[v] - first[v]) * (last[v] + first[v])
    return kinetic + omega_squared * (0.5 * (last[q] - first[q]) * (last[q] + first[q]))


@kernel
def end_member(pairs, potentials, work, k, limits, samples, queue, stages):
    """Write the end of the member in lane k of all, and its accounts, and let the lane be free.

    With G_i the change of q_i'^2 / 2 + omega_i^2 q_i^2 / 2, G_i = lever_x X_i + lever_y Y_i.  Of a
    forced asperite, whose levers are equal, that is X_i + Y_i, which alone is reported.  With U
    the energy of the contact, -dU = velocity_x J + mobility S + arm1 (X1 + Y1) - arm2 (X2 + Y2),
    where S = J^2 / 2.
    """
    i = k % LANES
    m = queue.held[k]
    pair = numbers_at_lane(pairs, i)
    first = samples[0, m]
    last = samples[1, m]
    for row in range(J + 1):
        last[row] = work[row, i]
    for row in range(J + 1, ENERGY):
        last[row] = 0.0
    end = limits[END]
    last[ENERGY] = energy_at(pair, potentials, end, last[Q1], last[Q2], last[K], i)
    gain1 = gain_of(first, last, Q1, V1, pair.omega_squared1)
    gain2 = gain_of(first, last, Q2, V2, pair.omega_squared2)
    slide = 0.5 * last[J] * last[J]
    released = (first[ENERGY] - last[ENERGY]) - pair.velocity_x * last[J] - pair.mobility * slide
    both1 = gain1 / pair.lever_x1
    both2 = gain2 / pair.lever_x2
    account = J + 1
    last[account + S] = slide
    last[account + X1] = both1
    last[account + X2] = both2
    if pair.lever_x1 != pair.lever_y1:
        both = (released + pair.arm2 * both2) / pair.arm1
        y = (gain1 - pair.lever_x1 * both) / (pair.lever_y1 - pair.lever_x1)
        last[account + X1] = both - y
        last[account + Y1] = y
    if pair.lever_x2 != pair.lever_y2:
        both = (pair.arm1 * both1 - released) / pair.arm2
        y = (gain2 - pair.lever_x2 * both) / (pair.lever_y2 - pair.lever_x2)
        last[account + X2] = both - y
        last[account + Y2] = y
    swings = max(abs(last[Q1]), abs(last[Q2]))
    whole = work[T, i] >= end and swings <= LARGEST_SWING and math.isfinite(gain1 + gain2)
    steps = int(work[ACCEPTED, i])
    trials = int(work[TRIALS, i])
    leave_member(queue, k, COMPLETED if whole else PAUSED, steps, trials * stages)


@kernel
def fill_lane(memory, k, at, limits, scenes, samples, queue):
    """Begin the next member that waits in lane k of all; without one let the lane rest."""
    work = memory[k // LANES]
    i = k % LANES
    m = next_member(queue, k)
    for row in range(F):
        work[row, i] = 0.0
    if m < 0:
        work[TRIALS, i] = -math.inf
        return
    load_scene(work, at, i, m, scenes)
    work[H, i] = limits[FIRST]
    for row in range(J + 1):
        work[row, i] = samples[0, m, row]
    for row in range(3):
        work[F + row, i] = samples[0, m, START + row]
        samples[0, m, START + row] = 0.0


def pair_members_in_lanes(pair, potential, scenes, memory, method, starts, samples, queue):
    """Integrate members from their starts to the end, GROUPS * LANES at a time.

    `potential` has units in lanes.  `scenes` (members, numbers) has the numbers of each member's
    pair, and of its potential if that has floats alone; with None all have those of `pair` and
    `potential`.  `memory` (GROUPS, F + 3 stages + numbers, 8) is zeros.  The `method` has the table
    of its :func:`coefficients`, limits UNIT1 to MOST_TRIALS, and the number of stages.  `starts`
    are (members, 2 coordinates) y of the scene's layout.  `samples` (2, members, COLUMNS) become
    those at the start and at the end; J_Y and the integrals of q are 0.
    """
    memory = rows_of(memory)
    table, limits, stages = method
    scenes, table, limits, starts, samples, queue = pointers(
        (scenes, table, limits, starts, samples, queue)
    )
    own = F + 3 * stages
    common = Common(pair, potential, scenes, limits, table, stages, own)
    members = starts.shape[0]
    prepare_starts(pair, potential, memory[0], own, scenes, starts, samples)
    for k in range(GROUPS * LANES):
        load_scene(memory[k // LANES], own, k % LANES, members - 1, scenes)
        fill_lane(memory, k, own, limits, scenes, samples, queue)
    left = members
    while left > 0:
        at = 0
        for i in range(1, stages):
            for g in range(GROUPS):
                evaluate_stage(common, memory[g], at, i)
            at += 1 + i
        for g in range(GROUPS):
            work = memory[g]
            ended = end_step(common, work, at)
            if sum_of_lanes(ended) > 0.0:
                pairs, potentials = scenes_in(common, work)
                for i in range(LANES):
                    k = g * LANES + i
                    if queue.held[k] >= 0 and lane(ended, i) > 0.0:
                        end_member(pairs, potentials, work, k, limits, samples, queue, stages)
                        left -= 1
                        fill_lane(memory, k, own, limits, scenes, samples, queue)
