"""The equations of motion: M q'' = F(q, q', t), asperite by asperite.

The coordinates q are the swing theta - rest of every asperite, then phi, x and y of those that
have them free, then the baths.  x and y are displacements from the initial uniform motion of the
centre of mass; where no net force can arise they stay zero and are no coordinates.  A bath
oscillator's coordinates are its displacement from the resting bar in the same uniform motion.
"""

import math

from numba import literal_unroll

from tribo.kernels.compiled import kernel, shared_kernel
from tribo.kernels.contact import contact_forces, force_within
from tribo.kernels.fields import field_forces
from tribo.kernels.kinematics import bar_position, bar_velocity, bob_position
from tribo.kernels.langevin import friction_force
from tribo.kernels.neighbours import crowded, refresh
from tribo.kernels.records import FORCED, PULLED, RIGID


@kernel
def bar_angle(asperite, t, q):
    """phi: a coordinate where the bar is free, uniform where it is clamped."""
    if asperite.dof_phi >= 0:
        return q[asperite.dof_phi]
    return asperite.phi + asperite.nu * t


@kernel
def displacement(slot, q):
    """The coordinate or velocity in a slot; 0 where there is none."""
    return q[slot] if slot >= 0 else 0.0


@kernel
def bar_displacement(asperite, q, swing):
    """Displacement of the bar from its rest, in the initial uniform motion.

    The position is r2 = r_cm + l2 (-sin theta, cos theta).
    """
    x = displacement(asperite.dof_x, q) - asperite.l2 * asperite.facing * math.sin(swing)
    half = math.sin(0.5 * swing)
    y = displacement(asperite.dof_y, q) - asperite.l2 * asperite.facing * 2.0 * half * half
    return x, y


@kernel
def place_bob(model, i, t, q):
    """Set position and direction of bob i, and clear its contact force."""
    a = model.asperites[i]
    b = model.bobs[i]
    b.tx = a.facing * math.cos(q[i])
    b.ty = a.facing * math.sin(q[i])
    x = a.x + a.vx * t + displacement(a.dof_x, q)
    y = a.y + a.vy * t + displacement(a.dof_y, q)
    b.x, b.y = bob_position(x, y, a.l1, b.tx, b.ty)
    b.fx = 0.0
    b.fy = 0.0


@shared_kernel
def place_bobs(model, t, q):
    """Set position and direction of every bob."""
    for i in range(model.asperites.shape[0]):
        place_bob(model, i, t, q)


@kernel
def velocity_of_bar(a, b, i, v):
    """Velocity of bar i's centre in the surface's first frame, bobs in place."""
    vx = displacement(a.dof_x, v)
    vy = displacement(a.dof_y, v)
    return bar_velocity(vx, vy, v[i], a.l2, b.tx, b.ty)


@kernel
def clear_internal(bars):
    """Clear the internal forces on the bars."""
    for i in range(bars.shape[0]):
        bars[i].hx = 0.0
        bars[i].hy = 0.0


@kernel
def stretch(bond, asperites, q):
    """(r2_i - r2_j) - (r2_i - r2_j)_rest of a lattice spring."""
    xi, yi = bar_displacement(asperites[bond.i], q, q[bond.i])
    xj, yj = bar_displacement(asperites[bond.j], q, q[bond.j])
    return xi - xj + bond.x, yi - yj + bond.y


@kernel
def spring_forces(model, bonds, q):
    """Add the forces of lattice springs on the bars, f = -k (stretch)."""
    if bonds is not None:
        for m in range(bonds.shape[0]):
            bond = bonds[m]
            x, y = stretch(bond, model.asperites, q)
            one = model.bars[bond.i]
            other = model.bars[bond.j]
            one.hx -= bond.stiffness * x
            one.hy -= bond.stiffness * y
            other.hx += bond.stiffness * x
            other.hy += bond.stiffness * y


@kernel
def bath_forces(model, bath, q):
    """Add the forces of bath oscillators on the bars, f = m w^2 (displacement from the bar)."""
    if bath is not None:
        for i in range(model.asperites.shape[0]):
            a = model.asperites[i]
            s = model.surfaces[a.surface]
            x, y = bar_displacement(a, q, q[i])
            d = model.bars[i]
            for n in range(s.oscillators):
                o = bath[s.first_oscillator + n]
                stiffness = o.mass * o.frequency * o.frequency
                d.hx += stiffness * (q[a.dof_bath + n] - x)
                d.hy += stiffness * (q[a.dof_bath + s.oscillators + n] - y)


@kernel
def friction_forces(model, langevin, v):
    """Set the Langevin friction on the bars, f_T = -gamma (v_bar - u).

    The integrator adds the noise.
    """
    if langevin is not None:
        for i in range(model.asperites.shape[0]):
            a = model.asperites[i]
            b = model.bobs[i]
            s = model.surfaces[a.surface]
            vx, vy = velocity_of_bar(a, b, i, v)
            d = model.bars[i]
            d.lx, d.ly = friction_force(s.gamma, vx, vy, s.reservoir_x, s.reservoir_y)


@kernel
def gather_contact(model):
    """Sum the contact forces on each rigid surface."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.drive == RIGID:
            s.fx = 0.0
            for i in range(s.start, s.stop):
                s.fx += model.bobs[i].fx


@kernel
def drive_bar(model, i, t, q):
    """Set f2 on bar i, contact forces in place."""
    a = model.asperites[i]
    b = model.bobs[i]
    d = model.bars[i]
    s = model.surfaces[a.surface]
    if s.drive == FORCED:
        d.gx = -b.fx
    elif s.drive == RIGID:
        d.gx = a.mass / s.mass * s.fx - b.fx
    elif s.drive == PULLED:
        reach = s.anchor + s.speed * t - displacement(a.dof_x, q) + a.l2 * b.ty
        d.gx = s.stiffness * reach
    else:
        d.gx = 0.0
    d.gy = s.load if s.loaded else -b.fy


@kernel
def drive_forces(model, t, q):
    """Set f2 on every bar."""
    gather_contact(model)
    for i in range(model.asperites.shape[0]):
        drive_bar(model, i, t, q)


@kernel
def custom_drive(model, drives, i, t, q, v):
    """Set f2 by a plug-in: a function of time, of the bar's motion, and of the contact force."""
    if drives is not None:
        a = model.asperites[i]
        for drive in literal_unroll(drives):
            if drive.surface == a.surface:
                b = model.bobs[i]
                s = model.surfaces[a.surface]
                x, y = bar_position(b.x, b.y, a.l1 + a.l2, b.tx, b.ty)
                x = x + drive.origin[0] + drive.velocity[0] * t
                y = y + drive.origin[1] + drive.velocity[1] * t
                vx, vy = velocity_of_bar(a, b, i, v)
                vx += a.vx + drive.velocity[0]
                vy += a.vy + drive.velocity[1]
                gx, gy = drive.plugin.force_on_bar(t, x, y, vx, vy, b.fx, b.fy)
                d = model.bars[i]
                d.gx = gx
                d.gy = s.load if s.loaded else gy


@kernel
def custom_ends(model, ends, i, t, q, v):
    """Set the forces of a plug-in on the ends of bar i: a function of time and of its rotation."""
    if ends is not None:
        a = model.asperites[i]
        for end in literal_unroll(ends):
            if end.surface == a.surface:
                phi = bar_angle(a, t, q)
                nu = displacement(a.dof_phi, v)
                left_x, left_y, right_x, right_y = end.plugin.end_forces(t, phi, nu, q[i] - phi)
                f = model.end_forces[i]
                f.left_x = left_x
                f.left_y = left_y
                f.right_x = right_x
                f.right_y = right_y


@kernel
def custom_forces(model, i, t, q, v):
    """Set all forces of plug-ins on bar i, contact forces in place."""
    custom_drive(model, model.drives, i, t, q, v)
    custom_ends(model, model.ends, i, t, q, v)


@kernel
def update_neighbours(model, neighbours, t, q):
    """Place the bobs and list their neighbours; returns whether there was room for all of them."""
    place_bobs(model, t, q)
    refresh(model, neighbours)
    return not crowded(neighbours)


@kernel
def forces(model, neighbours, t, q):
    """Set the forces that depend on positions alone: contact, fields, springs.

    The bobs are newly placed.
    """
    refresh(model, neighbours)
    contact_forces(model, neighbours)
    field_forces(model, model.fields, t)
    if model.bonds is not None or model.bath is not None:
        clear_internal(model.bars)
    spring_forces(model, model.bonds, q)


@kernel
def end_force_sum(end_forces, i):
    """f_L + f_R of a plug-in on bar i."""
    if end_forces is None:
        return 0.0, 0.0
    f = end_forces[i]
    return f.left_x + f.right_x, f.left_y + f.right_y


@kernel
def add_end_forces(model, end_forces, i, t, q, acceleration):
    """Add the forces of a plug-in on the ends of bar i, f_L and f_R, to q''."""
    if end_forces is not None:
        a = model.asperites[i]
        if a.acc_user_ends >= 0:
            b = model.bobs[i]
            f = end_forces[i]
            fx, fy = end_force_sum(end_forces, i)
            half = 0.5 * a.bar_length
            phi = bar_angle(a, t, q)
            cos = half * math.cos(phi)
            sin = half * math.sin(phi)
            torque = cos * (f.right_y - f.left_y) - sin * (f.right_x - f.left_x)
            acceleration[i] -= a.l2 * (b.tx * fx + b.ty * fy) / a.inertia
            acceleration[a.dof_phi] += torque / a.i2
            acceleration[a.dof_x] += fx / a.mass
            acceleration[a.dof_y] += fy / a.mass


@kernel
def bar_forces(model, i):
    """Force on bar i except at its ends: f2 + f_int + f_T, where the scene has them."""
    d = model.bars[i]
    x = d.gx
    y = d.gy
    if model.bonds is not None or model.bath is not None:
        x += d.hx
        y += d.hy
    if model.langevin is not None:
        x += d.lx
        y += d.ly
    return x, y


@kernel
def bob_forces(model, i):
    """Force on bob i: f1, contact within the surface, and external fields."""
    b = model.bobs[i]
    x, y = force_within(model.inner, i)
    x += b.fx
    y += b.fy
    if model.fields is not None:
        x += model.bars[i].ex
        y += model.bars[i].ey
    return x, y


@kernel
def accelerate(model, i, torsion, t, q, acceleration):
    """Set q'' of asperite i from the forces in place.

    `torsion` is 0 where the torsion springs are integrated separately, and 1 elsewhere.  Clamped
    ends have f_L + f_R = 0, and act on the bar's angle only.
    """
    a = model.asperites[i]
    b = model.bobs[i]
    bob_x, bob_y = bob_forces(model, i)
    bar_x, bar_y = bar_forces(model, i)
    spring = torsion * a.kappa * (q[i] - bar_angle(a, t, q))
    torque = a.l1 * (b.tx * bob_x + b.ty * bob_y) - a.l2 * (b.tx * bar_x + b.ty * bar_y)
    acceleration[i] = (torque - spring) / a.inertia
    if a.dof_phi >= 0:
        acceleration[a.dof_phi] = spring / a.i2
    if a.dof_x >= 0:
        acceleration[a.dof_x] = (bob_x + bar_x) / a.mass
    if a.dof_y >= 0:
        acceleration[a.dof_y] = (bob_y + bar_y) / a.mass
    add_end_forces(model, model.end_forces, i, t, q, acceleration)


@kernel
def bath_accelerations(model, bath, q, acceleration):
    """Set q'' of the bath oscillators, which springs hold to their bars."""
    if bath is not None:
        for i in range(model.asperites.shape[0]):
            a = model.asperites[i]
            s = model.surfaces[a.surface]
            x, y = bar_displacement(a, q, q[i])
            for n in range(s.oscillators):
                kx = a.dof_bath + n
                ky = kx + s.oscillators
                square = bath[s.first_oscillator + n].frequency ** 2
                acceleration[kx] = -square * (q[kx] - x)
                acceleration[ky] = -square * (q[ky] - y)


@kernel
def torsional_accelerations(model, torsional, t, q, acceleration):
    """Set q'' of the torsional oscillators, and add their torque on the bars."""
    if torsional is not None:
        for i in range(model.asperites.shape[0]):
            a = model.asperites[i]
            s = model.surfaces[a.surface]
            torque = 0.0
            for n in range(s.torsionals):
                k = a.dof_bath + 2 * s.oscillators + n
                o = torsional[s.first_torsional + n]
                twist = q[k] - bar_angle(a, t, q)
                acceleration[k] = -o.frequency * o.frequency * twist
                torque += o.mass * o.frequency * o.frequency * twist
            if s.torsionals > 0:
                acceleration[a.dof_phi] += torque / a.i2


@kernel
def equations_of_motion(model, neighbours, t, q, v, acceleration):
    """Set q'' of all coordinates."""
    place_bobs(model, t, q)
    forces(model, neighbours, t, q)
    drive_forces(model, t, q)
    bath_forces(model, model.bath, q)
    friction_forces(model, model.langevin, v)
    for i in range(model.asperites.shape[0]):
        custom_forces(model, i, t, q, v)
        accelerate(model, i, 1.0, t, q, acceleration)
    bath_accelerations(model, model.bath, q, acceleration)
    torsional_accelerations(model, model.torsional, t, q, acceleration)


@kernel
def top_speeds(model, t, q, v, speeds):
    """Set the velocity of each centre of mass, and the largest speed of its bob about it.

    The second follows from the energy of the swing, so a pendulum at its turning point counts with
    the speed that it will have at its rest angle.
    """
    asperites = model.asperites
    for i in range(asperites.shape[0]):
        a = asperites[i]
        twist = q[i] - bar_angle(a, t, q)
        rate = math.sqrt(v[i] * v[i] + a.kappa / a.inertia * twist * twist)
        speeds[i, 0] = a.vx + displacement(a.dof_x, v)
        speeds[i, 1] = a.vy + displacement(a.dof_y, v)
        speeds[i, 2] = a.l1 * rate
