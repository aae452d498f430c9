"""Forces of plug-ins on the bars and on their ends, asperite by asperite."""

from numba import literal_unroll

from tribo.compiler.jit import kernel
from tribo.compiler.numbers_in_lanes import lane_of
from tribo.kernels import records as rows
from tribo.kernels.baths import bar_angle
from tribo.kernels.blocks import column_of_constants
from tribo.kernels.kinematics import rod_position, rod_velocity


@kernel
def coordinate(slot, s, i, q):
    """The coordinate or velocity of one asperite, whose surface has them from `slot` on, or 0."""
    return q[slot + i - s.start] if slot >= 0 else 0.0


@kernel
def custom_drives(model, drives, t, q, v):
    """Set f2 by a plug-in: a function of time, of the bar's motion, and of the contact force."""
    if drives is not None:
        a = model.constants
        for drive in literal_unroll(drives):
            s = model.surfaces[drive.surface]
            for i in range(s.start, s.end):
                c = column_of_constants(s, i)
                tx, ty = model.directions[rows.X, i], model.directions[rows.Y, i]
                length = a[rows.L1, c] + a[rows.L2, c]
                x, y = rod_position(model.bobs[rows.X, i], model.bobs[rows.Y, i], -length, tx, ty)
                now = lane_of(t, i)
                x = x + drive.origin[0] + drive.velocity[0] * now
                y = y + drive.origin[1] + drive.velocity[1] * now
                vx, vy = coordinate(s.dof_x, s, i, v), coordinate(s.dof_y, s, i, v)
                vx, vy = rod_velocity(vx, vy, v[i], -a[rows.L2, c], tx, ty)
                vx += s.vx + drive.velocity[0]
                vy += s.vy + drive.velocity[1]
                fx, fy = model.f1[rows.X, i], model.f1[rows.Y, i]
                now = now - drive.begun
                gx, gy = drive.plugin.force_on_bar(now, x, y, vx, vy, fx, fy)
                model.drive[rows.X, i] = gx
                model.drive[rows.Y, i] = s.load if s.loaded else gy


@kernel
def custom_ends(model, ends, t, q, v):
    """Set the forces of a plug-in on the ends of bars: a function of time and of their rotation."""
    if ends is not None:
        for end in literal_unroll(ends):
            s = model.surfaces[end.surface]
            for i in range(s.start, s.end):
                phi = bar_angle(model, s, i, t, q)
                nu = coordinate(s.dof_phi, s, i, v)
                now = lane_of(t, i) - end.begun
                found = end.plugin.end_forces(now, phi, nu, q[i] - phi)
                model.left[rows.X, i], model.left[rows.Y, i] = found[0], found[1]
                model.right[rows.X, i], model.right[rows.Y, i] = found[2], found[3]


@kernel
def custom_forces(model, t, q, v):
    """Set all forces of plug-ins on the bars, contact forces in place."""
    custom_drives(model, model.drives, t, q, v)
    custom_ends(model, model.ends, t, q, v)
