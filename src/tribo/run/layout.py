"""From a scene to the flat arrays of the kernels, and the meaning of each slot of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tribo.kernels import records
from tribo.kernels.powers import CONTACT, DRIVE, ENDS, POINT, SLIDE, USER_ENDS
from tribo.kernels.records import (
    CUSTOM,
    FORCED,
    FREE,
    PULLED,
    RIGID,
    Box,
    Model,
    Neighbours,
)
from tribo.model.bath import thermal_start, thermal_torsional_start
from tribo.model.drives import Custom as CustomDrive
from tribo.model.drives import Ends, Forced, Free, Pulled
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.potentials.from_ase import Call, Live
from tribo.run import contacts
from tribo.run.batch import Batch, batch_of, batches_of
from tribo.run.force_records import Records, bonds, fields_on_surfaces, user_forces
from tribo.run.identity import loaded


@dataclass(frozen=True, eq=False)
class Layout:
    """A scene laid out for the kernels.

    y = (q, v) has the swings of all asperites first, then phi, x and y of those that are free
    to change, then the baths; s has the accounts.  A slot of -1 is absent.

    Attributes
    ----------
    scene : Scene
        What is laid out.
    model : Model
        The records that the kernels read.
    start : ndarray, (2 coordinates,)
        y at the start of the run.
    core, coordinates, accounts : int
        Coordinates of the asperites; all coordinates, including the baths'; size of s.
    velocity : ndarray, (n, 2)
        Initial velocity of each asperite's surface, in the laboratory.
    origin : ndarray, (2,)
        The point that positions are relative to, in the laboratory.
    parts : dict
        Surface -> slice of its asperites.
    calculator_calls : tuple of Call
        The ASE calculators that the kernels call.
    rows, skin : int, float
        Rows of the neighbour list, 0 without one; how much farther than a cutoff it reaches.
    beginning : float
        Time at which the run starts.
    """

    scene: Scene
    model: Model
    start: np.ndarray
    core: int
    coordinates: int
    accounts: int
    velocity: np.ndarray
    origin: np.ndarray
    parts: dict[str, slice]
    calculator_calls: tuple[Call, ...]
    rows: int
    skin: float
    beginning: float = 0.0

    @cached_property
    def times(self) -> np.ndarray:
        """The times to record, from the start of the run on."""
        times = self.scene.times
        return np.union1d(times[times > self.beginning], [self.beginning])

    @cached_property
    def batches(self) -> tuple[tuple[Batch, ...], ...]:
        """The asperites of each surface, as the ledger reads them."""
        return tuple(batches_of(self.together, part) for part in self.parts.values())

    @cached_property
    def together(self) -> Batch:
        """The asperites of all surfaces."""
        return batch_of(self.model.asperites, self.model.surfaces, self.velocity)

    @cached_property
    def effects(self) -> dict[str, tuple[int, bool, bool]]:
        """Surface -> its index, whether a field acts on it, whether it has a reservoir."""
        return {
            surface.name: (
                index,
                any(surface.name in item.on for item in self.scene.fields),
                bool(surface.langevin),
            )
            for index, surface in enumerate(self.scene.surfaces)
        }

    @property
    def anchors(self) -> np.ndarray:
        """Displacement of each pulling stage and each field at t = 0, (surfaces + fields, 2)."""
        stages = np.column_stack([self.model.surfaces.anchor, np.zeros(len(self.scene.surfaces))])
        return np.concatenate([stages, *(f.anchor[None] for f in self.model.fields or ())])

    @property
    def drifts(self) -> np.ndarray:
        """Velocity of each pulling stage and each field, (surfaces + fields, 2)."""
        stages = np.column_stack([self.model.surfaces.speed, np.zeros(len(self.scene.surfaces))])
        return np.concatenate([stages, *(f.drift[None] for f in self.model.fields or ())])

    def anchored(self, anchors: np.ndarray) -> Layout:
        """The same layout with other places of pulling stages and fields at t = 0."""
        model = self.model
        count = len(self.scene.surfaces)
        surfaces = model.surfaces.copy()
        surfaces.anchor = anchors[:count, 0]
        moved = [
            field._replace(origin=field.origin - anchor, anchor=anchor)
            for field, anchor in zip(model.fields or (), anchors[count:], strict=True)
        ]
        model = model._replace(surfaces=surfaces, fields=tuple(moved) or None)
        return replace(self, model=model)

    @property
    def plugins(self) -> list[Any]:
        """All plug-ins that the kernels are compiled with."""
        model = self.model
        own = [custom.plugin for custom in (*(model.drives or ()), *(model.ends or ()))]
        acting = (*model.contacts, *(model.within or ()), *(model.fields or ()))
        return [item.potential for item in acting] + own

    @property
    def named_plugins(self) -> list[tuple[str, Any]]:
        """All plug-ins that a user may have written, each with its field in the scene."""
        model = self.model
        places = [
            (f"interaction[{i}].potential", item.potential)
            for i, item in enumerate(self.scene.interactions)
            if not isinstance(item.potential, Live)
        ]
        places += [(f"field[{i}].kind", f.potential) for i, f in enumerate(model.fields or ())]
        places += [(f"surface[{c.surface}].drive", c.plugin) for c in model.drives or ()]
        return places + [(f"surface[{c.surface}].bars", c.plugin) for c in model.ends or ()]

    def neighbours(self) -> Neighbours | None:
        """An empty neighbour list, which the first evaluation of the forces fills."""
        if self.rows == 0:
            return None
        return contacts.neighbours(self.model, self.rows, self.skin)


def lay_out(scene: Scene) -> Layout:
    """The flat arrays of a scene, in which absent effects have no slots."""
    scene = loaded(scene)
    counts = [surface.count for surface in scene.surfaces]
    stops = np.cumsum(counts).tolist()
    parts = {
        surface.name: slice(stop - surface.count, stop)
        for surface, stop in zip(scene.surfaces, stops, strict=True)
    }
    asperites = np.zeros(scene.count, records.ASPERITE)
    surfaces = np.zeros(len(scene.surfaces), records.SURFACE)
    for k, surface in enumerate(scene.surfaces):
        part = parts[surface.name]
        _fill_asperites(asperites[part], scene, k)
        asperites["surface"][part] = k
        surfaces["start"][k], surfaces["stop"][k] = part.start, part.stop
        surfaces["mass"][k] = np.sum(asperites["mass"][part])
        _fill_surface(surfaces[k : k + 1], surface)
    oscillators, torsional = _baths(scene, surfaces)
    core = _give_coordinates(asperites, scene)
    coordinates = _give_bath(asperites, surfaces, core)
    accounts = _give_accounts(asperites, surfaces, scene)
    origin = _origin(scene)
    fields, accounts = fields_on_surfaces(scene, origin, accounts)
    between, within, rows, skin = contacts.lay_out_contacts(scene)
    bobs = _bobs(scene, parts)
    calls = contacts.calculator_calls(scene, [bobs["z"][part] for part in parts.values()])
    start = _start(asperites, scene, parts, core, coordinates)
    ends = user_forces(scene, origin, "bars", Ends)
    model = Model(
        asperites=asperites.view(np.recarray),
        surfaces=surfaces.view(np.recarray),
        contacts=between,
        within=within,
        calculators=contacts.calculators(scene, calls),
        species=contacts.species(scene),
        bobs=bobs.view(np.recarray),
        inner=np.zeros(scene.count, records.PUSH).view(np.recarray) if within else None,
        bars=np.zeros(scene.count, records.BAR).view(np.recarray),
        box=Box(scene.periodic.x or 0.0, scene.periodic.z or 0.0) if scene.periodic else None,
        bonds=bonds(scene, parts, asperites),
        bath=oscillators,
        torsional=torsional,
        fields=fields,
        langevin=True if any(surface.langevin for surface in scene.surfaces) else None,
        drives=user_forces(scene, origin, "drive", CustomDrive),
        ends=ends,
        end_forces=np.zeros(scene.count, records.END_FORCES).view(np.recarray) if ends else None,
    )
    return Layout(
        scene=scene,
        model=model,
        start=start,
        core=core,
        coordinates=coordinates,
        accounts=accounts,
        velocity=np.repeat([surface.velocity for surface in scene.surfaces], counts, axis=0),
        origin=origin,
        parts=parts,
        calculator_calls=calls,
        rows=rows,
        skin=skin,
    )


def _origin(scene: Scene) -> np.ndarray:
    return np.array(scene.surfaces[0].first_bob[:2])


def _resting_bobs(scene: Scene, index: int) -> np.ndarray:
    """(n, 3) resting bobs of a surface, relative to the first surface's first."""
    origin = scene.surfaces[0].first_bob
    return scene.surfaces[index].resting_bobs(origin, seed=[scene.seed, index, 0])


def _bobs(scene: Scene, parts: dict[str, slice]) -> np.ndarray:
    """Depths and charges of all bobs."""
    bobs = np.zeros(scene.count, records.BOB)
    for k, surface in enumerate(scene.surfaces):
        part = parts[surface.name]
        bobs["z"][part] = _resting_bobs(scene, k)[:, 2]
        bobs["charge"][part] = surface.asperite.for_each(surface.count)["charge"]
    return bobs


def _fill_asperites(asperites: np.ndarray, scene: Scene, index: int) -> None:
    surface, first = scene.surfaces[index], scene.surfaces[0]
    each = surface.asperite.for_each(surface.count)
    for name in ("mass", "inertia", "kappa", "l1", "l2", "i2", "bar_length"):
        asperites[name] = each[name]
    bobs = _resting_bobs(scene, index)
    asperites["facing"] = surface.facing_sign
    asperites["x"] = bobs[:, 0]
    asperites["y"] = bobs[:, 1] + surface.facing_sign * each["l1"]
    asperites["vx"] = surface.velocity[0] - first.velocity[0]
    asperites["vy"] = surface.velocity[1] - first.velocity[1]


def _fill_surface(record: np.ndarray, surface: Surface) -> None:
    drive = surface.drive
    if isinstance(drive, Forced):
        record["drive"] = FORCED
    elif isinstance(drive, Free):
        # A rigid body of one asperite is a free asperite.
        record["drive"] = RIGID if drive.rigid and surface.count > 1 else FREE
    elif isinstance(drive, Pulled):
        record["drive"] = PULLED
        record["stiffness"] = drive.stiffness
        record["speed"] = drive.speed - surface.velocity[0]
    else:
        record["drive"] = CUSTOM
    if drive.load is not None:
        record["loaded"] = 1
        record["load"] = -drive.load * surface.facing_sign
    if surface.langevin:
        record["gamma"] = surface.langevin.gamma
        record["temperature"] = surface.langevin.temperature
        if surface.langevin.velocity is not None:
            record["reservoir_x"] = surface.langevin.velocity[0] - surface.velocity[0]
            record["reservoir_y"] = surface.langevin.velocity[1] - surface.velocity[1]


def _baths(scene: Scene, surfaces: np.ndarray) -> tuple[Records | None, Records | None]:
    """The oscillators and the torsional oscillators of all surfaces; None without any."""
    tables: list[Records | None] = []
    for masses, frequencies, count, first in (
        ("masses", "frequencies", "oscillators", "first_oscillator"),
        ("inertias", "torsional_frequencies", "torsionals", "first_torsional"),
    ):
        sizes = np.array([getattr(surface.bath, masses).size for surface in scene.surfaces])
        surfaces[count] = sizes
        surfaces[first] = np.cumsum(sizes) - sizes
        table = np.zeros(int(np.sum(sizes)), records.OSCILLATOR)
        table["mass"] = np.concatenate([getattr(s.bath, masses) for s in scene.surfaces])
        table["frequency"] = np.concatenate([getattr(s.bath, frequencies) for s in scene.surfaces])
        tables.append(table.view(np.recarray) if table.size else None)
    for k, surface in enumerate(scene.surfaces):
        hung = surface.count * float(np.sum(surface.bath.masses))
        surfaces["total_mass"][k] = surfaces["mass"][k] + hung
    return tables[0], tables[1]


def _slots(wanted: np.ndarray, first: int, width: int = 1) -> tuple[np.ndarray, int]:
    """Slots of `width`, -1 where none is wanted, and the first slot after them."""
    slots = np.where(wanted, first + width * (np.cumsum(wanted) - 1), -1)
    return slots, first + width * int(np.count_nonzero(wanted))


def _of(asperites: np.ndarray, wanted: list[bool]) -> np.ndarray:
    """A value of each surface, repeated for each of its asperites."""
    return np.array(wanted)[asperites["surface"]]


def _give_coordinates(asperites: np.ndarray, scene: Scene) -> int:
    """Assign the asperites' slots of q; returns their number."""
    surfaces = scene.surfaces
    turning = _of(asperites, [s.bars != "clamped" for s in surfaces])
    along_x = _of(asperites, [scene.slides_along_x(s) for s in surfaces])
    along_y = _of(asperites, [scene.slides_along_y(s) for s in surfaces])
    asperites["dof_phi"], stop = _slots(turning, asperites.size)
    asperites["dof_x"], stop = _slots(along_x, stop)
    asperites["dof_y"], stop = _slots(along_y, stop)
    return stop


def _give_bath(asperites: np.ndarray, surfaces: np.ndarray, first: int) -> int:
    """Assign the baths' slots of q; returns the number of all coordinates."""
    width = (2 * surfaces["oscillators"] + surfaces["torsionals"])[asperites["surface"]]
    stops = first + np.cumsum(width)
    asperites["dof_bath"] = np.where(width > 0, stops - width, -1)
    return int(stops[-1])


def _give_accounts(asperites: np.ndarray, surfaces: np.ndarray, scene: Scene) -> int:
    """Assign the slots of s; returns their number."""
    own = scene.surfaces
    sliding = (asperites["dof_x"] >= 0) | (asperites["dof_y"] >= 0)
    kind = surfaces[asperites["surface"]]
    driven = np.isin(kind["drive"], (RIGID, PULLED, CUSTOM)) | (kind["loaded"] == 1)
    held = (asperites["dof_phi"] < 0) & (asperites["kappa"] > 0.0)
    inside = [
        bool(s.springs)
        or s.bath.masses.size + s.bath.inertias.size > 0
        or scene.has_contact_within(s)
        for s in own
    ]
    field = [any(s.name in item.on for item in scene.fields) for s in own]
    stop = 0
    for name, wanted, width in (
        ("acc_contact", np.full(asperites.size, True), CONTACT),
        ("acc_slide", sliding, SLIDE),
        ("acc_drive", driven, DRIVE),
        ("acc_ends", held, ENDS),
        ("acc_user_ends", _of(asperites, [isinstance(s.bars, Ends) for s in own]), USER_ENDS),
        ("acc_internal", _of(asperites, inside), POINT),
        ("acc_field", _of(asperites, field), POINT),
        ("acc_thermal", _of(asperites, [bool(s.langevin) for s in own]), POINT),
    ):
        asperites[name], stop = _slots(wanted, stop, width)
    moving = np.isin(np.arange(surfaces.size), asperites["surface"][sliding])
    surfaces["acc_block"], stop = _slots(moving, stop)
    return stop


def _start(
    asperites: np.ndarray, scene: Scene, parts: dict[str, slice], core: int, coordinates: int
) -> np.ndarray:
    """y at t = 0; the angle and the rate of a clamped bar are in its record instead."""
    y = np.zeros(2 * coordinates)
    q, v = y[:coordinates], y[coordinates:]
    for index, surface in enumerate(scene.surfaces):
        part = parts[surface.name]
        initial = surface.initial.for_each(surface.count)
        phi = 0.0 if initial["phi"] is None else initial["phi"]
        nu = 0.0 if initial["nu"] is None else initial["nu"]
        asperites["phi"][part], asperites["nu"][part] = phi, nu
        swing = surface.initial_swing
        q[part] = phi if swing is None else swing
        v[part] = 0.0 if initial["omega"] is None else initial["omega"]
        turning = asperites["dof_phi"][part]
        if surface.bars != "clamped":
            q[turning], v[turning] = phi, nu
        rng = np.random.default_rng([scene.seed, index, 1])
        set_bath(asperites[part], surface, part, q, v, rng)
    return y


def set_bath(
    asperites: np.ndarray,
    surface: Surface,
    part: slice,
    q: np.ndarray,
    v: np.ndarray,
    rng: np.random.Generator,
) -> None:
    """Start the oscillators of a surface at its bars, or drawn about them at temperature T."""
    bath, first = surface.bath, asperites["dof_bath"]
    n = bath.masses.size
    if n:
        swing = q[part]
        arm = asperites["l2"] * asperites["facing"]
        dx, dy, vx, vy = thermal_start(bath, rng, surface.count)
        slots = first[:, None] + np.arange(n)
        q[slots] = (-arm * np.sin(swing))[:, None] + dx
        q[slots + n] = (-arm * 2.0 * np.sin(0.5 * swing) ** 2)[:, None] + dy
        v[slots], v[slots + n] = vx, vy
    if bath.inertias.size:
        turn, rate = thermal_torsional_start(bath, rng, surface.count)
        slots = first[:, None] + 2 * n + np.arange(bath.inertias.size)
        q[slots] = q[asperites["dof_phi"]][:, None] + turn
        v[slots] = rate
