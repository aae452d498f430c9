"""Legs of a run: the times between the kinks of its scene's schedules.

In each leg, kernels read the numbers of every schedule from a table, which the caller of a loop
changes where a leg begins; see `tribo.loops.legs`.  Times of schedules begin with the run, or with
the drive or reservoir that a continued run keeps: `begun`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from tribo.kernels.schedule import COLUMNS
from tribo.model.number import changes
from tribo.model.scene import Scene
from tribo.model.schedule import Piece, Schedule
from tribo.model.surface import Surface

# Times that differ by less than this fraction of the duration are one.
SAME = 1e-12
# What has a time of its own, in the columns of `Layout.begun`.  Of surfaces: a user's drives and
# forces on ends, stages, loads, the reservoirs on bars and swings, and pushes along x and y.  Of
# fields, whose rows follow those: a user's energy that depends on time, and modulations.
BEGUN = (
    *("drive", "ends", "stage", "load", "heat", "swing_heat"),
    "field",
    *("push_x", "push_y"),
    "modulation",
)


class Scheduled(NamedTuple):
    """A number of a surface that follows a schedule."""

    surface: int  # or row of a field in `Layout.begun`
    name: str  # one of `kernels.records.SCHEDULED`
    schedule: Schedule  # of the number, or of the velocity of a stage
    clock: str  # one of BEGUN
    is_integral: bool = False  # whether kernels need the integral of the schedule
    drift: float = 0.0  # what is subtracted for each unit of time
    field: int = -1  # of a field in place of a surface

    def piece(self, inside: float, begun: float) -> Piece:
        """The numbers around a time, where the schedule's own time was zero at `begun`."""
        own = inside - begun
        schedule = self.schedule
        found = schedule.integral_piece(own) if self.is_integral else schedule.piece(own)
        found = found._replace(c0=found.c0 - self.drift * found.since, c1=found.c1 - self.drift)
        return found._replace(since=found.since + begun)

    def at(self, t: Any, begun: float) -> Any:
        """The number at times t, an array."""
        own = np.asarray(t) - begun
        schedule = self.schedule
        value = schedule.integral(own) if self.is_integral else schedule.at(own)
        return value - self.drift * own


class Legs(NamedTuple):
    """The legs of a scene's runs, from t = 0 to the duration."""

    kinks: np.ndarray  # (legs - 1,) [time]
    tables: np.ndarray  # (legs, 1 + schedules, COLUMNS)
    same: float  # times that differ by less are one

    def of_times(self, t: np.ndarray) -> np.ndarray:
        """The leg at each of some times; at a kink the one that begins there."""
        return np.asarray(np.searchsorted(self.kinks, t + self.same, side="right"))


def scheduled_numbers(scene: Scene) -> tuple[Scheduled, ...]:
    """All numbers of a scene's surfaces that follow schedules; the nth has row n + 1 of tables."""
    found = [_of_surface(k, surface) for k, surface in enumerate(scene.surfaces)]
    numbers = [each for own in found for each in own]
    for k, item in enumerate(scene.fields):
        if item.modulation is not None:
            row = len(scene.surfaces) + k
            numbers.append(Scheduled(row, "modulation", item.modulation, "modulation", field=k))
    return tuple(numbers)


def _of_surface(index: int, surface: Surface) -> Iterator[Scheduled]:
    """The scheduled numbers of a surface, in the frame and per asperite as kernels read them."""
    drive = surface.drive
    stage = drive.stage
    share = 1.0 / surface.count if drive.block else 1.0  # of a bar, of forces on all of them
    if stage is not None and stage.position is not None:
        yield Scheduled(index, "stage", stage.position, "stage", drift=surface.velocity[0])
    elif stage is not None and changes(stage.speed):
        relative = stage.speed.shifted(-surface.velocity[0])
        yield Scheduled(index, "stage", relative, "stage", is_integral=True)
    if changes(drive.load):
        yield Scheduled(index, "load", drive.load.times(-surface.facing_sign * share), "load")
    pushes = zip(("push", "load"), drive.along_axes, ("push_x", "push_y"), strict=True)
    for name, number, clock in pushes:
        if changes(number):
            yield Scheduled(index, name, number.times(share), clock)
    for reservoir in surface.reservoirs:
        if changes(reservoir.temperature):
            name = "swing_heat" if reservoir.on == "swing" else "heat"
            yield Scheduled(index, name, reservoir.temperature, name)


def begun_of(number: Scheduled, begun: np.ndarray) -> float:
    """When the schedule of a number began, of `Layout.begun`."""
    return float(begun[number.surface, BEGUN.index(number.clock)])


def legs_of(
    scene: Scene,
    numbers: tuple[Scheduled, ...],
    begun: np.ndarray,
    until: float | None = None,
) -> Legs:
    """The legs of a scene whose drives and reservoirs began at some times, of `Layout.begun`.

    `numbers` are its :func:`scheduled_numbers`.  The last leg ends at a time `until`, by default
    the duration.
    """
    until = scene.duration if until is None else until
    same = SAME * scene.duration
    starts = [begun_of(each, begun) for each in numbers]
    times = [
        kink + start
        for each, start in zip(numbers, starts, strict=True)
        for kink in each.schedule.kinks
    ]
    kinks: list[float] = []
    for time in sorted(times):
        inside = same < time < until - same
        if inside and (not kinks or time - kinks[-1] > same):
            kinks.append(time)
    ends = [0.0, *kinks, until]
    tables = np.zeros((len(ends) - 1, 1 + len(numbers), COLUMNS))
    for leg, table in enumerate(tables):
        middle = 0.5 * (ends[leg] + ends[leg + 1])
        for row, (each, start) in enumerate(zip(numbers, starts, strict=True), start=1):
            table[row] = each.piece(middle, start)
    return Legs(np.array(kinks), tables, same)
