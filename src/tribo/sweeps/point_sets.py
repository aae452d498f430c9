"""Points of a sweep that one plan serves, since their scenes differ in numbers of members alone.

These are swept by one ensemble, side by side in lanes.  All else, as words, durations, or an
automatic step's stiffness, takes a scene and a plan for each value, one after another or by an
engine at the same time.
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from tribo.ensembles.engines import run_tasks
from tribo.ensembles.kept_values import REFUSED, Kept, KeptValues, joined
from tribo.ensembles.members import Members, Source, Variation, is_start
from tribo.ensembles.request import Request
from tribo.ensembles.runner import Execution, in_batches, planned
from tribo.ensembles.swing_states import DrawnSwings
from tribo.layout.own_numbers import can_differ
from tribo.model.binding import SWING_STATE
from tribo.model.identity import as_sent, received
from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.prepared import Simulation
from tribo.sweeps.grid import Axis, Grid, values_at
from tribo.validation import InputError


class PointSet(NamedTuple):
    """Points of a sweep that one plan serves, and their members; it can be pickled."""

    scene: Scene  # with the values that all of them share
    request: Request
    kept: Kept  # of all points of the sweep
    swept: dict[str, np.ndarray]  # keys in which they differ -> (points,)
    points: int
    members: Members  # of each point, as :meth:`Variation.drawn` gives them
    seed: int  # from which they are drawn
    simulation: Simulation | None = None  # of a point in the middle, if it is prepared; not pickled

    @property
    def runs(self) -> int:
        return self.points * self.members.seeds.size

    @property
    def variation(self) -> Variation:
        """The differences between all members of all points, point by point."""
        vary: dict[str, Source] = {
            key: DrawnSwings(rows) if key.endswith(f".{SWING_STATE}") else rows
            for key, rows in self.members.values.items()
        }
        return Variation(self.scene, vary, self.seed, self.members.seeds, self.swept)

    def point(self, place: int) -> PointSet:
        """One of the points alone."""
        scene = self.scene_at(place)
        return self._replace(scene=scene, swept={}, points=1, simulation=None)

    def values(self) -> list[tuple[int, dict[str, np.ndarray] | None]]:
        """What the members of so many points at a time differ in, (points, members, ...).

        None where a point is refused.
        """
        try:
            runs = self.variation.members(np.arange(self.runs)).values
        except InputError:
            if self.points == 1:
                return [(1, None)]
            return [own for place in range(self.points) for own in self.point(place).values()]
        own = {key: each for key, each in runs.items() if key not in self.swept}
        return [
            (
                self.points,
                {key: each.reshape(self.points, -1, *each.shape[1:]) for key, each in own.items()},
            )
        ]

    def scene_at(self, point: int) -> Scene:
        own = {key: float(values[point]) for key, values in self.swept.items()}
        return with_values(self.scene, own) if own else self.scene

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the scene as text, with the sources from which plug-ins are loaded."""
        return _unpickled, (as_sent(self.scene), *self[1:-1])


def _unpickled(scene: Any, *rest: Any) -> PointSet:
    return PointSet(received(*scene), *rest)


def point_sets(
    grid: Grid, request: Request, variation: Variation, members: int | None, kept: Kept
) -> tuple[list[PointSet], list[Axis]]:
    """The sets of a grid, and the axes in whose order their points are, the last fastest.

    Each point has so many members of a variation; None for one run of its scene.  Raises
    InputError.
    """
    inner, simulation = _served_by_one_plan(grid, request, variation)
    outer = [axis for axis in grid.axes if axis not in inner]
    outside = tuple(len(axis.rows) for axis in outer)
    within = tuple(len(axis.rows) for axis in inner)
    points = math.prod(within)
    places = np.indices(within).reshape(len(within), points)
    swept = {}
    for axis, place_of_each in zip(inner, places, strict=True):
        for k, name in enumerate(axis.keys):
            values = np.array([row[k] for row in axis.rows], float)
            for key in grid.bound_to([name]):
                swept[key] = values[place_of_each]
    drawn = variation.drawn(np.arange(members or 1))
    sets = []
    for place in np.ndindex(outside):
        # Together with the first values of the others.
        own = values_at(outer, place) | values_at(inner, [0] * len(inner))
        scene = (with_values(grid.scene, own) if outer else grid.first).with_heights()
        if members is None:
            drawn = drawn._replace(seeds=np.array([scene.seed]))
        own_members = drawn, variation.seed, simulation
        sets.append(PointSet(scene, request, kept, swept, points, *own_members))
    return sets, outer + inner


def _served_by_one_plan(
    grid: Grid, request: Request, variation: Variation
) -> tuple[list[Axis], Simulation | None]:
    """The axes whose values can be those of members, and the simulation that shows it."""
    candidates = [axis for axis in grid.axes if len(axis.rows) > 1 and axis.name in grid.of_numbers]
    if not candidates:
        return [], None
    places = [len(axis.rows) // 2 if axis in candidates else 0 for axis in grid.axes]
    scene = with_values(grid.scene, values_at(grid.axes, places)).with_heights()
    recorded = request.recorded(scene)
    if recorded.output.series:
        return [], None
    try:
        simulation = request.prepare(scene, recorded)
    except InputError:
        return [], None
    plan = simulation.plan
    pair = simulation.integrator.pair is not None
    if plan.tuned is not None and not plan.tuned.met:
        return [], None

    def differ(axis: Axis) -> bool:
        numbers = [key for key in grid.bound_to(axis.keys) if not is_start(key)]
        return not numbers or (not plan.automatic and can_differ(simulation.layout, numbers, pair))

    inner = [axis for axis in candidates if differ(axis)]
    keys = grid.bound_to(key for axis in inner for key in axis.keys)
    numbers = [*variation.own_numbers, *(key for key in keys if not is_start(key))]
    if not inner or not in_batches(simulation, numbers):
        return [], None
    return inner, simulation if len(inner) == len(grid.axes) else None


def runs_of(sets: list[PointSet], done: int, how: Execution) -> Iterator[KeptValues]:
    """What is kept of all runs but the first `done`, in order; "Refused" where none is possible."""
    left = []
    for each in sets:
        if done < each.runs:
            left.append((each, max(0, done)))
        done -= each.runs
    if how.engine is not None and len(sets) > 1:
        tasks = ((pickle.dumps(each), first) for each, first in left)
        yield from run_tasks(how.engine, _run_task, tasks)
        return
    for each, first in left:
        yield from _runs_of_set(each, first, how)


def _run_task(task: tuple[bytes, int]) -> KeptValues:
    """Run a set in a process that does not have it yet."""
    content, first = task
    return joined(list(_runs_of_set(pickle.loads(content), first, Execution())))


def _runs_of_set(points: PointSet, done: int, how: Execution) -> Iterator[KeptValues]:
    """The runs of one set, or of its points one by one where one plan does not serve them."""
    request = points.request
    try:
        simulation = points.simulation or request.prepare(points.scene_at(points.points // 2))
        kept = request.kept(simulation.scene, simulation.layout)
        variation = points.variation
        runs = planned(request, simulation, kept, variation, points.runs, how)
        for found in runs.chunks(range(done, points.runs)):
            done += found["status"].size
            yield points.kept.of_others(found)
    except InputError as error:
        if points.points == 1:
            yield points.kept.without_runs(points.runs - done, REFUSED, str(error))
            return
        for point in map(points.point, range(points.points)):
            if done < point.runs:
                yield from _runs_of_set(point, max(0, done), how)
            done -= point.runs


def members_of(sets: list[PointSet]) -> Members:
    """The members of each point; values that follow the numbers of points are of all points.

    Those have the shape (points, members, asperites), with NaN where a point is refused.
    """
    numbers, seeds, _ = sets[0].members
    found = [own for each in sets for own in each.values()]
    known = next((own for _, own in found if own is not None), {})
    values = {}
    for key, rows in known.items():
        parts = []
        for count, own in found:
            refused = np.full((count, *rows.shape[1:]), np.nan)
            parts.append(refused if own is None else own[key])
        values[key] = np.concatenate(parts)
    alike = {key: rows[0] for key, rows in values.items() if not np.ptp(rows, axis=0).any()}
    return Members(numbers, seeds, values | alike)
