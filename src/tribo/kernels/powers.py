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
    swing      Langevin on the swing: work
    moving     of a field: work of the agent that moves it through the laboratory, or modulates it
    stage      of a surface: work of a stage that follows a schedule
    block      of a surface: pseudowork of all external forces at the centre of all its masses

Where they are written is in `accounts`.
"""

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import LANES, broadcast, lane, with_lane
from tribo.compiler.lanes_functions import sine_cosine
from tribo.compiler.lanes_memory import pack
from tribo.compiler.numbers_in_lanes import lane_of
from tribo.compiler.units import call_unit, fetched
from tribo.kernels import equations_of_motion as equations
from tribo.kernels import records as rows
from tribo.kernels.accounts import (
    Powers,
    add_powers,
    add_total,
    place_of,
)
from tribo.kernels.arms import with_tilting
from tribo.kernels.baths import set_bath_momenta, torsional_torque
from tribo.kernels.fields import (
    energy_at,
    energy_at_time,
    factor_of_field,
    field_shift,
    force_at,
    force_at_time,
)
from tribo.kernels.kinematics import end_force, rod_velocity, rotational_power
from tribo.kernels.levers import lever_mass, levers, velocities_of_centres
from tribo.kernels.packs import (
    absent,
    all_coordinates,
    constant,
    coordinates,
    plus,
    plus_if_any,
    totals,
    vectors,
    vectors_if_any,
)
from tribo.kernels.records import BARS, PENDULUMS
from tribo.kernels.schedule import rate_of_schedule


@inlined
def held_torques(model, s, i, phi, q):
    """Torques that clamped bars hold: of torsion springs, or of the forces on rigid asperites."""
    if s.fixed > 0:
        bob_x, bob_y = equations.bob_forces(model, i)
        bar_x, bar_y = equations.bar_forces(model, i, vectors(model.drive, i))
        return equations.torques(model, s, i, bob_x, bob_y, bar_x, bar_y)
    return constant(model, rows.KAPPA, s, i) * (pack(q, i) - phi)


@apart
def clamped_ends(model, s, i, t, q, velocities, power):
    """Add the powers of f_L, and of f_R = -f_L about the centre of mass."""
    omega, vx, vy = velocities
    phi = equations.bar_angles(model, s, i, t, q)
    torque = held_torques(model, s, i, phi, q)
    x, y = end_force(torque, constant(model, rows.INVERSE_BAR_LENGTH, s, i), *sine_cosine(phi))
    lever = -levers(model, model.pivots, s, i)[1]
    with_bar = rotational_power(lever, omega, *vectors(model.directions, i), x, y)
    turning = -0.5 * torque * constant(model, rows.NU_START, s, i)
    about = turning + with_bar, turning - with_bar
    add_powers(power, s, s.acc_ends, i, *about, x, y, x * vx + y * vy)


@apart
def custom_end_powers(model, s, i, t, q, velocities, power):
    """Add the powers of a plug-in's forces on the ends of bars, at r2 + r_L and r2 + r_R."""
    left_x, left_y = vectors(model.left, i)
    right_x, right_y = vectors(model.right, i)
    sin, cos = sine_cosine(equations.bar_angles(model, s, i, t, q))
    omega, nu, vx, vy = velocities
    tip = 0.5 * constant(model, rows.BAR_LENGTH, s, i) * nu
    tip_x = -tip * sin
    tip_y = tip * cos
    zero = broadcast(0.0)
    l2 = constant(model, rows.L2, s, i)
    x, y = rod_velocity(zero, zero, omega, -l2, *vectors(model.directions, i))
    on_left = left_x * (x - tip_x) + left_y * (y - tip_y)
    on_right = right_x * (x + tip_x) + right_y * (y + tip_y)
    impulses = left_x, left_y, right_x, right_y
    pseudo = left_x * vx + left_y * vy, right_x * vx + right_y * vy
    add_powers(power, s, s.acc_user_ends, i, on_left, on_right, *impulses, *pseudo)


@apart
def add_point_powers(model, table, lever, slot, s, i, velocities, power):
    """Add the powers of Jx, Jy, work about r_cm and pseudowork of forces at a lever from r_cm.

    The lever is positive towards the bob, negative towards the bar.
    """
    if not absent(table):
        omega, vx, vy = velocities
        x, y = vectors(table, i)
        about = rotational_power(lever, omega, *vectors(model.directions, i), x, y)
        add_powers(power, s, slot, i, x, y, about, x * vx + y * vy)


@inlined
def add_swing_powers(model, s, i, omega, power):
    """Add the power of the torque of a reservoir on the swing."""
    if s.acc_swing >= 0:
        if not absent(model.swing_friction):
            add_powers(power, s, s.acc_swing, i, pack(model.swing_friction[0], i) * omega)


@apart
def add_internal_powers(model, s, i, nu, velocities, power):
    """Add the same of the internal forces: springs and bath on the bars, contact on the bobs.

    The constraint of a block that tilts has torques on the bars, which turn at `nu`.
    """
    omega, vx, vy = velocities
    tx, ty = vectors(model.directions, i)
    bob, bar = levers(model, model.pivots, s, i)
    x, y = vectors_if_any(model.internal, i)
    bob_x, bob_y = vectors_if_any(model.inner, i)
    about = rotational_power(-bar, omega, tx, ty, x, y)
    about = about + rotational_power(bob, omega, tx, ty, bob_x, bob_y)
    if s.tilting > 0:
        about = about + nu * pack(model.couples[0], i)
    x = x + bob_x
    y = y + bob_y
    add_powers(power, s, s.acc_internal, i, x, y, about, x * vx + y * vy)


@inlined
def add_contact_powers(model, s, i, omega, power):
    """Add the powers of contact; in sums the work about the centre of mass, with its lever."""
    x, y = vectors(model.f1, i)
    tx, ty = vectors(model.directions, i)
    along_x = x * omega * tx
    along_y = y * omega * ty
    if model.sums:
        lever = levers(model, model.pivots, s, i)[0]
        along_x = lever * along_x
        along_y = lever * along_y
    add_powers(power, s, s.acc_contact, i, x, y, along_x, along_y)


@inlined
def add_drive_powers(model, s, i, velocities, power):
    """Add the powers of f2, likewise; the ledger finds the reaction of driven bars."""
    if s.acc_drive >= 0 and s.drive != BARS:
        omega, vx, vy = velocities
        x, y = vectors(model.drive, i)
        tx, ty = vectors(model.directions, i)
        about = omega * (tx * x + ty * y)
        if model.sums:
            about = levers(model, model.pivots, s, i)[1] * about
        add_powers(power, s, s.acc_drive, i, x, y, about, x * vx + y * vy)


@inlined
def powers_of_pack(model, s, i, torsion, t, q, velocities, power):
    """Add the powers of a pack's accounts, forces in place, if there is a ledger.

    `torsion` is 0 where the torsion springs, and the ends that hold them, are integrated
    separately; the ends that hold rigid asperites never are.
    """
    if model.ledger:
        omega, nu, vx, vy = velocities
        vx, vy = with_tilting(model, s, i, nu, vx, vy)
        vx, vy = velocities_of_centres(model, model.pivots, s, i, omega, vx, vy)
        at_centre = omega, vx, vy
        add_contact_powers(model, s, i, omega, power)
        if s.acc_slide >= 0:
            fx, fy = vectors(model.f1, i)
            add_powers(power, s, s.acc_slide, i, fx * vx, fy * vy)
        add_drive_powers(model, s, i, at_centre, power)
        if s.acc_ends >= 0 and (torsion != 0.0 or s.fixed > 0):
            clamped_ends(model, s, i, t, q, at_centre, power)
        bob, bar = levers(model, model.pivots, s, i)
        if s.acc_field >= 0:
            add_point_powers(model, model.external, bob, s.acc_field, s, i, at_centre, power)
        if s.acc_internal >= 0:
            add_internal_powers(model, s, i, nu, at_centre, power)
        if s.acc_thermal >= 0:
            add_point_powers(model, model.friction, -bar, s.acc_thermal, s, i, at_centre, power)
        add_swing_powers(model, s, i, omega, power)
        if s.acc_user_ends >= 0:
            custom_end_powers(model, s, i, t, q, velocities, power)


@inlined
def no_power(potential, t, x, y):
    return 0.0


@inlined
def power_at_time(potential, t, x, y):
    return potential.power_at_time(t, x, y)


@inlined
def add_field_power(model, potential, n, t, power, force, energy, rate):
    """Add the power of the agent that moves the nth field, modulates or changes it.

    `force`, `energy` and `rate`, that of the energy by time, call the methods of the potential.
    """
    potential = fetched(potential)
    fields = model.fields
    total = broadcast(0.0)
    factor = factor_of_field(model, n, t)
    growth = broadcast(0.0)
    if fields.modulation[n] > 0:
        growth = rate_of_schedule(model.schedules, fields.modulation[n], t)
    shift_x, shift_y = field_shift(fields, n, t)
    for k in range(fields.first[n], fields.first[n + 1]):
        s = model.surfaces[fields.surfaces[k]]
        for i in range(s.start, s.end):
            x = model.bobs[rows.X, i] + lane_of(shift_x, i)
            y = model.bobs[rows.Y, i] + lane_of(shift_y, i)
            now = lane_of(t, i) - fields.begun[n]
            fx, fy = force(potential, now, x, y)
            place = i % LANES
            moved = fx * fields.drift[n, rows.X] + fy * fields.drift[n, rows.Y]
            moved += rate(potential, now, x, y)
            if fields.modulation[n] > 0:
                moved = lane_of(factor, i) * moved
                moved += lane_of(growth, i) * energy(potential, now, x, y)
            done = lane(total, place) + moved
            total = with_lane(total, place, done)
    x = totals(model.members, total)
    add_total(model.members, power.accounts, fields.account[n], power.tau * x)
    return 0.0


def field_power_unit(model, potential, n, t, accounts, tau):
    """Add the power of the agent that moves the nth field, or modulates it."""
    power = Powers(accounts, tau)
    return add_field_power(model, potential, n, t, power, force_at, energy_at, no_power)


def timed_power_unit(model, potential, n, t, accounts, tau):
    """The same of a field that depends on time, with the power of its change."""
    power = Powers(accounts, tau)
    return add_field_power(
        model, potential, n, t, power, force_at_time, energy_at_time, power_at_time
    )


@apart
def field_powers(model, t, power):
    """Add the powers of the agents that move fields through the laboratory."""
    fields = model.fields
    for n in range(fields.power.size):
        if fields.account[n] >= 0:
            at = power.accounts, power.tau
            call_unit(fields.power[n], (model, fields.numbers[n], n, t, *at))


def torsional_powers(model, t, q, v, power):
    """Add the powers of torsional oscillators on the bars."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.torsionals > 0:
            slot = s.acc_internal + 2 * s.account_stride
            for i in range(s.start, s.end):
                torque = torsional_torque(model, model.torsional, s, i, t, q)
                power[place_of(s, slot, i)] += torque * v[s.dof_phi + i - s.start]
    return 0.0


@apart
def momentum(model, s, v):
    """Momentum of a surface, and of its bath if it is set, in its first frame; Lanes of members."""
    px = broadcast(0.0)
    py = broadcast(0.0)
    for i in range(s.start, s.stop, LANES):
        mass = constant(model, rows.MASS, s, i)
        x, y = vectors_if_any(model.bath_momentum, i)
        vx = coordinates(s.dof_x, s, i, v)
        vy = coordinates(s.dof_y, s, i, v)
        vx, vy = with_tilting(model, s, i, coordinates(s.dof_phi, s, i, v), vx, vy)
        px = px + (x + mass * vx)
        py = py + (y + mass * vy)
        if s.block == PENDULUMS or s.tilting > 0:
            about = lever_mass(model, s, i) * pack(v, i)
            tx, ty = vectors(model.directions, i)
            px = px + about * tx
            py = py + about * ty
    return totals(model.members, px), totals(model.members, py)


@inlined
def external_force(model, s):
    """Sum of f1, f2, field, f_T and a plug-in's forces on ends over a surface, Lanes of members."""
    total = broadcast(0.0), broadcast(0.0)
    for i in range(s.start, s.stop, LANES):
        total = plus(plus(total, vectors(model.f1, i)), vectors(model.drive, i))
        total = plus_if_any(total, model.external, i)
        total = plus_if_any(total, model.friction, i)
        if not absent(model.left):
            total = plus(total, plus(vectors(model.left, i), vectors(model.right, i)))
    return totals(model.members, total[0]), totals(model.members, total[1])


@apart
def power_of_stage(model, s, t):
    """Power of a stage that follows a schedule, in its surface's first frame; Lanes of members."""
    force = broadcast(0.0)
    for i in range(s.start, s.stop, LANES):
        force = force + pack(model.drive[rows.X], i)
    return totals(model.members, force * rate_of_schedule(model.schedules, s.stage_schedule, t))


@inlined
def shared_powers(model, t, v, power):
    """Add the powers of the accounts that are of no asperite, if there are any."""
    if model.shared:
        add_shared_powers(model, t, v, power)


@apart
def add_shared_powers(model, t, v, power):
    """The same where there are some."""
    if model.fields.power.size > 0:
        field_powers(model, t, power)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.acc_block >= 0:
            # The surface's external force at the velocity of its centre of mass.
            fx, fy = external_force(model, s)
            px, py = momentum(model, s, v)
            x = (fx * px + fy * py) * s.inverse_total_mass
            add_total(model.members, power.accounts, s.acc_block, power.tau * x)
        if s.acc_stage >= 0:
            x = power_of_stage(model, s, t)
            add_total(model.members, power.accounts, s.acc_stage, power.tau * x)


@kernel
def all_powers(model, t, q, v, accounts):
    """Set the powers of all accounts, if there is a ledger."""
    if model.ledger:
        call_unit(model.units[rows.POWERS], (model, broadcast(t), q, v, accounts))


def powers_unit(model, t, q, v, accounts):
    """The unit of :func:`all_powers`, which all methods share that need rates of change."""
    for m in range(accounts.size):
        accounts[m] = 0.0
    power = Powers(accounts, 1.0)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for i in range(s.start, s.stop, LANES):
            velocities = all_coordinates(s, i, v)
            powers_of_pack(model, s, i, 1.0, t, q, velocities, power)
    set_bath_momenta(model, v)
    shared_powers(model, t, v, power)
    if not absent(model.torsional):
        call_unit(model.units[rows.TORSIONAL_POWERS], (model, t, q, v, accounts))
    return 0.0
