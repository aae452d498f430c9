"""A scene as records: asperites, surfaces, fields, lattice springs, user forces; and of members."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.kernels import records
from tribo.kernels.kinematics import versine
from tribo.kernels.model import Custom, FieldOn, Springs
from tribo.layout.legs import Scheduled
from tribo.layout.slots import slide
from tribo.model.fields import Field, period_of
from tribo.model.number import constant
from tribo.model.scene import Scene
from tribo.model.surface import Surface

Records = np.recarray[Any, Any]  # whose fields are read as attributes


class MemberNumbers(NamedTuple):
    """The numbers of some members of an ensemble, where they differ from the scene of all."""

    asperites: np.ndarray  # (members, n) of ASPERITE, with the slots of the scene's layout
    charges: np.ndarray  # (members, n)
    velocity: np.ndarray  # (members, surfaces, 2) in the laboratory
    of_surfaces: np.ndarray  # (members, surfaces, numbers), see OF_MEMBERS
    # (members, fields) of the only interaction; without columns where it has others.
    potential: np.ndarray

    def of_members(self, selected: np.ndarray | slice) -> MemberNumbers:
        return MemberNumbers(*(each[selected] for each in self))

    def displaced(self, x: np.ndarray, y: np.ndarray) -> MemberNumbers:
        """The same with the asperites' places displaced (n,)."""
        asperites = self.asperites.copy()
        asperites["x"] += x
        asperites["y"] += y
        return self._replace(asperites=asperites)


def scene_records(
    scene: Scene, bobs: list[np.ndarray], scheduled: tuple[Scheduled, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """The asperites, whose surfaces have `bobs` (n, 3), and the surfaces, but for their slots."""
    asperites = np.zeros(scene.count, records.ASPERITE)
    surfaces = np.zeros(len(scene.surfaces), records.SURFACE)
    for k, surface in enumerate(scene.surfaces):
        own = asperites[scene.parts[surface.name]]
        record = surfaces[k : k + 1]
        _fill_surface(record, surface, scene.surfaces[0])
        fill_parameters(own, surface, surface.each, bobs[k])
        own["surface"] = k
        for name in ("facing", "vx", "vy"):
            own[name] = record[name]
        initial = surface.initial_of_each
        for name in ("phi", "nu"):
            own[name] = initial[name]
        record["mass"] = np.add.reduce(own["mass"])
        bath = float(np.add.reduce(surface.bath.masses))
        record["total_mass"] = record["mass"] + surface.count * bath
        record["inverse_total_mass"] = 1.0 / record["total_mass"]
        record["turning"] = (own["nu"] != 0.0).any()
        record["tilted"] = record["turning"] | (own["phi"] != 0.0).any()
    for row, each in enumerate(scheduled, start=1):
        if each.field >= 0:
            continue
        surfaces[each.surface][f"{each.name}_schedule"] = row
    return asperites, surfaces


def resting_bobs(scene: Scene, index: int) -> np.ndarray:
    """(n, 3) resting bobs of a surface, relative to the first surface's first."""
    origin = scene.surfaces[0].first_bob
    return scene.surfaces[index].resting_bobs(origin, seed=[scene.seed, index, 0])


def fill_parameters(
    asperites: np.ndarray, surface: Surface, each: dict[str, np.ndarray], bobs: np.ndarray
) -> None:
    """Fill in what follows from the parameters `each` of asperites and from their `bobs` (n, 3)."""
    for name in ("mass", "inertia", "kappa", "l1", "l2", "i2", "bar_length"):
        asperites[name] = each[name]
    if surface.asperite.is_rigid:
        asperites["kappa"] = 0.0  # a constraint holds them, and they store no energy
    if surface.drive.holds_bars or surface.refers_to_bars:
        asperites["pivot"] = each["l2"]
    asperites["x"] = bobs[:, 0]
    asperites["y"] = bobs[:, 1] + surface.facing_sign * each["l1"]
    if surface.tilts:
        rise = bobs[:, 1] + surface.facing_sign * each["length"]
        asperites["arm_x"] = bobs[:, 0] - np.mean(bobs[:, 0])
        asperites["arm_y"] = rise - np.mean(rise)


def _fill_surface(record: np.ndarray, surface: Surface, first: Surface) -> None:
    """Set what a surface's record takes from the scene; velocities are relative to the first's."""
    record["oscillators"] = surface.bath.masses.size
    record["torsionals"] = surface.bath.inertias.size
    record["facing"] = surface.facing_sign
    record["fixed"] = surface.asperite.is_rigid
    record["user_ends"] = surface.plugin_at_ends is not None
    record["vx"] = surface.velocity[0] - first.velocity[0]
    record["vy"] = surface.velocity[1] - first.velocity[1]
    drive = surface.drive
    # A rigid body of one asperite is a free asperite.
    record["drive"] = records.RIGID if surface.moves_as_one else drive.law
    bars = surface.count if drive.block else 1  # among which the drive's numbers are shared
    for name, value in drive.numbers(surface.velocity[0]).items():
        record[name] = value if name in ("speed", "loaded") else value / bars
    if drive.load is not None:
        record["loaded"] = 1
        record["load"] = -constant(drive.load) * surface.facing_sign / bars
    if drive.block and surface.elastic is not None:
        record["elastic_block"] = 1
    elif surface.has_moved_pendulums:
        record["block"] = records.PENDULUMS
    elif drive.block:
        rigid = surface.asperite.is_rigid
        record["block"] = records.RIGID_ASPERITES if rigid else records.PENDULUMS
        record["tilting"] = surface.tilts
    for reservoir in surface.reservoirs:
        before = "swing_" if reservoir.on == "swing" else ""
        record[f"{before}gamma"] = reservoir.strongest
        record[f"{before}temperature"] = reservoir.warmest
        if reservoir.velocity is not None:
            record["reservoir_x"] = reservoir.velocity[0] - surface.velocity[0]
            record["reservoir_y"] = reservoir.velocity[1] - surface.velocity[1]


def fields_on_surfaces(
    scene: Scene, origin: np.ndarray, accounts: int | None, scheduled: tuple[Scheduled, ...]
) -> tuple[tuple[FieldOn, ...] | None, int]:
    """The external fields, and how many accounts there are with one for each that moves.

    There are so many `accounts` before these; with None, fields have none.
    """
    velocity = np.array(scene.surfaces[0].velocity)
    fields = []
    count = accounts or 0
    each = enumerate(scheduled, start=1)
    rows = {one.field: row for row, one in each if one.field >= 0}
    for number, item in enumerate(scene.fields):
        drift = np.array(item.velocity)
        on = np.array(list(map(scene.index_of, item.on)))
        changes = bool(np.any(drift != 0.0)) or item.changes
        moves = accounts is not None and changes
        field = FieldOn(
            potential=item.potential,
            surfaces=on,
            origin=_in_frame_of(item, origin),
            velocity=velocity - drift,
            drift=drift,
            anchor=np.zeros(2),
            account=count if moves else -1,
            modulation=rows.get(number, 0),
        )
        fields.append(field)
        count += moves
    return tuple(fields) or None, count


def number_shared_accounts(
    scene: Scene, physics: np.ndarray, origin: np.ndarray, scheduled: tuple[Scheduled, ...]
) -> tuple[tuple[FieldOn, ...] | None, int]:
    """Give slots to accounts that are of no asperite, which come first; the fields, and how many.

    They are those of blocks that slide, of fields that move or change, and of stages that follow a
    schedule, in this order.  `physics` are the records of the surfaces.
    """
    kept = scene.output.ledger != "none"
    sliding = slide(scene) & kept
    physics["acc_block"] = np.where(sliding, sliding.cumsum() - 1, -1)
    accounts = int(sliding.sum()) if kept else None
    fields, shared = fields_on_surfaces(scene, origin, accounts, scheduled)
    staged = (physics["stage_schedule"] > 0) & kept
    physics["acc_stage"] = np.where(staged, shared + staged.cumsum() - 1, -1)
    return fields, shared + int(staged.sum())


def _in_frame_of(field: Field, origin: np.ndarray) -> np.ndarray:
    """The scene's origin in the field's own frame at t = 0 (2,).

    A period along x needs the phase alone: fmod is exact, and keeps all digits far from x = 0.
    """
    period = period_of(field.potential)
    if period is None:
        return origin - np.array(field.origin)
    x, start = (math.fmod(x, period) for x in (origin[0], field.origin[0]))
    return np.array([x - start, origin[1] - field.origin[1]])


def springs(scene: Scene, asperites: np.ndarray, columns: np.ndarray) -> Springs | None:
    """All lattice springs between bars with the columns (n, members); None without any."""
    if not any(surface.springs for surface in scene.surfaces):
        return None
    periodic = (scene.periodic.x is not None, scene.periodic.z is not None)
    tables = []
    chains = []
    for k, surface in enumerate(scene.surfaces):
        ends, stiffness = surface.springs.bonds(surface.shape, surface.count, periodic)
        i, j = (scene.parts[surface.name].start + ends).T
        table = np.zeros((3, len(ends)))
        table[records.STIFFNESS] = stiffness
        turned = surface.springs.turned
        if turned != 0.0:
            # The distance of the resting bars, minus the same distance turned.
            heights = asperites["y"] + asperites["facing"] * asperites["l2"]
            x, y = (bars[i] - bars[j] for bars in (asperites["x"], heights))
            less = versine(turned)
            sin = np.sin(turned)
            table[records.REST_X] = less * x + sin * y
            table[records.REST_Y] = less * y - sin * x
        tables.append(np.repeat(table, columns.shape[1], axis=1))
        chains.append(_chains(columns[i].ravel(), columns[j].ravel(), k))
    every = np.concatenate(chains)
    springs = np.concatenate(tables, axis=1)
    if not every.size:
        return None
    # Each chain begins with a pack and fills its last one.
    whole = -(-every["count"] // LANES) * LANES
    every["first"] = np.cumsum(whole) - whole
    filled = room((len(springs), int(np.sum(whole))))
    within = np.arange(springs.shape[1])
    before = np.cumsum(every["count"]) - every["count"]  # springs of the chains before each
    filled[:, within + np.repeat(every["first"] - before, every["count"])] = springs
    return Springs(every.view(np.recarray), filled)


def stiffness_at_bars(springs: Springs, count: int) -> np.ndarray:
    """Sum of the stiffnesses of all springs at each bar of the kernels' columns."""
    total = np.zeros(count)
    for chain in springs.chains:
        each = np.arange(chain.count)
        stiffness = springs.table[records.STIFFNESS, chain.first + each]
        for first in (chain.i, chain.j):
            np.add.at(total, first + each, stiffness)
    return total


def _chains(i: np.ndarray, j: np.ndarray, surface: int) -> np.ndarray:
    """Runs of springs, each of which joins the neighbours of the bars of the one before it."""
    begins = np.flatnonzero((np.diff(i, prepend=-2) != 1) | (np.diff(j, prepend=-2) != 1))
    chains = np.zeros(begins.size, records.CHAIN)
    chains["i"] = i[begins]
    chains["j"] = j[begins]
    chains["count"] = np.diff(begins, append=i.size)
    chains["surface"] = surface
    return chains


def plugin_forces(
    scene: Scene, origin: np.ndarray, plugin_of: Callable[[Surface], Any]
) -> tuple[Custom, ...] | None:
    """The forces of plug-ins at one place of the surfaces, drives or ends; None without any."""
    velocity = np.array(scene.surfaces[0].velocity)
    own = [
        Custom(plugin, k, origin, velocity)
        for k, surface in enumerate(scene.surfaces)
        if (plugin := plugin_of(surface)) is not None
    ]
    return tuple(own) or None
