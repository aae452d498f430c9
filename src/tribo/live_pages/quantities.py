"""What a page shows of a pair at one time, from a row of the loop's record.

The formulas are those of :mod:`tribo.ledger` for one asperite on one; ``tests/live_pages`` compares
both.
"""

import math
from typing import Any, NamedTuple

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import broadcast, lane, with_lane
from tribo.compiler.lanes_functions import sine_cosine_versine
from tribo.kernels.kinematics import rod_position, rod_velocity
from tribo.live_pages.accounts import (
    Energies,
    Entry,
    Powers,
    boost,
    dimension_of,
    powers_of,
    pseudowork,
    total,
    work,
)
from tribo.pair import step_rows
from tribo.pair.bodies import slide_of
from tribo.pair.forces import accelerations_of, contact_of
from tribo.pair.loop import ENERGY

FIRST_ACCOUNT = step_rows.J + 1


class Pose(NamedTuple):
    """Places and velocities of an asperite; those of bob and bar are named alike."""

    theta: Any
    omega: Any
    phi: Any
    nu: Any
    x_cm: Any
    y_cm: Any
    vx_cm: Any
    vy_cm: Any
    x_bob: Any
    y_bob: Any
    x_bar: Any
    y_bar: Any
    vx_bob: Any
    vy_bob: Any
    vx_bar: Any
    vy_bar: Any


class Works(NamedTuple):
    """Works and pseudoworks of forces on an asperite."""

    w1: Any
    w2: Any
    wL: Any
    wR: Any
    w: Any
    w1_ps: Any
    w2_ps: Any
    w_ps: Any


class Forces(NamedTuple):
    """Forces on an asperite."""

    f1_x: Any
    f1_y: Any
    f2_x: Any
    f2_y: Any
    fL_x: Any
    fL_y: Any
    fR_x: Any
    fR_y: Any


class OfAsperite(NamedTuple):
    """Quantities of an asperite, with the names of :mod:`tribo.ledger.quantities`."""

    pose: Any
    works: Any
    energies: Any
    forces: Any
    powers: Any


class OfSystem(NamedTuple):
    """Quantities of both: energies and works as in :mod:`tribo.ledger.quantities`."""

    contact_energy: Any
    total_energy_change: Any
    applied_work: Any
    distance: Any  # of the bobs


# Names of the quantities of an asperite, in the order of rows.
OF_ASPERITE = (
    *Pose._fields,
    *Works._fields,
    *Energies._fields,
    *Forces._fields,
    *Powers._fields,
)
# Rows of quantities: those of the first asperite, of the second, and of both.
MEMBERS = len(OF_ASPERITE)
QUANTITIES = 2 * MEMBERS + len(OfSystem._fields)
# The dimension of each row, its place among DIMENSIONS.
DIMENSION = tuple(map(dimension_of, (*2 * OF_ASPERITE, *OfSystem._fields)))


class Side(NamedTuple):
    """What one asperite has of a pair: numbers that do not change during a run."""

    body: Any
    rest: Any
    sign: Any  # 1 for the first, -1 for the second: of forces, which are those on the first
    x: Any  # of the resting centre of mass, in the laboratory
    y: Any
    vx: Any  # of its surface, in the observer's frame
    vy: Any
    bar_length: Any
    held_bar: Any
    clamped: Any


class Motion(NamedTuple):
    """Coordinates and accounts of one asperite in a sample."""

    q: Any
    omega: Any
    alpha: Any
    sin: Any
    cos: Any
    versine: Any  # 1 - cos q
    arc: Any  # sin q - q cos q
    slide: Any  # displacement of the centre of mass along x, where it slides, and its velocity
    speed: Any
    about_x: Any
    about_y: Any
    twist: Any  # integral of q
    pushed: Any  # integral of f_x j
    jx: Any  # impulse of the contact on this asperite
    jy: Any


class Columns(NamedTuple):
    """Columns of the loop's record that belong to one asperite."""

    q: int
    v: int
    about_x: int
    about_y: int
    twist: int


FIRST_COLUMNS = Columns(
    step_rows.Q1,
    step_rows.V1,
    FIRST_ACCOUNT + step_rows.X1,
    FIRST_ACCOUNT + step_rows.Y1,
    FIRST_ACCOUNT + step_rows.T1,
)
SECOND_COLUMNS = Columns(
    step_rows.Q2,
    step_rows.V2,
    FIRST_ACCOUNT + step_rows.X2,
    FIRST_ACCOUNT + step_rows.Y2,
    FIRST_ACCOUNT + step_rows.T2,
)
PUSHED = FIRST_ACCOUNT + step_rows.S
ACROSS = FIRST_ACCOUNT + step_rows.J_Y


@kernel
def motion_of(side, columns, row, angles, alpha):
    """The motion of a side from a row of the record, and the sines and cosines in it."""
    sin, cos, versine = angles
    q = row[columns.q]
    slide = slide_of(side.body, side.sign)
    return Motion(
        q,
        row[columns.v],
        alpha,
        sin,
        cos,
        versine,
        sin - q * cos,
        slide * row[step_rows.K],
        slide * row[step_rows.J],
        side.sign * row[columns.about_x],
        side.sign * row[columns.about_y],
        row[columns.twist],
        side.sign * slide * row[PUSHED],
        side.sign * row[step_rows.J],
        side.sign * row[ACROSS],
    )


@kernel
def contact_entry(side, now):
    swept = side.body.facing * (now.about_x + now.about_y)
    pivot = side.body.pivot
    return Entry(side.body.l1 * swept, now.jx, now.jy, now.pushed + pivot * swept)


@kernel
def end_entries(side, now, first_arc):
    """Of the left and the right end, where clamps hold the bar."""
    end = side.clamped * side.body.kappa / side.bar_length
    turned = side.body.facing * end * (now.arc - first_arc)
    left = Entry(-side.body.l2 * turned, 0.0, end * now.twist, side.body.pivot * turned)
    right = Entry(side.body.l2 * turned, 0.0, -end * now.twist, -side.body.pivot * turned)
    return left, right


@kernel
def moving_velocity(side, now):
    """Velocity of the centre of mass relative to its surface's uniform motion."""
    tx, ty = side.body.facing * now.cos, side.body.facing * now.sin
    around = side.body.pivot * now.omega
    return now.speed + around * tx, around * ty


@kernel
def drive_entry(side, now, start, contact, ends):
    """Of f2: on driven bars what the motion leaves over of other forces, else -f1."""
    if side.held_bar == 0.0:
        held = 1.0 - side.body.free
        about = side.body.facing * (held * now.about_x + now.about_y)
        return Entry(side.body.l2 * about, -held * contact.jx, -contact.jy, -held * contact.pseudo)
    left, right = ends
    vx, vy = moving_velocity(side, now)
    vx0, vy0 = moving_velocity(side, start)
    mass = side.body.mass
    kinetic = 0.5 * mass * (vx * vx + vy * vy - vx0 * vx0 - vy0 * vy0)
    pseudo = kinetic - (contact.pseudo + left.pseudo + right.pseudo)
    jx = mass * (vx - vx0) - contact.jx
    jy = mass * (vy - vy0) - (contact.jy + left.jy + right.jy)
    return Entry(-pseudo, jx, jy, pseudo)


@kernel
def pose_of(side, t, now):
    """Places and velocities of an asperite at time t."""
    body = side.body
    tx, ty = body.facing * now.cos, body.facing * now.sin
    vx, vy = moving_velocity(side, now)
    cx, cy = side.vx + vx, side.vy + vy
    x = side.x + (side.vx * t + (now.slide + body.pivot * ty))
    y = side.y + (side.vy * t + body.pivot * body.facing * now.versine)
    x_bob, y_bob = rod_position(x, y, body.l1, tx, ty)
    x_bar, y_bar = rod_position(x, y, -body.l2, tx, ty)
    vx_bob, vy_bob = rod_velocity(cx, cy, now.omega, body.l1, tx, ty)
    vx_bar, vy_bar = rod_velocity(cx, cy, now.omega, -body.l2, tx, ty)
    return Pose(
        theta=now.q + side.rest,
        omega=now.omega,
        phi=0.0,
        nu=0.0,
        x_cm=x,
        y_cm=y,
        vx_cm=cx,
        vy_cm=cy,
        x_bob=x_bob,
        y_bob=y_bob,
        x_bar=x_bar,
        y_bar=y_bar,
        vx_bob=vx_bob,
        vy_bob=vy_bob,
        vx_bar=vx_bar,
        vy_bar=vy_bar,
    )


@kernel
def energies_of_swing(side, now):
    """Kinetic energy of the pendulum's rotation, and the energy of the torsion spring."""
    body = side.body
    turning = 0.5 * body.inertia * (now.omega * now.omega)
    return turning, 0.5 * body.kappa * (now.q * now.q)


@kernel
def energies_of(side, now, start, contact, every):
    """Energies of an asperite, from the accounts of the contact force and of all forces."""
    body = side.body
    vx, vy = moving_velocity(side, now)
    vx0, vy0 = moving_velocity(side, start)
    cx, cy = side.vx + vx, side.vy + vy
    moving = 0.5 * body.mass * (vx * vx + vy * vy)
    moving0 = 0.5 * body.mass * (vx0 * vx0 + vy0 * vy0)
    kinetic = body.mass * (side.vx * (vx - vx0) + side.vy * (vy - vy0)) + (moving - moving0)
    turning, torsion = energies_of_swing(side, now)
    turning0, torsion0 = energies_of_swing(side, start)
    internal = (turning + torsion) - (turning0 + torsion0)
    return Energies(
        delta_k_trans=kinetic,
        delta_e_int=internal,
        swing_energy=turning + torsion + 0.5 * body.mass * (body.pivot * now.omega) ** 2,
        W=work(side, every),
        W_ps=pseudowork(side, every),
        delta_K=kinetic,
        delta_E_int=internal,
        friction_work=-boost(side, contact),
        k_trans=0.5 * body.mass * (cx * cx + cy * cy),
        k_swing=turning,
        e_torsion=torsion,
    )


@kernel
def forces_of(side, now, fx, fy):
    """All forces, from that of the contact; those of clamped ends are opposite.

    f2 is as in :func:`drive_entry`.
    """
    body = side.body
    end = side.clamped * body.kappa * now.q / side.bar_length
    if side.held_bar == 0.0:
        f2x, f2y = -(1.0 - body.free) * fx, -fy
    else:
        tx, ty = body.facing * now.cos, body.facing * now.sin
        inward = now.omega * now.omega
        f2x = body.mass * body.pivot * (now.alpha * tx - inward * ty) - fx
        f2y = body.mass * body.pivot * (now.alpha * ty + inward * tx) - fy
    return Forces(fx, fy, f2x, f2y, 0.0, end, 0.0, -end)


@kernel
def quantities_of(side, t, now, start, fx, fy):
    """All quantities of an asperite at time t; `fx` and `fy` are the contact force on it."""
    contact = contact_entry(side, now)
    ends = end_entries(side, now, start.arc)
    left, right = ends
    drive = drive_entry(side, now, start, contact, ends)
    every = total(contact, drive, left, right)
    works = Works(
        w1=work(side, contact),
        w2=work(side, drive),
        wL=work(side, left),
        wR=work(side, right),
        w=work(side, every),
        w1_ps=pseudowork(side, contact),
        w2_ps=pseudowork(side, drive),
        w_ps=pseudowork(side, every),
    )
    pose = pose_of(side, t, now)
    energies = energies_of(side, now, start, contact, every)
    forces = forces_of(side, now, fx, fy)
    return OfAsperite(pose, works, energies, forces, powers_of(forces, pose))


@kernel
def both_motions(pair, potential, sides, t, row):
    """The motions of both asperites at a time, the contact force on the first, and the distance."""
    q1 = row[step_rows.Q1]
    q2 = row[step_rows.Q2]
    k = row[step_rows.K]
    swings = with_lane(broadcast(q1), 1, q2)
    sin, cos, versine = sine_cosine_versine(swings)
    sin1 = broadcast(lane(sin, 0))
    cos1 = broadcast(lane(cos, 0))
    sin2 = broadcast(lane(sin, 1))
    cos2 = broadcast(lane(cos, 1))
    contact = contact_of(pair, potential, broadcast(t), broadcast(k), sin1, cos1, sin2, cos2)
    alpha1, alpha2, _ = accelerations_of(pair, contact, broadcast(q1), broadcast(q2))
    one, other = sides
    angles = lane(sin, 0), lane(cos, 0), lane(versine, 0)
    first = motion_of(one, FIRST_COLUMNS, row, angles, lane(alpha1, 0))
    angles = lane(sin, 1), lane(cos, 1), lane(versine, 1)
    second = motion_of(other, SECOND_COLUMNS, row, angles, lane(alpha2, 0))
    distance = math.sqrt(lane(contact.square, 0))
    return first, second, lane(contact.fx, 0), lane(contact.fy, 0), distance


@inlined
def put(values, series, place, k):
    """Write quantities of a sample in rows from a place on; returns the place behind them."""
    for value in values:
        series[place, k] = value
        place += 1
    return place


@kernel
def put_asperite(each, series, place, k):
    """Write all quantities of an asperite in rows; returns the place behind them."""
    place = put(each.pose, series, place, k)
    place = put(each.works, series, place, k)
    place = put(each.energies, series, place, k)
    place = put(each.forces, series, place, k)
    return put(each.powers, series, place, k)


@apart  # once for all runs
def write_quantities(pair, potential, sides, times, record, count, series):
    """Write all quantities of so many samples in `series` (QUANTITIES, times)."""
    one, other = sides
    start1, start2, _, _, _ = both_motions(pair, potential, sides, times[0], record[0])
    energy0 = record[0, ENERGY]
    for k in range(count):
        t = times[k]
        now1, now2, fx, fy, r = both_motions(pair, potential, sides, t, record[k])
        first = quantities_of(one, t, now1, start1, fx, fy)
        second = quantities_of(other, t, now2, start2, -fx, -fy)
        energy = record[k, ENERGY]
        e1, e2 = first.energies, second.energies
        w1, w2 = first.works, second.works
        changes = e1.delta_K + e1.delta_E_int + e2.delta_K + e2.delta_E_int
        applied = w1.w2 + w1.wL + w1.wR + w2.w2 + w2.wL + w2.wR
        place = put_asperite(first, series, 0, k)
        place = put_asperite(second, series, place, k)
        whole = OfSystem(energy, changes + (energy - energy0), applied, r)
        put(whole, series, place, k)
