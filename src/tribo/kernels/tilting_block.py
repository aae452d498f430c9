"""Rigid bodies of bars that turn about z: r2_i = R + e_i, where the arms e_i turn by the tilt chi.

With t and n as in `kernels.rigid_block`, and A_i = R'' + alpha z x e_i - nu^2 e_i the acceleration
of a bar, the constraint exerts on it the force and, as phi_i = chi, the torque

    C_i = (m1 + m2) A_i + m1 length (t theta_i'' - n omega_i^2) - F_i
    c_i = i2 alpha - kappa (theta_i - chi - rest)

of which the sums of C_i and of e_i x C_i + c_i are zero: three equations for R'' and alpha, in
which swings are eliminated as there.  Rigid asperites have theta_i'' = alpha, omega_i = nu, and in
c_i the torque by which the bar holds its rod in place of that of the torsion spring.
"""

from tribo.compiler.jit import apart, inlined
from tribo.compiler.lanes import LANES, broadcast, lane, sum_of_lanes
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.kernels import equations_of_motion as equations
from tribo.kernels import records as rows
from tribo.kernels.arms import accelerations_of_bars
from tribo.kernels.levers import lever_mass
from tribo.kernels.packs import add_vectors, constant, coordinates, plus, vectors


@inlined
def bar_torques(model, s, i, t, q):
    """Torques on a pack of pendulums about their bars, and those of their torsion springs."""
    bob_x, bob_y = equations.bob_forces(model, i)
    bar_x, bar_y = equations.bar_forces(model, i, vectors(model.drive, i))
    torque = equations.torques(model, s, i, bob_x, bob_y, bar_x, bar_y)
    twist = pack(q, i) - equations.bar_angles(model, s, i, t, q)
    return torque, constant(model, rows.KAPPA, s, i) * twist


@inlined
def terms_of_bars(model, s, i, t, q, v):
    """What a pack adds to the equations of the whole: its inertias, forces and torques.

    Inertias are xx, xy, yy, those of x and y with alpha, and that of alpha.
    """
    present = pack(model.each[rows.PRESENT], i)
    mass = present * constant(model, rows.MASS, s, i)
    lever = present * lever_mass(model, s, i)  # m1 length
    tx, ty = vectors(model.directions, i)  # n is (ty, -tx)
    x, y = vectors(model.turned, i)
    torque, spring = bar_torques(model, s, i, t, q)
    bob = equations.bob_forces(model, i)
    fx, fy = plus(bob, equations.bar_forces(model, i, vectors(model.drive, i)))
    fx = present * fx
    fy = present * fy
    inward = s.rate * s.rate
    turning = present * constant(model, rows.I2, s, i)
    if s.block == rows.PENDULUMS:
        inverse_length = lever_mass(model, s, i) * constant(model, rows.INVERSE_INERTIA, s, i)
        bob_mass = lever * inverse_length
        xx = mass - bob_mass * tx * tx
        xy = -bob_mass * tx * ty
        yy = mass - bob_mass * ty * ty
        along = present * (torque - spring) * inverse_length
        away = lever * pack(v, i) * pack(v, i)
        fx = fx - along * tx + away * ty + inward * (xx * x + xy * y)
        fy = fy - along * ty - away * tx + inward * (xy * x + yy * y)
        xa = xy * x - xx * y
        ya = yy * x - xy * y
        aa = turning + ya * x - xa * y
        torque = present * spring + x * fy - y * fx
    else:
        xx = mass
        xy = broadcast(0.0)
        yy = mass
        torque = present * torque + x * fy - y * fx
        fx = fx + inward * (mass * x + lever * ty)
        fy = fy + inward * (mass * y - lever * tx)
        xa = lever * tx - mass * y
        ya = lever * ty + mass * x
        about_bars = mass * (x * x + y * y) + 2.0 * lever * (ty * x - tx * y)
        aa = turning + about_bars + lever * constant(model, rows.L1, s, i)
    return (xx, xy, yy, xa, ya, aa), (fx, fy, torque)


@apart
def accelerate_tilting(model, s, t, q, v):
    """Set R'' and alpha of a body that tilts, all forces on its asperites in place."""
    s.rate = lane(coordinates(s.dof_phi, s, s.start, v), 0)
    zero = broadcast(0.0)
    xx, xy, yy, xa, ya, aa = zero, zero, zero, zero, zero, zero
    fx, fy, torque = zero, zero, zero
    for i in range(s.start, s.stop, LANES):
        inertias, forces = terms_of_bars(model, s, i, t, q, v)
        xx = xx + inertias[0]
        xy = xy + inertias[1]
        yy = yy + inertias[2]
        xa = xa + inertias[3]
        ya = ya + inertias[4]
        aa = aa + inertias[5]
        fx = fx + forces[0]
        fy = fy + forces[1]
        torque = torque + forces[2]
    along = sum_of_lanes(xx), sum_of_lanes(xy), sum_of_lanes(yy)
    with_x = sum_of_lanes(xa)
    with_y = sum_of_lanes(ya)
    # R'' at alpha = 0, and its change with alpha.
    x, y = solved(along, sum_of_lanes(fx), sum_of_lanes(fy))
    by_x, by_y = solved(along, with_x, with_y)
    inertia = sum_of_lanes(aa) - with_x * by_x - with_y * by_y
    s.alpha = (sum_of_lanes(torque) - with_x * x - with_y * y) / inertia
    s.ax = x - s.alpha * by_x
    s.ay = y - s.alpha * by_y


@inlined
def solved(matrix, x, y):
    """The solution of two equations with a symmetric matrix xx, xy, yy."""
    xx, xy, yy = matrix
    determinant = xx * yy - xy * xy
    return (yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant


@apart
def add_constraints_of_tilting(model, s, t, q, v):
    """Add the constraint's forces to the internal ones on the bars of a body; set its torques."""
    for i in range(s.start, s.stop, LANES):
        drive = vectors(model.drive, i)
        swing, turning, _, _ = equations.accelerations(model, s, i, 1.0, t, q, drive)
        present = pack(model.each[rows.PRESENT], i)
        mass = present * constant(model, rows.MASS, s, i)
        lever = present * lever_mass(model, s, i)
        tx, ty = vectors(model.directions, i)
        torque, spring = bar_torques(model, s, i, t, q)
        fx, fy = plus(equations.bob_forces(model, i), equations.bar_forces(model, i, drive))
        x, y = accelerations_of_bars(model, s, i)
        inward = lever * pack(v, i) * pack(v, i)
        along = lever * swing
        held = present * (constant(model, rows.I2, s, i) * turning - spring)
        if s.block == rows.RIGID_ASPERITES:
            about = lever * constant(model, rows.L1, s, i) * turning
            held = held + about + lever * (tx * x + ty * y) - present * torque
        set_pack(model.couples[0], i, held)
        x = mass * x - present * fx + along * tx - inward * ty
        y = mass * y - present * fy + along * ty + inward * tx
        add_vectors(model.internal, i, x, y)
