"""Jumps: displacements by reservoirs that drifts leave out, and the works of forces along them.

With strong friction a velocity is lost within a step, and the drifts before and after the kick
carry the asperite too far.  A jump after the kick makes the displacement of the step right.  Every
force that acts in a kick does work along the jumps before and after it, half of each, so that its
works are those along the path.  The reservoir, which causes the jump, does the opposite work, and
takes up the change of the torsion energy.  So the identities of the ledger hold to round-off.

Half of each jump, since then the sum over steps has no systematic error: with the force F_n of the
nth kick and the displacement d_n between the nth and the next, a linear force does the work
sum F_n (d_{n-1} + d_n) / 2, which is the change of its potential energy.
"""

from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.jit import apart, inlined
from tribo.compiler.lanes import broadcast
from tribo.compiler.lanes_functions import sine_cosine
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.kernels.accounts import add_works
from tribo.kernels.equations_of_motion import bar_angles
from tribo.kernels.kinematics import end_force, rotational_power
from tribo.kernels.levers import levers, pivot_lengths
from tribo.kernels.packs import constant, coordinates, set_coordinates, vectors
from tribo.kernels.records import INERTIA, INVERSE_BAR_LENGTH, KAPPA, L2, MASS
from tribo.kernels.samples import copy


class Reservoirs(NamedTuple):
    before: np.ndarray  # (coordinates,) velocities before the kick; empty without reservoirs
    jumps: np.ndarray  # (coordinates,) the last displacements of coordinates
    tau: Any  # the step [time]


@inlined
def reservoirs_of(before, state, tau):
    """What the reservoirs of a step of length `tau` need; without any, the jumps mean nothing."""
    jumps = state.memory[min(1, state.memory.shape[0] - 1)]
    return Reservoirs(before, jumps, tau)


@inlined
def acts(reservoirs):
    """Whether there are reservoirs."""
    return reservoirs.before.size > 0


@inlined
def keep_velocities(reservoirs, v):
    if acts(reservoirs):
        copy(v, reservoirs.before)


@inlined
def with_jump(reservoirs, s, i, velocities):
    """Velocities of a pack, and those that carry it along its jump in the time of a step."""
    omega, nu, vx, vy = velocities
    if not acts(reservoirs):
        return omega, nu, vx, vy
    rate = 1.0 / reservoirs.tau
    omega = omega + rate * pack(reservoirs.jumps, i)
    vx = vx + rate * coordinates(s.dof_x, s, i, reservoirs.jumps)
    vy = vy + rate * coordinates(s.dof_y, s, i, reservoirs.jumps)
    return omega, nu, vx, vy


@inlined
def add_to_reservoir(s, i, about, pseudowork, accounts):
    """Add works about the centre of mass and pseudoworks of a pack's reservoir."""
    if s.acc_thermal >= 0:
        add_works(accounts, s, s.acc_thermal + 2 * s.account_stride, i, about, pseudowork)
    elif s.acc_swing >= 0:
        add_works(accounts, s, s.acc_swing, i, about)


@inlined
def pseudowork_along_jump(jumps, s, i, px, py):
    """The product of impulses on a pack and the jumps of its centres of mass."""
    return px * coordinates(s.dof_x, s, i, jumps) + py * coordinates(s.dof_y, s, i, jumps)


@inlined
def add_opposite_works(model, reservoirs, s, i, acceleration, accounts):
    """Add the works of a pack's reservoir against the forces of half a kick along its jump."""
    if acts(reservoirs):
        if s.gamma > 0.0 or s.swing_gamma > 0.0:
            add_works_along_jump(model, reservoirs, s, i, acceleration, accounts)


@apart
def add_works_along_jump(model, reservoirs, s, i, acceleration, accounts):
    """The same where the pack has a reservoir."""
    swing, _, x, y = acceleration
    about = broadcast(0.0)
    if s.fixed == 0:
        torque = constant(model, INERTIA, s, i) * swing
        about = 0.5 * torque * pack(reservoirs.jumps, i)
    half = 0.5 * constant(model, MASS, s, i)
    pseudowork = pseudowork_along_jump(reservoirs.jumps, s, i, half * x, half * y)
    add_to_reservoir(s, i, -about, -pseudowork, accounts)


@inlined
def add_bath_works_of_jumps(model, reservoirs, s, i, px, py, accounts):
    """Add the works along the jump of a pack that belong to momenta from a bath.

    They are those of the bath on the bars, and the opposite ones of the reservoir.
    """
    if acts(reservoirs):
        if s.acc_internal >= 0:
            rate = 1.0 / reservoirs.tau
            tx, ty = vectors(model.directions, i)
            swept = rate * (tx * px + ty * py) * pack(reservoirs.jumps, i)
            lever = constant(model, L2, s, i)
            pivot = pivot_lengths(model.pivots, s, i)
            pseudowork = pseudowork_along_jump(reservoirs.jumps, s, i, rate * px, rate * py)
            works = 0.0 - (lever + pivot) * swept, pseudowork + pivot * swept
            add_works(accounts, s, s.acc_internal + 2 * s.account_stride, i, *works)
            add_to_reservoir(s, i, lever * swept, -pseudowork, accounts)


@inlined
def set_jump(model, s, i, t, q, jump, jumps, accounts):
    """Set the jump (angles, x, y) of a pack, and add its works on the torsion."""
    turn, x, y = jump
    set_pack(jumps, i, turn)
    set_coordinates(s.dof_x, s, i, jumps, x)
    set_coordinates(s.dof_y, s, i, jumps, y)
    if s.fixed == 0:
        phi = bar_angles(model, s, i, t, q)
        swing = pack(q, i) + 0.5 * turn  # in the middle of the jump
        torque = constant(model, KAPPA, s, i) * (swing - phi)
        add_to_reservoir(s, i, torque * turn, broadcast(0.0), accounts)
        if s.acc_ends >= 0:
            add_end_works(model, s, i, swing, phi, torque, jumps, accounts)


@inlined
def add_end_works(model, s, i, swing, phi, torque, jumps, accounts):
    """Add the works of the ends of clamped bars along the jump; those of f_R are opposite.

    The works about the centre of mass of bars at rest are functions of the angle.
    """
    x, y = end_force(torque, constant(model, INVERSE_BAR_LENGTH, s, i), *sine_cosine(phi))
    pseudowork = pseudowork_along_jump(jumps, s, i, x, y)
    if s.turning == 1:
        sin, cos = sine_cosine(swing)
        swept = rotational_power(1.0, pack(jumps, i), s.facing * cos, s.facing * sin, x, y)
        with_bar = levers(model, model.pivots, s, i)[1] * swept
        add_works(accounts, s, s.acc_ends, i, -with_bar, with_bar)
        pseudowork = pseudowork + pivot_lengths(model.pivots, s, i) * swept
    add_works(accounts, s, s.acc_ends + 4 * s.account_stride, i, pseudowork)


@inlined
def jump(model, reservoirs, q):
    if acts(reservoirs):
        for m in range(model.core):
            q[m] += reservoirs.jumps[m]
