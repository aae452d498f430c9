"""From a scene to the flat arrays of the kernels, and the meaning of each slot of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.plugin_methods import recognize
from tribo.kernels import records
from tribo.kernels.records import Model, Neighbours
from tribo.kernels.samples import BATH_ROWS
from tribo.layout import contacts, slots
from tribo.layout.ledger_view import LedgerView
from tribo.layout.member_numbers import MemberNumbers
from tribo.layout.scene_records import fields_on_surfaces, resting_bobs, scene_records, user_forces
from tribo.layout.start import start_of
from tribo.layout.tables import columns_of_constants, model_tables
from tribo.layout.threads import shares
from tribo.model.drives import Custom as CustomDrive
from tribo.model.drives import Ends
from tribo.model.identity import loaded
from tribo.model.scene import Scene
from tribo.potentials.from_ase import Call, Live


@dataclass(frozen=True, eq=False)
class Layout:
    """A scene laid out for the kernels.

    y = (q, v) has the swings of all asperites first, then phi, x and y of those that are free to
    change, then the baths; s has the accounts.  A slot of -1 is absent.
    """

    scene: Scene
    asperites: Any  # recarray of ASPERITE, with the slots of samples
    surfaces: Any  # recarray of SURFACE, the same
    model: Model
    start: np.ndarray  # (2 coordinates,) y at the start of the run
    core: int  # number of the asperites' coordinates, before those of baths
    coordinates: int
    accounts: int
    places: slots.Places  # where the kernels have what y and s have
    room: tuple[int, int]  # coordinates and accounts of the kernels
    origin: np.ndarray  # (2,) the point that positions are relative to, in the laboratory
    parts: dict[str, slice]  # surface -> slice of its asperites
    view: LedgerView  # by which samples are read
    calculator_calls: tuple[Call, ...]
    rows: int  # of the neighbour list, 0 without one
    skin: float  # how much farther than a cutoff the list reaches
    beginning: float = 0.0  # time at which the run starts

    @cached_property
    def times(self) -> np.ndarray:
        """The times to record, from the start of the run on."""
        times = self.scene.times
        return np.union1d(times[times > self.beginning], [self.beginning])

    @cached_property
    def effects(self) -> dict[str, tuple[int, bool, int]]:
        """Surface -> its index, whether a field acts on it, how many reservoirs it has."""
        return {
            surface.name: (
                index,
                any(surface.name in item.on for item in self.scene.fields),
                len(surface.reservoirs),
            )
            for index, surface in enumerate(self.scene.surfaces)
        }

    @property
    def sampled_baths(self) -> tuple[int, int]:
        """The shape of what a sample has of the baths, (0, 0) where no series needs it."""
        bathed = self.model.bath is not None or self.model.torsional is not None
        series = self.scene.output.series
        if not (series and bathed):
            return 0, 0
        rows = BATH_ROWS
        if "oscillators" in series:
            rows += 2 * max(self.oscillators.values())
        return rows, self.model.each.shape[1]

    @cached_property
    def oscillators(self) -> dict[str, int]:
        """Surface -> the number of oscillators on each bar that move along x and y."""
        return {surface.name: surface.bath.masses.size for surface in self.scene.surfaces}

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
    def constants(self) -> np.ndarray:
        """The constants of all asperites, (rows, n); see `tribo.kernels.records.CONSTANTS`."""
        columns = columns_of_constants(
            self.model.surfaces, self.asperites.surface, self.places.columns
        )
        return np.asarray(self.model.constants[:, columns])

    @property
    def depths(self) -> np.ndarray:
        """z of every bob [length], (n,)."""
        depths: np.ndarray = self.model.each[records.Z, self.places.columns]
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

    def of_members(self, numbers: MemberNumbers) -> Layout:
        """The same, by which samples of members with numbers of their own are read."""
        return replace(self, view=self.view.with_numbers(numbers, self.times.size))

    def neighbours(self, splits: bool = False) -> Neighbours | None:
        """An empty neighbour list, which the first evaluation of the forces fills.

        Splitting methods, for which `splits` is true, leave inactive blocks out.
        """
        if self.rows == 0:
            return None
        return contacts.neighbours(self.scene, self.model, self.rows, self.skin, splits)


def _orders(scene: Scene, bobs: list[np.ndarray], listed: bool) -> list[np.ndarray]:
    """Place of each asperite in the kernels' numbering of its surface.

    Lists of neighbours name blocks, so they are shorter where blocks are compact.  Lattice springs
    are faster where the bars of a row follow one another.
    """
    return [
        slots.spatial_order(own) if listed and not surface.springs else np.arange(len(own))
        for surface, own in zip(scene.surfaces, bobs, strict=True)
    ]


def _ledger_view(
    scene: Scene,
    asperites: np.ndarray,
    numbering: slots.Numbering,
    places: slots.Places,
    model: Model,
    origin: np.ndarray,
    parts: dict[str, slice],
) -> LedgerView:
    """The view of a layout with these slots and effects."""
    surfaces, lanes = numbering.surfaces.view(np.recarray), None
    if model.sums is not None:
        lanes = slots.lanes_of_surfaces(scene, surfaces).view(np.recarray)
    return LedgerView(
        asperites=asperites.view(np.recarray),
        surfaces=surfaces,
        lanes=lanes,
        velocities=np.array([surface.velocity for surface in scene.surfaces]),
        parts=parts,
        core=numbering.core,
        columns=places.columns,
        origin=origin,
        fields=tuple(each.account for each in model.fields or () if each.account >= 0),
    )


def lay_out(scene: Scene) -> Layout:
    """The flat arrays of a scene, in which absent effects have no slots."""
    scene = loaded(scene)
    counts = [surface.count for surface in scene.surfaces]
    stops = np.cumsum(counts).tolist()
    parts = {
        surface.name: slice(stop - surface.count, stop)
        for surface, stop in zip(scene.surfaces, stops, strict=True)
    }
    asperites, physics = scene_records(scene, parts)
    origin = np.array(scene.surfaces[0].first_bob[:2])
    kept = scene.output.ledger != "none"
    sliding = slots.slide(scene) & kept
    fields, shared = fields_on_surfaces(scene, origin, int(np.sum(sliding)) if kept else None)
    physics["acc_block"] = np.where(sliding, np.cumsum(sliding) - 1, -1)
    mine = slots.number(scene, physics, shared, width=1)
    theirs = slots.number(scene, physics, shared, LANES)
    slots.give_slots(asperites, mine.surfaces, ("dof_", "acc_"))
    if scene.output.ledger == "surfaces":
        for name in slots.GROUPS:  # only lanes have accounts
            asperites[name] = -1
    start = start_of(asperites, scene, parts, mine)
    bobs = [resting_bobs(scene, k) for k in range(len(scene.surfaces))]
    calculators, calls = contacts.calculators(scene, [own[:, 2] for own in bobs])
    between, within, rows, skin = contacts.lay_out_contacts(scene)
    orders = _orders(scene, bobs, rows > 0 and not calls)
    places = slots.places(mine, theirs, np.arange(shared), orders)
    model = model_tables(scene, asperites, theirs, places.columns[:, None])._replace(
        contacts=between,
        within=within,
        inner=True if within else None,
        calculators=calculators,
        fields=fields,
        external=True if fields else None,
        drives=user_forces(scene, origin, "drive", CustomDrive),
        ends=(ends := user_forces(scene, origin, "bars", Ends)),
        end_forces=True if ends else None,
        team=True if shares(scene, between + (within or ())) else None,
    )
    view = _ledger_view(scene, asperites, mine, places, model, origin, parts)
    layout = Layout(
        scene=scene,
        view=view,
        asperites=view.asperites,
        surfaces=view.surfaces,
        model=model,
        start=start,
        core=mine.core,
        coordinates=mine.coordinates,
        accounts=mine.accounts,
        places=places,
        room=(theirs.coordinates, theirs.accounts),
        origin=origin,
        parts=parts,
        calculator_calls=calls,
        rows=rows,
        skin=skin,
    )
    for plugin in layout.plugins:
        recognize(plugin)
    return layout
