"""Baths and reservoirs on frozen bars: the substep of splitting methods between two half kicks.

    bath   every oscillator rotates exactly about its bar, which takes up the opposite momentum
    noise  Langevin friction and noise on bars and swings, by the exact solutions

Each adds its own work, by the mean of the velocities before and after.

B. Leimkuhler, C. Matthews, Appl. Math. Res. Express 2013 (2013) 34, for the noise.
"""

from tribo.integrators.rotations import changes, rotation_of, set_rotations
from tribo.kernels.baths import first_slot, torsional_slot
from tribo.kernels.blocks import (
    column_of_constants,
    coordinates,
    is_fixed,
    keeps_velocity,
    own_number,
    set_vectors,
    vectors,
)
from tribo.kernels.compiled import inlined, kernel
from tribo.kernels.equations_of_motion import velocities_of_bars
from tribo.kernels.kinematics import end_force
from tribo.kernels.langevin import normals, pairs_of_normals, thermal_kicks
from tribo.kernels.levers import pivot_lengths
from tribo.kernels.numbers_in_lanes import add_numbers
from tribo.kernels.powers import momentum, place_of
from tribo.kernels.records import (
    ALONG_X,
    ALONG_Y,
    COS_PHI,
    I2,
    INVERSE_BAR_LENGTH,
    INVERSE_INERTIA,
    INVERSE_MASS,
    L2,
    OSCILLATOR_FREQUENCY,
    OSCILLATOR_MASS,
    OWN_GAMMA,
    OWN_SWING_GAMMA,
    OWN_TEMPERATURE,
    PRESENT,
    SIN_PHI,
    TX,
    TY,
)
from tribo.kernels.simd import LANES, broadcast, sum_of_lanes, with_lane
from tribo.kernels.simd_arrays import add_block, block, set_block


@inlined
def push_bars(model, s, i, px, py, v, accounts, slot):
    """Give momenta (px, py) to a block of bars, frozen in place.

    The works are added to the accounts from `slot` on.
    """
    a = model.constants
    c = column_of_constants(s, i)
    along = block(model.bobs[TX], i) * px + block(model.bobs[TY], i) * py
    omega = block(v, i)
    change = 0.0 - block(a[L2], c) * along * block(a[INVERSE_INERTIA], c)
    change_x = px * block(a[INVERSE_MASS], c)
    change_y = py * block(a[INVERSE_MASS], c)
    vx = coordinates(s.dof_x, s, i, v) + 0.5 * change_x
    vy = coordinates(s.dof_y, s, i, v) + 0.5 * change_y
    set_block(v, i, omega + change)
    if not keeps_velocity(s):
        add_block(v, s.dof_x + i - s.start, change_x)
        add_block(v, s.dof_y + i - s.start, change_y)
    if slot < 0:
        return
    stride = s.account_stride
    k = place_of(s, slot, i)
    swept = along * (omega + 0.5 * change)
    pivot = pivot_lengths(model.pivots, s, i)
    add_block(accounts, k, px)
    add_block(accounts, k + stride, py)
    add_block(accounts, k + 2 * stride, 0.0 - (block(a[L2], c) + pivot) * swept)
    add_block(accounts, k + 3 * stride, px * vx + py * vy + pivot * swept)
    if is_fixed(model.fixed, s):
        torque = 0.0 - block(a[L2], c) * along
        x, y = end_force(
            torque, block(a[INVERSE_BAR_LENGTH], c), block(a[SIN_PHI], c), block(a[COS_PHI], c)
        )
        k = place_of(s, s.acc_ends + 2 * stride, i)
        add_block(accounts, k, x)
        add_block(accounts, k + stride, y)
        add_block(accounts, k + 2 * stride, x * vx + y * vy)


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
def rotate_bath_of(model, bath, s, i, q, v, rotations):
    """Rotate the oscillators of bar i; returns their momentum after it."""
    px = broadcast(0.0)
    py = broadcast(0.0)
    x = model.displaced[ALONG_X, i]
    y = model.displaced[ALONG_Y, i]
    count = s.oscillators
    first = s.first_oscillator
    slot = first_slot(s, i)
    for m in range(0, count, LANES):
        turn = rotation_of(rotations, first + m)
        mass = block(bath[OSCILLATOR_MASS], first + m)
        rate, _ = rotate_oscillators(q, v, slot + m, x, turn)
        px = px + mass * rate
        rate, _ = rotate_oscillators(q, v, slot + count + m, y, turn)
        py = py + mass * rate
    return sum_of_lanes(px), sum_of_lanes(py)


@kernel
def rotate_baths_of(model, bath, s, first, q, v, accounts, rotations):
    """Rotate the oscillators of a block of bars, which take up the opposite momentum."""
    after_x = broadcast(0.0)
    after_y = broadcast(0.0)
    for i in range(first, min(first + LANES, s.end)):
        px, py = rotate_bath_of(model, bath, s, i, q, v, rotations)
        after_x = with_lane(after_x, i - first, px)
        after_y = with_lane(after_y, i - first, py)
    before_x, before_y = vectors(model.bath_momentum, first)
    set_vectors(model.bath_momentum, first, after_x, after_y)
    px = before_x - after_x
    py = before_y - after_y
    push_bars(model, s, first, px, py, v, accounts, s.acc_internal)


@kernel
def rotate_bath(model, bath, tau, q, v, accounts, rotations):
    """Rotate all oscillators exactly, bars frozen."""
    if bath is not None:
        set_rotations(bath[OSCILLATOR_FREQUENCY], tau, rotations)
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.oscillators > 0:
                for i in range(s.start, s.stop, LANES):
                    rotate_baths_of(model, bath, s, i, q, v, accounts, rotations)


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
                    v[j] -= gained / model.constants[I2, column_of_constants(s, i)]
                    if s.acc_internal >= 0:
                        accounts[place_of(s, account, i)] -= gained * 0.5 * (nu + v[j])


@kernel
def damp_swings(model, swing_friction, tau, v, accounts, noise):
    """Langevin friction and noise on the swings, exactly."""
    if swing_friction is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.swing_gamma > 0.0:
                for i in range(s.start, s.stop, LANES):
                    gamma = own_number(model.own, OWN_SWING_GAMMA, s.swing_gamma, i)
                    heat = own_number(model.own, OWN_TEMPERATURE, s.temperature, i)
                    mobility = block(model.constants[INVERSE_INERTIA], column_of_constants(s, i))
                    omega = block(v, i)
                    count = min(LANES, s.end - i)
                    drawn = normals(noise, s.temperature, count)
                    gained = thermal_kicks(gamma, heat, mobility, omega, tau, drawn)
                    now = omega + gained * mobility
                    set_block(v, i, now)
                    if s.acc_swing >= 0:
                        m = place_of(s, s.acc_swing, i)
                        add_block(accounts, m, gained * (0.5 * (omega + now)))


@inlined
def thermal_impulses(model, s, i, tau, v, noise):
    """The momenta that a block of bars receives from the reservoir: along their arcs and across."""
    a = model.constants
    tx = block(model.bobs[TX], i)
    ty = block(model.bobs[TY], i)
    vx, vy = velocities_of_bars(model, s, i, v)
    x = vx - s.reservoir_x
    y = vy - s.reservoir_y
    c = column_of_constants(s, i)
    across = block(a[INVERSE_MASS], c)
    arc = across + block(a[L2], c) * block(a[L2], c) * block(a[INVERSE_INERTIA], c)
    one, other = pairs_of_normals(noise, s.temperature, min(LANES, s.end - i))
    gamma = own_number(model.own, OWN_GAMMA, s.gamma, i)
    heat = own_number(model.own, OWN_TEMPERATURE, s.temperature, i)
    along = thermal_kicks(gamma, heat, arc, tx * x + ty * y, tau, one)
    side = thermal_kicks(gamma, heat, across, tx * y - ty * x, tau, other)
    present = block(model.each[PRESENT], i)
    return present * (along * tx - side * ty), present * (along * ty + side * tx)


@kernel
def thermalise(model, friction, tau, v, accounts, noise):
    """Langevin friction and noise on the frozen bars, exactly."""
    if friction is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            if s.gamma == 0.0:
                continue
            before_x, before_y = momentum(model, s, v)
            for i in range(s.start, s.stop, LANES):
                px, py = thermal_impulses(model, s, i, tau, v, noise)
                push_bars(model, s, i, px, py, v, accounts, s.acc_thermal)
            after_x, after_y = momentum(model, s, v)
            px = after_x - before_x
            py = after_y - before_y
            if s.acc_block >= 0:
                work = 0.5 * (px * (before_x + after_x) + py * (before_y + after_y))
                add_numbers(accounts, s.acc_block, work * s.inverse_total_mass)


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
