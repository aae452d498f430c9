"""From a scene to the flat arrays of the kernels, and the meaning of each slot of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tribo.kernels import records
from tribo.kernels.records import (
    BARS,
    CUSTOM,
    FORCED,
    FREE,
    PULLED,
    RIGID,
    Box,
    Model,
    Neighbours,
)
from tribo.kernels.simd import LANES
from tribo.kernels.simd_arrays import room
from tribo.model.bath import thermal_start, thermal_torsional_start
from tribo.model.drives import Custom as CustomDrive
from tribo.model.drives import DrivenBars, Ends, Forced, Free, Pulled
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.potentials.from_ase import Call, Live
from tribo.run import contacts, slots
from tribo.run.batch import Batch, batch_of, batches_of
from tribo.run.force_records import fields_on_surfaces, springs, user_forces
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
    asperites : recarray of ASPERITE
        What each asperite is, and where its numbers stand in y and s.
    surfaces : recarray of SURFACE
        The same of the surfaces.
    model : Model
        The tables that the kernels read.
    start : ndarray, (2 coordinates,)
        y at the start of the run.
    core, coordinates, accounts : int
        Coordinates of the asperites; all coordinates, including the baths'; size of s.
    places : Places
        Where the kernels have what y and s have.
    room : (int, int)
        Coordinates and accounts of the kernels.
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
    asperites: Any
    surfaces: Any
    model: Model
    start: np.ndarray
    core: int
    coordinates: int
    accounts: int
    places: slots.Places
    room: tuple[int, int]
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
        return batch_of(self.asperites, self.surfaces, self.velocity)

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
    def depths(self) -> np.ndarray:
        """z of every bob [length], (n,)."""
        depths: np.ndarray = self.model.asperites[records.Z, self.places.columns]
        return depths

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
    asperites, physics = _records(scene, parts)
    origin = _origin(scene)
    sliding = np.array(slots.slide(scene))
    fields, shared = fields_on_surfaces(scene, origin, int(np.sum(sliding)))
    physics["acc_block"] = np.where(sliding, np.cumsum(sliding) - 1, -1)
    mine = slots.number(scene, physics, shared, width=1)
    theirs = slots.number(scene, physics, shared, LANES)
    slots.give_slots(asperites, mine.surfaces)
    start = _start(asperites, scene, parts, mine)
    places = slots.places(mine, theirs, shared)
    depths = [_resting_bobs(scene, k)[:, 2] for k in range(len(scene.surfaces))]
    calls = contacts.calculator_calls(scene, depths)
    between, within, rows, skin = contacts.lay_out_contacts(scene)
    model = _model(scene, asperites, theirs, places)._replace(
        contacts=between,
        within=within,
        inner=room((2, theirs.columns)) if within else None,
        calculators=contacts.calculators(scene, calls),
        fields=fields,
        external=room((2, theirs.columns)) if fields else None,
        drives=user_forces(scene, origin, "drive", CustomDrive),
        ends=(ends := user_forces(scene, origin, "bars", Ends)),
        end_forces=room((4, theirs.columns)) if ends else None,
    )
    return Layout(
        scene=scene,
        asperites=asperites.view(np.recarray),
        surfaces=mine.surfaces.view(np.recarray),
        model=model,
        start=start,
        core=mine.core,
        coordinates=mine.coordinates,
        accounts=mine.accounts,
        places=places,
        room=(theirs.coordinates, theirs.accounts),
        velocity=np.repeat([surface.velocity for surface in scene.surfaces], counts, axis=0),
        origin=origin,
        parts=parts,
        calculator_calls=calls,
        rows=rows,
        skin=skin,
    )


def _records(scene: Scene, parts: dict[str, slice]) -> tuple[np.ndarray, np.ndarray]:
    """The asperites and the surfaces, but for their slots."""
    asperites = np.zeros(scene.count, records.ASPERITE)
    surfaces = np.zeros(len(scene.surfaces), records.SURFACE)
    for k, surface in enumerate(scene.surfaces):
        part = parts[surface.name]
        _fill_asperites(asperites[part], scene, k)
        asperites["surface"][part] = k
        surfaces["mass"][k] = np.sum(asperites["mass"][part])
        hung = surface.count * float(np.sum(surface.bath.masses))
        surfaces["total_mass"][k] = surfaces["mass"][k] + hung
        surfaces["turning"][k] = np.any(asperites["nu"][part] != 0.0)
        _fill_surface(surfaces[k : k + 1], surface, scene.surfaces[0])
    return asperites, surfaces


def _model(
    scene: Scene, asperites: np.ndarray, numbering: slots.Numbering, places: slots.Places
) -> Model:
    """The tables of the kernels; contacts, fields and forces of plug-ins are still absent."""
    n = numbering.columns
    bath = _oscillators(numbering, [(s.bath.masses, s.bath.frequencies) for s in scene.surfaces])
    torsional = _oscillators(
        numbering, [(s.bath.inertias, s.bath.torsional_frequencies) for s in scene.surfaces]
    )
    lattice = springs(scene, asperites, places.columns)
    pulls = lattice is not None or bath is not None
    on_bars = any(surface.bar_reservoir for surface in scene.surfaces)
    on_swings = any(surface.swing_reservoir for surface in scene.surfaces)
    return Model(
        asperites=_constants(scene, asperites, places.columns, n),
        surfaces=numbering.surfaces.view(np.recarray),
        core=numbering.core,
        contacts=(),
        within=None,
        calculators=None,
        species=contacts.species(scene, places.columns, n),
        bobs=room((records.BOB_ROWS, n)),
        drive=room((2, n)),
        inner=None,
        external=None,
        internal=room((2, n)) if pulls else None,
        displaced=room((2, n)) if pulls else None,
        friction=room((2, n)) if on_bars else None,
        swing_friction=room((1, n)) if on_swings else None,
        pivots=_pivots(asperites, places.columns, n),
        fixed=True if any(s.asperite.is_rigid for s in scene.surfaces) else None,
        end_forces=None,
        box=Box(scene.periodic.x or 0.0, scene.periodic.z or 0.0) if scene.periodic else None,
        springs=lattice,
        bath=bath,
        torsional=torsional,
        fields=None,
        drives=None,
        ends=None,
    )


def _origin(scene: Scene) -> np.ndarray:
    return np.array(scene.surfaces[0].first_bob[:2])


def _resting_bobs(scene: Scene, index: int) -> np.ndarray:
    """(n, 3) resting bobs of a surface, relative to the first surface's first."""
    origin = scene.surfaces[0].first_bob
    return scene.surfaces[index].resting_bobs(origin, seed=[scene.seed, index, 0])


def _constants(scene: Scene, asperites: np.ndarray, columns: np.ndarray, count: int) -> np.ndarray:
    """The table of asperites that kernels read; others fill it up, which feel no force."""
    table = room((len(records.CONSTANTS), count))
    table[[records.MASS, records.INERTIA, records.I2, records.BAR_LENGTH, records.COS_PHI]] = 1.0
    for row, name in enumerate(records.CONSTANTS):
        if name in (records.ASPERITE.names or ()):
            table[row, columns] = asperites[name]
    _refer_to_bars(table, asperites, columns)
    rigid = np.array([s.asperite.is_rigid for s in scene.surfaces])[asperites["surface"]]
    table[records.INERTIA, columns[rigid]] = np.inf
    table[records.PRESENT, columns] = 1.0
    phi = asperites["phi"]
    table[records.SIN_PHI, columns], table[records.COS_PHI, columns] = np.sin(phi), np.cos(phi)
    turning = asperites["dof_phi"] >= 0
    mobility = 1.0 / table[records.INERTIA, columns]
    mobility += np.where(turning, 1.0 / asperites["i2"], 0.0)
    table[records.FREQUENCY, columns] = np.sqrt(asperites["kappa"] * mobility)
    every = [s.asperite.for_each(s.count)["charge"] for s in scene.surfaces]
    table[records.CHARGE, columns] = np.concatenate(every)
    depths = [_resting_bobs(scene, k)[:, 2] for k in range(len(scene.surfaces))]
    table[records.Z, columns] = np.concatenate(depths)
    return table


def _refer_to_bars(table: np.ndarray, asperites: np.ndarray, columns: np.ndarray) -> None:
    """Refer the constants of asperites on driven bars to the bar's centre; see `kernels.levers`."""
    a = asperites[asperites["pivot"] > 0.0]
    columns = columns[asperites["pivot"] > 0.0]
    table[records.INERTIA, columns] += a["mass"] * a["pivot"] ** 2
    table[records.MASS, columns] = np.inf
    table[records.L1, columns] += a["pivot"]
    table[records.L2, columns] = 0.0
    table[records.Y_START, columns] += a["facing"] * a["pivot"]


def _pivots(asperites: np.ndarray, columns: np.ndarray, count: int) -> np.ndarray | None:
    """The table of :mod:`tribo.kernels.levers`; None without driven bars."""
    if not np.any(asperites["pivot"] > 0.0):
        return None
    pivots = room((1, count))
    pivots[0, columns] = asperites["pivot"]
    return pivots


def _fill_asperites(asperites: np.ndarray, scene: Scene, index: int) -> None:
    surface, first = scene.surfaces[index], scene.surfaces[0]
    each = surface.asperite.for_each(surface.count)
    for name in ("mass", "inertia", "kappa", "l1", "l2", "i2", "bar_length"):
        asperites[name] = each[name]
    bobs = _resting_bobs(scene, index)
    if surface.asperite.is_rigid:
        asperites["kappa"] = 0.0  # a constraint holds them, and they store no energy
    if isinstance(surface.drive, DrivenBars):
        asperites["pivot"] = each["l2"]
    asperites["facing"] = surface.facing_sign
    asperites["x"] = bobs[:, 0]
    asperites["y"] = bobs[:, 1] + surface.facing_sign * each["l1"]
    asperites["vx"] = surface.velocity[0] - first.velocity[0]
    asperites["vy"] = surface.velocity[1] - first.velocity[1]
    initial = surface.initial.for_each(surface.count)
    for name in ("phi", "nu"):
        asperites[name] = 0.0 if initial[name] is None else initial[name]


def _fill_surface(record: np.ndarray, surface: Surface, first: Surface) -> None:
    record["oscillators"] = surface.bath.masses.size
    record["torsionals"] = surface.bath.inertias.size
    record["facing"] = surface.facing_sign
    record["fixed"] = surface.asperite.is_rigid
    record["vx"] = surface.velocity[0] - first.velocity[0]
    record["vy"] = surface.velocity[1] - first.velocity[1]
    drive = surface.drive
    if isinstance(drive, Forced):
        record["drive"] = FORCED
    elif isinstance(drive, Free):
        # A rigid body of one asperite is a free asperite.
        record["drive"] = RIGID if drive.rigid and surface.count > 1 else FREE
    elif isinstance(drive, DrivenBars):
        record["drive"] = BARS
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
        record["gamma" if surface.bar_reservoir else "swing_gamma"] = surface.langevin.gamma
        record["temperature"] = surface.langevin.temperature
        if surface.langevin.velocity is not None:
            record["reservoir_x"] = surface.langevin.velocity[0] - surface.velocity[0]
            record["reservoir_y"] = surface.langevin.velocity[1] - surface.velocity[1]


def _oscillators(
    numbering: slots.Numbering, baths: list[tuple[np.ndarray, np.ndarray]]
) -> np.ndarray | None:
    """Masses and frequencies of all oscillators; those that fill the last block have none."""
    whole = [-(-masses.size // LANES) * LANES for masses, _ in baths]
    if sum(whole) == 0:
        return None
    table, first = room((2, sum(whole))), np.cumsum(whole) - whole
    for k, (masses, frequencies) in enumerate(baths):
        table[:, first[k] : first[k] + masses.size] = masses, frequencies
    return table


def _start(
    asperites: np.ndarray, scene: Scene, parts: dict[str, slice], numbering: slots.Numbering
) -> np.ndarray:
    """y at t = 0; the angle and the rate of a clamped bar are in its record instead."""
    y = np.zeros(2 * numbering.coordinates)
    q, v = y[: numbering.coordinates], y[numbering.coordinates :]
    for index, surface in enumerate(scene.surfaces):
        part = parts[surface.name]
        initial = surface.initial.for_each(surface.count)
        phi, nu = asperites["phi"][part], asperites["nu"][part]
        swing = surface.initial_swing
        q[part] = phi if swing is None else swing
        v[part] = 0.0 if initial["omega"] is None else initial["omega"]
        turning = asperites["dof_phi"][part]
        if surface.bars != "clamped":
            q[turning], v[turning] = phi, nu
        rng = np.random.default_rng([scene.seed, index, 1])
        set_bars(asperites[part], surface, part, q, v, rng)
    return y


def set_bars(
    asperites: np.ndarray,
    surface: Surface,
    part: slice,
    q: np.ndarray,
    v: np.ndarray,
    rng: np.random.Generator,
) -> None:
    """Start driven bars, and oscillators at the bars or drawn about them at temperature T.

    Driven bars stay where the initial angles put them about the centres of mass.
    """
    bath, first = surface.bath, asperites["dof_bath"]
    n = bath.masses.size
    arm = asperites["l2"] * asperites["facing"]
    x, y = -arm * np.sin(q[part]), -arm * 2.0 * np.sin(0.5 * q[part]) ** 2
    if isinstance(surface.drive, DrivenBars):
        q[asperites["dof_x"]], q[asperites["dof_y"]] = x, y
    if n:
        dx, dy, vx, vy = thermal_start(bath, rng, surface.count)
        slots = first[:, None] + np.arange(n)
        q[slots], q[slots + n] = x[:, None] + dx, y[:, None] + dy
        v[slots], v[slots + n] = vx, vy
    if bath.inertias.size:
        turn, rate = thermal_torsional_start(bath, rng, surface.count)
        slots = first[:, None] + 2 * n + np.arange(bath.inertias.size)
        q[slots] = q[asperites["dof_phi"]][:, None] + turn
        v[slots] = rate
