"""The powers whose time integrals are the ledger's accounts.

The work of each force is integrated in three parts: the impulse J of the force, its work about the
centre of mass, and its pseudowork in the frame of the surface's initial velocity V.  In the
laboratory, work = (about) + V . J + (pseudowork); no digits are lost where V is large.

    contact    Jx, Jy; integrals of f1_x omega t_x and f1_y omega t_y, where t is the unit vector
               along which a growing theta moves the bob: the work about the centre of mass is l1
               times their sum
    slide      pseudowork of f1_x and f1_y, where the centre of mass can leave its uniform motion
    drive      f2 where it is no multiple of f1: Jx, Jy, integral of omega t . f2, pseudowork
    ends       clamped bars: work of f_L, of f_R about the centre of mass, Jx and Jy of f_L (f_R is
               -f_L), pseudowork of f_L
    user_ends  the same of f_L and f_R each: about, about, Jx, Jy, Jx, Jy, pseudowork, pseudowork
    internal   springs and bath on the bar, contact within on the bob: Jx, Jy, about, pseudowork
    field      external fields on the bob: Jx, Jy, about, pseudowork
    thermal    Langevin at the bar: Jx, Jy, about, pseudowork
    moving     of a field: work of the agent that moves it through the laboratory
    block      of a surface: pseudowork of all external forces at the centre of all its masses
"""

import math

from numba import literal_unroll

from tribo.kernels.compiled import kernel
from tribo.kernels.contact import force_within
from tribo.kernels.equations_of_motion import bar_angle, displacement, end_force_sum
from tribo.kernels.fields import field_shift
from tribo.kernels.kinematics import bar_velocity, end_force, rotational_power

# Number of accounts in each group; POINT is that of internal, field and thermal.
CONTACT, SLIDE, DRIVE, ENDS, USER_ENDS, POINT = 4, 2, 4, 5, 8, 4


@kernel
def at_bar(power, k, fx, fy, a, b, omega, vx, vy):
    """Set the powers of Jx, Jy, work about r_cm and pseudowork of a force at the bar's centre."""
    power[k] = fx
    power[k + 1] = fy
    power[k + 2] = rotational_power(-a.l2, omega, b.tx, b.ty, fx, fy)
    power[k + 3] = fx * vx + fy * vy


@kernel
def at_bob(power, k, fx, fy, a, b, omega, vx, vy):
    """Add the powers of a force on the bob to the same four."""
    power[k] += fx
    power[k + 1] += fy
    power[k + 2] += rotational_power(a.l1, omega, b.tx, b.ty, fx, fy)
    power[k + 3] += fx * vx + fy * vy


@kernel
def clear(power, k):
    """Clear the powers of a group of POINT accounts."""
    for m in range(POINT):
        power[k + m] = 0.0


@kernel
def clamped_ends(power, k, a, b, t, q, i, omega, vx, vy):
    """Set the powers of f_L, and of f_R = -f_L about the centre of mass."""
    phi = bar_angle(a, t, q)
    torque = a.kappa * (q[i] - phi)
    end_x, end_y = end_force(torque, a.bar_length, math.sin(phi), math.cos(phi))
    with_bar = rotational_power(-a.l2, omega, b.tx, b.ty, end_x, end_y)
    turning = -0.5 * a.bar_length * (torque / a.bar_length) * a.nu
    power[k] = with_bar + turning
    power[k + 1] = -with_bar + turning
    power[k + 2] = end_x
    power[k + 3] = end_y
    power[k + 4] = end_x * vx + end_y * vy


@kernel
def custom_end_powers(model, end_forces, i, t, q, v, power):
    """Set the powers of a plug-in's forces on the ends of bar i, at r2 + r_L and r2 + r_R."""
    if end_forces is not None:
        a = model.asperites[i]
        if a.acc_user_ends >= 0:
            b = model.bobs[i]
            f = end_forces[i]
            phi = bar_angle(a, t, q)
            nu = displacement(a.dof_phi, v)
            vx = displacement(a.dof_x, v)
            vy = displacement(a.dof_y, v)
            tip_x = -0.5 * a.bar_length * math.sin(phi) * nu
            tip_y = 0.5 * a.bar_length * math.cos(phi) * nu
            bar_x, bar_y = bar_velocity(0.0, 0.0, v[i], a.l2, b.tx, b.ty)
            k = a.acc_user_ends
            power[k] = f.left_x * (bar_x - tip_x) + f.left_y * (bar_y - tip_y)
            power[k + 1] = f.right_x * (bar_x + tip_x) + f.right_y * (bar_y + tip_y)
            power[k + 2] = f.left_x
            power[k + 3] = f.left_y
            power[k + 4] = f.right_x
            power[k + 5] = f.right_y
            power[k + 6] = f.left_x * vx + f.left_y * vy
            power[k + 7] = f.right_x * vx + f.right_y * vy


@kernel
def powers_of(model, i, torsion, t, q, v, power):
    """Set the powers of asperite i's accounts.

    The forces are in place.  `torsion` is 0 where the torsion springs, and the ends that hold them,
    are integrated separately.
    """
    a = model.asperites[i]
    b = model.bobs[i]
    d = model.bars[i]
    omega = v[i]
    vx = displacement(a.dof_x, v)
    vy = displacement(a.dof_y, v)

    k = a.acc_contact
    power[k] = b.fx
    power[k + 1] = b.fy
    power[k + 2] = b.fx * omega * b.tx
    power[k + 3] = b.fy * omega * b.ty
    if a.acc_slide >= 0:
        power[a.acc_slide] = b.fx * vx
        power[a.acc_slide + 1] = b.fy * vy
    if a.acc_drive >= 0:
        k = a.acc_drive
        power[k] = d.gx
        power[k + 1] = d.gy
        power[k + 2] = omega * (b.tx * d.gx + b.ty * d.gy)
        power[k + 3] = d.gx * vx + d.gy * vy
    if a.acc_ends >= 0 and torsion != 0.0:
        clamped_ends(power, a.acc_ends, a, b, t, q, i, omega, vx, vy)
    if model.fields is not None:
        if a.acc_field >= 0:
            clear(power, a.acc_field)
            at_bob(power, a.acc_field, d.ex, d.ey, a, b, omega, vx, vy)
    if a.acc_internal >= 0:
        if model.bonds is not None or model.bath is not None or model.torsional is not None:
            at_bar(power, a.acc_internal, d.hx, d.hy, a, b, omega, vx, vy)
        else:
            clear(power, a.acc_internal)
        fx, fy = force_within(model.inner, i)
        at_bob(power, a.acc_internal, fx, fy, a, b, omega, vx, vy)
    if model.langevin is not None:
        if a.acc_thermal >= 0:
            at_bar(power, a.acc_thermal, d.lx, d.ly, a, b, omega, vx, vy)
    custom_end_powers(model, model.end_forces, i, t, q, v, power)


@kernel
def field_powers(model, fields, t, power):
    """Set the power of the agent that moves a field through the laboratory."""
    if fields is not None:
        for field in literal_unroll(fields):
            if field.account >= 0:
                power[field.account] = 0.0
                shift_x, shift_y = field_shift(field, t)
                for k in range(field.surfaces.shape[0]):
                    s = model.surfaces[field.surfaces[k]]
                    for i in range(s.start, s.stop):
                        b = model.bobs[i]
                        fx, fy = field.potential.force_at(b.x + shift_x, b.y + shift_y)
                        power[field.account] += fx * field.drift[0] + fy * field.drift[1]


@kernel
def shared_accounts(model, fields):
    """Number of accounts of surfaces and of moving fields, which are the last ones."""
    count = 0
    for k in range(model.surfaces.shape[0]):
        if model.surfaces[k].acc_block >= 0:
            count += 1
    if fields is not None:
        for field in literal_unroll(fields):
            if field.account >= 0:
                count += 1
    return count


@kernel
def torsional_powers(model, torsional, t, q, v, power):
    """Add the power of the torsional oscillators on the bars."""
    if torsional is not None:
        for i in range(model.asperites.shape[0]):
            a = model.asperites[i]
            s = model.surfaces[a.surface]
            for n in range(s.torsionals):
                o = torsional[s.first_torsional + n]
                twist = q[a.dof_bath + 2 * s.oscillators + n] - bar_angle(a, t, q)
                torque = o.mass * o.frequency * o.frequency * twist
                power[a.acc_internal + 2] += torque * v[a.dof_phi]


@kernel
def bath_momentum(model, bath, s, v):
    """Momentum of a surface's bath in the surface's first frame."""
    px = 0.0
    py = 0.0
    if bath is not None:
        for i in range(s.start, s.stop):
            k = model.asperites[i].dof_bath
            for n in range(s.oscillators):
                mass = bath[s.first_oscillator + n].mass
                px += mass * v[k + n]
                py += mass * v[k + s.oscillators + n]
    return px, py


@kernel
def momentum(model, s, v):
    """Momentum of a surface and its bath in the surface's first frame."""
    px, py = bath_momentum(model, model.bath, s, v)
    for i in range(s.start, s.stop):
        a = model.asperites[i]
        px += a.mass * displacement(a.dof_x, v)
        py += a.mass * displacement(a.dof_y, v)
    return px, py


@kernel
def external_force(model, s):
    """Sum of f1, f2, field, f_T and a plug-in's forces on ends over a surface."""
    fx = 0.0
    fy = 0.0
    for i in range(s.start, s.stop):
        b = model.bobs[i]
        d = model.bars[i]
        fx += b.fx + d.gx
        fy += b.fy + d.gy
        if model.fields is not None:
            fx += d.ex
            fy += d.ey
        if model.langevin is not None:
            fx += d.lx
            fy += d.ly
        end_x, end_y = end_force_sum(model.end_forces, i)
        fx += end_x
        fy += end_y
    return fx, fy


@kernel
def block_powers(model, v, power):
    """Set the power of each surface's external force at the velocity of its centre of mass."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.acc_block >= 0:
            fx, fy = external_force(model, s)
            px, py = momentum(model, s, v)
            power[s.acc_block] = (fx * px + fy * py) / s.total_mass


@kernel
def all_powers(model, t, q, v, power):
    """Set the powers of all accounts."""
    for i in range(model.asperites.shape[0]):
        powers_of(model, i, 1.0, t, q, v, power)
    field_powers(model, model.fields, t, power)
    torsional_powers(model, model.torsional, t, q, v, power)
    block_powers(model, v, power)
