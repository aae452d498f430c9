"""Means of all quantities over time: as many members as are wanted, or as a half-width takes."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import TYPE_CHECKING

from tribo.ensembles.dataset import Collected, dataset
from tribo.ensembles.intervals import members_needed
from tribo.ensembles.runner import FIRST_STAGE, Runner, SettingsCheck, sum_names, total_names
from tribo.model.scene import Scene
from tribo.validation import POSITIVE, InputError, inside, number, short_repr

if TYPE_CHECKING:
    import xarray


def means(
    runner: Runner, half_width: Mapping[str, float] | None, most: int, began: float
) -> xarray.Dataset:
    """The data set of means.

    Parameters
    ----------
    runner : Runner
        Runs the members.
    half_width : mapping, optional
        That is wanted, by quantity.
    most : int
        Members at most, and without `half_width` the number of members.
    began : float
        When the ensemble began, by time.perf_counter [s].
    """
    first_stage, needed = _run_members(runner, half_width, most)
    check = SettingsCheck() if runner.interrupted else runner.check_settings()
    collected = Collected(runner, check, half_width, first_stage, needed)
    return dataset(collected, time.perf_counter() - began)


def checked_half_width(scene: Scene, half_width: Mapping[str, float]) -> dict[str, float]:
    """The half-widths wanted, by quantity.  Raises InputError."""
    if not isinstance(half_width, Mapping) or not half_width:
        raise InputError(
            "half_width",
            f'must map quantities, as {{"upper.W": 1e-2}}, got {short_repr(half_width)}',
        )
    known = total_names(scene) + sum_names(scene)
    for name in half_width:
        if name not in known:
            raise InputError(f"half_width.{name}", f"must be one of {', '.join(known)}")
    with inside("half_width"):
        return {name: number(name, value, POSITIVE) for name, value in half_width.items()}


def _run_members(
    runner: Runner, half_width: Mapping[str, float] | None, most: int
) -> tuple[int | None, float]:
    """Run as many members as are wanted; members of the first stage, and the number needed."""
    if half_width is None:
        runner.add(most)
        return None, 0.0
    _check_series(runner, half_width)
    runner.add(min(FIRST_STAGE, most))
    first_stage = runner.completed
    return first_stage, 0.0 if runner.interrupted else _add_second_stage(runner, half_width, most)


def _check_series(runner: Runner, half_width: Mapping[str, float]) -> None:
    """Refuse quantities whose series members do not keep."""
    for name in half_width:
        if name not in runner.names:
            raise InputError(
                f"half_width.{name}",
                "is a sum over asperites, whose series are too long to keep; give fewer samples",
            )


def _add_second_stage(runner: Runner, half_width: Mapping[str, float], most: int) -> float:
    """Add as many members as Stein's rule requires by the spread of the first; their number."""
    scale = max(outcome.scale for outcome in runner.outcomes if outcome.completed)
    first = runner.complete_values
    needed = {
        name: members_needed(first[:, runner.names.index(name)], value * scale)
        for name, value in half_width.items()
    }
    name = max(needed, key=lambda key: needed[key])
    if needed[name] > most:
        raise InputError(
            f"half_width.{name}",
            f"would take {needed[name]:.0f} members by the spread of the first {len(first)}, and "
            f"at most {most} are allowed; give a larger half-width or a larger n",
        )
    while runner.completed < needed[name] and len(runner.members) < most and not runner.interrupted:
        missing = int(needed[name]) - runner.completed
        runner.add(min(missing, most - len(runner.members)))
    return needed[name]
