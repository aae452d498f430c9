"""Statistics of the members of each point of a sweep, which run point by point in lanes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from tribo.ensembles.dataset import times_of
from tribo.ensembles.kept_values import REFUSED, Kept, KeptValues
from tribo.ensembles.statistics import coordinates_of, variables_of
from tribo.ensembles.stores import StatisticsStore, Store
from tribo.kernels.status import Status
from tribo.loops.frames import Frames, as_bytes
from tribo.sweeps.grid import Axis, Grid

if TYPE_CHECKING:
    import xarray

NO_MEMBER = "the scene is completed by no member"


class PointStatistics(Store):
    """Takes in the members of points, so many of each, one point after another."""

    def __init__(self, kept: Kept, frames: Frames | None, members: int) -> None:
        """Begin with what the frames have: one of each point.

        Raises InputError if covariances are too many.
        """
        self._kept = kept
        self._members = members
        self._points: list[StatisticsStore] = []
        self._reasons: list[str] = []  # the first note of each point
        self._written = 0  # points that are in frames, complete
        super().__init__(frames)

    def flush(self) -> None:
        """Write the points that are not on disk yet; the last may not be complete."""
        if self._frames is None:
            return
        for place in range(self._written, len(self._points)):
            why = as_bytes(self._reasons[place])
            self._frames.append(place, self._points[place].state() | {"reason": why})
        self._written = self.done // self._members

    def take_back(self, arrays: KeptValues) -> None:
        """Take in a frame; it may be that of a point of which an earlier one has a part."""
        reason = arrays.pop("reason").tobytes().decode()
        if self._points and self._points[-1].done < self._members:
            self._points.pop()
            self._reasons.pop()
        point = StatisticsStore(self._kept, None)
        point.take_back(arrays)
        self._points.append(point)
        self._reasons.append(reason)
        self.done = sum(each.done for each in self._points)
        self._written = self.done // self._members

    def _take(self, found: KeptValues) -> None:
        """Give members to their points, in order: so many to each."""
        size = found["status"].size
        first = 0
        done = self.done
        while first < size:
            place, begun = divmod(done, self._members)
            stop = min(size, first + self._members - begun)
            own = {name: values[first:stop] for name, values in found.items()}
            if begun == 0:
                self._points.append(StatisticsStore(self._kept, None))
                self._reasons.append("")
            self._points[place].add(own)
            self._reasons[place] = self._reasons[place] or next(filter(None, own["note"]), "")
            done += stop - first
            first = stop

    def datasets(
        self, grid: Grid, order: list[Axis], step: float | None
    ) -> tuple[dict[int, xarray.Dataset], dict[int, str]]:
        """The data set of each complete point by its number in the grid, and refusals.

        The points are in the `order` of these axes; `step` is that which was given for all.
        """
        import xarray

        coordinates = times_of(self._kept, grid.scene) | coordinates_of(self._kept)
        found = {}
        refused = {}
        for index, place in enumerate(_places(grid, order)):
            if place >= self.done // self._members:
                continue
            tally = self._points[place].tally
            moments = self._points[place].moments()
            if moments is None:
                own = self._reasons[place] if REFUSED in tally.statuses else ""
                refused[index] = own or NO_MEMBER
                continue
            notes = json.dumps([*tally.notes(step)])
            about = {"status": str(Status.COMPLETED), "notes": notes}
            found[index] = xarray.Dataset(variables_of(self._kept, moments), coordinates, about)
        return found, refused


def _places(grid: Grid, order: list[Axis]) -> Iterator[int]:
    """For each point of the grid, its place among those that run in the order of other axes."""
    ran = tuple(len(axis.rows) for axis in order)
    places = np.arange(grid.size).reshape(ran)
    yield from places.transpose([order.index(axis) for axis in grid.axes]).ravel().tolist()
