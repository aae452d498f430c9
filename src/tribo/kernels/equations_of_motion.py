"""The equations of motion: M q'' = F(q, q', t), block by block of asperites.

The coordinates q are the swing theta - rest of every asperite, then phi, x and y of those that
have them free, then the baths.  x and y are displacements from the initial uniform motion of the
centre of mass; where no net force can arise they stay zero and are no coordinates.  A bath
oscillator's coordinates are its displacement from the resting bar in the same uniform motion.
"""

from tribo.kernels.baths import bath_accelerations, bath_forces, torsional_accelerations
from tribo.kernels.blocks import (
    block_size,
    clear,
    coordinates,
    directions,
    set_vectors,
    sum_of_block,
    vectors,
)
from tribo.kernels.compiled import kernel, shared_kernel
from tribo.kernels.contact import contact_forces
from tribo.kernels.fields import field_forces
from tribo.kernels.kinematics import bar_velocity, bob_position
from tribo.kernels.langevin import friction_force
from tribo.kernels.neighbours import crowded, refresh
from tribo.kernels.records import (
    BAR_LENGTH,
    FORCED,
    FX,
    FY,
    I2,
    INERTIA,
    KAPPA,
    L1,
    L2,
    LEFT_X,
    LEFT_Y,
    MASS,
    NU_START,
    PHI_START,
    PULLED,
    RIGHT_X,
    RIGHT_Y,
    RIGID,
    TX,
    TY,
    X_START,
    Y_START,
    X,
    Y,
)
from tribo.kernels.simd import LANES, broadcast, sqrt
from tribo.kernels.simd_arrays import part, set_part
from tribo.kernels.simd_functions import versine
from tribo.kernels.springs import spring_forces
from tribo.kernels.user_forces import custom_forces


@kernel
def bar_angles(model, s, i, n, t, q):
    """phi of a block: coordinates where bars are free, uniform where they are clamped."""
    if s.dof_phi >= 0:
        return coordinates(s.dof_phi, s, i, n, q)
    return part(model.asperites[PHI_START], i, n) + part(model.asperites[NU_START], i, n) * t


@kernel
def place_bars(displaced, s, i, n, x, y, l2, sin, cos):
    """Set the bars' displacements from rest in the initial uniform motion, where they are needed.

    The position is r2 = r_cm + l2 (-sin theta, cos theta).
    """
    if displaced is not None:
        x = x - l2 * s.facing * sin
        y = y - l2 * s.facing * versine(sin, cos)
        set_vectors(displaced, i, n, x, y)


@kernel
def place_block(model, s, i, n, t, q):
    """Set positions and directions of a block of bobs, and clear their contact forces."""
    a = model.asperites
    b = model.bobs
    sin, cos = directions(n, part(q, i, n))
    tx = s.facing * cos
    ty = s.facing * sin
    x = coordinates(s.dof_x, s, i, n, q)
    y = coordinates(s.dof_y, s, i, n, q)
    place_bars(model.displaced, s, i, n, x, y, part(a[L2], i, n), sin, cos)
    x = part(a[X_START], i, n) + s.vx * t + x
    y = part(a[Y_START], i, n) + s.vy * t + y
    x, y = bob_position(x, y, part(a[L1], i, n), tx, ty)
    set_part(b[X], i, n, x)
    set_part(b[Y], i, n, y)
    set_part(b[TX], i, n, tx)
    set_part(b[TY], i, n, ty)
    set_part(b[FX], i, n, broadcast(0.0))
    set_part(b[FY], i, n, broadcast(0.0))


@shared_kernel
def place_bobs(model, t, q):
    """Set position and direction of every bob."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for i in range(s.start, s.stop, LANES):
            place_block(model, s, i, block_size(s, i), t, q)


@kernel
def velocities_of_bars(model, s, i, n, v):
    """Velocities of the centres of a block of bars in the surface's first frame, bobs in place."""
    vx = coordinates(s.dof_x, s, i, n, v)
    vy = coordinates(s.dof_y, s, i, n, v)
    tx = part(model.bobs[TX], i, n)
    ty = part(model.bobs[TY], i, n)
    return bar_velocity(vx, vy, part(v, i, n), part(model.asperites[L2], i, n), tx, ty)


@kernel
def friction_forces(model, friction, v):
    """Set the Langevin friction on the bars, f_T = -gamma (v_bar - u).

    The integrator adds the noise.
    """
    if friction is not None:
        for k in range(model.surfaces.shape[0]):
            s = model.surfaces[k]
            for i in range(s.start, s.stop, LANES):
                n = block_size(s, i)
                vx, vy = velocities_of_bars(model, s, i, n, v)
                fx, fy = friction_force(s.gamma, vx, vy, s.reservoir_x, s.reservoir_y)
                set_vectors(friction, i, n, fx, fy)


@kernel
def gather_contact(model):
    """Sum the contact forces on each rigid surface."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.drive == RIGID:
            s.fx = 0.0
            for i in range(s.start, s.stop, LANES):
                n = block_size(s, i)
                s.fx += sum_of_block(n, part(model.bobs[FX], i, n))


@kernel
def drive_block(model, s, i, n, t, q):
    """Set f2 on a block of bars, contact forces in place."""
    b = model.bobs
    fx = part(b[FX], i, n)
    fy = part(b[FY], i, n)
    if s.drive == FORCED:
        gx = -fx
    elif s.drive == RIGID:
        gx = part(model.asperites[MASS], i, n) * (s.fx / s.mass) - fx
    elif s.drive == PULLED:
        bar = coordinates(s.dof_x, s, i, n, q) - part(model.asperites[L2], i, n) * part(b[TY], i, n)
        gx = s.stiffness * ((s.anchor + s.speed * t) - bar)
    else:
        gx = broadcast(0.0)
    gy = broadcast(s.load) if s.loaded else -fy
    set_vectors(model.drive, i, n, gx, gy)


@kernel
def drive_forces(model, t, q):
    """Set f2 on every bar."""
    gather_contact(model)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for i in range(s.start, s.stop, LANES):
            drive_block(model, s, i, block_size(s, i), t, q)


@kernel
def update_neighbours(model, neighbours, t, q):
    """Place the bobs and list their neighbours; returns whether there was room for all of them."""
    place_bobs(model, t, q)
    refresh(model, neighbours)
    return not crowded(neighbours)


@kernel
def forces(model, neighbours, t):
    """Set the forces that depend on positions alone: contact, fields, springs.

    The bobs are newly placed.
    """
    refresh(model, neighbours)
    contact_forces(model, neighbours)
    field_forces(model, model.fields, t)
    clear(model.internal)
    spring_forces(model, model.springs)


@kernel
def end_force_sums(end_forces, i, n):
    """f_L + f_R of a plug-in on a block of bars."""
    if end_forces is None:
        return broadcast(-0.0), broadcast(-0.0)
    x = part(end_forces[LEFT_X], i, n) + part(end_forces[RIGHT_X], i, n)
    return x, part(end_forces[LEFT_Y], i, n) + part(end_forces[RIGHT_Y], i, n)


@kernel
def add_end_torques(model, end_forces, s, i, n, t, q, acceleration):
    """Add the torques of a plug-in's forces on the ends of bars to phi''."""
    if end_forces is not None:
        if s.acc_user_ends >= 0:
            sin, cos = directions(n, bar_angles(model, s, i, n, t, q))
            half = 0.5 * part(model.asperites[BAR_LENGTH], i, n)
            x = part(end_forces[RIGHT_X], i, n) - part(end_forces[LEFT_X], i, n)
            y = part(end_forces[RIGHT_Y], i, n) - part(end_forces[LEFT_Y], i, n)
            torque = half * (cos * y - sin * x)
            k = s.dof_phi + i - s.start
            old = part(acceleration, k, n)
            set_part(acceleration, k, n, old + torque / part(model.asperites[I2], i, n))


@kernel
def bar_forces(model, i, n):
    """Force on a block of bars: f2 + f_int + f_T, and f_L + f_R of a plug-in."""
    x, y = vectors(model.drive, i, n)
    fx, fy = vectors(model.internal, i, n)
    x, y = x + fx, y + fy
    fx, fy = vectors(model.friction, i, n)
    x, y = x + fx, y + fy
    fx, fy = end_force_sums(model.end_forces, i, n)
    return x + fx, y + fy


@kernel
def bob_forces(model, i, n):
    """Force on a block of bobs: f1, contact within the surface, and external fields."""
    x = part(model.bobs[FX], i, n)
    y = part(model.bobs[FY], i, n)
    fx, fy = vectors(model.inner, i, n)
    x, y = x + fx, y + fy
    fx, fy = vectors(model.external, i, n)
    return x + fx, y + fy


@kernel
def accelerate_block(model, s, i, n, torsion, t, q, acceleration):
    """Set q'' of a block of asperites from the forces in place.

    `torsion` is 0 where the torsion springs are integrated separately, and 1 elsewhere.  Clamped
    ends have f_L + f_R = 0, and act on the bar's angle only.
    """
    a = model.asperites
    tx = part(model.bobs[TX], i, n)
    ty = part(model.bobs[TY], i, n)
    bob_x, bob_y = bob_forces(model, i, n)
    bar_x, bar_y = bar_forces(model, i, n)
    torque = part(a[L1], i, n) * (tx * bob_x + ty * bob_y)
    torque = torque - part(a[L2], i, n) * (tx * bar_x + ty * bar_y)
    if torsion != 0.0 or s.dof_phi >= 0:
        twist = part(q, i, n) - bar_angles(model, s, i, n, t, q)
        spring = torsion * part(a[KAPPA], i, n) * twist
        torque = torque - spring
        if s.dof_phi >= 0:
            set_part(acceleration, s.dof_phi + i - s.start, n, spring / part(a[I2], i, n))
    set_part(acceleration, i, n, torque / part(a[INERTIA], i, n))
    if s.dof_x >= 0:
        ax = (bob_x + bar_x) / part(a[MASS], i, n)
        set_part(acceleration, s.dof_x + i - s.start, n, ax)
    if s.dof_y >= 0:
        ay = (bob_y + bar_y) / part(a[MASS], i, n)
        set_part(acceleration, s.dof_y + i - s.start, n, ay)
    add_end_torques(model, model.end_forces, s, i, n, t, q, acceleration)


@kernel
def accelerate(model, torsion, t, q, acceleration):
    """Set q'' of all asperites from the forces in place; see :func:`accelerate_block`."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for i in range(s.start, s.stop, LANES):
            accelerate_block(model, s, i, block_size(s, i), torsion, t, q, acceleration)


@kernel
def equations_of_motion(model, neighbours, t, q, v, acceleration):
    """Set q'' of all coordinates."""
    place_bobs(model, t, q)
    forces(model, neighbours, t)
    drive_forces(model, t, q)
    bath_forces(model, model.bath, q)
    friction_forces(model, model.friction, v)
    custom_forces(model, t, q, v)
    accelerate(model, 1.0, t, q, acceleration)
    bath_accelerations(model, model.bath, q, acceleration)
    torsional_accelerations(model, model.torsional, t, q, acceleration)


@kernel
def top_speeds(model, t, q, v, speeds):
    """Set the velocity of each centre of mass, and the largest speed of its bob about it.

    The second follows from the energy of the swing, so a pendulum at its turning point counts with
    the speed that it will have at its rest angle.  `speeds` is (3, n).
    """
    a = model.asperites
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        for i in range(s.start, s.stop, LANES):
            n = block_size(s, i)
            twist = part(q, i, n) - bar_angles(model, s, i, n, t, q)
            omega = part(v, i, n)
            rate = part(a[KAPPA], i, n) / part(a[INERTIA], i, n) * twist * twist + omega * omega
            set_part(speeds[0], i, n, s.vx + coordinates(s.dof_x, s, i, n, v))
            set_part(speeds[1], i, n, s.vy + coordinates(s.dof_y, s, i, n, v))
            set_part(speeds[2], i, n, part(a[L1], i, n) * sqrt(rate))
