"""The equations of motion: M q'' = F(q, t), asperite by asperite.

Coordinates q: the swing theta - rest of every asperite, then phi, x and y of those that have
them free.  x and y are displacements from the uniform motion that the centre of mass began with;
where no net force can arise they stay zero, and are no coordinates at all.
"""

import math

from tribo.kernels.compiled import kernel
from tribo.kernels.contact import contact_forces
from tribo.kernels.records import FORCED, PULLED, RIGID


@kernel
def bar_angle(asperite, t, q):
    """phi: a coordinate where the bar is free, uniform where it is clamped."""
    if asperite.dof_phi >= 0:
        return q[asperite.dof_phi]
    return asperite.phi + asperite.nu * t


@kernel
def displacement(slot, q):
    """What is stored in a slot of coordinates or rates; zero where there is none."""
    return q[slot] if slot >= 0 else 0.0


@kernel
def place_bobs(asperites, bobs, t, q):
    """r1 = r_cm + l1 (sin theta, -cos theta)."""
    for i in range(asperites.shape[0]):
        a = asperites[i]
        b = bobs[i]
        b.tx = a.facing * math.cos(q[i])
        b.ty = a.facing * math.sin(q[i])
        b.x = a.x + a.vx * t + displacement(a.dof_x, q) + a.l1 * b.ty
        b.y = a.y + a.vy * t + displacement(a.dof_y, q) - a.l1 * b.tx


@kernel
def drive_forces(asperites, surfaces, bobs, t, q):
    """f2 on every bar, which knows the contact force f1."""
    for k in range(surfaces.shape[0]):
        s = surfaces[k]
        if s.drive == RIGID:
            s.fx = 0.0
            for i in range(s.start, s.stop):
                s.fx += bobs[i].fx
        for i in range(s.start, s.stop):
            a = asperites[i]
            b = bobs[i]
            if s.drive == FORCED:
                b.gx = -b.fx
            elif s.drive == RIGID:
                b.gx = a.mass / s.mass * s.fx - b.fx
            elif s.drive == PULLED:
                stretch = s.speed * t - displacement(a.dof_x, q) + a.l2 * b.ty
                b.gx = s.stiffness * stretch
            else:
                b.gx = 0.0
            b.gy = s.load if s.loaded else -b.fy


@kernel
def forces(model, t, q):
    """Place the bobs; fill in every force on them and on the bars."""
    place_bobs(model.asperites, model.bobs, t, q)
    contact_forces(model.contacts, model.surfaces, model.bobs)
    drive_forces(model.asperites, model.surfaces, model.bobs, t, q)


@kernel
def accelerations(model, t, q, acceleration):
    """q'' from the forces in place.  f_L + f_R = 0: clamped ends turn nothing but the bar."""
    asperites = model.asperites
    bobs = model.bobs
    for i in range(asperites.shape[0]):
        a = asperites[i]
        b = bobs[i]
        torsion = a.kappa * (q[i] - bar_angle(a, t, q))
        torque = a.l1 * (b.tx * b.fx + b.ty * b.fy) - a.l2 * (b.tx * b.gx + b.ty * b.gy)
        acceleration[i] = (torque - torsion) / a.inertia
        if a.dof_phi >= 0:
            acceleration[a.dof_phi] = torsion / a.i2
        if a.dof_x >= 0:
            acceleration[a.dof_x] = (b.fx + b.gx) / a.mass
        if a.dof_y >= 0:
            acceleration[a.dof_y] = (b.fy + b.gy) / a.mass


@kernel
def top_speeds(model, t, q, v, speeds):
    """Velocity of each centre of mass, and the fastest its pendulum can swing the bob about it.

    The second comes from the energy of the swing, so that a pendulum at its turning point is
    not taken for one at rest.
    """
    asperites = model.asperites
    for i in range(asperites.shape[0]):
        a = asperites[i]
        twist = q[i] - bar_angle(a, t, q)
        rate = math.sqrt(v[i] * v[i] + a.kappa / a.inertia * twist * twist)
        speeds[i, 0] = a.vx + displacement(a.dof_x, v)
        speeds[i, 1] = a.vy + displacement(a.dof_y, v)
        speeds[i, 2] = a.l1 * rate
