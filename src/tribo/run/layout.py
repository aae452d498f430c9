"""From a scene to the flat arrays of the kernels, and the meaning of each slot of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tribo.kernels import records
from tribo.kernels.powers import CONTACT, DRIVE, ENDS, POINT, SLIDE, USER_ENDS
from tribo.kernels.records import (
    CHARGE,
    CUSTOM,
    FORCED,
    FREE,
    PULLED,
    RIGID,
    Box,
    Model,
    Neighbours,
    Z,
)
from tribo.kernels.simd_arrays import room, with_spare_lanes
from tribo.model.bath import thermal_start, thermal_torsional_start
from tribo.model.drives import Custom as CustomDrive
from tribo.model.drives import Ends, Forced, Free, Pulled
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.potentials.from_ase import Call, Live
from tribo.run import contacts
from tribo.run.force_records import Records, fields_on_surfaces, springs, user_forces
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
    model : Model
        The tables that the kernels read.
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
    asperites: Records
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

    @property
    def times(self) -> np.ndarray:
        """The times to record, from the start of the run on."""
        times = self.scene.times
        return np.union1d(times[times > self.beginning], [self.beginning])

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
        _fill_surface(surfaces[k : k + 1], surface, scene.surfaces[0])
    bath, torsional = _baths(scene, surfaces)
    core = _give_coordinates(surfaces, scene)
    coordinates = _give_bath(surfaces, core)
    accounts = _give_accounts(asperites, surfaces, scene)
    _give_slots(asperites, surfaces)
    origin = _origin(scene)
    fields, accounts = fields_on_surfaces(scene, origin, accounts)
    between, within, rows, skin = contacts.lay_out_contacts(scene)
    start = _start(asperites, surfaces, scene, parts, core, coordinates)
    table = _constants(asperites, scene, parts)
    calls = contacts.calculator_calls(scene, [table[Z, part] for part in parts.values()])
    lattice = springs(scene, parts, asperites)
    ends = user_forces(scene, origin, "bars", Ends)
    reservoirs = any(surface.langevin for surface in scene.surfaces)

    def forces_if(present: object, rows: int = 2) -> np.ndarray | None:
        return room((rows, scene.count)) if present else None

    model = Model(
        asperites=table,
        surfaces=surfaces.view(np.recarray),
        contacts=between,
        within=within,
        calculators=contacts.calculators(scene, calls),
        species=contacts.species(scene),
        bobs=room((records.BOB_ROWS, scene.count)),
        drive=room((2, scene.count)),
        inner=forces_if(within),
        external=forces_if(fields),
        internal=forces_if(lattice or bath is not None),
        displaced=forces_if(lattice or bath is not None),
        friction=forces_if(reservoirs),
        end_forces=forces_if(ends, rows=4),
        box=Box(scene.periodic.x or 0.0, scene.periodic.z or 0.0) if scene.periodic else None,
        springs=lattice,
        bath=bath,
        torsional=torsional,
        fields=fields,
        drives=user_forces(scene, origin, "drive", CustomDrive),
        ends=ends,
    )
    return Layout(
        scene=scene,
        asperites=asperites.view(np.recarray),
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


def _constants(asperites: np.ndarray, scene: Scene, parts: dict[str, slice]) -> np.ndarray:
    """The table of asperites that kernels read."""
    table = room((len(records.CONSTANTS), scene.count))
    for row, name in enumerate(records.CONSTANTS):
        if name in (asperites.dtype.names or ()):
            table[row] = asperites[name]
    turning = asperites["dof_phi"] >= 0
    mobility = 1.0 / asperites["inertia"] + np.where(turning, 1.0 / asperites["i2"], 0.0)
    table[records.SIN_PHI], table[records.COS_PHI] = (
        np.sin(asperites["phi"]),
        np.cos(asperites["phi"]),
    )
    table[records.FREQUENCY] = np.sqrt(asperites["kappa"] * mobility)
    for k, surface in enumerate(scene.surfaces):
        part = parts[surface.name]
        table[Z, part] = _resting_bobs(scene, k)[:, 2]
        table[CHARGE, part] = surface.asperite.for_each(surface.count)["charge"]
    return table


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


def _fill_surface(record: np.ndarray, surface: Surface, first: Surface) -> None:
    record["facing"] = surface.facing_sign
    record["vx"] = surface.velocity[0] - first.velocity[0]
    record["vy"] = surface.velocity[1] - first.velocity[1]
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


def _baths(scene: Scene, surfaces: np.ndarray) -> tuple[np.ndarray | None, np.ndarray | None]:
    """The oscillators and the torsional oscillators of all surfaces; None without any."""
    tables: list[np.ndarray | None] = []
    for masses, frequencies, count, first in (
        ("masses", "frequencies", "oscillators", "first_oscillator"),
        ("inertias", "torsional_frequencies", "torsionals", "first_torsional"),
    ):
        sizes = np.array([getattr(surface.bath, masses).size for surface in scene.surfaces])
        surfaces[count] = sizes
        surfaces[first] = np.cumsum(sizes) - sizes
        table = np.array(
            [
                np.concatenate([getattr(s.bath, name) for s in scene.surfaces])
                for name in (masses, frequencies)
            ]
        )
        tables.append(with_spare_lanes(table) if table.size else None)
    for k, surface in enumerate(scene.surfaces):
        hung = surface.count * float(np.sum(surface.bath.masses))
        surfaces["total_mass"][k] = surfaces["mass"][k] + hung
    return tables[0], tables[1]


def _slots(
    wanted: np.ndarray, surfaces: np.ndarray, first: int, width: int = 1
) -> tuple[np.ndarray, int]:
    """First slot of each surface, -1 where none is wanted, and the first slot after them.

    Every asperite of a surface has `width` slots.
    """
    sizes = np.where(wanted, width * (surfaces["stop"] - surfaces["start"]), 0)
    stops = first + np.cumsum(sizes)
    return np.where(wanted, stops - sizes, -1), int(stops[-1])


def _give_coordinates(surfaces: np.ndarray, scene: Scene) -> int:
    """Assign the asperites' slots of q; returns their number."""
    own = scene.surfaces
    stop = scene.count
    for name, wanted in (
        ("dof_phi", [s.bars != "clamped" for s in own]),
        ("dof_x", [scene.slides_along_x(s) for s in own]),
        ("dof_y", [scene.slides_along_y(s) for s in own]),
    ):
        surfaces[name], stop = _slots(np.array(wanted), surfaces, stop)
    return stop


def _give_bath(surfaces: np.ndarray, first: int) -> int:
    """Assign the baths' slots of q; returns the number of all coordinates."""
    widths = 2 * surfaces["oscillators"] + surfaces["torsionals"]
    sizes = widths * (surfaces["stop"] - surfaces["start"])
    stops = first + np.cumsum(sizes)
    surfaces["dof_bath"] = np.where(sizes > 0, stops - sizes, -1)
    return int(stops[-1])


def _give_accounts(asperites: np.ndarray, surfaces: np.ndarray, scene: Scene) -> int:
    """Assign the slots of s; returns their number."""
    own = scene.surfaces
    sliding = (surfaces["dof_x"] >= 0) | (surfaces["dof_y"] >= 0)
    driven = np.isin(surfaces["drive"], (RIGID, PULLED, CUSTOM)) | (surfaces["loaded"] == 1)
    stiff = np.maximum.reduceat(asperites["kappa"], surfaces["start"]) > 0.0
    inside = [
        bool(s.springs)
        or s.bath.masses.size + s.bath.inertias.size > 0
        or scene.has_contact_within(s)
        for s in own
    ]
    stop = 0
    for name, wanted, width in (
        ("acc_contact", np.full(surfaces.size, True), CONTACT),
        ("acc_slide", sliding, SLIDE),
        ("acc_drive", driven, DRIVE),
        ("acc_ends", (surfaces["dof_phi"] < 0) & stiff, ENDS),
        ("acc_user_ends", np.array([isinstance(s.bars, Ends) for s in own]), USER_ENDS),
        ("acc_internal", np.array(inside), POINT),
        ("acc_field", np.array([any(s.name in f.on for f in scene.fields) for s in own]), POINT),
        ("acc_thermal", np.array([bool(s.langevin) for s in own]), POINT),
    ):
        surfaces[name], stop = _slots(wanted, surfaces, stop, width)
    surfaces["acc_block"] = np.where(sliding, stop + np.cumsum(sliding) - 1, -1)
    return stop + int(np.count_nonzero(sliding))


def _give_slots(asperites: np.ndarray, surfaces: np.ndarray) -> None:
    """Set every asperite's slots from its surface's."""
    own = surfaces[asperites["surface"]]
    place = np.arange(asperites.size) - own["start"]
    asperites["stride"] = own["stop"] - own["start"]
    for name in asperites.dtype.names or ():
        if name.startswith(("dof_", "acc_")):
            each = 2 * own["oscillators"] + own["torsionals"] if name == "dof_bath" else 1
            asperites[name] = np.where(own[name] >= 0, own[name] + each * place, -1)


def _start(
    asperites: np.ndarray,
    surfaces: np.ndarray,
    scene: Scene,
    parts: dict[str, slice],
    core: int,
    coordinates: int,
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
        surfaces["turning"][index] = np.any(asperites["nu"][part] != 0.0)
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
