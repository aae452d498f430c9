"""A sweep as a labelled data set: that of an ensemble, with a dimension for each key."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.ensembles.dataset import about_start, counts_of, member_coordinates, times_of
from tribo.ensembles.kept_values import (
    ERROR,
    NOT_RUN,
    REFUSED,
    Kept,
    KeptValues,
    interval_note,
    joined,
    missing_note,
    step_notes,
    without_interval,
)
from tribo.ensembles.members import Members
from tribo.ensembles.stores import Target
from tribo.kernels.status import Status
from tribo.results.averages import interval
from tribo.results.notes import NO_WORK, NOTED_EXCESS, excess_note
from tribo.results.result_file import Variable
from tribo.sweeps.grid import Axis, Grid
from tribo.validation import InputError, inside

if TYPE_CHECKING:
    import xarray


class Table:
    """The runs of a sweep in the order of its grid.  Raises InputError if no point can be run."""

    def __init__(
        self, grid: Grid, order: list[Axis], kept: Kept, found: KeptValues, members: Members | None
    ) -> None:
        """Put runs in the places of their points; points without runs are NOT_RUN."""
        self._members = () if members is None else (members.seeds.size,)
        if missing := grid.size * math.prod(self._members) - found["status"].size:
            found = joined([found, kept.without_runs(missing, NOT_RUN)])
        self._grid = grid
        self._kept = kept
        self._found = found
        self._ran = tuple(len(axis.rows) for axis in order)
        self._to_grid = [order.index(axis) for axis in grid.axes]
        self.coordinates = key_coordinates(grid)
        if kept.at_samples:
            self.coordinates |= times_of(kept, grid.scene)
        if members is not None:
            self.coordinates |= self._members_and_starts(members)
        self.dimensions = (*grid.names, *("member",) * len(self._members))
        self.status = self.placed(found["status"])
        self.note = self.placed(found["note"])
        if np.all(self.status == REFUSED):
            with inside(grid.label(0)):
                raise InputError("", str(self.note.flat[0]))

    def _members_and_starts(self, members: Members) -> dict[str, Variable]:
        """The coordinates of members; starts of each point are (points, members, asperites)."""
        of_points = {key: each for key, each in members.values.items() if each.ndim == 3}
        others = {key: each for key, each in members.values.items() if key not in of_points}
        seed = "member_seed" if "seed" in self._grid.keys else "seed"
        found = member_coordinates(members._replace(values=others), seed)
        for key, each in of_points.items():
            dimensions = *self._grid.names, "member", f"{key.rpartition('.')[0]}_asperite"
            rows = self.placed(each.reshape(-1, each.shape[2]))
            found[key] = dimensions, rows, about_start(key)
        return found

    def placed(self, rows: np.ndarray) -> np.ndarray:
        """Values of all runs, (keys..., [members], ...)."""
        table = rows.reshape(*self._ran, *self._members, *rows.shape[1:])
        rest = range(len(self._ran), table.ndim)
        return table.transpose(*self._to_grid, *rest)

    def variables(self) -> dict[str, Variable]:
        """All quantities, with means over members or error estimates, and counts of the runs."""
        about = {"long_name": "end of the run"}
        variables: dict[str, Variable] = {"status": (self.dimensions, self.status, about)}
        for name in self._kept.names:
            variables |= self._quantity(name)
        for name, meaning in counts_of(self._grid.scene).items():
            values = self.placed(self._found[name].astype(float))
            variables[name] = self.dimensions, values, {"long_name": meaning}
        return variables

    def _quantity(self, name: str) -> dict[str, Variable]:
        """The variables of a quantity: values, means over members, bounds on errors."""
        kept = self._kept
        values = self.placed(self._found[name])
        own = kept.dimensions(name)
        about = kept.about(name)
        label = f"{name}_end" if name in self.coordinates else name
        variables: dict[str, Variable] = {label: ((*self.dimensions, *own), values, about)}
        if self._members:
            rest = values.shape[len(self.dimensions) :]
            points = values.reshape(self._grid.size, *self._members, *rest)
            pair = _means_and_half_widths(points, self.status.reshape(self._grid.size, -1))
            tables = (each.reshape(*self._grid.shape, *rest) for each in pair)
            for table, word in zip(tables, ("mean", "half_width"), strict=True):
                what = about | {"long_name": f"{word.replace('_', '-')} of: {about['long_name']}"}
                variables[f"{name}_{word}"] = (*self._grid.names, *own), table, what
        bounds = self._found.get(f"{name}{ERROR}")
        if bounds is not None and np.isfinite(bounds).any():
            what = about | {"long_name": f"bound on the error of: {about['long_name']}"}
            variables[f"{name}{ERROR}"] = self.dimensions, self.placed(bounds), what
        return variables

    def notes(self, step: float | None) -> Iterator[str]:
        """What to know of all runs, and of single points, also of what a given step does."""
        points = self._grid.size
        if number := int(np.count_nonzero(without_interval(self._found))):
            yield interval_note(number, self._found["status"].size, "runs")
        status = self.status.reshape(points, -1)
        note = self.note.reshape(points, -1)
        stopped = (status != str(Status.COMPLETED)) & (status != NOT_RUN)
        without = np.count_nonzero(stopped, axis=1)
        excesses = self.placed(self._found["excess"]).reshape(points, -1)
        if not self._members:
            heats = excesses[:, 0] > NOTED_EXCESS  # NaN of points that were run alone
            noted = (note[:, 0] != "") | (heats & (step is not None))
            for index in np.flatnonzero(noted).tolist():
                lines = str(note[index, 0]).splitlines()
                if step is not None:
                    lines += excess_note(float(excesses[index, 0]), step)
                yield f"{self._grid.label(index)}: {'; '.join(lines)}"
            return
        missing = np.count_nonzero(np.char.find(note, NO_WORK) >= 0, axis=1)
        noted = np.flatnonzero(without + missing).tolist()
        some = range(points) if step is not None else noted
        for index in some:
            own_notes = []
            if without[index]:
                own_notes = [f"{without[index]} of {status.shape[1]} members have no values"]
                own_notes += _most_frequent(note[index][stopped[index]])
            known = excesses[index][~np.isnan(excesses[index])]
            excess = float(np.mean(known)) if known.size else 0.0
            own_notes += step_notes(Counter(status[index].tolist()), excess, step)
            own_notes += missing_note(int(missing[index]), status.shape[1])
            if own_notes:
                yield f"{self._grid.label(index)}: {'; '.join(own_notes)}"


def _most_frequent(notes: np.ndarray) -> list[str]:
    """The first line of the most frequent of some notes, if any is not empty."""
    found = Counter(note.splitlines()[0] for note in notes.tolist() if note)
    return [note for note, _ in found.most_common(1)]


def key_coordinates(grid: Grid) -> dict[str, Variable]:
    """The values of the keys."""
    found: dict[str, Variable] = {}
    for axis, name in zip(grid.axes, grid.names, strict=True):
        for k, key in enumerate(axis.keys):
            values = np.array([row[k] for row in axis.rows])
            found[grid.name_in_file(key)] = (name,), values, {"long_name": key}
    return found


def _means_and_half_widths(values: np.ndarray, status: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means over the members that completed, and half-widths of their intervals; else NaN.

    Values are (points, members, ...).  Points of which all members completed are one call.
    """
    complete = status == str(Status.COMPLETED)
    number = np.count_nonzero(complete, axis=1)
    mean, half_width = (np.full((len(values), *values.shape[2:]), np.nan) for _ in range(2))
    every = number == status.shape[1]
    mean[every], half_width[every] = interval(values[every].swapaxes(0, 1))
    for place in np.flatnonzero((number > 1) & ~every).tolist():
        mean[place], half_width[place] = interval(values[place][complete[place]])
    return mean, half_width


def points_dataset(
    grid: Grid,
    target: Target,
    found: Mapping[int, xarray.Dataset],
    refused: Mapping[int, str],
    interrupted: bool,
    of_scene: Sequence[str] = (),
) -> xarray.Dataset:
    """The data sets of points, by their numbers, side by side; the others have no values.

    Notes begin with those `of_scene`, if the points do not have them.
    `refused` has the reasons of points that cannot be run.  Raises InputError if there are no
    others, and KeyboardInterrupt if the first of them was interrupted.
    """
    import xarray

    if not found:
        if interrupted:
            raise KeyboardInterrupt
        with inside(grid.label(0)):
            raise InputError("", refused[0])
    statuses = [NOT_RUN] * grid.size
    notes = {}
    for index, data in found.items():
        statuses[index] = data.attrs["status"]
        notes[index] = json.loads(data.attrs.get("notes", "[]"))
    for index, why in refused.items():
        statuses[index] = REFUSED
        notes[index] = [why]
    variables, coordinates = _side_by_side(grid, found)
    about = {"long_name": "end of the ensemble"}
    variables["point_status"] = tuple(grid.names), np.reshape(statuses, grid.shape), about
    labelled = [f"{grid.label(index)}: {note}" for index in sorted(notes) for note in notes[index]]
    attributes = target.attributes(interrupted, [*of_scene, *labelled])
    attributes["keep"] = json.dumps([str(name) for name in found[min(found)].data_vars])
    coordinates |= key_coordinates(grid)
    return target.saved(xarray.Dataset(variables, coordinates, attributes))


def _side_by_side(
    grid: Grid, found: Mapping[int, xarray.Dataset]
) -> tuple[dict[str, Variable], dict[str, Variable]]:
    """All variables and coordinates of data sets of points, by the points' numbers.

    Where a point has no value they are NaN, or 0 in a histogram.
    """
    first = next(iter(found.values()))
    variables: dict[str, Variable] = {}
    for name in map(str, [*first.data_vars, *({"status"} & {*first.coords})]):
        arrays = {index: data[name].values for index, data in found.items()}
        shape = np.max([each.shape for each in arrays.values()], axis=0).astype(int)
        empty: Any = {"i": 0, "U": NOT_RUN, "O": NOT_RUN}.get(first[name].dtype.kind, np.nan)
        dtype = np.result_type(*arrays.values(), np.array(empty))
        table = np.full((grid.size, *shape), empty, dtype)
        for index, values in arrays.items():
            places: tuple[Any, ...] = (index, *map(slice, values.shape))
            table[places] = values
        dimensions = (*grid.names, *map(str, first[name].dims))
        table = table.reshape(*grid.shape, *table.shape[1:])
        variables[name] = dimensions, table, dict(first[name].attrs)
    largest = max(found.values(), key=lambda data: data.sizes.get("member", 0))
    coordinates: dict[str, Variable] = {
        str(name): (each.dims, each.values, dict(each.attrs))
        for name, each in largest.coords.items()
        if name != "status" and name not in grid.keys
    }
    return variables, coordinates
