"""Kicks of splitting methods: forces change velocities at fixed coordinates, and do work.

Where baths or reservoirs act in the middle of a kick, the same forces act in both halves.  A force
does its work at the mean velocity of each half: at v + a tau / 4 in the first, where v + a tau / 2
is the velocity before the substep, and at v' + a tau / 4 in the second, where v' is the one after
it.  The mean of both is the mean of the velocities before and after the substep.  Where reservoirs
let the asperites jump, each half has the velocity that makes its jump in a step, too; see `jumps`.
The time is Lanes, as in the equations of motion.
"""

from tribo.compiler.jit import apart, inlined
from tribo.compiler.lanes import broadcast
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.integrators.jumps import add_opposite_works, reservoirs_of, with_jump
from tribo.kernels import equations_of_motion as equations
from tribo.kernels import packs
from tribo.kernels.accounts import Powers
from tribo.kernels.powers import powers_of_pack, shared_powers
from tribo.kernels.user_forces import custom_forces

# Iterations for velocities in the middle of a kick, on which forces of plug-ins may depend.  A
# force that rotates a velocity by z in a kick should not change its square: with one or two
# iterations it does so by z^4 / 4, with three by z^6 / 16.
ITERATIONS = 3
# Parts of a kick: whole, with its works; the first half, and the same forces again, with the works
# of both halves.
WHOLE, FIRST_HALF, AGAIN = range(3)


def settle_custom_forces(model, neighbours, t, tau, q, v, work):
    """Set the forces of plug-ins in the middle of a kick, by iteration of the velocities there."""
    active = packs.active_of(neighbours)
    equations.drive_forces(model, active, t, q)
    custom_forces(model, t, q, v)
    equations.join_blocks(model, t, q, v)
    for _ in range(ITERATIONS):
        equations.accelerate(model, 0.0, t, q, work.acceleration)
        for m in range(model.core):
            work.middle[m] = v[m] + 0.5 * tau * work.acceleration[m]
        custom_forces(model, t, q, work.middle)
        equations.join_blocks(model, t, q, work.middle)
    return 0.0


@inlined
def drive_in_kick(model, s, i, t, q):
    """f2 on a pack of bars, in place where there are plug-ins; kept where powers need it."""
    if model.drives.forces.size > 0:
        return packs.vectors(model.drive, i)
    x, y = equations.drive_of_pack(model, s, i, t, q)
    if s.acc_drive >= 0 or s.acc_block >= 0 or s.fixed > 0:
        packs.set_vectors(model.drive, i, x, y)
    return x, y


@inlined
def kick_slot(slot, s, i, change, v):
    """Change a pack's velocities from `slot` on; returns them in the middle, 0 without."""
    if slot < 0:
        return broadcast(0.0)
    k = slot + i - s.start
    old = pack(v, k)
    set_pack(v, k, old + change)
    return old + 0.5 * change


@inlined
def kick_pack(model, s, i, t, tau, state, work, acceleration):
    """Kick a pack of asperites, and add works at the mid-kick velocities."""
    q, v = packs.halves(state.y)
    reservoirs = reservoirs_of(work.before, state, 2.0 * tau)
    swing, phi, x, y = acceleration
    omega = kick_slot(s.start, s, i, tau * swing, v)
    nu = kick_slot(s.dof_phi, s, i, tau * phi, v)
    vx = broadcast(0.0)
    vy = broadcast(0.0)
    if not packs.keeps_velocity(s):
        vx = kick_slot(s.dof_x, s, i, tau * x, v)
        vy = kick_slot(s.dof_y, s, i, tau * y, v)
    if s.acc_block >= 0:
        packs.set_coordinates(s.dof_x, s, i, work.middle, vx)
        packs.set_coordinates(s.dof_y, s, i, work.middle, vy)
    power = Powers(state.s, tau)
    velocities = with_jump(reservoirs, s, i, (omega, nu, vx, vy))
    powers_of_pack(model, s, i, 0.0, t, q, velocities, power)
    add_opposite_works(model, reservoirs, s, i, acceleration, state.s)


@inlined
def pushed(velocities, tau, acceleration):
    """All velocities of a pack after accelerations have acted for tau."""
    omega, nu, vx, vy = velocities
    swing, phi, x, y = acceleration
    return omega + tau * swing, nu + tau * phi, vx + tau * x, vy + tau * y


@inlined
def mean(one, other):
    """Means of two sets of the four velocities of a pack."""
    a, b, c, d = one
    e, f, g, h = other
    return 0.5 * (a + e), 0.5 * (b + f), 0.5 * (c + g), 0.5 * (d + h)


@inlined
def add_half_shared_works(model, t, tau, state):
    """Add half of the works that are of no asperite: noise changes a surface's momentum."""
    if not packs.absent(model.friction):
        power = Powers(state.s, tau)
        shared_powers(model, t, packs.halves(state.y)[1], power)


@inlined
def kick_piece(model, part, active, piece, t, tau, state, work):
    """Kick a piece of a surface; works are added unless the forces act again."""
    if part == FIRST_HALF:
        kick_first_half(model, active, piece, t, tau, state, work)
        return
    s = model.surfaces[piece.surface]
    q = packs.halves(state.y)[0]
    for n in range(piece.begin, piece.end):
        i = packs.column_of(active, n)
        drive = drive_in_kick(model, s, i, t, q)
        acceleration = equations.accelerations(model, s, i, 0.0, t, q, drive)
        kick_pack(model, s, i, t, tau, state, work, acceleration)


@apart
def kick_first_half(model, active, piece, t, tau, state, work):
    """The same where the forces act again after a substep, which then adds the works."""
    s = model.surfaces[piece.surface]
    q, v = packs.halves(state.y)
    reservoirs = reservoirs_of(work.before, state, 2.0 * tau)
    for n in range(piece.begin, piece.end):
        i = packs.column_of(active, n)
        drive = drive_in_kick(model, s, i, t, q)
        acceleration = equations.accelerations(model, s, i, 0.0, t, q, drive)
        after = pushed(packs.all_coordinates(s, i, v), tau, acceleration)
        packs.set_all(s, i, v, after)
        packs.set_all(s, i, work.middle, with_jump(reservoirs, s, i, after))
        packs.set_all(s, i, work.acceleration, acceleration)
        add_opposite_works(model, reservoirs, s, i, acceleration, state.s)


@apart
def repeat_kick(model, active, t, tau, state, work):
    """The same forces act again for tau; the works of both half kicks are added."""
    q, v = packs.halves(state.y)
    reservoirs = reservoirs_of(work.before, state, 2.0 * tau)
    power = Powers(state.s, 2.0 * tau)
    if packs.absent(model.friction):
        shared_powers(model, t, v, power)
    else:
        add_half_shared_works(model, t, tau, state)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for n in range(*packs.active_range(active, s, k)):
            i = packs.column_of(active, n)
            now = packs.all_coordinates(s, i, v)
            acceleration = packs.all_coordinates(s, i, work.acceleration)
            packs.set_all(s, i, v, pushed(now, tau, acceleration))
            between = mean(
                packs.all_coordinates(s, i, work.middle), with_jump(reservoirs, s, i, now)
            )
            powers_of_pack(model, s, i, 0.0, t, q, between, power)
            add_opposite_works(model, reservoirs, s, i, acceleration, state.s)
