"""Forces of plug-ins on the bars and on their ends, asperite by asperite."""

from numba import literal_unroll

from tribo.compiler.jit import kernel
from tribo.compiler.numbers_in_lanes import lane_of
from tribo.kernels import records as rows
from tribo.kernels.baths import bar_angle
from tribo.kernels.blocks import column_of_constants
from tribo.kernels.kinematics import bar_position, bar_velocity


@kernel
def coordinate(slot, s, i, q):
    """The coordinate or velocity of one asperite, whose surface has them from `slot` on, or 0."""
    return q[slot + i - s.start] if slot >= 0 else 0.0


@kernel
def custom_drives(model, drives, t, q, v):
    """Set f2 by a plug-in: a function of time, of the bar's motion, and of the contact force."""
    if drives is not None:
        a = model.constants
        b = model.bobs
        for drive in literal_unroll(drives):
            s = model.surfaces[drive.surface]
            for i in range(s.start, s.end):
                c = column_of_constants(s, i)
                tx, ty = b[rows.TX, i], b[rows.TY, i]
                x, y = bar_position(
                    b[rows.X, i], b[rows.Y, i], a[rows.L1, c] + a[rows.L2, c], tx, ty
                )
                now = lane_of(t, i)
                x = x + drive.origin[0] + drive.velocity[0] * now
                y = y + drive.origin[1] + drive.velocity[1] * now
                vx, vy = coordinate(s.dof_x, s, i, v), coordinate(s.dof_y, s, i, v)
                vx, vy = bar_velocity(vx, vy, v[i], a[rows.L2, c], tx, ty)
                vx += s.vx + drive.velocity[0]
                vy += s.vy + drive.velocity[1]
                gx, gy = drive.plugin.force_on_bar(now, x, y, vx, vy, b[rows.FX, i], b[rows.FY, i])
                model.drive[rows.ALONG_X, i] = gx
                model.drive[rows.ALONG_Y, i] = s.load if s.loaded else gy


@kernel
def custom_ends(model, ends, t, q, v):
    """Set the forces of a plug-in on the ends of bars: a function of time and of their rotation."""
    if ends is not None:
        for end in literal_unroll(ends):
            s = model.surfaces[end.surface]
            for i in range(s.start, s.end):
                phi = bar_angle(model, s, i, t, q)
                nu = coordinate(s.dof_phi, s, i, v)
                now = lane_of(t, i)
                found = end.plugin.end_forces(now, phi, nu, q[i] - phi)
                left_x, left_y, right_x, right_y = found
                model.end_forces[rows.LEFT_X, i] = left_x
                model.end_forces[rows.LEFT_Y, i] = left_y
                model.end_forces[rows.RIGHT_X, i] = right_x
                model.end_forces[rows.RIGHT_Y, i] = right_y


@kernel
def custom_forces(model, t, q, v):
    """Set all forces of plug-ins on the bars, contact forces in place."""
    custom_drives(model, model.drives, t, q, v)
    custom_ends(model, model.ends, t, q, v)
