"""Drifts of splitting methods: torsion springs rotate their pendulums, and nothing else acts.

They are exact for any time.
"""

import math

import numpy as np

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import LANES, broadcast
from tribo.compiler.lanes_functions import sine_cosine
from tribo.compiler.lanes_memory import add_block, block, set_block
from tribo.integrators.bar_pushes import impulse_on_end
from tribo.integrators.rotations import changes, rotation
from tribo.kernels import records as rows
from tribo.kernels.blocks import constant, coordinates, is_fixed, keeps_velocity
from tribo.kernels.equations_of_motion import place_block
from tribo.kernels.kinematics import end_force, rotational_power
from tribo.kernels.levers import lever_of_bar, pivot_lengths
from tribo.kernels.powers import place_of

# Gauss-Legendre nodes and weights on (0, 1), for the ends of clamped bars that rotate.
_ROOT = math.sqrt(0.6)
NODES = np.array([0.5 - 0.5 * _ROOT, 0.5, 0.5 + 0.5 * _ROOT])
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0


@inlined
def add_end_impulses(model, s, i, impulse, v, accounts):
    """Add the impulse on the ends of clamped bars at rest, and its pseudowork."""
    x, y = impulse_on_end(model, s, i, impulse)
    stride = s.account_stride
    k = place_of(s, s.acc_ends + 2 * stride, i)
    # Memory limits the steps of large scenes, so accounts that stay zero are left alone.
    if s.tilted:
        add_block(accounts, k, x)
    add_block(accounts, k + stride, y)
    if not keeps_velocity(s):
        vx, vy = coordinates(s.dof_x, s, i, v), coordinates(s.dof_y, s, i, v)
        add_block(accounts, k + 2 * stride, x * vx + y * vy)


@kernel
def settle_end_works(model, q, accounts, arcs):
    """Add the works of the ends of clamped bars at rest since they were last settled.

    They are functions of the angles alone: the integral of x sin x is sin x - x cos x.
    """
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.acc_ends >= 0 and s.turning == 0:
            for i in range(s.start, s.stop, LANES):
                twist = block(q, i) - constant(model, rows.PHI_START, s, i)
                sin, cos = sine_cosine(twist)
                arc = sin - twist * cos
                force = constant(model, rows.KAPPA, s, i) / constant(model, rows.BAR_LENGTH, s, i)
                swept = s.facing * force * (arc - block(arcs, i))
                work = lever_of_bar(model, model.pivots, s, i) * swept
                m = place_of(s, s.acc_ends, i)
                stride = s.account_stride
                add_block(accounts, m, -work)
                add_block(accounts, m + stride, work)
                add_block(accounts, m + 4 * stride, pivot_lengths(model.pivots, s, i) * swept)
                set_block(arcs, i, arc)


@kernel
def add_turning_end_works(model, s, i, twist, rate, impulse, t, tau, vx, vy, accounts):
    """Add the works of the ends where clamped bars turn, by Gauss-Legendre quadrature."""
    stiffness, frequency = constant(model, rows.KAPPA, s, i), constant(model, rows.FREQUENCY, s, i)
    inverse_length = constant(model, rows.INVERSE_BAR_LENGTH, s, i)
    start, nu = constant(model, rows.PHI_START, s, i), constant(model, rows.NU_START, s, i)
    stride = s.account_stride
    k = place_of(s, s.acc_ends, i)
    turning = 0.5 * nu * impulse
    add_block(accounts, k, -turning)
    add_block(accounts, k + stride, -turning)
    for m in range(NODES.size):
        weight = WEIGHTS[m] * tau
        turn = rotation(frequency, NODES[m] * tau)
        change, change_of_rate = changes(twist, rate, turn)
        now = twist + change
        now_rate = rate + change_of_rate
        phi = start + nu * (t + NODES[m] * tau)
        sin, cos = sine_cosine(phi)
        x, y = end_force(stiffness * now, inverse_length, sin, cos)
        sin, cos = sine_cosine(now + phi)
        tx = s.facing * cos
        ty = s.facing * sin
        swept = weight * rotational_power(1.0, now_rate + nu, tx, ty, x, y)
        with_bar = -lever_of_bar(model, model.pivots, s, i) * swept
        add_block(accounts, k, with_bar)
        add_block(accounts, k + stride, -with_bar)
        add_block(accounts, k + 2 * stride, weight * x)
        add_block(accounts, k + 3 * stride, weight * y)
        pseudowork = weight * (x * vx + y * vy) + pivot_lengths(model.pivots, s, i) * swept
        add_block(accounts, k + 4 * stride, pseudowork)


@inlined
def drift_clamped(model, s, i, t, tau, q, v, turn):
    """Pendulums on bars that rotate uniformly or rest.

    Returns the new swings; twist, its rate, and the change of the rate.
    """
    nu = constant(model, rows.NU_START, s, i)
    old = block(q, i)
    omega = block(v, i)
    twist = old - (constant(model, rows.PHI_START, s, i) + nu * t)
    rate = omega - nu
    change, change_of_rate = changes(twist, rate, turn)
    now = old + (change + nu * tau)
    set_block(q, i, now)
    set_block(v, i, omega + change_of_rate)
    return now, (twist, rate, change_of_rate)


@inlined
def add_end_works(model, turning, s, i, twists, t, tau, v, accounts):
    """Add impulses of the ends of clamped bars in a drift, and works where they turn."""
    twist, rate, change_of_rate = twists
    impulse = 0.0 - constant(model, rows.INERTIA, s, i) * change_of_rate
    if turning is None:
        add_end_impulses(model, s, i, impulse, v, accounts)
    elif s.turning == 0:
        add_end_impulses(model, s, i, impulse, v, accounts)
    else:
        vx, vy = coordinates(s.dof_x, s, i, v), coordinates(s.dof_y, s, i, v)
        add_turning_end_works(model, s, i, twist, rate, impulse, t, tau, vx, vy, accounts)


@inlined
def drift_free(model, s, i, tau, q, v, turn):
    """Pendulums and bars rotate against each other about their uniform mean; the new swings."""
    k = s.dof_phi + i - s.start
    swing = block(q, i)
    phi = block(q, k)
    omega = block(v, i)
    nu = block(v, k)
    inertia, i2 = constant(model, rows.INERTIA, s, i), constant(model, rows.I2, s, i)
    change, change_of_rate = changes(swing - phi, omega - nu, turn)
    share = i2 / (inertia + i2)
    mean = (inertia * omega + i2 * nu) / (inertia + i2)
    now = swing + (mean * tau + share * change)
    set_block(q, i, now)
    set_block(q, k, phi + (mean * tau - (1.0 - share) * change))
    set_block(v, i, omega + share * change_of_rate)
    set_block(v, k, nu - (1.0 - share) * change_of_rate)
    return now


@inlined
def move(slot, s, i, tau, q, v):
    """Move a block's coordinates from `slot` on at their velocities; returns them, 0 without."""
    if slot < 0 or keeps_velocity(s):
        return coordinates(slot, s, i, q)
    k = slot + i - s.start
    now = block(q, k) + tau * block(v, k)
    set_block(q, k, now)
    return now


@inlined
def drift_block(model, s, i, now, tau, q, v, accounts, turn):
    """Drift of a block for tau, which ends now, and the bobs' places then."""
    zero = broadcast(0.0)
    twists = zero, zero, zero
    if s.dof_phi >= 0:
        swing = drift_free(model, s, i, tau, q, v, turn)
    elif is_fixed(model.fixed, s):
        swing = block(q, i)
    else:
        swing, twists = drift_clamped(model, s, i, now - tau, tau, q, v, turn)
    x = move(s.dof_x, s, i, tau, q, v)
    y = move(s.dof_y, s, i, tau, q, v)
    place_block(model, s, i, now, swing, x, y)
    # Works come last, since the next forces do not wait for them.
    if s.acc_ends >= 0 and not is_fixed(model.fixed, s):
        add_end_works(model, model.turning, s, i, twists, now - tau, tau, v, accounts)
