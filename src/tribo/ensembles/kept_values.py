"""Kept quantities of many members: what they are, and their values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Self

import numpy as np

from tribo.accuracy.weak_works import LOST
from tribo.kernels.status import Status
from tribo.layout.further_series import further_series, system_names
from tribo.layout.layout import Layout
from tribo.ledger.ledger import Ledger, assemble
from tribo.ledger.quantities import (
    ASPERITE_QUANTITIES,
    AVERAGED,
    BLOCK_QUANTITIES,
    EVERY_QUANTITY,
    FURTHER_OF_SURFACES,
    OPTIONAL_QUANTITIES,
    SYSTEM_QUANTITIES,
    needs_accounts,
)
from tribo.ledger.samples import Samples
from tribo.ledger.sinks import exceeds_memory
from tribo.loops.frames import Arrays
from tribo.loops.state import below
from tribo.model.scene import Scene
from tribo.result import Result
from tribo.results.force_averages import force_average
from tribo.validation import InputError

# The status of a member whose accuracy is out of reach.
MISSED = "AccuracyMissed"
# The status of a member that still needs a run with a search for its own settings.
UNKNOWN = ""
# The status of a point of a sweep that cannot be run, and of one that an interrupt left out.
REFUSED, NOT_RUN = "Refused", "not run"
# Works of each asperite whose sums over a surface are kept.
WORKS = ("w1", "w2", "wL", "wR", "w_int")
# Quantities of asperites, whose sums over a surface are kept.
SUMMED = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES
# What is added to the name of an average over time for the half-width of its 95 % interval.
INTERVAL = "_time_half_width"
# The quantity beside which the share of time without contact is kept, where contact has a range.
FRICTION, SHARE = "friction_force", "time_without_contact"
# Of an array of names of statuses.
STATUS_TYPE = f"U{max(map(len, [MISSED, REFUSED, *Status]))}"


@dataclass(eq=False)
class KeptValues:
    """Kept quantities of some members, and how their runs went; all but `values` are (members,)."""

    values: dict[str, np.ndarray]  # name -> (members, [times,] [asperites]); NaN of members without
    # name -> bounds on errors, NaN where unknown; of all quantities if Kept.with_errors
    errors: dict[str, np.ndarray]
    status: np.ndarray
    steps: np.ndarray
    evaluations: np.ndarray
    level: np.ndarray  # of the tolerances; NaN of members with a run of their own, or a given step
    error: np.ndarray  # largest difference from a finer run, in scales; NaN of members not checked
    note: np.ndarray  # limitations of each run, a line each

    @classmethod
    def without_runs(cls, kept: Kept, members: int, status: str = UNKNOWN, note: str = "") -> Self:
        """The values of members that have not been run."""
        shapes = zip(kept.names, kept.shapes, strict=True)
        return cls(
            {name: np.full((members, *shape), np.nan) for name, shape in shapes},
            {name: np.full(members, np.nan) for name in kept.names if kept.with_errors},
            np.full(members, status, dtype=STATUS_TYPE),
            np.zeros(members, np.int64),
            np.zeros(members, np.int64),
            np.full(members, np.nan),
            np.full(members, np.nan),
            np.full(members, note),
        )

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Parts one after another."""
        tables = [part.arrays() for part in parts]
        return cls.of_arrays(
            {name: np.concatenate([t[name] for t in tables]) for name in tables[0]}
        )

    def arrays(self) -> Arrays:
        """All of it, by name."""
        rest = [each.name for each in fields(self) if each.name not in ("values", "errors")]
        return (
            {f"value_{name}": values for name, values in self.values.items()}
            | {f"bound_{name}": values for name, values in self.errors.items()}
            | {name: getattr(self, name) for name in rest}
        )

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, np.ndarray]) -> Self:
        """As :meth:`arrays` returned it."""
        rest = [each.name for each in fields(cls) if each.name not in ("values", "errors")]
        values, errors = (below(prefix, dict(arrays)) for prefix in ("value_", "bound_"))
        return cls(values, errors, *(arrays[name] for name in rest))

    def set_notes(self, places: int | np.ndarray, notes: str | list[str]) -> None:
        """Replace the notes of some members."""
        self.note = self.note.astype(np.result_type(self.note, np.array(notes)))
        self.note[places] = notes

    def set_alone(self, index: int, result: Result, kept: Kept) -> None:
        """Fill in one member.  Raises KeyboardInterrupt if its run was interrupted."""
        if result.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        completed = result.status == Status.COMPLETED
        missed = completed and result.met is False
        self.status[index] = MISSED if missed else str(result.status)
        self.steps[index] = result.cost.steps
        self.evaluations[index] = result.cost.force_evaluations
        note = "\n".join(filter(None, [result.shortcoming, *result.notes]))
        if result.shortcoming and kept.with_errors:
            note = result.shortcoming
        self.set_notes(index, note)
        known = completed and (kept.with_errors or not missed)
        values = kept.values_of(result) if known else {}
        bounds = result.error_estimate if known and kept.with_errors else {}
        for name in kept.names:
            self.values[name][index] = values.get(name, np.nan)
            if name in self.errors:
                bound = bounds.get(name, bounds.get(name.rpartition(".")[2]))
                self.errors[name][index] = np.nan if bound is None else bound * kept.terms(name)


@dataclass(frozen=True)
class Kept:
    """What is kept of each member."""

    names: tuple[str, ...]  # "upper.w1"
    at_samples: bool  # at all times of the scene, or at the end alone
    shapes: tuple[tuple[int, ...], ...] = field(repr=False)  # of each quantity in one member
    # each value has an error estimate; values that miss the accuracy are kept too
    with_errors: bool = False
    # asperites of each surface, over which quantities are summed; else empty
    counts: Mapping[str, int] = field(default_factory=dict)

    @classmethod
    def sums(cls, layout: Layout) -> Self:
        """The series of all surfaces as wholes and of the system, and sums over asperites."""
        scene, times = layout.scene, layout.times.size
        names = total_names(scene)
        if not exceeds_memory(layout, times):
            names += sum_names(scene)
        counts = {surface.name: surface.count for surface in scene.surfaces}
        return cls(tuple(names), True, ((times,),) * len(names), counts=counts)

    @classmethod
    def checked(
        cls, layout: Layout, keep: Sequence[str], at_samples: bool, with_errors: bool = False
    ) -> Self:
        """The names, each once, of quantities of a scene.  Raises InputError."""
        ledger, times = assemble(layout, Samples.at_zero(layout)), layout.times.size
        scene, surfaces = layout.scene, layout.parts
        if at_samples and exceeds_memory(layout, times):
            raise InputError(
                "at", f'"samples" would keep series that are too long: {times} times; give fewer'
            )
        names: list[str] = []
        for name in map(str, keep):
            shape = _shape(name, ledger, scene)
            if shape is None and (at_samples or not is_interval(name)):
                raise InputError(
                    f"keep.{name}",
                    f'must be a quantity of a surface, as "{next(iter(surfaces))}.w1", or one of '
                    'the system, as "contact_energy"',
                )
            names.append(name)
            if name.rpartition(".")[2] in AVERAGED and not at_samples:
                _check_averaged(scene)
                names.append(f"{name}{INTERVAL}")
                surface, _, kind = name.rpartition(".")
                beside = f"{surface}.{SHARE}"
                if kind == FRICTION and _shape(beside, ledger, scene) is not None:
                    names.append(beside)
        unique = tuple(dict.fromkeys(names))
        leading = (times,) if at_samples else ()
        own = (_shape(name, ledger, scene) or () for name in unique)
        return cls(unique, at_samples, tuple((*leading, *shape) for shape in own), with_errors)

    @property
    def times(self) -> int:
        """The number of times at which quantities are kept."""
        return self.shapes[0][0] if self.at_samples else 1

    def columns(self, name: str) -> int:
        """The number of values of a quantity at one time."""
        return int(np.prod(self.shapes[self.names.index(name)], dtype=int)) // self.times

    def dimensions(self, name: str) -> tuple[str, ...]:
        """Of a quantity in one member."""
        shape = self.shapes[self.names.index(name)]
        found = ("time",) if self.at_samples else ()
        asperites = (f"{name.rpartition('.')[0]}_asperite",)
        return found + asperites * (len(shape) > len(found))

    def about(self, name: str) -> dict[str, str]:
        """The units and the meaning of a quantity."""
        kind = name.rpartition(".")[2].removesuffix(INTERVAL)
        quantity = EVERY_QUANTITY[kind]
        when = ", averaged over time" if kind in (*AVERAGED, SHARE) else ", at the end"
        meaning = quantity.long_name + when * (not self.at_samples)
        before = "half-width of the 95 % interval of: " * is_interval(name)
        return {"units": quantity.units, "long_name": before + meaning}

    def terms(self, name: str) -> int:
        """The number of values of asperites that a kept value is the sum of."""
        surface, _, kind = name.rpartition(".")
        return self.counts.get(surface, 1) if kind in SUMMED else 1

    def of_asperites(self, series: np.ndarray) -> np.ndarray:
        """A series as it is kept: (times,) or (times, asperites)."""
        return np.sum(series, axis=1) if self.counts and series.ndim == 2 else series

    def values_of(self, result: Result) -> dict[str, np.ndarray | float]:
        """The kept values of a complete result."""
        found: dict[str, np.ndarray | float] = {}
        ledger = result.ledger if self.at_samples else result.ledger.at_end()
        for name in self.names:
            averaged = name.removesuffix(INTERVAL)
            if self.at_samples:
                found[name] = self.of_asperites(ledger.series(name)[0])
            elif name in found:  # with its average
                continue
            elif averaged.rpartition(".")[2] in AVERAGED:
                average = force_average(result, averaged)
                found[averaged], found[f"{averaged}{INTERVAL}"] = average.mean, average.half_width
            elif name.endswith(f".{SHARE}"):
                found[name] = result.time_without_contact(name.rpartition(".")[0])
            else:
                found[name] = ledger.series(name)[0][-1]
        return {name: found[name] for name in self.names}


def total_names(scene: Scene) -> list[str]:
    """Names of the series of the surfaces as wholes and of the system."""
    blocks = [
        f"{surface.name}.{name}"
        for surface in scene.surfaces
        for name in (*BLOCK_QUANTITIES, *FURTHER_OF_SURFACES)
        if name in BLOCK_QUANTITIES or name in further_series(scene, surface)
    ]
    return _without_accounts(scene, [*blocks, *SYSTEM_QUANTITIES, *system_names(scene)])


def sum_names(scene: Scene) -> list[str]:
    """Names of the works and heats of asperites that are summed over their surface."""
    names = []
    for surface in scene.surfaces:
        fields = any(surface.name in item.on for item in scene.fields)
        kinds = WORKS + ("w_field",) * fields + ("w_T", "heat") * bool(surface.reservoirs)
        names += [f"{surface.name}.{kind}" for kind in kinds]
    return _without_accounts(scene, names)


def _without_accounts(scene: Scene, names: list[str]) -> list[str]:
    """The names that do not need a ledger which the scene does without."""
    none = scene.output.ledger == "none"
    return [name for name in names if not (none and needs_accounts(name.rpartition(".")[2]))]


def is_interval(name: str) -> bool:
    """Whether a name, as "upper.friction_force_time_half_width", is that of an interval."""
    return name.endswith(INTERVAL) and name.removesuffix(INTERVAL).rpartition(".")[2] in AVERAGED


def _shape(name: str, ledger: Ledger, scene: Scene) -> tuple[int, ...] | None:
    """The shape of a quantity at one time; None if the scene does not report it."""
    surface, _, kind = name.rpartition(".")
    if not surface:
        return () if kind in ledger.system else None
    count = {each.name: each.count for each in scene.surfaces}
    if kind in ledger.surfaces.get(surface, ()):
        return (count[surface],)
    return () if kind in ledger.blocks.get(surface, ()) else None


def _check_averaged(scene: Scene) -> None:
    """Refuse averages over time of less than two samples, beside a first one without a value."""
    least, run_in = 3, scene.output.run_in
    times = int(np.count_nonzero(scene.times >= run_in))
    if times < least:
        later = f" from t = {run_in:g} on" if run_in > 0.0 else ""
        raise InputError(
            "output.samples",
            f"must be at least {least}{later} for averages of forces over time, got {times}",
        )


@dataclass
class Tally:
    """Counts of members, for the notes of an ensemble."""

    status: dict[str, int] = field(default_factory=dict)
    checked: int = 0  # run again with finer settings
    refined: int = 0  # needed these
    weak: int = 0  # have a note on works that are lost in rounding

    def add(self, found: KeptValues, common_level: float) -> None:
        """Take in some members; `common_level` is that of most of them, NaN if there is none."""
        status = found.status
        others = status[status != str(Status.COMPLETED)]  # comparing is quicker than counting
        counts = Counter(others.tolist())
        counts[str(Status.COMPLETED)] = status.size - others.size
        self.status = dict(Counter(self.status) + counts)
        self.checked += int(np.isfinite(found.error).sum())
        if np.isfinite(common_level):
            self.refined += int((found.level != common_level).sum())
        self.weak += sum(LOST in note for note in found.note[found.note != ""].tolist())

    @property
    def notes(self) -> list[str]:
        """How many members were refined, and how many have no values."""
        notes, total = [], sum(self.status.values())
        stopped = {name: n for name, n in self.status.items() if name != Status.COMPLETED}
        if stopped:
            names = ", ".join(sorted(stopped))
            notes.append(f"{sum(stopped.values())} of {total} members have no values ({names})")
        if self.checked:
            notes.append(
                f"{self.checked} members were run again with finer settings; {self.refined} needed "
                "them"
            )
        if self.weak:
            notes.append(
                f"works of {self.weak} members that were compared lie {LOST} that they change: "
                "errors are relative to these, and these works have no digit that is known"
            )
        return notes
