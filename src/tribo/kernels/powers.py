"""The powers whose time integrals are the ledger's accounts.

Work is booked in three parts, force by force: the impulse J of the force, its work about the
centre of mass, and its pseudowork in the frame of the surface's initial velocity.  With V that
velocity, work = (about) + V . J + (pseudowork there): no digit is lost in a fast frame.

    contact  Jx, Jy; integrals of f1_x omega t_x and f1_y omega t_y, where t is the unit vector
             along which a growing theta moves the bob: the work about the centre of mass is l1
             times their sum
    slide    pseudowork of f1_x and f1_y, where the centre of mass can leave its uniform motion
    drive    f2 where it is more than a part of -f1: Jx, Jy, integral of omega t . f2, pseudowork
    block    pseudowork of all forces on a surface, at the centre of all its masses
    ends     clamped bars: work of f_L, of f_R, Jx and Jy of f_L (f_R = -f_L), pseudowork of f_L
"""

import math

from tribo.kernels.compiled import kernel
from tribo.kernels.motion import bar_angle, displacement

CONTACT, SLIDE, DRIVE, ENDS = 4, 2, 4, 5  # accounts in each group


@kernel
def block_powers(model, v, power):
    """Power of the whole force on each surface at the velocity of its centre of mass."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.acc_block < 0:
            continue
        fx = 0.0
        fy = 0.0
        px = 0.0
        py = 0.0
        for i in range(s.start, s.stop):
            a = model.asperites[i]
            b = model.bobs[i]
            fx += b.fx + b.gx
            fy += b.fy + b.gy
            px += a.mass * displacement(a.dof_x, v)
            py += a.mass * displacement(a.dof_y, v)
        power[s.acc_block] = (fx * px + fy * py) / s.mass


@kernel
def powers(model, t, q, v, power):
    """Fill in the power of every account from the forces in place and the rates v."""
    asperites = model.asperites
    bobs = model.bobs
    block_powers(model, v, power)
    for i in range(asperites.shape[0]):
        a = asperites[i]
        b = bobs[i]
        omega = v[i]
        vx = displacement(a.dof_x, v)
        vy = displacement(a.dof_y, v)

        k = a.acc_contact
        power[k] = b.fx
        power[k + 1] = b.fy
        power[k + 2] = b.fx * omega * b.tx
        power[k + 3] = b.fy * omega * b.ty

        k = a.acc_slide
        if k >= 0:
            power[k] = b.fx * vx
            power[k + 1] = b.fy * vy

        k = a.acc_drive
        if k >= 0:
            power[k] = b.gx
            power[k + 1] = b.gy
            power[k + 2] = omega * (b.tx * b.gx + b.ty * b.gy)
            power[k + 3] = b.gx * vx + b.gy * vy

        k = a.acc_ends
        if k >= 0:
            phi = bar_angle(a, t, q)
            end = a.kappa * (q[i] - phi) / a.bar_length
            end_x = -end * math.sin(phi)
            end_y = end * math.cos(phi)
            with_bar = -a.l2 * omega * (end_x * b.tx + end_y * b.ty)
            turning = -0.5 * a.bar_length * end * a.nu
            power[k] = with_bar + turning
            power[k + 1] = -with_bar + turning
            power[k + 2] = end_x
            power[k + 3] = end_y
            power[k + 4] = end_x * vx + end_y * vy
