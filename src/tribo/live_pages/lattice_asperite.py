"""What a page shows of an asperite in a row or grid, from a sample of a time loop.

The formulas are those of :mod:`tribo.ledger`; ``tests/live_pages`` compares both.
"""

import math
from typing import Any, NamedTuple

from tribo.compiler.jit import inlined, kernel
from tribo.kernels.kinematics import rod_position, rod_velocity
from tribo.kernels.records import BARS, FORCED, MOVED, X, Y
from tribo.live_pages.accounts import (
    Energies,
    Entry,
    boost,
    powers_of,
    pseudowork,
    total,
    work,
)
from tribo.live_pages.lattice_loop import Legs

# Numbers of the scene: the origin of places, the observer's velocity, and from VELOCITIES on the
# velocity of each surface in the laboratory.
ORIGIN_X, ORIGIN_Y, OBSERVER_X, OBSERVER_Y, VELOCITIES = range(5)


class Works(NamedTuple):
    """Works and pseudoworks of forces on an asperite, or sums over a surface."""

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


class OfAsperite(NamedTuple):
    """Quantities of an asperite, and its momentum relative to its surface."""

    works: Any
    energies: Any
    k_bar: Any
    powers: Any
    drawn: Any
    momentum: Any


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


class Entries(NamedTuple):
    """The accounts of forces on an asperite, and sums of them: external ones, and all."""

    contact: Any
    drive: Any
    left: Any
    right: Any
    internal: Any
    field: Any
    external: Any
    every: Any


@kernel
def entries_of(scene, samples, i, k, now):
    """The accounts of the ith asperite at the kth sample."""
    a = scene.asperites[i]
    s = samples.s
    start = motion_of(scene, samples, i, 0)
    contact = contact_entry(s, k, a)
    left = end_entry(s, k, a, 0)
    right = end_entry(s, k, a, 1)
    internal = point(s, k, a, a.acc_internal)
    field = point(s, k, a, a.acc_field)
    others = total(contact, left, right, internal, field)
    drive = drive_entry(s, k, a, scene.surfaces[a.surface].drive, now, start, others)
    external = total(contact, left, right, field, drive)
    return Entries(
        contact, drive, left, right, internal, field, external, every=total(others, drive)
    )


@kernel
def works_of(frame, entries):
    """Works and pseudoworks in the observer's frame."""
    return Works(
        w1=work(frame, entries.contact),
        w2=work(frame, entries.drive),
        wL=work(frame, entries.left),
        wR=work(frame, entries.right),
        w_int=work(frame, entries.internal),
        w_field=work(frame, entries.field),
        w=work(frame, entries.every),
        w1_ps=pseudowork(frame, entries.contact),
        w2_ps=pseudowork(frame, entries.drive),
        w_int_ps=pseudowork(frame, entries.internal),
        w_field_ps=pseudowork(frame, entries.field),
        w_ps=pseudowork(frame, entries.every),
    )


@inlined
def bar_energy(a, now):
    """Kinetic energy of the bar's rotation."""
    return 0.5 * a.i2 * (now.nu * now.nu)


@kernel
def energies_of(a, drive, frame, now, entries):
    """Energies of an asperite; of the whole surface, what is no sum over asperites is zero."""
    cx = frame.vx + now.vx
    cy = frame.vy + now.vy
    moving = 0.5 * a.mass * (now.vx * now.vx + now.vy * now.vy)
    turning = 0.5 * a.inertia * (now.omega * now.omega)
    twist = now.swing - now.phi
    torsion = 0.5 * a.kappa * (twist * twist)
    energy = turning + bar_energy(a, now) + torsion
    is_held = a.dof_x < 0 or drive == MOVED
    around = a.pivot * now.omega if is_held else 0.0
    return Energies(
        delta_k_trans=a.mass * (frame.vx * now.vx + frame.vy * now.vy) + moving,
        delta_e_int=energy,
        swing_energy=energy + 0.5 * a.mass * around * around,
        W=work(frame, entries.external),
        W_ps=boost(frame, entries.external),
        delta_K=0.0,
        delta_E_int=moving + energy,
        friction_work=-boost(frame, entries.contact),
        k_trans=0.5 * a.mass * (cx * cx + cy * cy),
        k_swing=turning,
        e_torsion=torsion,
    )


@kernel
def drawn_of(model, scene, i, t, frame, now):
    """What is drawn of the ith asperite at time t, forces of its sample in place."""
    a = scene.asperites[i]
    numbers = scene.numbers
    cx = frame.vx + now.vx
    cy = frame.vy + now.vy
    x = numbers[ORIGIN_X] + (a.x + frame.vx * t + now.x)
    y = numbers[ORIGIN_Y] + (a.y + frame.vy * t + now.y)
    x_bob, y_bob = rod_position(x, y, a.l1, now.tx, now.ty)
    x_bar, y_bar = rod_position(x, y, -a.l2, now.tx, now.ty)
    vx_bob, vy_bob = rod_velocity(cx, cy, now.omega, a.l1, now.tx, now.ty)
    vx_bar, vy_bar = rod_velocity(cx, cy, now.omega, -a.l2, now.tx, now.ty)
    f1x, f1y, f2x, f2y = forces_of(model, scene, i, scene.surfaces[a.surface].drive)
    return Drawn(
        x_bar=x_bar,
        y_bar=y_bar,
        phi=now.phi,
        x_bob=x_bob,
        y_bob=y_bob,
        f1_x=f1x,
        f1_y=f1y,
        f2_x=f2x,
        f2_y=f2y,
        vx_bar=vx_bar,
        vy_bar=vy_bar,
        vx_cm=cx,
        vy_cm=cy,
        vx_bob=vx_bob,
        vy_bob=vy_bob,
    )


@kernel
def quantities_of(model, scene, samples, i, k, frame):
    """All quantities of the ith asperite at the kth sample, forces of the sample in place."""
    a = scene.asperites[i]
    now = motion_of(scene, samples, i, k)
    entries = entries_of(scene, samples, i, k, now)
    drawn = drawn_of(model, scene, i, samples.times[k], frame, now)
    return OfAsperite(
        works_of(frame, entries),
        energies_of(a, scene.surfaces[a.surface].drive, frame, now, entries),
        bar_energy(a, now),
        powers_of(drawn, drawn),
        drawn,
        (a.mass * now.vx, a.mass * now.vy),
    )
