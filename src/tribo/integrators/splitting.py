"""Symmetric splitting: pendulums turn exactly on their springs, everything else is kicks.

One step of length h is drift(h/2) kick(h) drift(h/2), and compositions of it have higher order;
so have other sequences of drifts and kicks, see :class:`Splitting`.

    drift  every torsion spring rotates its pendulum exactly, centres of mass move uniformly
    kick   contact, drive, field and lattice springs change the rates at fixed places
    turns  inside the kick: baths and reservoirs, bars frozen; see `bath_substep`

Each part books its own work with the mean of the rates before and after it, so that pseudowork
= delta k_trans and work = delta (k_trans + e_int) hold to round-off at any step.

L. Verlet, Phys. Rev. 159 (1967) 98; G. Strang, SIAM J. Numer. Anal. 5 (1968) 506.
"""

import math
from typing import NamedTuple

import numpy as np

from tribo.integrators.bath_substep import bath_substep, room_for_turns
from tribo.integrators.step_control import (
    advance,
    all_finite,
    end_of_step,
    equal_step,
    equal_step_status,
    nearness,
    record_due,
    time_left,
    update_encounter,
)
from tribo.kernels.compiled import kernel
from tribo.kernels.equations_of_motion import (
    accelerate,
    displacement,
    drive_bar,
    forces,
    gather_contact,
    place_bob,
    update_neighbours,
)
from tribo.kernels.neighbours import crowded, refresh
from tribo.kernels.powers import (
    CONTACT,
    DRIVE,
    POINT,
    SLIDE,
    block_powers,
    field_powers,
    powers_of,
    shared_accounts,
)
from tribo.kernels.status import (
    BOBS_COINCIDE,
    COMPLETED,
    NOT_FINITE,
    PAUSED,
)

# Gauss-Legendre nodes and weights on (0, 1), for the ends of clamped bars that turn.
_ROOT = math.sqrt(0.6)
NODES = np.array([0.5 - 0.5 * _ROOT, 0.5, 0.5 + 0.5 * _ROOT])
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0


class Splitting(NamedTuple):
    """A step as drifts and kicks in turn, drifts first and last, in parts of the step."""

    drifts: np.ndarray  # (kicks + 1,), a palindrome
    kicks: np.ndarray  # (kicks,), a palindrome


def composed(*first: float) -> Splitting:
    """The palindrome of leapfrog steps with these lengths, the last of them in the middle."""
    weights = np.array([*first, *reversed(first[:-1])])
    half = 0.5 * np.concatenate([[0.0], weights, [0.0]])
    return Splitting(half[:-1] + half[1:], weights)


def alternating(drifts: tuple[float, ...], kicks: tuple[float, ...]) -> Splitting:
    """Palindromes from the first drifts and kicks; the drift and kicks in the middle make up 1."""
    middle = 1.0 - 2.0 * sum(drifts)
    last = 0.5 - sum(kicks)
    return Splitting(
        np.array([*drifts, middle, *reversed(drifts)]),
        np.array([*kicks, last, last, *reversed(kicks)]),
    )


@kernel
def rotated(x, rate, frequency, tau):
    """A harmonic oscillator after tau, without the bias of cos^2 + sin^2 != 1."""
    if frequency == 0.0:
        return x + rate * tau, rate
    sin = math.sin(frequency * tau)
    half = math.sin(0.5 * frequency * tau)
    less = 2.0 * half * half
    return (
        x - less * x + sin / frequency * rate,
        rate - less * rate - sin * frequency * x,
    )


@kernel
def arc_work(twist):
    """sin x - x cos x, the integral of x sin x."""
    return math.sin(twist) - twist * math.cos(twist)


@kernel
def book_ends(a, twist, rate, new, new_rate, vx, vy, s):
    """What the ends of a clamped bar at rest do while its pendulum turns from twist to new."""
    k = a.acc_ends
    with_bar = arc_work(new) - arc_work(twist)
    with_bar *= -a.l2 * a.kappa / a.bar_length * a.facing
    impulse = a.inertia * (rate - new_rate) / a.bar_length
    end_x = -impulse * math.sin(a.phi)
    end_y = impulse * math.cos(a.phi)
    s[k] += with_bar
    s[k + 1] -= with_bar
    s[k + 2] += end_x
    s[k + 3] += end_y
    s[k + 4] += end_x * vx + end_y * vy


@kernel
def book_turning_ends(a, twist, rate, frequency, t, tau, vx, vy, s):
    """The same where the bar itself turns uniformly: by Gauss-Legendre quadrature."""
    k = a.acc_ends
    pull = a.kappa / a.bar_length
    for m in range(NODES.size):
        weight = WEIGHTS[m] * tau
        now, now_rate = rotated(twist, rate, frequency, NODES[m] * tau)
        phi = a.phi + a.nu * (t + NODES[m] * tau)
        end_x = -pull * now * math.sin(phi)
        end_y = pull * now * math.cos(phi)
        with_bar = -a.l2 * (now_rate + a.nu) * pull * now * a.facing * math.sin(now)
        s[k] += weight * with_bar
        s[k + 1] -= weight * with_bar
        s[k + 2] += weight * end_x
        s[k + 3] += weight * end_y
        s[k + 4] += weight * (end_x * vx + end_y * vy)


@kernel
def drift_clamped(a, i, t, tau, q, v, s):
    """Pendulum on a bar whose angle moves uniformly."""
    twist = q[i] - (a.phi + a.nu * t)
    rate = v[i] - a.nu
    frequency = math.sqrt(a.kappa / a.inertia)
    new, new_rate = rotated(twist, rate, frequency, tau)
    if a.acc_ends >= 0:
        vx = displacement(a.dof_x, v)
        vy = displacement(a.dof_y, v)
        if a.nu == 0.0:
            book_ends(a, twist, rate, new, new_rate, vx, vy, s)
        else:
            book_turning_ends(a, twist, rate, frequency, t, tau, vx, vy, s)
            turning = 0.5 * a.nu * a.inertia * (rate - new_rate)
            s[a.acc_ends] -= turning
            s[a.acc_ends + 1] -= turning
    q[i] += (new - twist) + a.nu * tau
    v[i] += new_rate - rate


@kernel
def drift_free(a, i, tau, q, v):
    """Pendulum and bar turn against each other about their uniform mean."""
    j = a.dof_phi
    twist = q[i] - q[j]
    rate = v[i] - v[j]
    frequency = math.sqrt(a.kappa * (1.0 / a.inertia + 1.0 / a.i2))
    new, new_rate = rotated(twist, rate, frequency, tau)
    share = a.i2 / (a.inertia + a.i2)
    mean = (a.inertia * v[i] + a.i2 * v[j]) / (a.inertia + a.i2)
    q[i] += mean * tau + share * (new - twist)
    q[j] += mean * tau - (1.0 - share) * (new - twist)
    v[i] += share * (new_rate - rate)
    v[j] -= (1.0 - share) * (new_rate - rate)


@kernel
def drift(model, now, tau, q, v, s):
    """Everything moves by itself for tau, until now, and the bobs with it."""
    for i in range(model.asperites.shape[0]):
        a = model.asperites[i]
        if a.dof_phi >= 0:
            drift_free(a, i, tau, q, v)
        else:
            drift_clamped(a, i, now - tau, tau, q, v, s)
        if a.dof_x >= 0:
            q[a.dof_x] += tau * v[a.dof_x]
        if a.dof_y >= 0:
            q[a.dof_y] += tau * v[a.dof_y]
        place_bob(model, i, now, q)


@kernel
def apply_kick(slot, tau, slope, v, middle):
    """The rate in a slot, if there is one, after the kick and in the middle of it."""
    if slot >= 0:
        middle[slot] = v[slot] + 0.5 * tau * slope[slot]
        v[slot] += tau * slope[slot]


@kernel
def accumulate(slot, width, tau, power, s):
    """What a group of accounts gains in tau, if there is such a group."""
    if slot >= 0:
        for m in range(slot, slot + width):
            s[m] += tau * power[m]


@kernel
def kick(model, t, tau, q, v, s, slope, middle, power, core, common):
    """The forces in place act for tau; they are booked at the mid-kick rates.

    The first `core` rates are the asperites', the last `common` accounts of no single one.
    Asperite by asperite all at once: of many, each is read from memory once.
    """
    gather_contact(model)
    for i in range(model.asperites.shape[0]):
        a = model.asperites[i]
        drive_bar(model, i, t, q)
        accelerate(model, i, 0.0, t, q, slope)
        apply_kick(i, tau, slope, v, middle)
        apply_kick(a.dof_phi, tau, slope, v, middle)
        apply_kick(a.dof_x, tau, slope, v, middle)
        apply_kick(a.dof_y, tau, slope, v, middle)
        powers_of(model, i, 0.0, t, q, middle, power)
        accumulate(a.acc_contact, CONTACT, tau, power, s)
        accumulate(a.acc_slide, SLIDE, tau, power, s)
        accumulate(a.acc_drive, DRIVE, tau, power, s)
        accumulate(a.acc_internal, POINT, tau, power, s)
        accumulate(a.acc_field, POINT, tau, power, s)
    for m in range(core, v.size):
        middle[m] = v[m]
    field_powers(model, model.fields, t, power)
    block_powers(model, t, q, middle, power)
    accumulate(s.size - common, common, tau, power, s)


def composed_steps(model, neighbours, splitting, step, clocks, state, times, record, budget, noise):
    """March through the samples in equal steps of at most `step`; return a status.

    PAUSED after `budget` steps: call again to go on.  The drift that ends a step is done together
    with the one that begins the next.  `noise` is a random Generator.
    """
    clock = clocks[0]
    n = state.y.size // 2
    core = record.y.shape[1] // 2
    q = state.y[:n]
    v = state.y[n:]
    s = state.s
    slope = np.zeros(n)
    middle = np.empty(n)
    power = np.zeros(s.size)
    speeds = np.empty((model.asperites.size, 3))
    turns = room_for_turns(model.bath)
    twists = room_for_turns(model.torsional)
    common = shared_accounts(model, model.fields)
    split = model.bath is not None or model.torsional is not None or model.langevin is not None
    if not update_neighbours(model, neighbours, clock.t, q):
        return PAUSED
    encounter, closest = nearness(model, neighbours, clock.t, state.y, speeds)
    if closest == 0.0:
        return BOBS_COINCIDE
    clock.unseen = 0.0
    for _ in range(budget):
        if clock.sample < times.size and time_left(clock, times[clock.sample]) <= 0.0:
            drift(model, clock.t, clock.owed, q, v, s)
            clock.owed = 0.0
            refresh(model, neighbours)
        left = record_due(model, neighbours, clock, state, times, record)
        if left == 0.0:
            return COMPLETED if all_finite(state.y) else NOT_FINITE
        if crowded(neighbours):
            return PAUSED
        goal = times[clock.sample]
        h = equal_step(left, step)
        status = equal_step_status(h, encounter, times[-1])
        if status != COMPLETED:
            return status
        t = clock.t
        for m in range(splitting.kicks.size):
            tau = splitting.kicks[m] * h
            ahead = splitting.drifts[m] * h
            t += ahead
            drift(model, t, clock.owed + ahead, q, v, s)
            clock.owed = 0.0
            forces(model, neighbours, t, q)
            clock.evaluations += 1
            if split:
                kick(model, t, 0.5 * tau, q, v, s, slope, middle, power, core, common)
                bath_substep(model, tau, q, v, s, turns, twists, noise)
                kick(model, t, 0.5 * tau, q, v, s, slope, middle, power, core, common)
            else:
                kick(model, t, tau, q, v, s, slope, middle, power, core, common)
        clock.owed = splitting.drifts[-1] * h
        advance(clock, end_of_step(clock, goal, h, h == left), h, h == left)
        encounter = update_encounter(model, neighbours, clock, state.y, speeds, h, encounter)
        if clock.unseen == 0.0 and not all_finite(state.y):
            return NOT_FINITE
    return PAUSED
