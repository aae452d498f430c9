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

from tribo.integrators.bath_substep import bath_substep
from tribo.integrators.rotations import (
    changes,
    empty_rotations,
    rotation,
    rotation_of,
    set_rotations,
)
from tribo.integrators.step_control import (
    advance_equally,
    all_finite,
    current_encounter,
    equal_step,
    equal_step_status,
    record_due,
    time_left,
    update_encounter,
)
from tribo.kernels.array_pointers import pointers
from tribo.kernels.baths import set_bath_momenta
from tribo.kernels.blocks import clear, coordinates, is_fixed
from tribo.kernels.compiled import inlined, kernel
from tribo.kernels.contact_forces import contact_piece
from tribo.kernels.equations_of_motion import (
    accelerate,
    accelerate_block,
    drive_block,
    drive_forces,
    forces,
    gather_contact,
    place_block,
    update_neighbours,
)
from tribo.kernels.kinematics import end_force, rotational_power
from tribo.kernels.levers import lever_of_bar, pivot_lengths
from tribo.kernels.neighbours import crowded, refresh
from tribo.kernels.powers import Powers, place_of, powers_of_block, shared_powers
from tribo.kernels.records import (
    BAR_LENGTH,
    COS_PHI,
    FREQUENCY,
    I2,
    INERTIA,
    KAPPA,
    NU_START,
    PHI_START,
    SIN_PHI,
    Model,
)
from tribo.kernels.samples import State, copy
from tribo.kernels.simd import LANES
from tribo.kernels.simd_arrays import add_block, block, room, set_block
from tribo.kernels.simd_functions import sine_cosine
from tribo.kernels.status import (
    BOBS_COINCIDE,
    COMPLETED,
    NOT_FINITE,
    PAUSED,
)
from tribo.kernels.team import (
    DRIFT,
    DRIVE,
    KICK,
    PHASE,
    REACTIONS,
    begin_phase,
    end_phase,
    finish_piece,
    next_piece,
    wait_for_piece,
)
from tribo.kernels.user_forces import custom_forces

# Gauss-Legendre nodes and weights on (0, 1), for the ends of clamped bars that rotate.
_ROOT = math.sqrt(0.6)
NODES = np.array([0.5 - 0.5 * _ROOT, 0.5, 0.5 + 0.5 * _ROOT])
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
# Iterations for velocities in the middle of a kick, on which forces of plug-ins may depend.  A
# force that rotates a velocity by z in a kick should not change its square: with one or two
# iterations it does so by z^4 / 4, with three by z^6 / 16.
ITERATIONS = 3


class Work(NamedTuple):
    """Room for what a step computes."""

    acceleration: np.ndarray  # (coordinates,)
    middle: np.ndarray  # (coordinates,) velocities in the middle of a kick
    accounts: np.ndarray  # (accounts,)
    speeds: np.ndarray  # (3, asperites)
    rotations: np.ndarray  # (1, 3, asperites + 8), see `set_rotations`
    bath: np.ndarray  # (kicks, 3, oscillators + 8), since rotations take longer than their use
    torsional: np.ndarray


class Splitting(NamedTuple):
    """A step as alternating drifts and kicks, drifts first and last, in fractions of the step."""

    drifts: np.ndarray  # (kicks + 1,), a palindrome
    kicks: np.ndarray  # (kicks,), a palindrome

    def workspace(self, model: Model, state: State) -> Work:
        """The arrays that a step needs, for Python."""
        n = state.y.size // 2
        return Work(
            room((n,)),
            room((n,)),
            room(state.s.shape),
            room((3, model.asperites.shape[1])),
            empty_rotations(model.asperites, 1),
            empty_rotations(model.bath, self.kicks.size),
            empty_rotations(model.torsional, self.kicks.size),
        )


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


@inlined
def add_end_impulses(model, s, i, impulse, vx, vy, accounts):
    """Add the impulse on the ends of clamped bars at rest, and its pseudowork."""
    a = model.asperites
    sin = block(a[SIN_PHI], i)
    x, y = end_force(impulse, block(a[BAR_LENGTH], i), sin, block(a[COS_PHI], i))
    stride = s.account_stride
    k = place_of(s, s.acc_ends + 2 * stride, i)
    add_block(accounts, k, x)
    add_block(accounts, k + stride, y)
    add_block(accounts, k + 2 * stride, x * vx + y * vy)


@kernel
def settle_end_works(model, q, accounts, arcs):
    """Add the works of the ends of clamped bars at rest since they were last settled.

    They are functions of the angles alone: the integral of x sin x is sin x - x cos x.
    """
    a = model.asperites
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.acc_ends >= 0 and s.turning == 0:
            for i in range(s.start, s.stop, LANES):
                twist = block(q, i) - block(a[PHI_START], i)
                sin, cos = sine_cosine(twist)
                arc = sin - twist * cos
                force = block(a[KAPPA], i) / block(a[BAR_LENGTH], i)
                swept = s.facing * force * (arc - block(arcs, i))
                work = lever_of_bar(model, model.pivots, i) * swept
                m = place_of(s, s.acc_ends, i)
                stride = s.account_stride
                add_block(accounts, m, -work)
                add_block(accounts, m + stride, work)
                add_block(accounts, m + 4 * stride, pivot_lengths(model.pivots, i) * swept)
                set_block(arcs, i, arc)


@kernel
def add_turning_end_works(model, s, i, twist, rate, impulse, t, tau, vx, vy, accounts):
    """Add the works of the ends where clamped bars turn, by Gauss-Legendre quadrature."""
    a = model.asperites
    stiffness = block(a[KAPPA], i)
    bar_length = block(a[BAR_LENGTH], i)
    nu = block(a[NU_START], i)
    stride = s.account_stride
    k = place_of(s, s.acc_ends, i)
    turning = 0.5 * nu * impulse
    add_block(accounts, k, -turning)
    add_block(accounts, k + stride, -turning)
    for m in range(NODES.size):
        weight = WEIGHTS[m] * tau
        turn = rotation(block(a[FREQUENCY], i), NODES[m] * tau)
        change, change_of_rate = changes(twist, rate, turn)
        now = twist + change
        now_rate = rate + change_of_rate
        phi = block(a[PHI_START], i) + nu * (t + NODES[m] * tau)
        sin, cos = sine_cosine(phi)
        x, y = end_force(stiffness * now, bar_length, sin, cos)
        sin, cos = sine_cosine(now + phi)
        tx = s.facing * cos
        ty = s.facing * sin
        swept = weight * rotational_power(1.0, now_rate + nu, tx, ty, x, y)
        with_bar = -lever_of_bar(model, model.pivots, i) * swept
        add_block(accounts, k, with_bar)
        add_block(accounts, k + stride, -with_bar)
        add_block(accounts, k + 2 * stride, weight * x)
        add_block(accounts, k + 3 * stride, weight * y)
        pseudowork = weight * (x * vx + y * vy) + pivot_lengths(model.pivots, i) * swept
        add_block(accounts, k + 4 * stride, pseudowork)


@inlined
def drift_clamped(model, turning, s, i, t, tau, q, v, accounts, turn):
    """Pendulums on bars that rotate uniformly or rest."""
    a = model.asperites
    nu = block(a[NU_START], i)
    old = block(q, i)
    omega = block(v, i)
    twist = old - (block(a[PHI_START], i) + nu * t)
    rate = omega - nu
    change, change_of_rate = changes(twist, rate, turn)
    if s.acc_ends >= 0:
        impulse = 0.0 - block(a[INERTIA], i) * change_of_rate
        vx = coordinates(s.dof_x, s, i, v)
        vy = coordinates(s.dof_y, s, i, v)
        if turning is None:
            add_end_impulses(model, s, i, impulse, vx, vy, accounts)
        elif s.turning == 0:
            add_end_impulses(model, s, i, impulse, vx, vy, accounts)
        else:
            add_turning_end_works(model, s, i, twist, rate, impulse, t, tau, vx, vy, accounts)
    set_block(q, i, old + (change + nu * tau))
    set_block(v, i, omega + change_of_rate)


@inlined
def drift_free(model, s, i, tau, q, v, turn):
    """Pendulums and bars rotate against each other about their uniform mean."""
    k = s.dof_phi + i - s.start
    swing = block(q, i)
    phi = block(q, k)
    omega = block(v, i)
    nu = block(v, k)
    inertia = block(model.asperites[INERTIA], i)
    i2 = block(model.asperites[I2], i)
    change, change_of_rate = changes(swing - phi, omega - nu, turn)
    share = i2 / (inertia + i2)
    mean = (inertia * omega + i2 * nu) / (inertia + i2)
    set_block(q, i, swing + (mean * tau + share * change))
    set_block(q, k, phi + (mean * tau - (1.0 - share) * change))
    set_block(v, i, omega + share * change_of_rate)
    set_block(v, k, nu - (1.0 - share) * change_of_rate)


@inlined
def move(slot, s, i, tau, q, v):
    """Move a block's coordinates from `slot` on at their velocities, if there are any."""
    if slot >= 0:
        k = slot + i - s.start
        add_block(q, k, tau * block(v, k))


@inlined
def drift(model, team, now, tau, state, work):
    """Drift of all asperites for tau, which ends now, and the bobs' places then."""
    set_rotations(model.asperites[FREQUENCY], tau, work.rotations[0])
    if team is None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            drift_part(model, s, s.start, s.stop, now, tau, state, work)
    else:
        share_phase(model, team, DRIFT, now, tau, state, work)


@inlined
def drift_part(model, s, first, last, now, tau, state, work):
    """Drift of the asperites of a surface from `first` to `last`."""
    n = state.y.size // 2
    q = state.y[:n]
    v = state.y[n:]
    for i in range(first, last, LANES):
        turn = rotation_of(work.rotations[0], i)
        if s.dof_phi >= 0:
            drift_free(model, s, i, tau, q, v, turn)
        elif not is_fixed(model.fixed, s):
            drift_clamped(model, model.turning, s, i, now - tau, tau, q, v, state.s, turn)
        move(s.dof_x, s, i, tau, q, v)
        move(s.dof_y, s, i, tau, q, v)
        place_block(model, s, i, now, q)


@inlined
def kick_slot(slot, s, i, tau, acceleration, v, middle):
    """Set a block's velocities from `slot` on, if there are any, after and in the middle."""
    if slot >= 0:
        k = slot + i - s.start
        change = tau * block(acceleration, k)
        old = block(v, k)
        set_block(middle, k, old + 0.5 * change)
        set_block(v, k, old + change)


@kernel
def settle_custom_forces(model, drives, ends, t, tau, q, v, work):
    """Set the forces of plug-ins on the bars for their velocities in the middle of a kick.

    These are found by iteration from the velocities before the kick.
    """
    if drives is not None or ends is not None:
        custom_forces(model, t, q, v)
        for _ in range(ITERATIONS):
            accelerate(model, 0.0, t, q, work.acceleration)
            for m in range(model.core):
                work.middle[m] = v[m] + 0.5 * tau * work.acceleration[m]
            custom_forces(model, t, q, work.middle)


@inlined
def kick_block(model, s, i, t, tau, q, v, work, power):
    """Kick a block of asperites, and add works at the mid-kick velocities."""
    acceleration = work.acceleration
    middle = work.middle
    kick_slot(s.start, s, i, tau, acceleration, v, middle)
    kick_slot(s.dof_phi, s, i, tau, acceleration, v, middle)
    kick_slot(s.dof_x, s, i, tau, acceleration, v, middle)
    kick_slot(s.dof_y, s, i, tau, acceleration, v, middle)
    powers_of_block(model, model.ledger, s, i, 0.0, t, q, middle, power)


@inlined
def kick(model, team, t, tau, state, work):
    """Contact, fields and springs, in place, and the drive act for tau."""
    n = state.y.size // 2
    q = state.y[:n]
    if team is None:
        drive_forces(model, t, q)
    else:
        gather_contact(model)
        share_phase(model, team, DRIVE, t, tau, state, work)
    settle_custom_forces(model, model.drives, model.ends, t, tau, q, state.y[n:], work)
    if team is None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            kick_part(model, s, s.start, s.stop, t, tau, state, work)
    else:
        share_phase(model, team, KICK, t, tau, state, work)
    shared_powers(model, model.ledger, t, work.middle, Powers(state.s, model.sums, tau))


@inlined
def kick_part(model, s, first, last, t, tau, state, work):
    """Kick the asperites of a surface from `first` to `last`."""
    n = state.y.size // 2
    q = state.y[:n]
    power = Powers(state.s, model.sums, tau)
    for i in range(first, last, LANES):
        accelerate_block(model, s, i, 0.0, t, q, work.acceleration)
        kick_block(model, s, i, t, tau, q, state.y[n:], work, power)


@kernel
def share_phase(model, team, phase, t, tau, state, work):
    """Compute all pieces of a phase, together with assistants."""
    team.numbers[0] = t
    team.numbers[1] = tau
    begin_phase(team, phase, team.tiles.shape[0])
    piece = next_piece(team)
    while piece >= 0:
        step_piece(model, team, piece, state, work)
        finish_piece(team)
        piece = next_piece(team)
    end_phase(team)


@kernel
def step_piece(model, team, piece, state, work):
    """Compute a piece of the present phase."""
    s = model.surfaces[team.tiles[piece, 0]]
    first, last = team.tiles[piece, 1], team.tiles[piece, 2]
    phase, t, tau = team.counters[PHASE], team.numbers[0], team.numbers[1]
    if phase == DRIFT:
        drift_part(model, s, first, last, t, tau, state, work)
    elif phase == DRIVE:
        for i in range(first, last, LANES):
            drive_block(model, s, i, t, state.y[: state.y.size // 2])
    else:
        kick_part(model, s, first, last, t, tau, state, work)


def assist(model, neighbours, state, work):
    """Compute pieces of the steps of :func:`splitting_steps`, called at the same time."""
    model, neighbours, state, work = pointers((model, neighbours, state, work))
    assist_team(model, model.team, neighbours, state, work)


@kernel
def assist_team(model, team, neighbours, state, work):
    """Compute pieces until the team is closed."""
    piece = wait_for_piece(team)
    while piece >= 0:
        if team.counters[PHASE] <= REACTIONS:
            contact_piece(model, team, neighbours, piece)
        else:
            step_piece(model, team, piece, state, work)
        finish_piece(team)
        piece = wait_for_piece(team)


@inlined
def repeat_kick(model, drives, ends, t, tau, state, work):
    """The same forces act again for tau; those of plug-ins are for the velocities of now."""
    if drives is not None or ends is not None:
        kick(model, model.team, t, tau, state, work)
        return
    n = state.y.size // 2
    q = state.y[:n]
    v = state.y[n:]
    power = Powers(state.s, model.sums, tau)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for i in range(s.start, s.stop, LANES):
            kick_block(model, s, i, t, tau, q, v, work, power)
    shared_powers(model, model.ledger, t, work.middle, power)


@kernel
def begin(model, neighbours, clock, state, work):
    """The encounter rate and the works of the ends at the start of a run; a status."""
    n = state.y.size // 2
    if not update_neighbours(model, neighbours, clock.t, state.y[:n]):
        return PAUSED
    rate, closest = current_encounter(model, neighbours, clock.t, state.y, work.speeds)
    if closest == 0.0:
        return BOBS_COINCIDE
    clock.encounter_rate = rate
    # The first call sets what works are counted from; the accounts stay as they are.
    copy(state.s, work.accounts)
    settle_end_works(model, state.y[:n], state.s, state.memory[0])
    copy(work.accounts, state.s)
    return COMPLETED


@kernel
def arrive(model, neighbours, clock, state, work):
    """Do the drift that the last step left, for a sample."""
    n = state.y.size // 2
    drift(model, model.team, clock.t, clock.drift_lag, state, work)
    clock.drift_lag = 0.0
    settle_end_works(model, state.y[:n], state.s, state.memory[0])
    refresh(model, neighbours)


@inlined
def has_substep(model):
    """Whether baths or reservoirs act between two half kicks."""
    baths = model.bath is not None or model.torsional is not None
    return baths or model.friction is not None or model.swing_friction is not None


@inlined
def take_step(model, neighbours, splitting, clock, h, state, work, noise):
    """The drifts and kicks of a step, but for its last drift, which is left."""
    n = state.y.size // 2
    q = state.y[:n]
    v = state.y[n:]
    s = state.s
    t = clock.t
    for m in range(splitting.kicks.size):
        tau = splitting.kicks[m] * h
        ahead = splitting.drifts[m] * h
        t += ahead
        drift(model, model.team, t, clock.drift_lag + ahead, state, work)
        clock.drift_lag = 0.0
        forces(model, neighbours, t)
        clock.evaluations += 1
        if has_substep(model):
            kick(model, model.team, t, 0.5 * tau, state, work)
            bath_substep(model, tau, q, v, s, work.bath[m], work.torsional[m], noise)
            repeat_kick(model, model.drives, model.ends, t, 0.5 * tau, state, work)
        else:
            kick(model, model.team, t, tau, state, work)
    clock.drift_lag = splitting.drifts[splitting.kicks.size] * h


def splitting_steps(
    model, neighbours, splitting, step, clocks, state, times, record, budget, noise, work
):
    """Integrate through the sample times in equal steps of at most `step`; return a status.

    PAUSED after `budget` steps: call again to continue.  The drift that ends a step is done
    together with the one that begins the next.  `noise` is a random Generator.
    """
    clock = clocks[0]
    model, neighbours, splitting, state, times, record, work = pointers(
        (model, neighbours, splitting, state, times, record, work)
    )
    last = times[times.size - 1]
    clear(model.friction)
    clear(model.swing_friction)
    set_bath_momenta(model, model.bath, state.y[state.y.size // 2 :])
    if clock.evaluations == 0:
        status = begin(model, neighbours, clock, state, work)
        if status != COMPLETED:
            return status
    for _ in range(budget):
        if crowded(neighbours):
            return PAUSED
        if clock.sample < times.size and time_left(clock, times[clock.sample]) <= 0.0:
            arrive(model, neighbours, clock, state, work)
        left = record_due(model, neighbours, clock, state, times, record)
        if left == 0.0:
            return COMPLETED if all_finite(state.y) else NOT_FINITE
        h, landing = equal_step(clock, left, step)
        status = equal_step_status(clock, h, last)
        if status != COMPLETED:
            return status
        take_step(model, neighbours, splitting, clock, h, state, work, noise)
        advance_equally(clock, times[clock.sample], h, landing)
        updated = update_encounter(model, neighbours, clock, state.y, work.speeds, h)
        if updated and not all_finite(state.y):
            return NOT_FINITE
    return PAUSED
