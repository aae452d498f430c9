"""Symmetric splitting: pendulums rotate exactly on their springs; other forces act in kicks.

One step of length h is drift(h/2) kick(h) drift(h/2).  Compositions of it have higher order, and
so have other sequences of drifts and kicks, see :class:`Splitting`.

    drift  every torsion spring rotates its pendulum exactly; centres of mass move uniformly
    kick   contact, drive, field and lattice springs change velocities at fixed coordinates
    bath   inside the kick: baths and reservoirs, bars frozen; see `bath_substep`, `reservoirs`

Each part adds its own work, by the mean of the velocities before and after it, so that pseudowork
= delta k_trans and work = delta (k_trans + e_int) of each asperite, and W_ps = delta K of each
surface, hold to round-off at any step.  Balances with another potential energy than that of the
torsion springs (contact, fields, lattice springs, baths) have the error of the method.

L. Verlet, Phys. Rev. 159 (1967) 98; G. Strang, SIAM J. Numer. Anal. 5 (1968) 506.
"""

from typing import NamedTuple

import numpy as np

from tribo.compiler import team as teams
from tribo.compiler.jit import apart, inlined
from tribo.compiler.lanes import broadcast, sum_of_lanes
from tribo.compiler.lanes_memory import room
from tribo.compiler.units import call_unit
from tribo.integrators import step_control as control
from tribo.integrators.drift import begin_end_works, drift_pack, settle_end_works
from tribo.integrators.inactive import advance_inactive, make_lists, update_lists
from tribo.integrators.jumps import acts, jump, keep_velocities, reservoirs_of
from tribo.integrators.kicks import (
    AGAIN,
    FIRST_HALF,
    WHOLE,
    add_half_shared_works,
    kick_piece,
    repeat_kick,
)
from tribo.integrators.rotations import empty_rotations, rotation_of, set_active_rotations
from tribo.integrators.stiffness import watch_kick
from tribo.kernels import packs
from tribo.kernels import records as rows
from tribo.kernels.accounts import Powers
from tribo.kernels.baths import set_bath_momenta
from tribo.kernels.contact_forces import contact_piece
from tribo.kernels.equations_of_motion import (
    drive_forces,
    forces,
    gather_contact,
    join_blocks,
    place_bobs,
)
from tribo.kernels.model import Model
from tribo.kernels.neighbours import crowded, has_lists, have_moved, is_empty, list_chunk
from tribo.kernels.powers import shared_powers
from tribo.kernels.samples import State
from tribo.kernels.status import BOBS_COINCIDE, COMPLETED, PAUSED
from tribo.kernels.user_forces import has_customs


class Work(NamedTuple):
    """Room for what a step computes."""

    acceleration: np.ndarray  # (coordinates,)
    middle: np.ndarray  # (coordinates,) velocities in the middle of a kick
    before: np.ndarray  # (coordinates,) and before it; empty where there are no reservoirs
    rotations: np.ndarray  # (1, 3, asperites + 8), see `set_rotations`
    bath: np.ndarray  # (kicks, 3, oscillators + 8), since rotations take longer than their use
    torsional: np.ndarray
    substep: bool  # whether baths or reservoirs act between two half kicks
    twice: bool  # whether the forces of the first half kick act in the second too


class Splitting(NamedTuple):
    """A step as alternating drifts and kicks, drifts first and last, in fractions of the step."""

    drifts: np.ndarray  # (kicks + 1,), a palindrome
    kicks: np.ndarray  # (kicks,), a palindrome

    def workspace(self, model: Model, state: State) -> Work:
        """The memory of a step, and whether reservoirs and baths make it have a substep."""
        n = state.y.size // 2
        damped = model.friction.size + model.swing_friction.size > 0
        substep = damped or model.bath.size + model.torsional.size > 0
        custom = len(model.drives.forces) + len(model.ends.forces) > 0  # whose forces may differ
        return Work(
            room((n,)),
            room((n,)),
            room((n if damped else 0,)),
            empty_rotations(model.constants, 1),
            empty_rotations(model.bath, self.kicks.size),
            empty_rotations(model.torsional, self.kicks.size),
            substep=substep,
            twice=substep and not custom,
        )

    def begin(self, model, neighbours, clock, state, work, speeds):
        """What the first step needs, see :mod:`tribo.integrators.time_loops`; a status."""
        return begin(model, neighbours, clock, state, work, speeds)

    def step(self, model, neighbours, clock, h, end, state, work, noise):
        """The drifts and kicks of a step, but for its last drift, which is left.

        It is done together with the one that begins the next, or for a sample.  `noise` is the
        argument of a random generator.
        """
        take_step(model, neighbours, self, clock, h, state, work, noise)
        return COMPLETED

    def arrive(self, model, neighbours, clock, state, work):
        """Do the drift that the last step left."""
        arrive(model, neighbours, clock, state, work)

    def stays_finite(self, model, state, updated):
        """Whether velocities are finite, which is asked where the encounter rate was `updated`.

        Whatever is not finite reaches the velocities of the asperites within a step.
        """
        return not updated or control.all_finite(packs.halves(state.y)[1][: model.core])


def composed(*first: float) -> Splitting:
    """The palindrome of leapfrog steps with these lengths, the last of them in the middle."""
    weights = np.array([*first, *reversed(first[:-1])])
    half = 0.5 * np.concatenate([[0.0], weights, [0.0]])
    return Splitting(half[:-1] + half[1:], weights)


def alternating(drifts: np.ndarray, kicks: np.ndarray) -> Splitting:
    """Palindromes from the first drifts and kicks; those in the middle make the sums 1."""
    middle = 1.0 - 2.0 * sum(drifts)
    last = 0.5 - sum(kicks)
    return Splitting(
        np.array([*drifts, middle, *reversed(drifts)]),
        np.array([*kicks, last, last, *reversed(kicks)]),
    )


@inlined
def drift(model, neighbours, now, tau, state, work):
    """Drift of all active asperites for tau, which ends now, and the bobs' places then."""
    call_unit(model.units[rows.DRIFT], (model, neighbours, now, tau, state, work))


def drift_unit(model, neighbours, now, tau, state, work):
    """The unit of :func:`drift`."""
    active = packs.active_of(neighbours)
    set_active_rotations(model, active, tau, work.rotations[0])
    if model.team.counters.size == 0:
        for k in range(model.surfaces.shape[0]):
            piece = packs.active_piece(model, active, k)
            drift_piece(model, neighbours, piece, now, tau, state, work)
    else:
        phase = teams.DRIFT, now, tau, state, work
        call_unit(model.units[rows.SHARE_STEP], (model, neighbours, *phase))
    return 0.0


@inlined
def drift_piece(model, neighbours, piece, now, tau, state, work):
    """Drift a piece of a surface; set `crossed` where the lists of neighbours are outdated."""
    s = model.surfaces[piece.surface]
    rotations = work.rotations[0]
    active = packs.active_of(neighbours)
    crossed = broadcast(0.0)
    for n in range(piece.begin, piece.end):
        i = packs.column_of(active, n)
        turn = rotation_of(rotations, packs.column_of_constants(s, i))
        drift_pack(model, s, i, now, tau, state, turn)
        if has_lists(neighbours):
            crossed = crossed + have_moved(model, neighbours.place, neighbours.skin, i)
    if has_lists(neighbours) and sum_of_lanes(crossed) > 0.0:
        neighbours.crossed[0] = 1


@inlined
def kick(model, neighbours, part, t, tau, state, work):
    """Contact, fields and springs, in place, and the drive act for tau; `part` as in `kicks`."""
    call_unit(model.units[rows.KICK], (model, neighbours, part, t, tau, state, work))


def kick_unit(model, neighbours, part, t, tau, state, work):
    """The unit of :func:`kick`."""
    active = packs.active_of(neighbours)
    now = broadcast(t)
    if part == AGAIN:
        repeat_kick(model, active, now, tau, state, work)
        return 0.0
    gather_contact(model, model.members)
    q, v = packs.halves(state.y)
    if has_customs(model):
        call_unit(model.units[rows.SETTLE_CUSTOM_FORCES], (model, neighbours, now, tau, q, v, work))
    elif model.blocks:
        drive_forces(model, active, now, q)
        join_blocks(model, now, q, v)
    if model.team.counters.size == 0:
        for k in range(model.surfaces.shape[0]):
            piece = packs.active_piece(model, active, k)
            kick_piece(model, part, active, piece, now, tau, state, work)
    else:
        phase = teams.KICK, t, tau, state, work
        call_unit(model.units[rows.SHARE_STEP], (model, neighbours, *phase))
    if part == WHOLE:
        shared_powers(model, now, work.middle, Powers(state.s, tau))
    else:
        add_half_shared_works(model, now, tau, state)
    return 0.0


def kick_around_substep(model, neighbours, steps, t, tau, state, work, m, noise):
    """The mth kick in halves, before and after a substep."""
    q, v = packs.halves(state.y)
    reservoirs = reservoirs_of(work.before, state, tau)
    damped = acts(reservoirs)
    bathed = not (packs.absent(model.bath) and packs.absent(model.torsional))
    keep_velocities(reservoirs, v)
    kick(model, neighbours, FIRST_HALF if work.twice else WHOLE, t, 0.5 * tau, state, work)
    turned = 0.5 * tau if damped else tau
    if bathed:
        call_unit(model.units[rows.ROTATE_BATHS], (model, tau, turned, state, work, m))
    if damped:
        call_unit(model.units[rows.DAMP], (model, t, tau, state, work, noise))
        if bathed:
            call_unit(model.units[rows.ROTATE_BATHS], (model, tau, turned, state, work, m))
    kick(model, neighbours, AGAIN if work.twice else WHOLE, t, 0.5 * tau, state, work)
    if damped:
        if m == 0:
            watch_kick(model, steps, q, state.memory, work.acceleration)
    jump(model, reservoirs, q)
    return 0.0


def share_step(model, neighbours, phase, t, tau, state, work):
    """Compute all pieces of a drift or kick, together with assistants."""
    team = model.team
    team.numbers[0] = t
    team.numbers[1] = tau
    piece = teams.begin_phase(team, phase, team.tiles.shape[0])
    while piece >= 0:
        step_piece(model, neighbours, team, piece, state, work)
        piece = teams.continue_phase(team)
    return 0.0


@apart
def step_piece(model, neighbours, team, number, state, work):
    """A thread's piece of a drift or a kick, by its number and the phase that the team is in."""
    active = packs.active_of(neighbours)
    whole = packs.active_piece(model, active, team.tiles[number, 0])
    tile, tiles = team.tiles[number, 1], team.tiles[number, 2]
    piece = packs.Piece(whole.surface, *teams.part_of(whole.begin, whole.end, tile, tiles))
    phase = team.counters[teams.PHASE]
    t = team.numbers[0]
    tau = team.numbers[1]
    if phase == teams.DRIFT:
        drift_piece(model, neighbours, piece, t, tau, state, work)
    else:
        part = FIRST_HALF if work.twice else WHOLE
        kick_piece(model, part, active, piece, broadcast(t), tau, state, work)


def assist(model, neighbours, state, work):
    """Compute pieces of the steps of another thread's loop until the team is closed."""
    team = model.team
    rank = teams.next_rank(team)
    piece = teams.wait_for_piece(team, rank)
    while piece >= 0:
        if team.counters[teams.PHASE] == teams.LISTS:
            list_chunk(model, team, neighbours, piece)
        elif team.counters[teams.PHASE] <= teams.REACTIONS:
            contact_piece(model, team, neighbours, piece)
        else:
            step_piece(model, neighbours, team, piece, state, work)
        teams.finish_piece(team)
        piece = teams.wait_for_piece(team, rank)


@apart
def begin(model, neighbours, clock, state, work, speeds):
    """What a call of a loop begins with, and at the start of a run the encounter rate; a status."""
    work.rotations[0, 0, model.constants.shape[1]] = np.nan  # other packs may have become active
    packs.clear(model.friction)
    packs.clear(model.swing_friction)
    q, v = packs.halves(state.y)
    set_bath_momenta(model, v)
    if clock.evaluations > 0:
        return COMPLETED
    place_bobs(model, broadcast(clock.t), q)
    if is_empty(neighbours):
        make_lists(model, neighbours, clock.t, state)
    if crowded(neighbours):
        return PAUSED
    rate, closest = control.current_encounter(model, neighbours, clock.t, state.y, speeds)
    if closest == 0.0:
        return BOBS_COINCIDE
    clock.encounter_rate = rate
    begin_end_works(model, q, state.memory[0])
    return COMPLETED


@apart
def arrive(model, neighbours, clock, state, work):
    """Do the drift that the last step left, for a sample."""
    active = packs.active_of(neighbours)
    drift(model, neighbours, clock.t, clock.drift_lag, state, work)
    clock.drift_lag = 0.0
    advance_inactive(model, neighbours, clock.t, state)
    settle_end_works(model, packs.halves(state.y)[0], state.s, state.memory[0])
    update_lists(model, neighbours, active, clock.t, state)


@inlined
def take_step(model, neighbours, splitting, clock, h, state, work, noise):
    """The drifts and kicks of a step, but for its last drift, which is left.

    A kick is made in halves before and after a substep, where there is one.
    """
    t = clock.t
    active = packs.active_of(neighbours)
    for m in range(splitting.kicks.size):
        tau = splitting.kicks[m] * h
        ahead = splitting.drifts[m] * h
        t += ahead
        drift(model, neighbours, t, clock.drift_lag + ahead, state, work)
        clock.drift_lag = 0.0
        if has_lists(neighbours):
            update_lists(model, neighbours, active, t, state)
        forces(model, neighbours, broadcast(t))
        clock.evaluations += 1
        if work.substep:
            step = clock.steps, t, tau, state, work, m, noise
            call_unit(model.units[rows.KICK_AROUND], (model, neighbours, *step))
        else:
            kick(model, neighbours, WHOLE, t, tau, state, work)
    clock.drift_lag = splitting.drifts[splitting.kicks.size] * h
