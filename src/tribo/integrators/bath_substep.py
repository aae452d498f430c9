"""Baths and reservoirs on frozen bars: the substep of splitting methods between two half kicks.

    bath   every oscillator rotates exactly about its bar, which takes up the opposite momentum
    noise  Langevin friction and noise on the bars, by its exact solution

Each adds its own work, by the mean of the velocities before and after.

B. Leimkuhler, C. Matthews, Appl. Math. Res. Express 2013 (2013) 34, for the noise.
"""

import math

import numpy as np

from tribo.kernels.compiled import kernel, owning_kernel
from tribo.kernels.equations_of_motion import bar_displacement, velocity_of_bar
from tribo.kernels.langevin import thermal_kick
from tribo.kernels.powers import momentum


@kernel
def push_bar(a, b, px, py, i, v, s, k):
    """Give momentum (px, py) to bar i, frozen in place, and add to the accounts from k on."""
    along = b.tx * px + b.ty * py
    omega = v[i]
    vx = v[a.dof_x]
    vy = v[a.dof_y]
    v[i] -= a.l2 * along / a.inertia
    v[a.dof_x] += px / a.mass
    v[a.dof_y] += py / a.mass
    s[k] += px
    s[k + 1] += py
    s[k + 2] -= a.l2 * along * 0.5 * (omega + v[i])
    s[k + 3] += px * 0.5 * (vx + v[a.dof_x]) + py * 0.5 * (vy + v[a.dof_y])


@kernel
def rotate_oscillators(q, v, start, count, centre, bath, first, rotations):
    """Rotate `count` oscillators about a place; returns the momentum that they gained."""
    gained = 0.0
    for n in range(count):
        k = start + n
        o = bath[first + n]
        x = q[k] - centre
        rate = v[k]
        versine = rotations[first + n, 0]
        sin = rotations[first + n, 1]
        change = -versine * rate - sin * o.frequency * x
        q[k] += sin / o.frequency * rate - versine * x
        v[k] += change
        gained += o.mass * change
    return gained


@owning_kernel
def empty_rotations(bath):
    """Room for `set_rotations`: (oscillators + 1, 2)."""
    if bath is None:
        return np.empty((0, 2))
    return np.full((bath.size + 1, 2), np.nan)


@kernel
def set_rotations(bath, tau, rotations):
    """1 - cos and sin of every oscillator's rotation in tau, which stands in the last row."""
    if rotations[-1, 0] == tau:
        return
    rotations[-1, 0] = tau
    for n in range(bath.shape[0]):
        half = math.sin(0.5 * bath[n].frequency * tau)
        rotations[n, 0] = 2.0 * half * half
        rotations[n, 1] = math.sin(bath[n].frequency * tau)


@kernel
def rotate_bath(model, bath, tau, q, v, s, rotations):
    """Rotate all oscillators exactly, bars frozen; the bars take up the opposite momentum."""
    if bath is not None:
        set_rotations(bath, tau, rotations)
        for i in range(model.asperites.shape[0]):
            a = model.asperites[i]
            count = model.surfaces[a.surface].oscillators
            if count > 0:
                first = model.surfaces[a.surface].first_oscillator
                x, y = bar_displacement(a, q, q[i])
                px = rotate_oscillators(q, v, a.dof_bath, count, x, bath, first, rotations)
                py = rotate_oscillators(q, v, a.dof_bath + count, count, y, bath, first, rotations)
                push_bar(a, model.bobs[i], -px, -py, i, v, s, a.acc_internal)


@kernel
def rotate_torsional(model, torsional, tau, q, v, s, rotations):
    """Rotate all torsional oscillators exactly; the bars take up the opposite angular momentum."""
    if torsional is not None:
        set_rotations(torsional, tau, rotations)
        for i in range(model.asperites.shape[0]):
            a = model.asperites[i]
            surface = model.surfaces[a.surface]
            if surface.torsionals > 0:
                start = a.dof_bath + 2 * surface.oscillators
                first = surface.first_torsional
                gained = rotate_oscillators(
                    q, v, start, surface.torsionals, q[a.dof_phi], torsional, first, rotations
                )
                nu = v[a.dof_phi]
                v[a.dof_phi] -= gained / a.i2
                s[a.acc_internal + 2] -= gained * 0.5 * (nu + v[a.dof_phi])


@kernel
def thermalise(model, langevin, tau, v, s, noise):
    """Langevin friction and noise on the frozen bars, exactly: along the bar's arc and across."""
    if langevin is not None:
        for k in range(model.surfaces.shape[0]):
            surface = model.surfaces[k]
            if surface.gamma == 0.0:
                continue
            before_x, before_y = momentum(model, surface, v)
            for i in range(surface.start, surface.stop):
                a = model.asperites[i]
                b = model.bobs[i]
                vx, vy = velocity_of_bar(a, b, i, v)
                x = vx - surface.reservoir_x
                y = vy - surface.reservoir_y
                arc = 1.0 / a.mass + a.l2 * a.l2 / a.inertia
                across = 1.0 / a.mass
                gamma = surface.gamma
                heat = surface.temperature
                along = thermal_kick(gamma, heat, arc, b.tx * x + b.ty * y, tau, noise)
                side = thermal_kick(gamma, heat, across, b.tx * y - b.ty * x, tau, noise)
                px = along * b.tx - side * b.ty
                py = along * b.ty + side * b.tx
                push_bar(a, b, px, py, i, v, s, a.acc_thermal)
            after_x, after_y = momentum(model, surface, v)
            px = after_x - before_x
            py = after_y - before_y
            s[surface.acc_block] += (
                0.5 * (px * (before_x + after_x) + py * (before_y + after_y)) / surface.total_mass
            )


@kernel
def bath_substep(model, tau, q, v, s, rotations, torsional_rotations, noise):
    """Baths and reservoirs for tau, bars and bobs frozen: symmetric in time."""
    if model.langevin is None:
        rotate_bath(model, model.bath, tau, q, v, s, rotations)
        rotate_torsional(model, model.torsional, tau, q, v, s, torsional_rotations)
    else:
        rotate_bath(model, model.bath, 0.5 * tau, q, v, s, rotations)
        rotate_torsional(model, model.torsional, 0.5 * tau, q, v, s, torsional_rotations)
        thermalise(model, model.langevin, tau, v, s, noise)
        rotate_torsional(model, model.torsional, 0.5 * tau, q, v, s, torsional_rotations)
        rotate_bath(model, model.bath, 0.5 * tau, q, v, s, rotations)
