"""Baths and reservoirs on frozen bars: the substep of splitting methods between two half kicks.

    bath   every oscillator rotates exactly about its bar, which takes up the opposite momentum
    noise  Langevin friction and noise on bars and swings, by the exact solutions

Each adds its own work, by the mean of the velocities before and after.

B. Leimkuhler, C. Matthews, Appl. Math. Res. Express 2013 (2013) 34, for the noise.
"""

from tribo.integrators.rotations import changes, rotation_of, set_rotations
from tribo.kernels.baths import first_slot, torsional_slot
from tribo.kernels.blocks import is_fixed
from tribo.kernels.compiled import inlined, kernel
from tribo.kernels.kinematics import end_force
from tribo.kernels.langevin import thermal_kick
from tribo.kernels.levers import pivot_length
from tribo.kernels.powers import momentum, place_of
from tribo.kernels.records import (
    ALONG_X,
    ALONG_Y,
    BAR_LENGTH,
    COS_PHI,
    I2,
    INERTIA,
    L2,
    MASS,
    OSCILLATOR_FREQUENCY,
    OSCILLATOR_MASS,
    SIN_PHI,
    TX,
    TY,
)
from tribo.kernels.simd import LANES, broadcast, sum_of_lanes
from tribo.kernels.simd_arrays import block, set_block
from tribo.kernels.user_forces import velocity_of_bar


@kernel
def push_bar(model, s, i, px, py, v, accounts, slot):
    """Give momentum (px, py) to bar i, frozen in place, and add to the accounts from `slot` on."""
    a = model.asperites
    along = model.bobs[TX, i] * px + model.bobs[TY, i] * py
    local = i - s.start
    x = s.dof_x + local
    y = s.dof_y + local
    omega = v[i]
    vx = v[x]
    vy = v[y]
    v[i] -= a[L2, i] * along / a[INERTIA, i]
    v[x] += px / a[MASS, i]
    v[y] += py / a[MASS, i]
    if slot < 0:
        return
    stride = s.account_stride
    k = place_of(s, slot, i)
    accounts[k] += px
    accounts[k + stride] += py
    vx = 0.5 * (vx + v[x])
    vy = 0.5 * (vy + v[y])
    swept = along * 0.5 * (omega + v[i])
    pivot = pivot_length(model.pivots, i)
    accounts[k + 2 * stride] -= (a[L2, i] + pivot) * swept
    accounts[k + 3 * stride] += px * vx + py * vy + pivot * swept
    if is_fixed(model.fixed, s):
        x, y = end_force(-a[L2, i] * along, a[BAR_LENGTH, i], a[SIN_PHI, i], a[COS_PHI, i])
        k = place_of(s, s.acc_ends + 2 * stride, i)
        accounts[k] += x
        accounts[k + stride] += y
        accounts[k + 2 * stride] += x * vx + y * vy


@inlined
def rotate_oscillators(q, v, k, centre, turn):
    """Rotate eight oscillators about a place; returns their rates, and how these changed."""
    x = block(q, k)
    rate = block(v, k)
    change, change_of_rate = changes(x - centre, rate, turn)
    rate = rate + change_of_rate
    set_block(q, k, x + change)
    set_block(v, k, rate)
    return rate, change_of_rate


@kernel
def rotate_bath_of(model, bath, s, i, q, v, accounts, rotations):
    """Rotate the oscillators of bar i, which takes up the opposite of the momentum they gain."""
    momentum_x = broadcast(0.0)
    momentum_y = broadcast(0.0)
    slot = first_slot(s, i)
    for m in range(0, s.oscillators, LANES):
        turn = rotation_of(rotations, s.first_oscillator + m)
        mass = block(bath[OSCILLATOR_MASS], s.first_oscillator + m)
        rate, _ = rotate_oscillators(q, v, slot + m, model.displaced[ALONG_X, i], turn)
        momentum_x = momentum_x + mass * rate
        k = slot + s.oscillators + m
        rate, _ = rotate_oscillators(q, v, k, model.displaced[ALONG_Y, i], turn)
        momentum_y = momentum_y + mass * rate
    after_x = sum_of_lanes(momentum_x)
    after_y = sum_of_lanes(momentum_y)
    px = model.bath_momentum[ALONG_X, i] - after_x
    py = model.bath_momentum[ALONG_Y, i] - after_y
    model.bath_momentum[ALONG_X, i] = after_x
    model.bath_momentum[ALONG_Y, i] = after_y
    push_bar(model, s, i, px, py, v, accounts, s.acc_internal)


@kernel
def rotate_bath(model, bath, tau, q, v, accounts, rotations):
    """Rotate all oscillators exactly, bars frozen; the bars take up the opposite momentum."""
    if bath is not None:
        set_rotations(bath[OSCILLATOR_FREQUENCY], tau, rotations)
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.oscillators > 0:
                for i in range(s.start, s.end):
                    rotate_bath_of(model, bath, s, i, q, v, accounts, rotations)


@kernel
def rotate_torsional(model, torsional, tau, q, v, accounts, rotations):
    """Rotate all torsional oscillators exactly; the bars take up the opposite angular momentum."""
    if torsional is not None:
        set_rotations(torsional[OSCILLATOR_FREQUENCY], tau, rotations)
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            first = s.first_torsional
            count = s.torsionals
            if count > 0:
                account = s.acc_internal + 2 * s.account_stride
                for i in range(s.start, s.end):
                    slot = torsional_slot(s, i)
                    j = s.dof_phi + i - s.start
                    gain = broadcast(0.0)
                    for m in range(0, count, LANES):
                        turn = rotation_of(rotations, first + m)
                        _, change = rotate_oscillators(q, v, slot + m, q[j], turn)
                        gain = gain + block(torsional[OSCILLATOR_MASS], first + m) * change
                    gained = sum_of_lanes(gain)
                    nu = v[j]
                    v[j] -= gained / model.asperites[I2, i]
                    if s.acc_internal >= 0:
                        accounts[place_of(s, account, i)] -= gained * 0.5 * (nu + v[j])


@kernel
def damp_swings(model, swing_friction, tau, v, accounts, noise):
    """Langevin friction and noise on the swings, exactly."""
    if swing_friction is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.swing_gamma > 0.0:
                gamma = s.swing_gamma
                for i in range(s.start, s.end):
                    mobility = 1.0 / model.asperites[INERTIA, i]
                    omega = v[i]
                    gained = thermal_kick(gamma, s.temperature, mobility, omega, tau, noise)
                    v[i] += gained * mobility
                    if s.acc_swing >= 0:
                        m = place_of(s, s.acc_swing, i)
                        accounts[m] += gained * 0.5 * (omega + v[i])


@kernel
def thermalise(model, friction, tau, v, accounts, noise):
    """Langevin friction and noise on the frozen bars, exactly: along the bar's arc and across."""
    if friction is not None:
        a = model.asperites
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.gamma == 0.0:
                continue
            before_x, before_y = momentum(model, s, v)
            for i in range(s.start, s.end):
                tx = model.bobs[TX, i]
                ty = model.bobs[TY, i]
                vx, vy = velocity_of_bar(model, s, i, v)
                x = vx - s.reservoir_x
                y = vy - s.reservoir_y
                across = 1.0 / a[MASS, i]
                arc = across + a[L2, i] * a[L2, i] / a[INERTIA, i]
                heat = s.temperature
                along = thermal_kick(s.gamma, heat, arc, tx * x + ty * y, tau, noise)
                side = thermal_kick(s.gamma, heat, across, tx * y - ty * x, tau, noise)
                px = along * tx - side * ty
                py = along * ty + side * tx
                push_bar(model, s, i, px, py, v, accounts, s.acc_thermal)
            after_x, after_y = momentum(model, s, v)
            px = after_x - before_x
            py = after_y - before_y
            if s.acc_block >= 0:
                accounts[s.acc_block] += (
                    0.5 * (px * (before_x + after_x) + py * (before_y + after_y)) / s.total_mass
                )


@kernel
def bath_substep(model, tau, q, v, accounts, rotations, torsional_rotations, noise):
    """Baths and reservoirs for tau, bars and bobs frozen: symmetric in time."""
    if model.friction is None and model.swing_friction is None:
        rotate_bath(model, model.bath, tau, q, v, accounts, rotations)
        rotate_torsional(model, model.torsional, tau, q, v, accounts, torsional_rotations)
    else:
        rotate_bath(model, model.bath, 0.5 * tau, q, v, accounts, rotations)
        rotate_torsional(model, model.torsional, 0.5 * tau, q, v, accounts, torsional_rotations)
        thermalise(model, model.friction, tau, v, accounts, noise)
        damp_swings(model, model.swing_friction, tau, v, accounts, noise)
        rotate_torsional(model, model.torsional, 0.5 * tau, q, v, accounts, torsional_rotations)
        rotate_bath(model, model.bath, 0.5 * tau, q, v, accounts, rotations)
