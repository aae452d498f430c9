"""The equations of motion: M q'' = F(q, q', t), pack by pack of asperites.

The coordinates q are the swing theta - rest of every asperite, then phi, x and y of those that
have them free, then the baths.  x and y are displacements from the initial uniform motion of the
centre of mass; where no net force can arise they stay zero and are no coordinates.  A bath
oscillator's coordinates are its displacement from the resting bar in the same uniform motion.

The time is Lanes in all of them, equal ones but where members of an ensemble are at their own
times, so that all methods and members share what is compiled.  `equations_of_motion` takes
a number, too.
"""

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import LANES, broadcast, sum_of_lanes
from tribo.compiler.lanes_functions import sine_cosine, sine_cosine_versine
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.compiler.units import call_unit
from tribo.kernels import records as rows
from tribo.kernels.arms import (
    accelerations_of_bars,
    with_tilting,
    with_turned_arms,
)
from tribo.kernels.contact_forces import contact_forces
from tribo.kernels.elastic import shares_of_bars
from tribo.kernels.fields import field_forces
from tribo.kernels.kinematics import rod_position, rod_velocity
from tribo.kernels.levers import lever_mass
from tribo.kernels.neighbours import crowded, has_lists, refresh
from tribo.kernels.packs import (
    absent,
    active_of,
    active_range,
    all_coordinates,
    clear,
    column_of,
    constant,
    coordinates,
    own_number,
    plus,
    plus_if_any,
    set_all,
    set_vectors,
    vectors,
    vectors_if_any,
)
from tribo.kernels.records import (
    BARS,
    FORCED,
    MOVED,
    PENDULUMS,
    PULLED,
    PUSHED,
    RIGID,
    RIGID_ASPERITES,
)
from tribo.kernels.schedule import given_acceleration, number_or_scheduled, scheduled
from tribo.kernels.springs import spring_forces
from tribo.kernels.user_forces import custom_forces, has_customs


@inlined
def bar_angles(model, s, i, t, q):
    """phi of a pack: coordinates where bars are free, uniform where they are clamped."""
    if s.dof_phi >= 0:
        return coordinates(s.dof_phi, s, i, q)
    return constant(model, rows.PHI_START, s, i) + constant(model, rows.NU_START, s, i) * t


@inlined
def place_bars(displaced, s, i, x, y, l2, sin, versine):
    """Set bars' displacements from rest, if needed, by r2 = r_cm + l2 (-sin theta, cos theta)."""
    if not absent(displaced):
        x = x - l2 * s.facing * sin
        y = y - l2 * s.facing * versine
        set_vectors(displaced, i, x, y)


@inlined
def place_pack(model, s, i, t, swing, phi, x, y):
    """Set positions and directions of a pack of bobs, and clear their contact forces."""
    sin, cos, versine = sine_cosine_versine(swing)
    tx = s.facing * cos
    ty = s.facing * sin
    place_bars(model.displaced, s, i, x, y, constant(model, rows.L2, s, i), sin, versine)
    x, y = with_turned_arms(model, s, i, phi, x, y)
    x = pack(model.each[rows.X_START], i) + own_number(model.own, rows.OWN_VX, s.vx, i) * t + x
    y = pack(model.each[rows.Y_START], i) + own_number(model.own, rows.OWN_VY, s.vy, i) * t + y
    x, y = rod_position(x, y, constant(model, rows.L1, s, i), tx, ty)
    set_vectors(model.bobs, i, x, y)
    set_vectors(model.directions, i, tx, ty)
    set_vectors(model.f1, i, broadcast(0.0), broadcast(0.0))


@apart
def place_bobs(model, t, q):
    """Set the places of all bobs and the directions of their rods."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for i in range(s.start, s.stop, LANES):
            place_pack(model, s, i, t, *all_coordinates(s, i, q))


@inlined
def velocities_of_bars(model, s, i, v):
    """Velocities of the centres of a pack of bars in the surface's first frame, bobs in place."""
    vx = coordinates(s.dof_x, s, i, v)
    vy = coordinates(s.dof_y, s, i, v)
    vx, vy = with_tilting(model, s, i, coordinates(s.dof_phi, s, i, v), vx, vy)
    l2 = constant(model, rows.L2, s, i)
    return rod_velocity(vx, vy, pack(v, i), -l2, *vectors(model.directions, i))


@inlined
def is_damped(model):
    """Whether reservoirs act on bars or swings."""
    return not (absent(model.friction) and absent(model.swing_friction))


@apart
def friction_forces(model, friction, swing_friction, v):
    """Set the Langevin friction on the bars, f_T = -gamma (v_bar - u), and on swings, -gamma omega.

    The integrator adds the noise.
    """
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for i in range(s.start, s.stop, LANES):
            if not absent(friction):
                vx, vy = velocities_of_bars(model, s, i, v)
                gamma = own_number(model.own, rows.OWN_GAMMA, s.gamma, i)
                fx = -gamma * (vx - s.reservoir_x)
                fy = -gamma * (vy - s.reservoir_y)
                present = pack(model.each[rows.PRESENT], i)
                # As `integrators.reservoirs` shares it; bars of a block that tilts have their own.
                if s.block == RIGID_ASPERITES and s.tilting == 0:
                    share = (s.end - s.start) / s.mass
                    present = present * share * constant(model, rows.MASS, s, i)
                set_vectors(friction, i, present * fx, present * fy)
            if not absent(swing_friction):
                gamma = own_number(model.own, rows.OWN_SWING_GAMMA, s.swing_gamma, i)
                set_pack(swing_friction[0], i, -gamma * pack(v, i))


@inlined
def gather_contact(model, members):
    """Sum the contact forces on each rigid surface, if there is any."""
    if model.rigid:
        sum_contact(model, members)


@apart
def sum_contact(model, members):
    """The same where there is one."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.drive == RIGID:
            total = broadcast(0.0)
            for i in range(s.start, s.stop, LANES):
                total = total + pack(model.f1[rows.X], i)
            if members.size == 0:
                s.fx = sum_of_lanes(total)
            else:
                set_pack(members, s.start, total)


@inlined
def gathered_contact(members, s):
    """The sum of the contact forces on a rigid surface, of one run or of each member."""
    if members.size == 0:
        return broadcast(s.fx)
    return pack(members, s.start)


@inlined
def bob_forces(model, i):
    """Force on a pack of bobs: f1, contact within the surface, and external fields."""
    f1 = vectors(model.f1, i)
    if not model.on_bobs:
        return f1
    return plus_if_any(plus_if_any(f1, model.inner, i), model.external, i)


@apart
def moving_force(model, s, i, t):
    """f2 that gives a pack of rigid asperites the acceleration of a motion, forces in place.

    That of pendulums has another part, see `kernels.rigid_block`.
    """
    x, y = bob_forces(model, i)
    bar_x, bar_y = vectors_if_any(model.internal, i)
    mass = constant(model, rows.MASS, s, i)
    ax, ay = given_acceleration(model, s, t)
    present = pack(model.each[rows.PRESENT], i)
    return present * (mass * ax - x - bar_x), present * (mass * ay - y - bar_y)


@inlined
def load_of_pack(model, s, i, t):
    """f2_y on a pack of loaded or pushed bars."""
    if s.load_schedule > 0:
        return scheduled(model.schedules, s.load_schedule, t)
    return own_number(model.own, rows.OWN_LOAD, s.load, i) + s.load_rate * t


@inlined
def drive_of_pack(model, s, i, t, q):
    """f2 on a pack of bars, contact forces in place."""
    fx, fy = vectors(model.f1, i)
    if s.drive == FORCED:
        gx = -fx
    elif s.drive == RIGID:
        total = gathered_contact(model.members, s)
        gx = constant(model, rows.MASS, s, i) * (total / s.mass) - fx
    elif s.drive == PULLED:
        bar = constant(model, rows.L2, s, i) * pack(model.directions[rows.Y], i)
        bar = coordinates(s.dof_x, s, i, q) - bar
        if s.elastic_block > 0:
            bar = broadcast(s.ax)
        stiffness = own_number(model.own, rows.OWN_STIFFNESS, s.stiffness, i)
        if s.stage_schedule > 0:
            gx = stiffness * ((s.anchor + scheduled(model.schedules, s.stage_schedule, t)) - bar)
        else:
            speed = own_number(model.own, rows.OWN_SPEED, s.speed, i)
            gx = stiffness * ((s.anchor + speed * t) - bar)
    elif s.drive == PUSHED:
        push = broadcast(s.push + s.push_rate * t)
        gx = number_or_scheduled(model.schedules, s.push_schedule, push, t)
    elif s.drive == MOVED:
        return moving_force(model, s, i, t)
    else:
        gx = broadcast(0.0)
    gy = load_of_pack(model, s, i, t) if s.loaded else -fy
    if s.stiffness_y > 0.0:
        if s.elastic_block > 0:
            gy = gy - s.stiffness_y * s.ay
        else:
            gy = gy - s.stiffness_y * coordinates(s.dof_y, s, i, q)
    if s.elastic_block > 0:
        gx, gy = shares_of_bars(model.elastic.shares, i, gx, gy)
    if s.loaded == 0 and (s.drive == FORCED or s.drive == BARS):
        return gx, gy  # no contact acts on those that fill the last pack
    present = pack(model.each[rows.PRESENT], i)
    return present * gx, present * gy


@apart
def drive_forces(model, active, t, q):
    """Set the forces of the drives on active bars, contact forces in place."""
    gather_contact(model, model.members)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for n in range(*active_range(active, s, k)):
            i = column_of(active, n)
            set_vectors(model.drive, i, *drive_of_pack(model, s, i, t, q))


@kernel
def update_neighbours(model, neighbours, t, q):
    """Place the bobs and list their neighbours; returns whether there was room for all of them."""
    place_bobs(model, t, q)
    if has_lists(neighbours):
        refresh(model, neighbours)
    return not crowded(neighbours)


@inlined
def forces(model, neighbours, t):
    """Set the forces that depend on positions alone; the bobs are newly placed, and listed."""
    contact_forces(model, neighbours)
    if model.fields.forces.size > 0:
        field_forces(model, t)
    clear(model.internal)
    spring_forces(model, model.springs)
    if model.bodies:
        call_unit(model.units[rows.ELASTIC_FORCES], (model,))


@apart
def end_torques(model, left, right, s, i, t, q):
    """Torques of a plug-in's forces on the ends of a pack of bars, about the bars' centres."""
    if absent(left):
        return broadcast(-0.0)
    sin, cos = sine_cosine(bar_angles(model, s, i, t, q))
    half = 0.5 * constant(model, rows.BAR_LENGTH, s, i)
    left_x, left_y = vectors(left, i)
    right_x, right_y = vectors(right, i)
    return half * (cos * (right_y - left_y) - sin * (right_x - left_x))


@inlined
def bar_forces(model, i, drive):
    """Force on a pack of bars: f2 + f_int + f_T, and f_L + f_R of a plug-in."""
    if not model.on_bars:
        return drive[0], drive[1]
    force = plus_if_any(drive, model.internal, i)
    force = plus_if_any(force, model.friction, i)
    if absent(model.left):
        return force
    return plus(force, plus(vectors(model.left, i), vectors(model.right, i)))


@inlined
def torques(model, s, i, bob_x, bob_y, bar_x, bar_y):
    """Torque on a pack of pendulums, but for that of the torsion springs."""
    tx, ty = vectors(model.directions, i)
    torque = constant(model, rows.L1, s, i) * (tx * bob_x + ty * bob_y)
    torque = torque - constant(model, rows.L2, s, i) * (tx * bar_x + ty * bar_y)
    if absent(model.swing_friction):
        return torque
    return torque + pack(model.swing_friction[0], i)


@inlined
def joined(model, s, i, swing, turning, x, y):
    """Accelerations of a pack; those of the whole where bars are one rigid body, in place.

    Asperites that fill a pack stay at rest: sums over packs count what moves.
    """
    if s.block > 0:
        present = pack(model.each[rows.PRESENT], i)
        x = present * s.ax
        y = present * s.ay
        along_x = x
        along_y = y
        if s.tilting > 0:
            turning = present * s.alpha
            along_x, along_y = accelerations_of_bars(model, s, i)
            along_x = present * along_x
            along_y = present * along_y
        if s.block == PENDULUMS:
            tx, ty = vectors(model.directions, i)
            inverse_length = lever_mass(model, s, i) * constant(model, rows.INVERSE_INERTIA, s, i)
            swing = swing - (tx * along_x + ty * along_y) * inverse_length
        elif s.tilting > 0:
            swing = turning
    return swing, turning, x, y


@inlined
def join_blocks(model, t, q, v):
    """Set the motion and the constraints of rigid bodies, all forces in place."""
    if model.blocks:
        call_unit(model.units[rows.JOIN_BLOCKS], (model, t, q, v))


@inlined
def accelerations(model, s, i, torsion, t, q, drive):
    """q'' of a pack from the forces in place: swings, bars' angles, x and y.

    `torsion` is 0 where the torsion springs are integrated separately, and 1 elsewhere.  `drive` is
    f2.  Clamped ends have f_L + f_R = 0, and act on the bar's angle only.
    """
    bob_x, bob_y = bob_forces(model, i)
    bar_x, bar_y = bar_forces(model, i, drive)
    torque = torques(model, s, i, bob_x, bob_y, bar_x, bar_y)
    turning = broadcast(0.0)
    if torsion != 0.0 or s.dof_phi >= 0:
        twist = pack(q, i) - bar_angles(model, s, i, t, q)
        spring = torsion * constant(model, rows.KAPPA, s, i) * twist
        torque = torque - spring
        if s.dof_phi >= 0:
            ends = end_torques(model, model.left, model.right, s, i, t, q)
            turning = (spring + ends) / constant(model, rows.I2, s, i)
    mobility = constant(model, rows.INVERSE_MASS, s, i)
    x, y = (bob_x + bar_x) * mobility, (bob_y + bar_y) * mobility
    swing = torque * constant(model, rows.INVERSE_INERTIA, s, i)
    return joined(model, s, i, swing, turning, x, y)


@inlined
def accelerate(model, torsion, t, q, acceleration):
    """Set q'' of all asperites from the forces in place; see :func:`accelerations`."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for i in range(s.start, s.stop, LANES):
            drive = vectors(model.drive, i)
            set_all(s, i, acceleration, accelerations(model, s, i, torsion, t, q, drive))


@apart
def all_forces(model, neighbours, t, q, v):
    """Set all forces but those of baths; the bobs are newly placed, and listed."""
    forces(model, neighbours, t)
    drive_forces(model, active_of(neighbours), t, q)
    if is_damped(model):
        friction_forces(model, model.friction, model.swing_friction, v)
    if has_customs(model):
        custom_forces(model, t, q, v)


@kernel
def equations_of_motion(model, neighbours, t, q, v, acceleration):
    """Set q'' of all coordinates."""
    call_unit(model.units[rows.RATES], (model, neighbours, broadcast(t), q, v, acceleration))


def rates_unit(model, neighbours, t, q, v, acceleration):
    """The unit of :func:`equations_of_motion`, which all methods share that need q''."""
    place_bobs(model, t, q)
    if has_lists(neighbours):
        refresh(model, neighbours)
    all_forces(model, neighbours, t, q, v)
    if not absent(model.bath):
        call_unit(model.units[rows.BATH_FORCES], (model, q, acceleration))
    join_blocks(model, t, q, v)
    accelerate(model, 1.0, t, q, acceleration)
    if not absent(model.torsional):
        call_unit(model.units[rows.TORSIONAL_ACCELERATIONS], (model, t, q, acceleration))
    return 0.0
