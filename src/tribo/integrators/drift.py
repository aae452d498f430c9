"""Drifts of splitting methods: torsion springs rotate their pendulums, and nothing else acts.

They are exact for any time.
"""

import math

import numpy as np

from tribo.compiler.jit import apart, inlined
from tribo.compiler.lanes import LANES, broadcast
from tribo.compiler.lanes_functions import sine_cosine
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.integrators.bar_pushes import impulse_on_end
from tribo.integrators.rotations import changes, rotation
from tribo.kernels import records as rows
from tribo.kernels.accounts import add_works
from tribo.kernels.equations_of_motion import place_pack
from tribo.kernels.kinematics import end_force, rotational_power
from tribo.kernels.levers import levers, pivot_lengths
from tribo.kernels.packs import constant, coordinates, halves, keeps_velocity

# Gauss-Legendre nodes and weights on (0, 1), for the ends of clamped bars that rotate.
_ROOT = math.sqrt(0.6)
NODES = np.array([0.5 - 0.5 * _ROOT, 0.5, 0.5 + 0.5 * _ROOT])
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0


@inlined
def add_end_impulses(model, s, i, impulse, v, accounts):
    """Add the impulse on the ends of clamped bars at rest, and its pseudowork."""
    x, y = impulse_on_end(model, s, i, impulse)
    k = s.acc_ends + 2 * s.account_stride
    # Memory limits the steps of large scenes, so accounts that stay zero are left alone.
    if s.tilted:
        add_works(accounts, s, k, i, x)
    add_works(accounts, s, k + s.account_stride, i, y)
    if not keeps_velocity(s):
        vx = coordinates(s.dof_x, s, i, v)
        vy = coordinates(s.dof_y, s, i, v)
        add_works(accounts, s, k + 2 * s.account_stride, i, x * vx + y * vy)


@inlined
def has_still_ends(s):
    """Whether there are accounts for the ends of clamped bars, which are at rest."""
    return s.acc_ends >= 0 and s.turning == 0


@inlined
def arc_of(model, s, i, q):
    """The integral of x sin x up to the twists of a pack, of which works of ends are multiples."""
    twist = pack(q, i) - constant(model, rows.PHI_START, s, i)
    sin, cos = sine_cosine(twist)
    return sin - twist * cos


@apart
def begin_end_works(model, q, arcs):
    """Count the works of the ends of clamped bars at rest from here on."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if has_still_ends(s):
            for i in range(s.start, s.stop, LANES):
                set_pack(arcs, i, arc_of(model, s, i, q))


@apart
def settle_end_works(model, q, accounts, arcs):
    """Add the works of the ends of clamped bars at rest since they were last settled.

    They are functions of the angles alone.
    """
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if has_still_ends(s):
            for i in range(s.start, s.stop, LANES):
                arc = arc_of(model, s, i, q)
                force = constant(model, rows.KAPPA, s, i) / constant(model, rows.BAR_LENGTH, s, i)
                swept = s.facing * force * (arc - pack(arcs, i))
                work = levers(model, model.pivots, s, i)[1] * swept
                add_works(accounts, s, s.acc_ends, i, -work, work)
                pseudowork = pivot_lengths(model.pivots, s, i) * swept
                add_works(accounts, s, s.acc_ends + 4 * s.account_stride, i, pseudowork)
                set_pack(arcs, i, arc)


@inlined
def end_impulse(model, s, i, change_of_rate):
    """The angular impulse on clamped bars that changes the rates of their twists."""
    return 0.0 - constant(model, rows.INERTIA, s, i) * change_of_rate


@apart
def add_turning_end_works(model, s, i, twists, t, tau, v, accounts):
    """Add the works of the ends where clamped bars turn, by Gauss-Legendre quadrature."""
    twist, rate, change_of_rate = twists
    vx = coordinates(s.dof_x, s, i, v)
    vy = coordinates(s.dof_y, s, i, v)
    stiffness = constant(model, rows.KAPPA, s, i)
    frequency = constant(model, rows.FREQUENCY, s, i)
    inverse_length = constant(model, rows.INVERSE_BAR_LENGTH, s, i)
    start = constant(model, rows.PHI_START, s, i)
    nu = constant(model, rows.NU_START, s, i)
    turning = 0.5 * nu * end_impulse(model, s, i, change_of_rate)
    add_works(accounts, s, s.acc_ends, i, -turning, -turning)
    for m in range(NODES.size):
        weight = WEIGHTS[m] * tau
        turn = rotation(frequency, NODES[m] * tau)
        change, change_by_then = changes(twist, rate, turn)
        now = twist + change
        now_rate = rate + change_by_then
        phi = start + nu * (t + NODES[m] * tau)
        sin, cos = sine_cosine(phi)
        x, y = end_force(stiffness * now, inverse_length, sin, cos)
        sin, cos = sine_cosine(now + phi)
        tx = s.facing * cos
        ty = s.facing * sin
        swept = weight * rotational_power(1.0, now_rate + nu, tx, ty, x, y)
        with_bar = -levers(model, model.pivots, s, i)[1] * swept
        pseudowork = weight * (x * vx + y * vy) + pivot_lengths(model.pivots, s, i) * swept
        works = with_bar, -with_bar, weight * x, weight * y, pseudowork
        add_works(accounts, s, s.acc_ends, i, *works)


@inlined
def drift_clamped(model, s, i, t, tau, q, v, turn):
    """New swings on bars that turn uniformly or rest; twist, its rate, and the rate's change."""
    nu = constant(model, rows.NU_START, s, i)
    old = pack(q, i)
    omega = pack(v, i)
    twist = old - (constant(model, rows.PHI_START, s, i) + nu * t)
    rate = omega - nu
    change, change_of_rate = changes(twist, rate, turn)
    now = old + (change + nu * tau)
    set_pack(q, i, now)
    set_pack(v, i, omega + change_of_rate)
    return now, (twist, rate, change_of_rate)


@inlined
def add_end_works(model, s, i, twists, t, tau, v, accounts):
    """Add impulses of the ends of clamped bars in a drift, and works where they turn."""
    if s.turning == 0:
        impulse = end_impulse(model, s, i, twists[2])
        add_end_impulses(model, s, i, impulse, v, accounts)
    else:
        add_turning_end_works(model, s, i, twists, t, tau, v, accounts)


@apart
def drift_free(model, s, i, tau, q, v, turn):
    """Pendulums and bars rotate against each other about their uniform mean; the new swings."""
    k = s.dof_phi + i - s.start
    swing = pack(q, i)
    phi = pack(q, k)
    omega = pack(v, i)
    nu = pack(v, k)
    inertia = constant(model, rows.INERTIA, s, i)
    i2 = constant(model, rows.I2, s, i)
    change, change_of_rate = changes(swing - phi, omega - nu, turn)
    share = i2 / (inertia + i2)
    mean = (inertia * omega + i2 * nu) / (inertia + i2)
    now = swing + (mean * tau + share * change)
    set_pack(q, i, now)
    set_pack(q, k, phi + (mean * tau - (1.0 - share) * change))
    set_pack(v, i, omega + share * change_of_rate)
    set_pack(v, k, nu - (1.0 - share) * change_of_rate)
    return now


@inlined
def move(slot, s, i, tau, q, v):
    """Move a pack's coordinates from `slot` on at their velocities; returns them, 0 without."""
    if slot < 0 or keeps_velocity(s):
        return coordinates(slot, s, i, q)
    k = slot + i - s.start
    now = pack(q, k) + tau * pack(v, k)
    set_pack(q, k, now)
    return now


@inlined
def drift_pack(model, s, i, now, tau, state, turn):
    """Drift of a pack for tau, which ends now, and the bobs' places then."""
    q, v = halves(state.y)
    zero = broadcast(0.0)
    twists = zero, zero, zero
    if s.dof_phi >= 0:
        swing = drift_free(model, s, i, tau, q, v, turn)
    elif s.fixed > 0:
        swing = pack(q, i)
    else:
        swing, twists = drift_clamped(model, s, i, now - tau, tau, q, v, turn)
    x = move(s.dof_x, s, i, tau, q, v)
    y = move(s.dof_y, s, i, tau, q, v)
    # No splitting method takes blocks that tilt, whose bars' angles have a part in places.
    place_pack(model, s, i, now, swing, zero, x, y)
    # Works come last, since the next forces do not wait for them.
    if s.acc_ends >= 0 and s.fixed == 0:
        add_end_works(model, s, i, twists, now - tau, tau, v, state.s)
