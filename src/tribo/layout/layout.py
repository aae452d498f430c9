"""From a scene to the flat arrays of the kernels, and the meaning of each slot of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, wraps
from typing import Any, TypeVar

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.compiler.plugin_methods import recognize
from tribo.kernels import records
from tribo.kernels.model import Custom, Neighbours, Tables
from tribo.kernels.records import OF_MEMBERS
from tribo.kernels.samples import BATH_ROWS
from tribo.layout import contacts, slots
from tribo.layout.legs import BEGUN, SAME, Legs, Scheduled, begun_of, legs_of, scheduled_numbers
from tribo.layout.scene_records import (
    MemberNumbers,
    number_shared_accounts,
    plugin_forces,
    resting_bobs,
    scene_records,
)
from tribo.layout.span import SPAN_SIZE, Asperites, Span, span_of, spans_of
from tribo.layout.start import start_of
from tribo.layout.tables import columns_of_constants, model_tables
from tribo.model.identity import loaded
from tribo.model.scene import Scene
from tribo.potentials.from_ase import Call

# Largest error of rounding to the nearest double, relative to it.
ROUNDING = 0.5 * float(np.finfo(float).eps)

T = TypeVar("T")


def once_per_layout(function: Callable[[Layout], T]) -> Callable[[Layout], T]:
    """A function of a layout that is computed once for each, as what all its runs share."""
    return _once(function, "computed")


def once_per_scene(function: Callable[[Layout], T]) -> Callable[[Layout], T]:
    """The same of what the scene alone decides: once for all layouts that are made from one."""
    return _once(function, "computed_of_scene")


def _once(function: Callable[[Layout], T], place: str) -> Callable[[Layout], T]:
    """The function, whose values are kept in a dictionary at a place in the layout."""

    @wraps(function)
    def known(layout: Layout) -> T:
        values = layout.__dict__[place]
        if function not in values:
            values[function] = function(layout)
        value: T = values[function]
        return value

    return known


@dataclass(frozen=True, eq=False)
class Layout:
    """A scene laid out for the kernels.

    y = (q, v) has the swings of all asperites first, then phi, x and y of those that are free to
    change, then the baths; s has the accounts.  A slot of -1 is absent.  Members that differ in
    `numbers` have a row of masses and velocities for each time and member, as their samples.
    """

    scene: Scene
    asperites: Any  # recarray of ASPERITE, with the slots of samples
    surfaces: Any  # recarray of SURFACE, the same
    model: Tables
    start: np.ndarray  # (2 coordinates,) y at the start of the run
    core: int  # number of the asperites' coordinates, before those of baths
    coordinates: int
    accounts: int
    places: slots.Places  # where the kernels have what y and s have
    room: tuple[int, int]  # coordinates and accounts of the kernels
    origin: np.ndarray  # (2,) the point that positions are relative to, in the laboratory
    calculator_calls: tuple[Call, ...]
    scheduled: tuple[Scheduled, ...]  # numbers that follow schedules
    rows: int  # of the neighbour list, 0 without one
    skin: float  # how much farther than a cutoff the list reaches
    # (surfaces + fields, BEGUN) when the own times of each drive and of the others were zero.
    begun: np.ndarray
    beginning: float = 0.0  # time at which the run starts
    numbers: MemberNumbers | None = None
    member_times: int = 1  # at which samples have rows of all members
    # Of a run with noise, half of which lies between a sample and the next kick; 0 elsewhere.
    noisy_step: float = 0.0
    # Values of functions that are computed `once_per_scene`; layouts made from this one share them.
    computed_of_scene: dict[Callable[[Layout], Any], Any] = field(default_factory=dict, repr=False)
    # Values of functions that are computed `once_per_layout`.
    computed: dict[Callable[[Layout], Any], Any] = field(
        default_factory=dict, init=False, repr=False
    )

    @property
    def parts(self) -> dict[str, slice]:
        return self.scene.parts

    @cached_property
    def times(self) -> np.ndarray:
        """The times to record, from the start of the run on, but for its rounding."""
        times = self.scene.times
        later = times - self.beginning > SAME * self.scene.duration
        return np.concatenate([[self.beginning], times[later]])

    @cached_property
    def legs(self) -> Legs:
        """The times between kinks of schedules; one leg without any."""
        return legs_of(self.scene, self.scheduled, self.begun)

    @cached_property
    def stops(self) -> np.ndarray:
        """The times at which steps end: those to record, and kinks of schedules."""
        kinks = self.legs.kinks[self.legs.kinks > self.beginning + self.legs.same]
        if kinks.size == 0:
            return self.times
        nearest = np.min(np.abs(kinks[:, None] - self.times), axis=1)
        return np.sort(np.concatenate([self.times, kinks[nearest > self.legs.same]]))

    @property
    def run_time(self) -> float:
        """How long the run lasts, from where it starts."""
        return self.scene.duration - self.beginning

    @property
    def sampled_baths(self) -> tuple[int, int]:
        """The shape of what a sample has of the baths, (0, 0) where no series needs it."""
        bathed = self.model.bath is not None or self.model.torsional is not None
        series = self.scene.output.series
        if not (series and bathed):
            return 0, 0
        more = 2 * max(self.oscillators.values()) if "oscillators" in series else 0
        return BATH_ROWS + more, self.model.each.shape[1]

    @cached_property
    def oscillators(self) -> dict[str, int]:
        """Surface -> the number of oscillators on each bar that move along x and y."""
        return {surface.name: surface.bath.masses.size for surface in self.scene.surfaces}

    @property
    def anchors(self) -> np.ndarray:
        """Displacement of each pulling stage and each field at t = 0, (surfaces + fields, 2)."""
        stages = [(x, 0.0) for x in self.model.surfaces.anchor]
        return np.array([*stages, *(field.anchor for field in self.model.fields or ())])

    def moved(self, t: float) -> np.ndarray:
        """How far each pulling stage and each field is at t from its anchor, (stages + fields, 2).

        A stage's is relative to the initial motion of its surface.
        """
        stages = [(float(self.stage_moved(k, t)), 0.0) for k in range(len(self.scene.surfaces))]
        fields = [np.multiply(field.drift, t) for field in self.model.fields or ()]
        return np.array([*stages, *fields])

    @property
    def numbering(self) -> tuple[object, ...]:
        """Equal for layouts in which each number of y and s is of the same thing."""
        names = [name for name in records.SURFACE.names or () if name[:4] in ("dof_", "acc_")]
        own = self.surfaces[["stop", "account_stride", *names]]
        return own.tolist(), self.accounts_of_fields, self.accounts

    def stage_moved(self, index: int, t: Any) -> Any:
        """How far the pulling stage of a surface is from its anchor at times t, likewise."""
        for each in self.scheduled:
            if each.surface == index and each.name == "stage":
                return each.at(t, begun_of(each, self.begun))
        return self.number_of(index, "speed") * np.asarray(t)

    def begun_at(self, begun: np.ndarray, anchors: np.ndarray) -> Layout:
        """The same layout with drives and ends that began at other times.

        `anchors` are the places of pulling stages and fields at t = 0.
        """
        model = self.model
        count = len(self.scene.surfaces)
        surfaces = model.surfaces.copy()
        surfaces.anchor = anchors[:count, 0]
        surfaces.push -= surfaces.push_rate * begun[:count, BEGUN.index("push_x")]
        surfaces.load -= surfaces.load_rate * begun[:count, BEGUN.index("push_y")]
        own = model.own
        if own is not None:
            own = own.copy()
            for surface in surfaces:
                own[records.OWN_LOAD, surface.start : surface.end] = surface.load
        drives = _begun_at(model.drives, begun[:, BEGUN.index("drive")])
        ends = _begun_at(model.ends, begun[:, BEGUN.index("ends")])
        fields = zip(
            model.fields or (),
            anchors[count:],
            begun[count:, BEGUN.index("field")].tolist(),
            strict=True,
        )
        moved = tuple(
            field._replace(origin=field.origin - anchor, anchor=anchor, begun=own)
            for field, anchor, own in fields
        )
        model = model._replace(
            surfaces=surfaces,
            fields=moved or None,
            drives=drives or None,
            ends=ends or None,
            own=own,
        )
        begun_then = replace(self, model=model, begun=begun)
        model = model._replace(schedules=begun_then.legs.tables[0])
        return replace(begun_then, model=model)

    @property
    def constants(self) -> np.ndarray:
        """The constants of all asperites, (rows, n); see `tribo.kernels.records.CONSTANTS`."""
        surfaces = np.asarray(self.model.surfaces)
        owners = np.asarray(self.asperites)["surface"]
        columns = columns_of_constants(surfaces, owners, self.places.columns)
        return np.asarray(self.model.constants[:, columns])

    @property
    def depths(self) -> np.ndarray:
        """z of every bob [length], (n,)."""
        return np.asarray(self.model.each[records.Z, self.places.columns])

    @property
    def plugins(self) -> list[Any]:
        """All plug-ins that the kernels are compiled with."""
        model = self.model
        own = [custom.plugin for custom in (*(model.drives or ()), *(model.ends or ()))]
        acting = (*model.contacts, *(model.fields or ()))
        return [item.potential for item in acting] + own

    @property
    def accounts_of_fields(self) -> list[int]:
        """Slots of the works of moving fields."""
        return [field.account for field in self.model.fields or () if field.account >= 0]

    @cached_property
    def velocities(self) -> np.ndarray:
        """Initial velocities of the surfaces in the laboratory, (surfaces, 2)."""
        return np.array([surface.velocity for surface in self.scene.surfaces])

    @cached_property
    def together(self) -> Span:
        """The asperites of all surfaces."""
        mine = self.asperites.surface
        one = span_of(self.asperites, self.surfaces, self.velocities[mine])
        if self.numbers is None:
            return one
        own = {
            name: self._rows(self.numbers.asperites[name])
            for name, each in vars(one.asperites).items()
            if each.dtype.kind == "f"
        }
        velocity = np.moveaxis(self._rows(self.numbers.velocity[:, mine]), 2, 0)
        return replace(one, asperites=Asperites(**vars(one.asperites) | own), velocity=velocity)

    @cached_property
    def whole_spans(self) -> tuple[Span, ...]:
        """The asperites of all surfaces, in as few spans as they fit."""
        whole = self.together
        count = self.scene.count
        return (whole,) if count <= SPAN_SIZE else spans_of(whole, slice(0, count))

    @cached_property
    def spans(self) -> tuple[tuple[Span, ...], ...]:
        return tuple(spans_of(self.together, part) for part in self.parts.values())

    @cached_property
    def accounted(self) -> Span:
        """Those that have the accounts: all asperites, or lanes that stand for their sums."""
        if self.model.sums is None:
            return self.together
        lanes = slots.lanes_of_surfaces(self.scene, self.surfaces).view(np.recarray)
        return span_of(lanes, self.surfaces, self.velocities[lanes.surface])

    @cached_property
    def accounted_parts(self) -> tuple[slice, ...]:
        """The place of each surface in `accounted`."""
        counts = self.surfaces.account_stride
        stops = np.cumsum(counts)
        return tuple(map(slice, (stops - counts).tolist(), stops.tolist()))

    @cached_property
    def accounted_spans(self) -> tuple[tuple[Span, ...], ...]:
        """Those of each surface that have the accounts."""
        if self.model.sums is None:
            return self.spans
        return tuple(spans_of(self.accounted, part) for part in self.accounted_parts)

    def velocity_of(self, index: int) -> tuple[float | np.ndarray, ...]:
        """The initial velocity of a surface, in the laboratory: x and y."""
        if self.numbers is None:
            return tuple(self.velocities[index].tolist())
        return tuple(self._rows(self.numbers.velocity[:, index]).T)

    def mass_of(self, index: int) -> float | np.ndarray:
        """The mass of a surface and its bath."""
        record = self.surfaces[index]
        if self.numbers is None:
            return float(record.total_mass)
        own = self.numbers.asperites["mass"][:, list(self.parts.values())[index]].sum(axis=1)
        return self._rows(own + (record.total_mass - record.mass))

    def number_of(self, index: int, name: str) -> float | np.ndarray:
        """A number of a surface's drive or reservoir, of those in OF_MEMBERS."""
        if self.numbers is None:
            return float(self.surfaces[index][name])
        return self._rows(self.numbers.of_surfaces[:, index, OF_MEMBERS.index(name)])

    def _rows(self, each: np.ndarray) -> np.ndarray:
        """A row for each time and member, from one for each member."""
        return np.concatenate([each] * self.member_times)

    @cached_property
    def shifts(self) -> np.ndarray:
        """One rounding of the place of each bob, along x and y, of either sign (2, asperites)."""
        a = np.asarray(self.asperites)
        moved = np.hypot(a["vx"] - a["vx"][0], a["vy"] - a["vy"][0]) * self.scene.duration
        place = np.hypot(a["x"], a["y"]) + moved + a["l1"] + a["l2"]
        signs = np.random.default_rng(0).choice([-1.0, 1.0], (2, place.size))
        return np.asarray(ROUNDING * place * signs)

    def with_other_rounding(self) -> Layout:
        """The same layout with all bobs displaced by a rounding of their places.

        All runs of a layout share the rounding of its places.  At an equilibrium that is unstable,
        such as a bar on the maximum of a field, it is all that moves anything, in all runs alike:
        in 5 units of time, an error grew to 70 times the difference of two runs.  So one of the
        runs that are compared has other places.
        """
        x, y = self.shifts
        columns = self.places.columns
        asperites = np.array(self.asperites)
        asperites["x"] += x
        asperites["y"] += y
        each = room(self.model.each.shape)
        each[:] = self.model.each
        each[records.X_START, columns] += x
        each[records.Y_START, columns] += y
        model = self.model._replace(each=each)
        return replace(self, asperites=asperites.view(np.recarray), model=model)

    def neighbours(self, splits: bool = False) -> Neighbours:
        """An empty list, which the first evaluation fills; `splits` leaves inactive packs out."""
        return contacts.neighbours(self.scene, self.model, self.rows, self.skin, splits)


def _begun_at(forces: tuple[Custom, ...] | None, times: np.ndarray) -> tuple[Custom, ...]:
    """A user's forces, each begun at the time of its surface, (surfaces,)."""
    return tuple(each._replace(begun=float(times[each.surface])) for each in forces or ())


def lay_out(scene: Scene) -> Layout:
    """The flat arrays of a scene, in which absent effects have no slots."""
    scene = loaded(scene)
    bobs = [resting_bobs(scene, k) for k in range(len(scene.surfaces))]
    scheduled = scheduled_numbers(scene)
    asperites, physics = scene_records(scene, bobs, scheduled)
    origin = np.array(scene.surfaces[0].first_bob[:2])
    fields, shared = number_shared_accounts(scene, physics, origin, scheduled)
    wanted = slots.wanted_slots(scene, physics)
    mine = slots.number(scene, physics, wanted, shared, width=1)
    theirs = slots.number(scene, physics, wanted, shared, LANES)
    slots.give_slots(asperites, mine.surfaces, ("dof_", "acc_"))
    if scene.output.ledger == "surfaces":
        for name in slots.GROUPS:  # only lanes have accounts
            asperites[name] = -1
    start = start_of(asperites, scene, mine)
    depths = [own[:, 2] for own in bobs]
    calculators, calls = contacts.calculators(scene, depths, theirs.surfaces["start"])
    found, rows, skin = contacts.lay_out_contacts(scene)
    orders = slots.orders_of_bobs(scene, bobs, compact=rows > 0 and not calls)
    places = slots.places(mine, theirs, np.arange(shared), orders)
    ends = plugin_forces(scene, origin, lambda surface: surface.plugin_at_ends)
    columns = places.columns[:, None]
    z = np.concatenate(depths)
    model = model_tables(scene, asperites, z, theirs, columns, apart=False)._replace(
        contacts=found,
        inner=True if any(contact.within for contact in found) else None,
        calculators=calculators,
        fields=fields,
        external=True if fields else None,
        drives=plugin_forces(scene, origin, lambda surface: surface.drive.plugin),
        ends=ends,
        left=True if ends else None,
        right=True if ends else None,
        team=True if contacts.is_shared(scene, found) else None,
    )
    layout = Layout(
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
        origin=origin,
        calculator_calls=calls,
        scheduled=scheduled,
        rows=rows,
        skin=skin,
        begun=np.zeros((len(scene.surfaces) + len(scene.fields), len(BEGUN))),
    )
    layout = replace(layout, model=model._replace(schedules=layout.legs.tables[0]))
    for plugin in layout.plugins:
        recognize(plugin)
    return layout
