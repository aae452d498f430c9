"""Forces of plug-ins on the bars and on their ends, asperite by asperite."""

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import LANES
from tribo.compiler.numbers_in_lanes import lane_of
from tribo.compiler.units import call_unit, fetched
from tribo.kernels import records as rows
from tribo.kernels.baths import bar_angle
from tribo.kernels.kinematics import rod_position, rod_velocity
from tribo.kernels.packs import column_of_constants
from tribo.kernels.schedule import scheduled


@kernel
def coordinate(slot, s, i, q):
    """The coordinate or velocity of one asperite, whose surface has them from `slot` on, or 0."""
    return q[slot + i - s.start] if slot >= 0 else 0.0


@kernel
def load_or(model, s, gy, t, i):
    """f2_y on a bar: the load of its surface, or `gy` without one."""
    if s.load_schedule > 0:
        return lane_of(scheduled(model.schedules, s.load_schedule, t), i % LANES)
    return s.load if s.loaded else gy


@kernel
def share_among_bars(model, s, gx, gy, t):
    """Set f2 on each bar of a rigid body to these equal parts; s.load is such a part."""
    for i in range(s.start, s.end):
        model.drive[rows.X, i] = gx
        model.drive[rows.Y, i] = load_or(model, s, gy, t, i)


def custom_drive_unit(model, plugin, n, t, q, v):
    """Set f2 by a plug-in: a function of time, of the bar's motion, and of the contact force."""
    plugin = fetched(plugin)
    constants = model.constants
    drives = model.drives
    s = model.surfaces[drives.surface[n]]
    count = float(s.end - s.start)
    sum_x = 0.0
    sum_y = 0.0
    sum_fx = 0.0
    sum_fy = 0.0
    for i in range(s.start, s.end):
        column = column_of_constants(s, i)
        l1 = constants[rows.L1, column]
        l2 = constants[rows.L2, column]
        tx = model.directions[rows.X, i]
        ty = model.directions[rows.Y, i]
        x, y = rod_position(model.bobs[rows.X, i], model.bobs[rows.Y, i], -(l1 + l2), tx, ty)
        now = lane_of(t, i)
        x = x + drives.origin[n, rows.X] + drives.velocity[n, rows.X] * now
        y = y + drives.origin[n, rows.Y] + drives.velocity[n, rows.Y] * now
        vx = coordinate(s.dof_x, s, i, v)
        vy = coordinate(s.dof_y, s, i, v)
        vx, vy = rod_velocity(vx, vy, v[i], -l2, tx, ty)
        vx += s.vx + drives.velocity[n, rows.X]
        vy += s.vy + drives.velocity[n, rows.Y]
        fx = model.f1[rows.X, i]
        fy = model.f1[rows.Y, i]
        now = now - drives.begun[n]
        if s.block > 0:
            # The plug-in drives the whole, from the mean place of the bars and all of contact.
            sum_x += x
            sum_y += y
            sum_fx += fx
            sum_fy += fy
            if i < s.end - 1:
                continue
            x = sum_x / count
            y = sum_y / count
            fx = sum_fx
            fy = sum_fy
        gx, gy = plugin.force_on_bar(now, x, y, vx, vy, fx, fy)
        if s.block > 0:
            share_among_bars(model, s, gx / count, gy / count, t)
        else:
            model.drive[rows.X, i] = gx
            model.drive[rows.Y, i] = load_or(model, s, gy, t, i)
    return 0.0


def custom_ends_unit(model, plugin, n, t, q, v):
    """Set the forces of a plug-in on the ends of bars: a function of time and of their rotation."""
    plugin = fetched(plugin)
    s = model.surfaces[model.ends.surface[n]]
    for i in range(s.start, s.end):
        phi = bar_angle(model, s, i, t, q)
        nu = coordinate(s.dof_phi, s, i, v)
        now = lane_of(t, i) - model.ends.begun[n]
        found = plugin.end_forces(now, phi, nu, q[i] - phi)
        model.left[rows.X, i] = found[0]
        model.left[rows.Y, i] = found[1]
        model.right[rows.X, i] = found[2]
        model.right[rows.Y, i] = found[3]
    return 0.0


@inlined
def has_customs(model):
    """Whether plug-ins act on bars or their ends."""
    return model.drives.forces.size + model.ends.forces.size > 0


@kernel
def set_customs(model, customs, t, q, v):
    for n in range(customs.forces.size):
        call_unit(customs.forces[n], (model, customs.numbers[n], n, t, q, v))


@apart
def custom_forces(model, t, q, v):
    """Set all forces of plug-ins on the bars, contact forces in place."""
    set_customs(model, model.drives, t, q, v)
    set_customs(model, model.ends, t, q, v)
