"""The points of a sweep as sets of members that one engine runs, one data set of all."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from tribo.ensembles.members import Variation
from tribo.ensembles.request import Request
from tribo.ensembles.runner import Execution
from tribo.ensembles.stores import MemberStore, Target
from tribo.model.scene import Scene
from tribo.results.notes import scene_notes
from tribo.sweeps.dataset import Table, points_dataset
from tribo.sweeps.grid import Grid
from tribo.sweeps.point_sets import members_of, point_sets, runs_of
from tribo.sweeps.point_statistics import PointStatistics

if TYPE_CHECKING:
    import xarray


class SideBySide(NamedTuple):
    """All points of a sweep by one engine, those that one plan serves side by side."""

    grid: Grid
    request: Request
    recorded: Scene
    variation: Variation
    members: int | None  # of each point
    how: Execution
    statistics: bool

    def compute(self, target: Target, progress: Callable[[float], None] | None) -> xarray.Dataset:
        """The table of all points, or of those before an interrupt."""
        import xarray

        grid = self.grid
        members = self.members
        step = self.recorded.numerics.step
        kept = self.request.kept(self.recorded)
        sets, order = point_sets(grid, self.request, self.variation, members, kept)
        by = self.how
        store: MemberStore | PointStatistics = (
            PointStatistics(kept, target.frames, members)
            if self.statistics and members is not None
            else MemberStore(target.frames)
        )
        if progress is not None:
            by = by._replace(progress=lambda done: progress(done // (members or 1)))
        interrupted = by.collect(runs_of(sets, store.done, by), store)
        if isinstance(store, PointStatistics):
            store.flush()
            found = store.datasets(grid, order, step)
            return points_dataset(grid, target, *found, interrupted, scene_notes(grid.first))
        table = Table(grid, order, kept, store.values(), members_of(sets) if members else None)
        notes = [*scene_notes(grid.first), *table.notes(step)]
        attributes = target.attributes(interrupted, notes)
        attributes["keep"] = json.dumps(kept.names)
        return target.saved(xarray.Dataset(table.variables(), table.coordinates, attributes))
