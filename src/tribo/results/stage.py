"""Where the stage that pulls a surface is, when it turns back, and tables of what happens then."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tribo.model.surface import Surface
from tribo.results.run_result import RunResult, index_of
from tribo.validation import InputError, vector

if TYPE_CHECKING:
    import xarray

# Part of its whole range by which a position moves back where it turns.
TURN = 0.1
# Range of a position that stays, relative to its largest value: round-off.
STAYS = 1e-9


class Pull(NamedTuple):
    """The drive of a surface along x, as a cantilever measures it.

    The position is that of the stage, or of the bars that are held themselves.
    """

    position: np.ndarray  # (times,) [length]
    force: np.ndarray  # (times,) of the drive on the surface along x [force]
    stiffness: float  # of all springs to the stage; inf of bars that are held [force / length]


def pull_of(result: RunResult, name: str, position: object = None) -> Pull:
    """The position and the force of the drive of a surface, or of a `position` that is given.

    The stage is found from the force of its springs and the places of the bars, so that it may have
    moved in any way.  Raises InputError.
    """
    index = index_of(result, name)
    surface = result.scene.surfaces[index]
    series = result[name]
    for needed, problem in (
        ("pull_force", 'does not contain "forces", or the drive has no force of its own'),
        ("x_bar", "leaves out the places of the bars"),
    ):
        if needed not in series or len(series[needed]) != result.t.size:
            raise InputError("output.series", f'{problem}: the pull on "{name}" is not known')
    force = np.asarray(series["pull_force"])
    places = series["x_bar"].mean(axis=1)
    stiffness = stiffness_of(surface)
    if position is not None:
        given = vector("position", position, size=result.t.size, unit="length")
        return Pull(given, force, stiffness)
    if surface.drive.holds_bars:
        return Pull(places, force, np.inf)
    if not 0.0 < stiffness < np.inf:
        raise InputError(
            "surface",
            f'must be one that springs to a stage pull, or whose bars are driven; "{name}" has '
            f'{surface.drive}: give the position of its stage as "position"',
        )
    return Pull(places + force / stiffness, force, stiffness)


def stiffness_of(surface: Surface) -> float:
    """The stiffness of all springs of a surface to its stage; zero without one."""
    stage = surface.drive.stage
    if stage is None:
        return 0.0
    springs = 1 if surface.drive.block else surface.count
    return float(stage.stiffness) * springs


def turning_points(values: np.ndarray, least: float) -> np.ndarray:
    """Indices at which a series turns back by `least` or more, with its first and last index.

    Between two of them the series goes from one extreme to the next.
    """
    found = [0]
    low = high = 0
    direction = 0
    for i, value in enumerate(values.tolist()):
        if value > values[high]:
            high = i
        if value < values[low]:
            low = i
        if direction >= 0 and value <= values[high] - least:
            if direction > 0 or high > 0:
                found.append(high)
            direction = -1
            low = high = i
        elif direction <= 0 and value >= values[low] + least:
            if direction < 0 or low > 0:
                found.append(low)
            direction = 1
            low = high = i
    if found[-1] != values.size - 1:
        found.append(values.size - 1)
    return np.unique(found)


class Leg(NamedTuple):
    """A part of a run in which a position goes one way."""

    first: int  # sample
    last: int  # sample, which the next leg begins with
    along: float  # +1 where the position grows, else -1


def legs_of(position: np.ndarray, after: float, t: np.ndarray) -> list[Leg]:
    """The legs of a position from a time on; a position that stays has none."""
    begin = int(np.searchsorted(t, after))
    moved = position[begin:]
    if moved.size < 2 or not np.all(np.isfinite(moved)):
        return []
    if np.ptp(moved) <= STAYS * np.max(np.abs(moved)):
        return []
    turns = begin + turning_points(moved, TURN * float(np.ptp(moved)))
    return [
        Leg(int(a), int(b), float(np.sign(position[b] - position[a]))) for a, b in pairwise(turns)
    ]


def table_of(
    columns: Mapping[str, tuple[str, str]], dimension: str, rows: Sequence[Sequence[float]]
) -> xarray.Dataset:
    """A table of slips or cycles, from the unit and the meaning of each column."""
    import xarray

    values = np.array(rows, float).reshape(len(rows), len(columns))
    variables = {
        name: (dimension, column, {"units": unit, "long_name": meaning})
        for (name, (unit, meaning)), column in zip(columns.items(), values.T, strict=True)
    }
    return xarray.Dataset(variables, {dimension: np.arange(len(rows))})
