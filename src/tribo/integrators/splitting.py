"""Symmetric splitting: pendulums rotate exactly on their springs; other forces act in kicks.

One step of length h is drift(h/2) kick(h) drift(h/2).  Compositions of it have higher order, and
so have other sequences of drifts and kicks, see :class:`Splitting`.

    drift  every torsion spring rotates its pendulum exactly; centres of mass move uniformly
    kick   contact, drive, field and lattice springs change velocities at fixed coordinates
    bath   inside the kick: baths and reservoirs, bars frozen; see `bath_substep`

Each part adds its own work, by the mean of the velocities before and after it, so that pseudowork
= delta k_trans and work = delta (k_trans + e_int) hold to round-off at any step.

L. Verlet, Phys. Rev. 159 (1967) 98; G. Strang, SIAM J. Numer. Anal. 5 (1968) 506.
"""

import math
from typing import NamedTuple

import numpy as np

from tribo.integrators.bath_substep import bath_substep, empty_rotations
from tribo.integrators.step_control import (
    advance,
    all_finite,
    current_encounter,
    end_of_step,
    equal_step,
    equal_step_status,
    record_due,
    time_left,
    update_encounter,
)
from tribo.kernels.compiled import kernel
from tribo.kernels.equations_of_motion import (
    accelerate,
    custom_forces,
    displacement,
    drive_bar,
    forces,
    gather_contact,
    place_bob,
    update_neighbours,
)
from tribo.kernels.kinematics import end_force, rotational_power
from tribo.kernels.langevin import clear_friction
from tribo.kernels.neighbours import crowded, refresh
from tribo.kernels.powers import (
    CONTACT,
    DRIVE,
    POINT,
    SLIDE,
    USER_ENDS,
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

# Gauss-Legendre nodes and weights on (0, 1), for the ends of clamped bars that rotate.
_ROOT = math.sqrt(0.6)
NODES = np.array([0.5 - 0.5 * _ROOT, 0.5, 0.5 + 0.5 * _ROOT])
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
# Iterations for velocities in the middle of a kick, on which forces of plug-ins may depend.  A
# force that rotates a velocity by z in a kick should not change its square: with one or two
# iterations it does so by z^4 / 4, with three by z^6 / 16.
ITERATIONS = 3


class Splitting(NamedTuple):
    """A step as alternating drifts and kicks, drifts first and last, in fractions of the step."""

    drifts: np.ndarray  # (kicks + 1,), a palindrome
    kicks: np.ndarray  # (kicks,), a palindrome


def composed(*first: float) -> Splitting:
    """The palindrome of leapfrog steps with these lengths, the last of them in the middle."""
    weights = np.array([*first, *reversed(first[:-1])])
    half = 0.5 * np.concatenate([[0.0], weights, [0.0]])
    return Splitting(half[:-1] + half[1:], weights)


def alternating(drifts: tuple[float, ...], kicks: tuple[float, ...]) -> Splitting:
    """Palindromes from the first drifts and kicks; those in the middle make the sums 1."""
    middle = 1.0 - 2.0 * sum(drifts)
    last = 0.5 - sum(kicks)
    return Splitting(
        np.array([*drifts, middle, *reversed(drifts)]),
        np.array([*kicks, last, last, *reversed(kicks)]),
    )


@kernel
def rotated(x, rate, frequency, tau):
    """A harmonic oscillator after tau; the rounding of cos^2 + sin^2 causes no drift of energy."""
    if frequency == 0.0:
        return x + rate * tau, rate
    sin = math.sin(frequency * tau)
    half = math.sin(0.5 * frequency * tau)
    versine = 2.0 * half * half
    return (
        x - versine * x + sin / frequency * rate,
        rate - versine * rate - sin * frequency * x,
    )


@kernel
def arc_work(twist):
    """sin x - x cos x, the integral of x sin x."""
    return math.sin(twist) - twist * math.cos(twist)


@kernel
def add_end_works(a, twist, rate, new, new_rate, vx, vy, s):
    """Add the works of the ends of a clamped bar at rest while its pendulum goes to `new`."""
    k = a.acc_ends
    with_bar = arc_work(new) - arc_work(twist)
    with_bar *= -a.l2 * a.kappa / a.bar_length * a.facing
    impulse = a.inertia * (rate - new_rate)
    end_x, end_y = end_force(impulse, a.bar_length, math.sin(a.phi), math.cos(a.phi))
    s[k] += with_bar
    s[k + 1] -= with_bar
    s[k + 2] += end_x
    s[k + 3] += end_y
    s[k + 4] += end_x * vx + end_y * vy


@kernel
def add_rotating_end_works(a, twist, rate, frequency, t, tau, vx, vy, s):
    """Add them where the bar itself rotates uniformly, by Gauss-Legendre quadrature."""
    k = a.acc_ends
    for m in range(NODES.size):
        weight = WEIGHTS[m] * tau
        now, now_rate = rotated(twist, rate, frequency, NODES[m] * tau)
        phi = a.phi + a.nu * (t + NODES[m] * tau)
        end_x, end_y = end_force(a.kappa * now, a.bar_length, math.sin(phi), math.cos(phi))
        swing = now + phi
        tx = a.facing * math.cos(swing)
        ty = a.facing * math.sin(swing)
        with_bar = rotational_power(-a.l2, now_rate + a.nu, tx, ty, end_x, end_y)
        s[k] += weight * with_bar
        s[k + 1] -= weight * with_bar
        s[k + 2] += weight * end_x
        s[k + 3] += weight * end_y
        s[k + 4] += weight * (end_x * vx + end_y * vy)


@kernel
def drift_clamped(a, i, t, tau, q, v, s):
    """A pendulum on a bar that rotates uniformly."""
    twist = q[i] - (a.phi + a.nu * t)
    rate = v[i] - a.nu
    frequency = math.sqrt(a.kappa / a.inertia)
    new, new_rate = rotated(twist, rate, frequency, tau)
    if a.acc_ends >= 0:
        vx = displacement(a.dof_x, v)
        vy = displacement(a.dof_y, v)
        if a.nu == 0.0:
            add_end_works(a, twist, rate, new, new_rate, vx, vy, s)
        else:
            add_rotating_end_works(a, twist, rate, frequency, t, tau, vx, vy, s)
            bar_work = 0.5 * a.nu * a.inertia * (rate - new_rate)
            s[a.acc_ends] -= bar_work
            s[a.acc_ends + 1] -= bar_work
    q[i] += (new - twist) + a.nu * tau
    v[i] += new_rate - rate


@kernel
def drift_free(a, i, tau, q, v):
    """Pendulum and bar rotate against each other about their uniform mean."""
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
    """Drift of all asperites for tau, which ends now, and the bobs' places then."""
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
def set_middle(slot, tau, acceleration, v, middle):
    """Set the velocity in a slot, if there is one, in the middle of a kick."""
    if slot >= 0:
        middle[slot] = v[slot] + 0.5 * tau * acceleration[slot]


@kernel
def apply_kick(slot, tau, acceleration, v, middle):
    """Set the velocity in a slot, if there is one, after a kick and in the middle of it."""
    if slot >= 0:
        set_middle(slot, tau, acceleration, v, middle)
        v[slot] += tau * acceleration[slot]


@kernel
def settle_custom_forces(model, drives, ends, i, t, tau, q, v, acceleration, middle):
    """Set the forces of plug-ins on bar i for its velocities in the middle of a kick.

    These are found by iteration from the velocities before the kick.
    """
    if drives is not None or ends is not None:
        a = model.asperites[i]
        custom_forces(model, i, t, q, v)
        for _ in range(ITERATIONS):
            accelerate(model, i, 0.0, t, q, acceleration)
            set_middle(i, tau, acceleration, v, middle)
            set_middle(a.dof_phi, tau, acceleration, v, middle)
            set_middle(a.dof_x, tau, acceleration, v, middle)
            set_middle(a.dof_y, tau, acceleration, v, middle)
            custom_forces(model, i, t, q, middle)


@kernel
def accumulate(slot, width, tau, power, s):
    """Add the gain in tau to a group of accounts, if there is such a group."""
    if slot >= 0:
        for m in range(slot, slot + width):
            s[m] += tau * power[m]


@kernel
def kick(model, t, tau, q, v, s, acceleration, middle, power, core, common):
    """The forces in place act for tau; their works are added at the mid-kick velocities.

    The first `core` velocities are those of the asperites; the last `common` accounts belong to no
    single asperite.  One loop does all, so that each of many asperites is read from memory once.
    """
    gather_contact(model)
    for i in range(model.asperites.shape[0]):
        a = model.asperites[i]
        drive_bar(model, i, t, q)
        drives, ends = model.drives, model.ends
        settle_custom_forces(model, drives, ends, i, t, tau, q, v, acceleration, middle)
        accelerate(model, i, 0.0, t, q, acceleration)
        apply_kick(i, tau, acceleration, v, middle)
        apply_kick(a.dof_phi, tau, acceleration, v, middle)
        apply_kick(a.dof_x, tau, acceleration, v, middle)
        apply_kick(a.dof_y, tau, acceleration, v, middle)
        powers_of(model, i, 0.0, t, q, middle, power)
        accumulate(a.acc_contact, CONTACT, tau, power, s)
        accumulate(a.acc_slide, SLIDE, tau, power, s)
        accumulate(a.acc_drive, DRIVE, tau, power, s)
        accumulate(a.acc_internal, POINT, tau, power, s)
        accumulate(a.acc_field, POINT, tau, power, s)
        accumulate(a.acc_user_ends, USER_ENDS, tau, power, s)
    for m in range(core, v.size):
        middle[m] = v[m]
    field_powers(model, model.fields, t, power)
    block_powers(model, middle, power)
    accumulate(s.size - common, common, tau, power, s)


def splitting_steps(
    model, neighbours, splitting, step, clocks, state, times, record, budget, noise
):
    """Integrate through the sample times in equal steps of at most `step`; return a status.

    PAUSED after `budget` steps: call again to continue.  The drift that ends a step is done
    together with the one that begins the next.  `noise` is a random Generator.
    """
    clock = clocks[0]
    n = state.y.size // 2
    core = record.y.shape[1] // 2
    q = state.y[:n]
    v = state.y[n:]
    s = state.s
    acceleration = np.zeros(n)
    middle = np.empty(n)
    power = np.zeros(s.size)
    speeds = np.empty((model.asperites.size, 3))
    rotations = empty_rotations(model.bath)
    torsional_rotations = empty_rotations(model.torsional)
    common = shared_accounts(model, model.fields)
    split = model.bath is not None or model.torsional is not None or model.langevin is not None
    clear_friction(model.bars)
    if clock.evaluations == 0:
        if not update_neighbours(model, neighbours, clock.t, q):
            return PAUSED
        encounter = current_encounter(model, neighbours, clock.t, state.y, speeds)
        clock.encounter_rate, closest = encounter
        if closest == 0.0:
            return BOBS_COINCIDE
    for _ in range(budget):
        if crowded(neighbours):
            return PAUSED
        if clock.sample < times.size and time_left(clock, times[clock.sample]) <= 0.0:
            drift(model, clock.t, clock.drift_lag, q, v, s)
            clock.drift_lag = 0.0
            refresh(model, neighbours)
        left = record_due(model, neighbours, clock, state, times, record)
        if left == 0.0:
            return COMPLETED if all_finite(state.y) else NOT_FINITE
        goal = times[clock.sample]
        h = equal_step(left, step)
        status = equal_step_status(clock, h, times[-1])
        if status != COMPLETED:
            return status
        t = clock.t
        for m in range(splitting.kicks.size):
            tau = splitting.kicks[m] * h
            ahead = splitting.drifts[m] * h
            t += ahead
            drift(model, t, clock.drift_lag + ahead, q, v, s)
            clock.drift_lag = 0.0
            forces(model, neighbours, t, q)
            clock.evaluations += 1
            if split:
                kick(model, t, 0.5 * tau, q, v, s, acceleration, middle, power, core, common)
                bath_substep(model, tau, q, v, s, rotations, torsional_rotations, noise)
                kick(model, t, 0.5 * tau, q, v, s, acceleration, middle, power, core, common)
            else:
                kick(model, t, tau, q, v, s, acceleration, middle, power, core, common)
        clock.drift_lag = splitting.drifts[-1] * h
        advance(clock, end_of_step(clock, goal, h, h == left), h, h == left)
        updated = update_encounter(model, neighbours, clock, state.y, speeds, h)
        if updated and not all_finite(state.y):
            return NOT_FINITE
    return PAUSED
