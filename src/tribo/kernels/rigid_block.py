"""Surfaces whose bars are joined into one rigid body, which moves along x and y: r2_i = R + offset.

With rigid asperites M R'' = F, the sum of the forces on all of them.  Pendulums hang from the
accelerated bars; their coordinates x and y are those of the bars, see `kernels.levers`.  With the
unit vector t along which a growing theta moves a bob, and n the one from the bar to the bob,

    sum over i of (m1 + m2) R'' + m1 length (t theta_i'' - n omega_i^2) = F
    m1 length^2 theta_i'' + m1 length t . R'' = torque_i

so that theta_i'' is eliminated, and R'' follows from the 2 x 2 matrix, sum of m1 + m2 - m1 t t^T.
The force of the constraint on each bar is what its motion leaves over of all others.  Bodies that
turn too are in `kernels.tilting_block`.
"""

from tribo.compiler.jit import apart, inlined
from tribo.compiler.lanes import LANES, broadcast, lane, sum_of_lanes
from tribo.compiler.lanes_memory import pack
from tribo.kernels import equations_of_motion as equations
from tribo.kernels import records as rows
from tribo.kernels.levers import lever_mass
from tribo.kernels.packs import add_vectors, constant, coordinates, vectors
from tribo.kernels.schedule import given_acceleration, rate_of_schedule
from tribo.kernels.tilting_block import accelerate_tilting, add_constraints_of_tilting


@inlined
def pull_back(model, s, i, v):
    """The force along n that keeps the bobs of a pack of pendulums on their circles."""
    tx, ty = vectors(model.directions, i)
    inward = lever_mass(model, s, i) * pack(v, i) * pack(v, i)
    return -inward * ty, inward * tx


@apart
def sum_of_forces(model, s, t, q, v):
    """R'' of a rigid body, drives in place: the sum of all forces, through its mass matrix."""
    zero = broadcast(0.0)
    sum_x = zero
    sum_y = zero
    xx = zero
    xy = zero
    yy = zero
    for i in range(s.start, s.stop, LANES):
        present = pack(model.each[rows.PRESENT], i)
        bob_x, bob_y = equations.bob_forces(model, i)
        x, y = equations.bar_forces(model, i, vectors(model.drive, i))
        x = x + bob_x
        y = y + bob_y
        if s.block == rows.PENDULUMS:
            tx, ty = vectors(model.directions, i)
            lever = lever_mass(model, s, i)
            inverse_length = lever * constant(model, rows.INVERSE_INERTIA, s, i)
            torque = equations.torques(model, s, i, bob_x, bob_y, x, y)
            twist = pack(q, i) - equations.bar_angles(model, s, i, t, q)
            along = (torque - constant(model, rows.KAPPA, s, i) * twist) * inverse_length
            back_x, back_y = pull_back(model, s, i, v)
            x = x - along * tx - back_x
            y = y - along * ty - back_y
            mass = present * constant(model, rows.MASS, s, i)
            bob = present * lever * inverse_length  # m1
            xx = xx + (mass - bob * tx * tx)
            xy = xy - bob * tx * ty
            yy = yy + (mass - bob * ty * ty)
        sum_x = sum_x + present * x
        sum_y = sum_y + present * y
    return (
        (sum_of_lanes(sum_x), sum_of_lanes(sum_y)),
        (sum_of_lanes(xx), sum_of_lanes(xy), sum_of_lanes(yy)),
    )


@apart
def accelerate_blocks(model, t, q, v):
    """Set R'' of all rigid bodies, all forces on their asperites in place."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.block > 0 and s.drive == rows.MOVED:
            ax, ay = given_acceleration(model, s, t)
            s.ax = lane(ax, 0)
            s.ay = lane(ay, 0)
        elif s.tilting > 0:
            accelerate_tilting(model, s, t, q, v)
        elif s.block > 0:
            total, matrix = sum_of_forces(model, s, t, q, v)
            x, y = total
            if s.block == rows.PENDULUMS:
                xx, xy, yy = matrix
                determinant = xx * yy - xy * xy
                s.ax = (yy * x - xy * y) / determinant
                s.ay = (xx * y - xy * x) / determinant
            else:
                # Along an axis without a coordinate, the drive cancels all forces.
                s.ax = x / s.mass if s.dof_x >= 0 else 0.0
                s.ay = y / s.mass if s.dof_y >= 0 else 0.0


@apart
def add_constraints(model, t, q, v):
    """Add the constraint's forces to the internal ones on the bars of all rigid bodies."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.tilting > 0:
            add_constraints_of_tilting(model, s, t, q, v)
        elif s.block > 0:
            for i in range(s.start, s.stop, LANES):
                drive = vectors(model.drive, i)
                swing, _, x, y = equations.accelerations(model, s, i, 1.0, t, q, drive)
                present = pack(model.each[rows.PRESENT], i)
                mass = present * constant(model, rows.MASS, s, i)
                bob_x, bob_y = equations.bob_forces(model, i)
                bar_x, bar_y = equations.bar_forces(model, i, drive)
                fx = mass * x - present * (bob_x + bar_x)
                fy = mass * y - present * (bob_y + bar_y)
                if s.block == rows.PENDULUMS:
                    tx, ty = vectors(model.directions, i)
                    along = present * lever_mass(model, s, i) * swing
                    back_x, back_y = pull_back(model, s, i, v)
                    fx = fx + along * tx + present * back_x
                    fy = fy + along * ty + present * back_y
                # The agent that moves bars exerts what a constraint does on a body's.
                table = model.drive if s.drive == rows.MOVED else model.internal
                add_vectors(table, i, fx, fy)


@apart
def damp_drives(model, t, v):
    """Add the dampers between rigid bodies and their stages to the drives."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.block > 0:
            if s.damping > 0.0 or s.damping_y > 0.0:
                for i in range(s.start, s.stop, LANES):
                    present = pack(model.each[rows.PRESENT], i)
                    speed = broadcast(s.speed)
                    if s.stage_schedule > 0:
                        speed = rate_of_schedule(model.schedules, s.stage_schedule, t)
                    x = s.damping * (speed - coordinates(s.dof_x, s, i, v))
                    y = -s.damping_y * coordinates(s.dof_y, s, i, v)
                    add_vectors(model.drive, i, present * x, present * y)


def join_blocks(model, t, q, v):
    """Set R'' of all rigid bodies and their constraints' forces, all other forces in place."""
    damp_drives(model, t, v)
    accelerate_blocks(model, t, q, v)
    add_constraints(model, t, q, v)
    return 0.0
