"""Kept quantities of many members: what they are, and their values."""

import difflib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from tribo.accuracy.comparison import LOST
from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.ledger import quantities
from tribo.ledger.guards import MOST_MISSED
from tribo.ledger.quantity import Quantity
from tribo.ledger.reported import SUMMED_QUANTITIES, Reported, present_names, quantity_of, reported
from tribo.ledger.sinks import exceeds_memory
from tribo.model.scene import Scene
from tribo.result import Result
from tribo.results.force_averages import force_average
from tribo.results.notes import HEATS, NO_WORK, excess_note
from tribo.validation import InputError

# The status of a member whose accuracy is out of reach.
MISSED = "AccuracyMissed"
# The status of a member that still needs a run with a search for its own settings.
UNKNOWN = ""
# The status of a point of a sweep that cannot be run, and of one that an interrupt left out.
REFUSED = "Refused"
NOT_RUN = "not run"
# Quantities of asperites, whose sums over a surface are kept.
SUMMED = quantities.ASPERITE_QUANTITIES | quantities.OPTIONAL_QUANTITIES
# What is added to the name of an average over time for the half-width of its 95 % interval.
INTERVAL = "_time_half_width"
# The quantity beside which the share of time without contact is kept, where contact has a range.
FRICTION = "friction_force"
SHARE = "time_without_contact"
# What is added to the name of a quantity for the bounds on its errors.
ERROR = "_error"
# Counts beside those of statuses: run again, in need of it, and with works lost in rounding.
CHECKED = "checked"
REFINED = "refined"
WEAK = "weak"
# A count of members that have an average over time, but no interval of it.
WITHOUT_INTERVAL = "without interval"
# Beside them: the sum of excesses, and the number of its terms.
EXCESS = "excess"
EXCESSES = "excesses"
# And members with runs of their own in which the step heats.
HEATED = "heated"
# And members of whose energy no work accounts for too much.
MISSING = "missing"
# Ends of runs whose step is too long: other members completed with it, perhaps by chance.
RUN_AWAY = frozenset(map(str, (Status.ENERGY_RUNAWAY, Status.NOT_FINITE, Status.ENCOUNTER_JUMPED)))
# Of an array of names of statuses.
STATUS_TYPE = f"U{max(map(len, [MISSED, REFUSED, *Status]))}"


# Kept quantities of some members by name, (members, [times,] [asperites]), NaN without a value;
# bounds on their errors, as "upper.w1_error", NaN where unknown, if Kept.with_errors; and how the
# runs went, (members,): status, steps, force_evaluations, the level of the tolerances (NaN of a
# run of its own, or with a given step), the error, which is the largest difference from a finer run
# in scales (NaN of members not checked), the excess, by which a step with noise makes the kinetic
# temperature too high, relative (NaN of runs of their own), and a note with limitations, a line
# each.
KeptValues = dict[str, np.ndarray]


def joined(parts: Sequence[KeptValues]) -> KeptValues:
    """The values of members one after another."""
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def completed(found: KeptValues) -> np.ndarray:
    """Which members completed, (members,)."""
    return np.asarray(found["status"] == str(Status.COMPLETED))


def set_notes(found: KeptValues, places: int | np.ndarray, notes: str | list[str]) -> None:
    found["note"] = found["note"].astype(np.result_type(found["note"], np.array(notes)))
    found["note"][places] = notes


def doubtful(statuses: Mapping[str, int]) -> int:
    """Members that completed, if others ran away with the same step."""
    return statuses.get(str(Status.COMPLETED), 0) if RUN_AWAY & statuses.keys() else 0


def step_notes(statuses: Mapping[str, int], excess: float, step: float | None) -> Iterator[str]:
    """Notes on a given step with which members ran away beside others, or that heats."""
    if step is None:
        return
    if number := doubtful(statuses):
        away = sorted(RUN_AWAY & statuses.keys())
        others = sum(statuses[name] for name in away)
        yield (
            f"the {number} members that completed are doubtful: with the same steps of {step:.3g}, "
            f"{others} others ran away ({', '.join(away)}); give a shorter step, or none"
        )
    yield from excess_note(excess, step)


def is_averaged(name: str) -> bool:
    """Whether a quantity that is kept of members without their samples is an average over time."""
    kind = name.rpartition(".")[2].removesuffix(INTERVAL)
    return kind in (*quantities.AVERAGED, SHARE)


@dataclass(frozen=True)
class Kept:
    """What is kept of each member."""

    shapes: Mapping[str, tuple[int, ...]]  # "upper.w1" -> its shape in one member
    at_samples: bool  # at all times of the scene, or at the end alone
    with_errors: bool = False  # of each value, which is kept also where it misses the accuracy
    counts: Mapping[str, int] = field(default_factory=dict)  # of asperites, if they are summed

    @classmethod
    def sums(cls, layout: Layout) -> Self:
        """The series of all surfaces as wholes and of the system, and sums over asperites."""
        scene = layout.scene
        times = layout.times.size
        names = total_names(scene)
        if not exceeds_memory(layout, times):
            names += sum_names(scene)
        counts = {surface.name: surface.count for surface in scene.surfaces}
        return cls(dict.fromkeys(names, (times,)), True, counts=counts)

    @classmethod
    def at_end(cls, scene: Scene, keep: Sequence[str], with_errors: bool = False) -> Self:
        """Quantities of a scene at its end, each name once.  Raises InputError."""
        return cls._checked(scene, keep, None, with_errors)

    @classmethod
    def at_all_times(cls, layout: Layout, keep: Sequence[str], with_errors: bool = False) -> Self:
        """The same at all times.  Raises InputError, also if the series are too long."""
        times = layout.times.size
        if exceeds_memory(layout, times):
            raise InputError(
                "at", f'"samples" would keep series that are too long: {times} times; give fewer'
            )
        return cls._checked(layout.scene, keep, times, with_errors)

    @classmethod
    def _checked(
        cls, scene: Scene, keep: Sequence[str], times: int | None, with_errors: bool
    ) -> Self:
        """Quantities at so many times, or at the end alone.  Raises InputError."""
        at_samples = times is not None
        leading = () if times is None else (times,)
        reports = dict(_reported(scene))
        shapes: dict[str, tuple[int, ...]] = {}
        for name in map(str, keep):
            shape = _shape(name, reports, scene)
            if shape is None and (at_samples or not is_interval(name)):
                near = difflib.get_close_matches(name, _names_of(reports), n=1)
                raise InputError(
                    f"keep.{name}",
                    f'must be a quantity of a surface, as "{scene.surfaces[0].name}.w1", or one '
                    'of the system, as "contact_energy"' + "".join(f'; is it "{n}"?' for n in near),
                )
            shapes[name] = (*leading, *(shape or ()))
            surface, _, kind = name.rpartition(".")
            if kind in quantities.AVERAGED and not at_samples:
                _check_averaged(scene)
                shapes[f"{name}{INTERVAL}"] = ()
                if kind == FRICTION and _shape(f"{surface}.{SHARE}", reports, scene) == ():
                    shapes[f"{surface}.{SHARE}"] = ()
        return cls(shapes, at_samples, with_errors)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.shapes)

    @property
    def times(self) -> int:
        """The number of times at which quantities are kept."""
        return next(iter(self.shapes.values()))[0] if self.at_samples else 1

    def columns(self, name: str) -> int:
        """The number of values of a quantity at one time."""
        return int(np.prod(self.shapes[name], dtype=int)) // self.times

    def dimensions(self, name: str) -> tuple[str, ...]:
        found = ("time",) if self.at_samples else ()
        if len(self.shapes[name]) == len(found):
            return found
        return (*found, f"{name.rpartition('.')[0]}_asperite")

    def about(self, name: str, of: str = "") -> dict[str, str]:
        """The units and the meaning of a quantity, or `of` it."""
        kind = name.rpartition(".")[2].removesuffix(INTERVAL)
        quantity = quantity_of(kind, len(self.dimensions(name)) == self.at_samples)
        when = ", averaged over time" if is_averaged(name) else ", at the end"
        meaning = quantity.long_name if self.at_samples else quantity.long_name + when
        before = "half-width of the 95 % interval of: " if is_interval(name) else ""
        return {"units": quantity.units, "long_name": of + before + meaning}

    def of_asperites(self, series: np.ndarray) -> np.ndarray:
        """A series as it is kept: (times,) or (times, asperites)."""
        return np.sum(series, axis=1) if self.counts and series.ndim == 2 else series

    def without_runs(self, members: int, status: str = UNKNOWN, note: str = "") -> KeptValues:
        """The values of members that have not been run."""
        bounds = [f"{name}{ERROR}" for name in self.names if self.with_errors]
        shapes = {**self.shapes, **dict.fromkeys([*bounds, "level", "error", "excess"], ())}
        return {
            **{name: np.full((members, *shape), np.nan) for name, shape in shapes.items()},
            **{name: np.zeros(members, np.int64) for name in ("steps", "force_evaluations")},
            "status": np.full(members, status, STATUS_TYPE),
            "note": np.full(members, note),
        }

    def of_others(self, found: KeptValues) -> KeptValues:
        """The values of runs of another scene, which may lack a quantity or have others."""
        mine = self.without_runs(found["status"].size)
        return mine | {name: found[name] for name in mine.keys() & found.keys()}

    def fill_in(self, found: KeptValues, index: int, result: Result) -> None:
        """Set the values of one member.  Raises KeyboardInterrupt if its run was interrupted."""
        if result.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        ended = result.status == Status.COMPLETED
        missed = ended and result.met is False
        found["status"][index] = MISSED if missed else str(result.status)
        found["steps"][index] = result.cost.steps
        found["force_evaluations"][index] = result.cost.force_evaluations
        notes = () if result.shortcoming and self.with_errors else result.notes
        set_notes(found, index, "\n".join(filter(None, [result.shortcoming, *notes])))
        known = ended and (self.with_errors or not missed)
        values = self._values_of(result) if known else {}
        for name in self.names:
            found[name][index] = values.get(name, np.nan)
            if self.with_errors:
                bounds = result.error_estimate
                surface, _, kind = name.rpartition(".")
                bound = bounds.get(name, bounds.get(kind)) if known else None
                terms = self.counts.get(surface, 1) if kind in SUMMED else 1
                found[f"{name}{ERROR}"][index] = np.nan if bound is None else bound * terms

    def _values_of(self, result: Result) -> dict[str, np.ndarray | float]:
        """The kept values of a complete result."""
        found: dict[str, np.ndarray | float] = {}
        ledger = result.ledger if self.at_samples else result.ledger.at_end()
        for name in self.names:
            averaged = name.removesuffix(INTERVAL)
            if self.at_samples:
                found[name] = self.of_asperites(ledger.series(name)[0])
            elif name in found:  # with its average
                continue
            elif averaged.rpartition(".")[2] in quantities.AVERAGED:
                average = force_average(result, averaged)
                found[averaged] = average.mean
                found[f"{averaged}{INTERVAL}"] = average.half_width
            elif name.endswith(f".{SHARE}"):
                found[name] = result.time_without_contact(name.rpartition(".")[0])
            else:
                found[name] = ledger.series(name)[0][-1]
        return found


def total_names(scene: Scene) -> list[str]:
    """Names of the series of the surfaces as wholes and of the system."""
    summed = SUMMED_QUANTITIES
    found = _reported(scene)
    names = [f"{name}.{n}" for name, each in found for n in each.blocks if n not in summed]
    return [*names, *dict.fromkeys(n for _, each in found for n in each.system)]


def sum_names(scene: Scene) -> list[str]:
    """Names of the works and heats of asperites that are summed over their surface."""
    found = _reported(scene)
    tables = [(name, table) for name, each in found for table in (each.asperites, each.blocks)]
    return [
        f"{surface}.{name}"
        for surface, table in tables
        for name, quantity in table.items()
        if quantity.is_summed
    ]


def _reported(scene: Scene) -> list[tuple[str, Reported]]:
    """The quantities that a scene reports, by surface."""
    present = [(each.name, present_names(scene, each)) for each in scene.surfaces]
    return [(name, reported(scene.output.ledger, own)) for name, own in present]


def is_interval(name: str) -> bool:
    """Whether a name, as "upper.friction_force_time_half_width", is that of an interval."""
    kind = name.rpartition(".")[2]
    return kind.endswith(INTERVAL) and kind.removesuffix(INTERVAL) in quantities.AVERAGED


def _shape(name: str, reports: Mapping[str, Reported], scene: Scene) -> tuple[int, ...] | None:
    """The shape of a quantity at one time; None if the scene does not report it."""
    surface, _, kind = name.rpartition(".")
    if not surface:
        return () if kind in _of_system(reports) else None
    if surface not in reports:
        return None
    if kind in reports[surface].asperites:
        return (scene.surfaces[scene.index_of(surface)].count,)
    return () if kind in reports[surface].blocks else None


def _of_system(reports: Mapping[str, Reported]) -> Mapping[str, Quantity]:
    """The quantities of the system, as the ledger has them."""
    return list(reports.values())[-1].system


def _names_of(reports: Mapping[str, Reported]) -> list[str]:
    """The names of all that is reported of a scene."""
    tables = [
        (name, table) for name, own in reports.items() for table in (own.asperites, own.blocks)
    ]
    return [
        *_of_system(reports),
        *(f"{surface}.{kind}" for surface, table in tables for kind in table),
    ]


def _check_averaged(scene: Scene) -> None:
    """Refuse averages over time of less than two samples, beside a first one without a value."""
    least = 3
    run_in = scene.output.run_in
    times = int(np.count_nonzero(scene.times >= run_in))
    if times < least:
        later = f" from t = {run_in:g} on" if run_in > 0.0 else ""
        mend = ""
        if run_in > 0.0 and scene.times.size >= least:
            mend = (
                f"; output.run_in must be below the duration {scene.duration:g}, and change with "
                'it in a sweep, as "duration,output.run_in" does'
            )
        raise InputError(
            "output.samples",
            f"must be at least {least}{later} for averages of forces over time, got {times}{mend}",
        )


def without_interval(found: KeptValues) -> np.ndarray:
    """Which runs completed with an average over time that has no interval, (runs,)."""
    missing = [np.isnan(each) for name, each in found.items() if is_interval(name)]
    return completed(found) & np.any([np.zeros(found["status"].size, bool), *missing], axis=0)


def interval_note(number: int, total: int, what: str) -> str:
    return (
        f"averages over time of {number} of {total} {what} have no interval (NaN): their series "
        "are too short for one; run for longer, or let the averages begin earlier (output.run_in)"
    )


def missing_note(number: int, total: int) -> Iterator[str]:
    """A note on members of whose energy no work accounts for too much."""
    if number:
        yield (
            f"in {number} of {total} members {NO_WORK} more than {100.0 * MOST_MISSED:.2g} % of "
            "the energy that reservoirs and drives exchange; give a shorter step"
        )


class Tally(Counter[str]):
    """Numbers of members by status, and of those that are named above."""

    def take_in(self, found: KeptValues, common_level: float) -> None:
        """Count some members; `common_level` is that of most of them, NaN if there is none."""
        others = found["status"][~completed(found)]  # comparing is quicker than counting
        self.update(others.tolist())
        self[str(Status.COMPLETED)] += found["status"].size - others.size
        if np.isfinite(common_level):
            self[CHECKED] += int(np.isfinite(found["error"]).sum())
            self[REFINED] += int((found["level"] != common_level).sum())
        noted = found["note"][found["note"] != ""].tolist()
        self[WEAK] += sum(LOST in note for note in noted)
        self[WITHOUT_INTERVAL] += int(without_interval(found).sum())
        self[HEATED] += sum(HEATS in note for note in noted)
        self[MISSING] += sum(NO_WORK in note for note in noted)
        excess = found["excess"][~np.isnan(found["excess"])]
        self[EXCESS] += float(np.sum(excess))  # type: ignore[assignment]
        self[EXCESSES] += excess.size

    @property
    def statuses(self) -> dict[str, int]:
        others = (CHECKED, REFINED, WEAK, WITHOUT_INTERVAL, EXCESS, EXCESSES, HEATED, MISSING)
        return {name: n for name, n in self.items() if n and name not in others}

    @property
    def excess(self) -> float:
        """The mean excess of the kinetic temperature; 0 where none was measured."""
        return self[EXCESS] / max(1, self[EXCESSES])

    def notes(self, step: float | None) -> Iterator[str]:
        """How many members were refined, and how many have no values; what a given step does."""
        total = sum(self.statuses.values())
        if stopped := sorted(self.statuses.keys() - {str(Status.COMPLETED)}):
            number = total - self[str(Status.COMPLETED)]
            yield f"{number} of {total} members have no values ({', '.join(stopped)})"
        of_step = [*step_notes(self.statuses, self.excess, step)]
        yield from of_step
        if self[HEATED] and not any(HEATS in note for note in of_step):
            yield (
                f"in {self[HEATED]} of {total} members the step makes the kinetic temperature more "
                "than 1 % too high; give a shorter step, or none"
            )
        yield from missing_note(self[MISSING], total)
        if self[CHECKED]:
            again = f"{self[CHECKED]} members were run again with finer settings"
            yield f"{again}; {self[REFINED]} needed them"
        if self[WEAK]:
            yield (
                f"works of {self[WEAK]} members that were compared lie {LOST} that they change: "
                "errors are relative to these, and these works have no digit that is known"
            )
        if self[WITHOUT_INTERVAL]:
            yield interval_note(self[WITHOUT_INTERVAL], total, "members")
