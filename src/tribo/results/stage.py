"""Where the stage that pulls a surface is, when it turns back, and tables of what happens then."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tribo.layout.elastic_body import shares_of_edges
from tribo.layout.legs import BEGUN
from tribo.model.surface import Surface
from tribo.results.run_result import RunResult
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

    The force is that of the springs to the stage where no forces were recorded.  Raises InputError.
    """
    index = result.scene.index_of(name)
    surface = result.scene.surfaces[index]
    stiffness = stiffness_of(surface)
    stage = _place_of_stage(result, index) if stiffness > 0.0 else None
    force = _force(result, index, stage)
    if position is not None:
        given = vector("position", position, size=result.t.size, unit="length")
        return Pull(given, force, stiffness)
    if stage is not None:
        return Pull(stage, force, stiffness)
    if surface.drive.holds_bars or surface.drive.gives_motion:
        return Pull(places_of_bars(result, name).mean(axis=1), force, np.inf)
    raise InputError(
        "surface",
        "must be one that springs to a stage pull, or whose bars are driven or moved; "
        f'"{name}" has {surface.drive}: give the position of its stage as "position"',
    )


def _force(result: RunResult, index: int, stage: np.ndarray | None) -> np.ndarray:
    """(times,) the force of a drive along x.  Raises InputError where it is not known."""
    surface = result.scene.surfaces[index]
    if _is_recorded(result, surface.name, "pull_force"):
        return np.asarray(result[surface.name]["pull_force"])
    if stage is None or surface.drive.damps > 0.0:
        raise InputError(
            "output.series",
            f'does not contain "forces", without which the pull on "{surface.name}" is known only '
            "of undamped springs to a stage",
        )
    return stiffness_of(surface) * (stage - _place_of_spring(result, index))


def places_of_bars(result: RunResult, name: str) -> np.ndarray:
    """(times, n) places of the bars of a surface along x.  Raises InputError without them."""
    if not _is_recorded(result, name, "x_bar"):
        raise InputError(
            "output",
            f'leaves out the places of the bars of "{name}" between the first and the last time: '
            "record fewer samples, or keep x_bar",
        )
    return np.asarray(result[name]["x_bar"])


def _is_recorded(result: RunResult, name: str, quantity: str) -> bool:
    """Whether a result has a quantity of a surface at all times."""
    series = result[name]
    return quantity in series and len(series[quantity]) == result.t.size


def _place_of_stage(result: RunResult, index: int) -> np.ndarray | None:
    """(times,) mean place of the springs' ends on the stage; None without a stage."""
    surface = result.scene.surfaces[index]
    stage = surface.drive.stage
    if stage is None:
        return None
    rest = float(np.mean(_resting_bobs(result, index)[:, 0]))
    if result.settings.get("start") is None:
        return np.asarray(rest + stage.displacement(result.t))
    # Where an earlier run has brought it, perhaps by another schedule.
    state = result.state()
    at_end = surface.velocity[0] * state.t + state.phases[index, 0]
    return rest + at_end + moved_by_stage(result, index, result.t)


def moved_by_stage(result: RunResult, index: int, t: np.ndarray) -> np.ndarray:
    """How far the stage of a surface is at times t from its place at the end of the run."""
    state = result.state()
    stage = result.scene.surfaces[index].drive.stage
    assert stage is not None
    begun = state.begun[index, BEGUN.index("stage")]
    return np.asarray(stage.displacement(t - begun) - stage.displacement(state.t - begun))


def _resting_bobs(result: RunResult, index: int) -> np.ndarray:
    """(n, 3) places of the bobs of a surface at rest."""
    scene = result.scene
    return scene.surfaces[index].resting_bobs(seed=[scene.seed, index, 0])


def _place_of_spring(result: RunResult, index: int) -> np.ndarray:
    """(times,) where the spring of a surface acts along x: the mean of its bars.

    That of a block on a body with free edges acts far away in the body, which the bars move by
    unequal shares.
    """
    surface = result.scene.surfaces[index]
    x_bar = places_of_bars(result, surface.name)
    has_body = surface.elastic is not None and surface.drive.block
    shares = shares_of_edges(result.scene, surface) if has_body else None
    if shares is None:
        return np.asarray(x_bar.mean(axis=1))
    x, y, _ = _resting_bobs(result, index).T
    above = y + surface.facing_sign * surface.each["length"]
    moved = np.stack([x_bar - x, result[surface.name]["y_bar"] - above])
    along = np.einsum("atn,an->t", moved, shares[:, :, 0]) / surface.count
    return np.asarray(np.mean(x) + along)


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
