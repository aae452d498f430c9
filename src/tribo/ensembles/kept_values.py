"""Kept quantities of many members, as labelled data."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Self

import numpy as np

from tribo.ensembles.dataset import varied_coordinates
from tribo.ensembles.members import Members
from tribo.kernels.status import Status
from tribo.ledger.ledger import Ledger
from tribo.ledger.quantities import AVERAGED, EVERY_QUANTITY
from tribo.ledger.sinks import exceeds_memory
from tribo.model.scene import Scene
from tribo.prepared import Simulation
from tribo.result import Result
from tribo.results.dataset import Variable
from tribo.results.force_averages import force_average
from tribo.validation import InputError, short_repr

if TYPE_CHECKING:
    import xarray

# The status of a member whose accuracy is out of reach.
MISSED = "AccuracyMissed"
# The status of a member that still needs a run with a search for its own settings, and in a file of
# one that has not been run.
UNKNOWN = ""
# What is added to the name of an average over time for the half-width of its 95 % interval.
INTERVAL = "_time_half_width"
# The quantity beside which the share of time without contact is kept, where contact has a range.
FRICTION, SHARE = "friction_force", "time_without_contact"
# Of an array of names of statuses.
STATUS_TYPE = f"U{max(map(len, [MISSED, *Status]))}"


@dataclass(eq=False)
class KeptValues:
    """Kept quantities of some members, and how their runs went.

    Attributes
    ----------
    values : dict
        Name -> (members, [times,] [asperites]); NaN of members that did not complete.
    status : ndarray, (members,), of str
        How each run ended.
    steps : ndarray, (members,)
        Of each run.
    level : ndarray, (members,)
        Of the tolerances of each run; NaN of members that had a run of their own, or a given step.
    error : ndarray, (members,)
        The largest difference of a member from a finer run, relative to its scales; NaN of members
        that were not checked.
    """

    values: dict[str, np.ndarray]
    status: np.ndarray
    steps: np.ndarray
    level: np.ndarray
    error: np.ndarray

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Parts one after another."""
        values = {
            name: np.concatenate([part.values[name] for part in parts]) for name in parts[0].values
        }
        rest = [each.name for each in fields(cls) if each.name != "values"]
        return cls(values, *(np.concatenate([getattr(p, name) for p in parts]) for name in rest))


@dataclass(frozen=True)
class Kept:
    """What is kept of each member.

    Attributes
    ----------
    names : tuple of str
        Of the quantities, "upper.w1".
    at_samples : bool
        Whether they are kept at all times of the scene, or at the end alone.
    shapes : tuple of tuples
        Of each quantity in one member.
    """

    names: tuple[str, ...]
    at_samples: bool
    shapes: tuple[tuple[int, ...], ...] = field(repr=False)

    @classmethod
    def checked(cls, simulation: Simulation, keep: Sequence[str], at_samples: bool) -> Self:
        """The names, each once, of quantities of a scene.  Raises InputError."""
        if isinstance(keep, str) or not isinstance(keep, Sequence) or not keep:
            raise InputError(
                "keep", f'must list quantities, as ["upper.w1"], got {short_repr(keep)}'
            )
        ledger, times = simulation.empty_ledger, simulation.scene.times.size
        surfaces = simulation.layout.parts
        if at_samples and exceeds_memory(simulation.layout, times):
            raise InputError(
                "at", f'"samples" would keep series that are too long: {times} times; give fewer'
            )
        names: list[str] = []
        for name in map(str, keep):
            shape = _shape(name, ledger, simulation.scene)
            if shape is None and (at_samples or not is_interval(name)):
                raise InputError(
                    f"keep.{name}",
                    f'must be a quantity of a surface, as "{next(iter(surfaces))}.w1", or one of '
                    'the system, as "contact_energy"',
                )
            names.append(name)
            if name.rpartition(".")[2] in AVERAGED and not at_samples:
                _check_averaged(simulation.scene)
                names.append(f"{name}{INTERVAL}")
                surface, _, kind = name.rpartition(".")
                beside = f"{surface}.{SHARE}"
                if kind == FRICTION and _shape(beside, ledger, simulation.scene) is not None:
                    names.append(beside)
        unique = tuple(dict.fromkeys(names))
        leading = (times,) if at_samples else ()
        own = (_shape(name, ledger, simulation.scene) or () for name in unique)
        return cls(unique, at_samples, tuple((*leading, *shape) for shape in own))

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
        return about_kept(name, not self.at_samples)

    def values_of(self, result: Result, at_end: Ledger) -> dict[str, np.ndarray | float]:
        """The kept values of a complete result, whose ledger at its end is `at_end`."""
        found: dict[str, np.ndarray | float] = {}
        for name in self.names:
            averaged = name.removesuffix(INTERVAL)
            if self.at_samples:
                found[name] = result.ledger.series(name)[0]
            elif name in found:  # with its average
                continue
            elif averaged.rpartition(".")[2] in AVERAGED:
                average = force_average(result, averaged)
                found[averaged], found[f"{averaged}{INTERVAL}"] = average.mean, average.half_width
            elif name.endswith(f".{SHARE}"):
                found[name] = result.time_without_contact(name.rpartition(".")[0])
            else:
                found[name] = at_end.series(name)[0][-1]
        return {name: found[name] for name in self.names}


def is_interval(name: str) -> bool:
    """Whether a name, as "upper.friction_force_time_half_width", is that of an interval."""
    return name.endswith(INTERVAL) and name.removesuffix(INTERVAL).rpartition(".")[2] in AVERAGED


def about_kept(name: str, at_end: bool) -> dict[str, str]:
    """The units and the meaning of a kept quantity of single runs."""
    kind = name.rpartition(".")[2].removesuffix(INTERVAL)
    quantity = EVERY_QUANTITY[kind]
    when = ", averaged over time" if kind in (*AVERAGED, SHARE) else ", at the end"
    before = "half-width of the 95 % interval of: " * is_interval(name)
    return {"units": quantity.units, "long_name": f"{before}{quantity.long_name}{when * at_end}"}


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


def of_members(kept: Kept, members: Members, found: KeptValues) -> dict[str, Variable]:
    """The variables that have a value for each member."""
    variables: dict[str, Variable] = {}
    for name, values in found.values.items():
        # The name of a start that is varied is taken.
        own = f"{name}_end" if name in members.values else name
        variables[own] = ("member", *kept.dimensions(name)), values, kept.about(name)
    return variables | {
        name: (("member",), values, {"long_name": meaning})
        for name, values, meaning in (
            ("steps", found.steps, "steps of the run"),
            ("level", found.level, "level of the tolerances; NaN where settings were searched for"),
            ("error", found.error, "difference from a finer run, relative; NaN where not checked"),
        )
    }


def coordinates_of(members: Members, found: KeptValues) -> dict[str, Variable]:
    """The coordinates of each member: its number, seed, status and varied values."""
    return {
        "member": (("member",), members.numbers, {"long_name": "member"}),
        "seed": (("member",), members.seeds, {"long_name": "seed of the member"}),
        "status": (("member",), found.status, {"long_name": "end of its run"}),
    } | varied_coordinates(members.values)


def times_of(kept: Kept, simulation: Simulation) -> dict[str, Variable]:
    """The times at which quantities are kept."""
    scene = simulation.scene
    about = {"units": "time", "long_name": "time" if kept.at_samples else "time of the end"}
    return {
        "time": (("time",), scene.times, about) if kept.at_samples else ((), scene.duration, about)
    }


def kept_dataset(
    kept: Kept,
    simulation: Simulation,
    members: Members,
    found: KeptValues,
    attributes: Mapping[str, str | float],
) -> xarray.Dataset:
    """The data set of some members."""
    import xarray

    coordinates = coordinates_of(members, found) | times_of(kept, simulation)
    return xarray.Dataset(of_members(kept, members, found), coordinates, attributes)


def attributes_of(simulation: Simulation, seed: int) -> dict[str, str | float]:
    """Properties of the whole ensemble; text is JSON where it is no word."""
    from tribo import __version__

    plan = simulation.plan
    return {
        "tribo_version": __version__,
        "numpy_version": np.__version__,
        "scene": simulation.scene.to_toml(),
        "method": plan.method,
        "method_alone": plan.method,
        "step": json.dumps(plan.setting if plan.tuned is None else None),
        "accuracy": json.dumps(plan.accuracy),
        "seed": str(seed),
    }


@dataclass
class Tally:
    """Counts of members, for the notes of an ensemble.

    Attributes
    ----------
    status : dict
        Members by status.
    checked : int
        Members that were run again with finer settings.
    refined : int
        Members that needed finer settings.
    """

    status: dict[str, int] = field(default_factory=dict)
    checked: int = 0
    refined: int = 0

    def add(
        self, status: np.ndarray, level: np.ndarray, error: np.ndarray, common_level: float
    ) -> None:
        """Take in some members; `common_level` is that of most of them, NaN if there is none."""
        others = status[status != str(Status.COMPLETED)]  # comparing is quicker than counting
        counts = Counter(others.tolist())
        counts[str(Status.COMPLETED)] = status.size - others.size
        self.status = dict(Counter(self.status) + counts)
        self.checked += int(np.isfinite(error).sum())
        if np.isfinite(common_level):
            self.refined += int((level != common_level).sum())

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
        return notes
