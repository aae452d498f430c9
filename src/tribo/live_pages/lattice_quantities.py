"""What a page shows of rows and grids, from the samples of a time loop.

The formulas are those of :mod:`tribo.ledger`, summed over the asperites of a surface;
``tests/live_pages`` compares both.
"""

import math
from typing import Any, NamedTuple

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import broadcast
from tribo.kernels import equations_of_motion as equations
from tribo.kernels.kinematics import rod_position, rod_velocity
from tribo.kernels.records import BARS, FORCED, MOVED, X, Y
from tribo.kernels.samples import BATH, MOMENTUM_X, MOMENTUM_Y, SPRINGS, TORSIONAL, WITHIN
from tribo.ledger.quantities import EVERY_QUANTITY
from tribo.live_pages.lattice_loop import Legs, leg_at, set_leg
from tribo.live_pages.limits import largest
from tribo.live_pages.program import pool, widen
from tribo.live_pages.quantities import DIMENSIONS, ONLY_HERE, Entry, boost, pseudowork, total, work


class OfSurface(NamedTuple):
    """Quantities of a surface: sums over its asperites, with the names of a ledger.

    Beside these, p1 is the power of the contact forces at the bobs and p1_cm at the velocities of
    the centres of mass; p2 and p2_cm are those of the drives, at the bars.  energy_bath is all
    energy of the bath in the observer's frame, k_bath + e_bath of a ledger.
    """

    w1: Any
    w2: Any
    wL: Any
    wR: Any
    w_int: Any
    w_field: Any
    w: Any
    w1_ps: Any
    w2_ps: Any
    w_int_ps: Any
    w_field_ps: Any
    w_ps: Any
    delta_k_trans: Any
    delta_e_int: Any
    swing_energy: Any
    W: Any
    W_ps: Any
    delta_K: Any
    delta_E_int: Any
    friction_work: Any
    k_trans: Any
    k_swing: Any
    k_bar: Any
    e_torsion: Any
    e_springs: Any
    energy_bath: Any
    heat_bath: Any
    p1: Any
    p1_cm: Any
    p2: Any
    p2_cm: Any


class OfWhole(NamedTuple):
    """Quantities of the system."""

    contact_energy: Any
    field_energy: Any
    total_energy_change: Any
    applied_work: Any


class Drawn(NamedTuple):
    """What is drawn of each asperite: places, forces and velocities."""

    x_bar: Any
    y_bar: Any
    phi: Any
    x_bob: Any
    y_bob: Any
    f1_x: Any
    f1_y: Any
    f2_x: Any
    f2_y: Any
    vx_bar: Any
    vy_bar: Any
    vx_cm: Any
    vy_cm: Any
    vx_bob: Any
    vy_bob: Any


# Those of which the change since the start is shown.
CHANGES = tuple(
    OfSurface._fields.index(name)
    for name in ("delta_k_trans", "delta_e_int", "W_ps", "delta_K", "delta_E_int", "heat_bath")
)
MEMBERS = len(OfSurface._fields)
WHOLE = len(OfWhole._fields)
# Numbers of the scene: the origin of places, the observer's velocity, and from VELOCITIES on the
# velocity of each surface in the laboratory.
ORIGIN_X, ORIGIN_Y, OBSERVER_X, OBSERVER_Y, VELOCITIES = range(5)


def dimensions_of(surfaces: int) -> list[int]:
    """The places among DIMENSIONS of the quantities of so many surfaces and of the whole."""
    names = [*surfaces * OfSurface._fields, *OfWhole._fields]
    return [DIMENSIONS.index(ONLY_HERE.get(n) or EVERY_QUANTITY[n].kind) for n in names]


class Scene(NamedTuple):
    """What the quantities follow from beside samples."""

    asperites: Any  # recarray of ASPERITE
    surfaces: Any  # recarray of SURFACE, with the slots of samples
    numbers: Any  # (VELOCITIES + 2 surfaces,)
    field_accounts: Any  # accounts of moving fields
    columns: Any  # those of the asperites, in the tables of the kernels
    swings: Any  # those of the swings, in the state of the kernels
    core: Any  # number of coordinates in a sample
    legs: Legs


class Samples(NamedTuple):
    """The samples of a run; see :class:`tribo.kernels.samples.Record`."""

    times: Any
    y: Any
    s: Any
    contact: Any
    field: Any
    stored: Any
    places: Any  # where the kernels have the coordinates of a sample


class Frame(NamedTuple):
    """The velocity of a surface in the observer's frame."""

    vx: Any
    vy: Any


class Motion(NamedTuple):
    """One asperite in a sample, relative to the uniform motion of its surface."""

    swing: Any
    omega: Any
    phi: Any
    nu: Any
    tx: Any
    ty: Any
    x: Any  # displacement of the centre of mass, and its velocity
    y: Any
    vx: Any
    vy: Any


@inlined
def sampled(table, k, slot, absent):
    """A number of a sample, or that of an asperite without the slot."""
    if slot < 0:
        return absent
    return table[k, slot]


@inlined
def account(s, k, a, slot, place):
    """An account of a group that begins at a slot."""
    return sampled(s, k, slot + place * a.stride if slot >= 0 else -1, 0.0)


@inlined
def tilted(a, phi):
    """The displacement of a bar of a block that tilts, about the mean of all; 0 of others."""
    sin = math.sin(phi)
    half = math.sin(0.5 * phi)
    versine = 2.0 * half * half
    return -versine * a.arm_x - sin * a.arm_y, sin * a.arm_x - versine * a.arm_y


@kernel
def motion_of(scene, samples, i, k):
    """Swing, turn, place and velocity of the ith asperite at the kth sample."""
    a = scene.asperites[i]
    y = samples.y
    core = scene.core
    t = samples.times[k]
    swing = y[k, i]
    omega = y[k, core + i]
    phi = sampled(y, k, a.dof_phi, a.phi + a.nu * t)
    nu = sampled(y, k, core + a.dof_phi if a.dof_phi >= 0 else -1, a.nu)
    half = math.sin(0.5 * swing)
    tx = a.facing * math.cos(swing)
    ty = a.facing * math.sin(swing)
    around = a.pivot * omega
    bar_x, bar_y = tilted(a, phi)
    return Motion(
        swing,
        omega,
        phi,
        nu,
        tx,
        ty,
        sampled(y, k, a.dof_x, 0.0) + a.pivot * ty + bar_x,
        sampled(y, k, a.dof_y, 0.0) + a.pivot * (a.facing * 2.0 * half * half) + bar_y,
        sampled(y, k, core + a.dof_x if a.dof_x >= 0 else -1, 0.0)
        + around * tx
        - nu * (a.arm_y + bar_y),
        sampled(y, k, core + a.dof_y if a.dof_y >= 0 else -1, 0.0)
        + around * ty
        + nu * (a.arm_x + bar_x),
    )


@inlined
def point(s, k, a, slot):
    """A force with accounts of its own."""
    return Entry(
        account(s, k, a, slot, 2),
        account(s, k, a, slot, 0),
        account(s, k, a, slot, 1),
        account(s, k, a, slot, 3),
    )


@kernel
def contact_entry(s, k, a):
    """Of the contact force at the bob."""
    swept = account(s, k, a, a.acc_contact, 2) + account(s, k, a, a.acc_contact, 3)
    slide = account(s, k, a, a.acc_slide, 0) + account(s, k, a, a.acc_slide, 1)
    about_bar = a.pivot if a.acc_slide < 0 else 0.0
    return Entry(
        a.l1 * swept,
        account(s, k, a, a.acc_contact, 0),
        account(s, k, a, a.acc_contact, 1),
        slide + about_bar * swept,
    )


@kernel
def end_entry(s, k, a, is_right):
    """Of an end of the bar: of a clamp, opposite on the right one, and of a plug-in's force."""
    side = -1.0 if is_right == 1 else 1.0
    own = a.acc_user_ends
    return Entry(
        account(s, k, a, a.acc_ends, is_right) + account(s, k, a, own, is_right),
        account(s, k, a, own, 2 + 2 * is_right) + side * account(s, k, a, a.acc_ends, 2),
        account(s, k, a, own, 3 + 2 * is_right) + side * account(s, k, a, a.acc_ends, 3),
        account(s, k, a, own, 6 + is_right) + side * account(s, k, a, a.acc_ends, 4),
    )


@kernel
def drive_entry(s, k, a, drive, now, start, others):
    """Of f2: from its account, on driven bars what the motion leaves over, else minus f1."""
    if drive == BARS:
        kinetic = now.vx * now.vx + now.vy * now.vy - start.vx * start.vx - start.vy * start.vy
        pseudo = 0.5 * a.mass * kinetic - others.pseudo
        jx = a.mass * (now.vx - start.vx) - others.jx
        jy = a.mass * (now.vy - start.vy) - others.jy
        return Entry(-pseudo, jx, jy, pseudo)
    if a.acc_drive >= 0:
        own = point(s, k, a, a.acc_drive)
        return Entry(-a.l2 * own.about, own.jx, own.jy, own.pseudo)
    held = 1.0 if drive == FORCED else 0.0
    about_x = account(s, k, a, a.acc_contact, 2)
    about_y = account(s, k, a, a.acc_contact, 3)
    return Entry(
        a.l2 * (held * about_x + about_y),
        -held * account(s, k, a, a.acc_contact, 0),
        -account(s, k, a, a.acc_contact, 1),
        -(held * account(s, k, a, a.acc_slide, 0) + account(s, k, a, a.acc_slide, 1)),
    )


@kernel
def forces_of(model, scene, i, drive):
    """f1 and f2 on an asperite, forces of its sample in place; f2 of driven bars is not known."""
    column = scene.columns[i]
    f1x, f1y = model.f1[X, column], model.f1[Y, column]
    if drive == BARS:
        return f1x, f1y, math.nan, math.nan
    return f1x, f1y, model.drive[X, column], model.drive[Y, column]


@kernel
def add_asperite(model, scene, samples, i, k, frame, first, series, drawn):
    """Add what a surface has of an asperite in sample k to the rows from `first` on."""
    a = scene.asperites[i]
    surface = scene.surfaces[a.surface]
    s = samples.s
    now = motion_of(scene, samples, i, k)
    start = motion_of(scene, samples, i, 0)
    contact = contact_entry(s, k, a)
    left = end_entry(s, k, a, 0)
    right = end_entry(s, k, a, 1)
    internal = point(s, k, a, a.acc_internal)
    field = point(s, k, a, a.acc_field)
    others = total(contact, left, right, internal, field)
    drive = drive_entry(s, k, a, surface.drive, now, start, others)
    every = total(others, drive)
    external = total(contact, left, right, field, drive)
    cx = frame.vx + now.vx
    cy = frame.vy + now.vy
    moving = 0.5 * a.mass * (now.vx * now.vx + now.vy * now.vy)
    turning = 0.5 * a.inertia * (now.omega * now.omega)
    bar = 0.5 * a.i2 * (now.nu * now.nu)
    twist = now.swing - now.phi
    torsion = 0.5 * a.kappa * (twist * twist)
    energy = turning + bar + torsion
    is_held = a.dof_x < 0 or surface.drive == MOVED
    around = a.pivot * now.omega if is_held else 0.0
    numbers = scene.numbers
    t = samples.times[k]
    x = numbers[ORIGIN_X] + (a.x + frame.vx * t + now.x)
    y = numbers[ORIGIN_Y] + (a.y + frame.vy * t + now.y)
    x_bob, y_bob = rod_position(x, y, a.l1, now.tx, now.ty)
    x_bar, y_bar = rod_position(x, y, -a.l2, now.tx, now.ty)
    bob_x, bob_y = rod_velocity(cx, cy, now.omega, a.l1, now.tx, now.ty)
    bar_x, bar_y = rod_velocity(cx, cy, now.omega, -a.l2, now.tx, now.ty)
    f1x, f1y, f2x, f2y = forces_of(model, scene, i, surface.drive)
    values = OfSurface(
        w1=work(frame, contact),
        w2=work(frame, drive),
        wL=work(frame, left),
        wR=work(frame, right),
        w_int=work(frame, internal),
        w_field=work(frame, field),
        w=work(frame, every),
        w1_ps=pseudowork(frame, contact),
        w2_ps=pseudowork(frame, drive),
        w_int_ps=pseudowork(frame, internal),
        w_field_ps=pseudowork(frame, field),
        w_ps=pseudowork(frame, every),
        delta_k_trans=a.mass * (frame.vx * now.vx + frame.vy * now.vy) + moving,
        delta_e_int=energy,
        swing_energy=energy + 0.5 * a.mass * around * around,
        W=work(frame, external),
        W_ps=boost(frame, external),
        delta_K=0.0,
        delta_E_int=moving + energy,
        friction_work=-boost(frame, contact),
        k_trans=0.5 * a.mass * (cx * cx + cy * cy),
        k_swing=turning,
        k_bar=bar,
        e_torsion=torsion,
        e_springs=0.0,
        energy_bath=0.0,
        heat_bath=0.0,
        p1=f1x * bob_x + f1y * bob_y,
        p1_cm=f1x * cx + f1y * cy,
        p2=f2x * bar_x + f2y * bar_y,
        p2_cm=f2x * cx + f2y * cy,
    )
    place = first
    for value in values:
        series[place, k] += value
        place += 1
    seen = Drawn(
        x_bar,
        y_bar,
        now.phi,
        x_bob,
        y_bob,
        f1x,
        f1y,
        f2x,
        f2y,
        bar_x,
        bar_y,
        cx,
        cy,
        bob_x,
        bob_y,
    )
    for row, value in enumerate(seen):
        drawn[row, k, i] = value
    return a.mass * now.vx, a.mass * now.vy


W_PS, DELTA_K, DELTA_E_INT, E_SPRINGS, ENERGY_BATH, HEAT_BATH = (
    OfSurface._fields.index(name)
    for name in ("W_ps", "delta_K", "delta_E_int", "e_springs", "energy_bath", "heat_bath")
)
APPLIED = tuple(OfSurface._fields.index(name) for name in ("w2", "wL", "wR"))


@inlined
def boosted(stored, mass, vx, vy):
    """What a bath of a mass has more of energy where it moves faster by a velocity."""
    common = vx * stored[MOMENTUM_X] + vy * stored[MOMENTUM_Y]
    return common + 0.5 * mass * (vx * vx + vy * vy)


@kernel
def bulk(scene, samples, index, k, frame, momentum, first, series):
    """Set what a surface has as a whole, from the momentum of its asperites in its first frame."""
    surface = scene.surfaces[index]
    stored = samples.stored[k, index]
    mass = surface.total_mass
    lag_x = (momentum[0] + stored[MOMENTUM_X]) / mass
    lag_y = (momentum[1] + stored[MOMENTUM_Y]) / mass
    moving = 0.5 * mass * (lag_x * lag_x + lag_y * lag_y)
    bath = stored[BATH] + stored[TORSIONAL]
    series[first + DELTA_K, k] = mass * (frame.vx * lag_x + frame.vy * lag_y) + moving
    series[first + DELTA_E_INT, k] += stored[SPRINGS] + stored[WITHIN] + bath - moving
    series[first + E_SPRINGS, k] = stored[SPRINGS]
    mass_of_bath = mass - surface.mass
    series[first + ENERGY_BATH, k] = bath + boosted(stored, mass_of_bath, frame.vx, frame.vy)
    if surface.drive == BARS:
        series[first + HEAT_BATH, k] = bath
    else:  # in the motion with the surface
        series[first + HEAT_BATH, k] = bath + boosted(stored, mass_of_bath, -lag_x, -lag_y)
    if surface.acc_block >= 0:
        series[first + W_PS, k] += samples.s[k, surface.acc_block]
    elif surface.drive == BARS:  # a constraint provides the change of momentum
        series[first + W_PS, k] += moving


@apart
def set_forces(model, neighbours, legs, samples, k, q, v):
    """Set all forces in sample k."""
    places = samples.places
    half = places.size // 2
    for m in range(half):
        q[places[m]] = samples.y[k, m]
        v[places[m]] = samples.y[k, half + m]
    t = samples.times[k]
    set_leg(model, legs, leg_at(legs, t))
    now = broadcast(t)
    equations.update_neighbours(model, neighbours, now, q)
    equations.all_forces(model, neighbours, now, q, v)
    equations.join_blocks(model, now, q, v)


def live_quantities(model, neighbours, scene, samples, scratch, clocks, reached, series, drawn):
    """Write all quantities of the samples that a run `reached` (1,) in `series` (rows, times).

    `drawn` (rows of :class:`Drawn`, times, asperites) has what is drawn.
    """
    q, v = scratch
    count = clocks[0].sample
    reached[0] = count
    surfaces = scene.surfaces.shape[0]
    series[:] = 0.0
    last = surfaces * MEMBERS
    for k in range(count):
        set_forces(model, neighbours, scene.legs, samples, k, q, v)
        i = 0
        for n in range(surfaces):
            first = n * MEMBERS
            at = VELOCITIES + 2 * n
            frame = Frame(
                scene.numbers[at] - scene.numbers[OBSERVER_X],
                scene.numbers[at + 1] - scene.numbers[OBSERVER_Y],
            )
            px = py = 0.0
            while i < scene.asperites.shape[0] and scene.asperites[i].surface == n:
                x, y = add_asperite(model, scene, samples, i, k, frame, first, series, drawn)
                px += x
                py += y
                i += 1
            bulk(scene, samples, n, k, frame, (px, py), first, series)
        series[last, k] = samples.contact[k]
        series[last + 1, k] = samples.field[k]
    for n in range(surfaces):
        for name in CHANGES:
            row = series[n * MEMBERS + name]
            begin = row[0]
            for k in range(count):
                row[k] -= begin
    for k in range(count):
        change = series[last, k] - series[last, 0] + series[last + 1, k] - series[last + 1, 0]
        applied = 0.0
        for n in range(surfaces):
            change += series[n * MEMBERS + DELTA_K, k] + series[n * MEMBERS + DELTA_E_INT, k]
            for name in APPLIED:
                applied += series[n * MEMBERS + name, k]
        for slot in scene.field_accounts:
            applied += samples.s[k, slot]
        series[last + 2, k] = change
        series[last + 3, k] = applied
    return 0


def live_errors(series, other, reached, other_reached, dimension, errors, accuracy):
    """Set bounds on the errors from a run with steps twice as long, whose series are `other`.

    Returns 0 where none is above `accuracy` times the largest value of its dimension, else 1.

    A method of second order has three times less error than they differ, which
    :func:`tribo.live_pages.program.pool` takes three times, as for others.
    """
    errors[:] = 0.0
    count = reached[0]
    widen(series, other, count, other_reached[0], (1, 1), errors)
    pool(series, count, 1.0, dimension, other, errors)
    for name in range(series.shape[0]):
        scale = 0.0
        for each in range(series.shape[0]):
            if dimension[each] == dimension[name]:
                scale = max(scale, largest(series[each], count))
        if errors[name] > accuracy * scale:
            return 1
    return 0
