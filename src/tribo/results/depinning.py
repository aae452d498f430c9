"""The force at which a pulled or pushed surface starts to slide."""

from typing import NamedTuple

import numpy as np

from tribo.layout.legs import BEGUN
from tribo.model.fields import period_of
from tribo.results.averages import interval
from tribo.results.run_result import RunResult
from tribo.results.stage import moved_by_stage, places_of_bars
from tribo.validation import POSITIVE, InputError, number

# Relative size of a motion backwards that is round-off.
ROUNDING = 1e-12


class Depinning(NamedTuple):
    """The drive's force along x at which an asperite starts to slide.

    Attributes
    ----------
    mean : float
        The mean over the asperites that started to slide [force].
    half_width : float
        Half-width of its 95 % interval, as of independent asperites; NaN where fewer than two or
        not all started.  Bars of a block, or that springs couple, start together and count as one.
    each : ndarray, (asperites,)
        Force of each asperite; NaN where it did not start. Bars of a block, or that springs couple,
        share one number, their average.
    times : ndarray, (asperites,)
        Times at which the force was largest [time].
    """

    mean: float
    half_width: float
    each: np.ndarray
    times: np.ndarray


def depinning(result: RunResult, surface: str, distance: float | None = None) -> Depinning:
    """The drive's force at which a pulled or pushed surface starts to slide, along x.

    It is the largest recorded force on each asperite until its bar has moved by `distance` over
    the field or the other surface, from where the run begins: the static friction, if the pull is
    slow and samples are close in time. If the force grows at a rate, the result is too large by
    the rate times the time that the bar takes for the distance.

    Parameters
    ----------
    surface : str
        Name of the surface, whose drive pulls or pushes.
    distance : float, optional
        Distance beyond the top of a barrier [length]. By default half of the period of the
        corrugation on the surface, or of the spacing of the other surface.

    Returns
    -------
    Depinning
        The force on an asperite, with its interval over the asperites.

    Raises
    ------
    InputError
        If there is no such surface, another drive holds it, no bar moves so far, or the distance
        is missing.
    """
    index = result.scene.index_of(surface)
    periods, ground = _ground(result, surface)
    if distance is None:
        if len(set(periods)) != 1:
            raise InputError("distance", "is missing, and the scene has no period along x; give it")
        distance = 0.5 * periods[0]
    distance = number("distance", distance, POSITIVE, "length")
    force, along = _force(result, index, ground)
    moved = places_of_bars(result, surface) - ground[:, None]
    sliding = result.scene.surfaces[index]
    if sliding.springs or sliding.drive.block or sliding.moves_as_one:  # bars start together
        moved = moved.mean(axis=1, keepdims=True)
        force = force.mean(axis=1, keepdims=True)
    moved = along * (moved - moved[0])
    slid = moved >= distance
    stuck = ~np.logical_or.accumulate(slid, axis=0)
    starts = slid.any(axis=0)
    if not starts.any():
        raise InputError(
            "distance",
            f'must be one that "{surface}" moves, got {distance:g}, and its bars move by '
            f"{np.max(moved):.3g} at most; run for longer or with more force",
        )
    places = np.argmax(np.where(stuck, along * force, -np.inf), axis=0)
    each = np.where(starts, force[places, np.arange(starts.size)], np.nan)
    known = starts.all() and starts.size > 1
    half_width = float(interval(each).half_width) if known else np.nan
    return Depinning(float(np.nanmean(each)), half_width, each, result.t[places])


def _ground(result: RunResult, name: str) -> tuple[list[float], np.ndarray]:
    """What a surface slides on, fields or else other surfaces: periods, displacement (times,)."""
    fields = [field for field in result.scene.fields if name in field.on]
    if fields:
        declared = [period_of(field.potential) for field in fields]
        periods = [period for period in declared if period is not None]
        return periods, np.mean([field.velocity[0] for field in fields]) * (result.t - result.t[0])
    others = [s for s in result.scene.surfaces if s.name != name]
    rows = [s for s in others if s.positions is None and s.shape[0] > 1 and s.spacing[0] > 0.0]
    places = [places_of_bars(result, s.name).mean(axis=1) for s in others] or [0.0 * result.t]
    displacement = np.mean(places, axis=0)
    return [s.spacing[0] for s in rows], displacement - displacement[0]


def _force(result: RunResult, index: int, ground: np.ndarray) -> tuple[np.ndarray, float]:
    """The x component of the drive's force on each asperite, (times, asperites), and its sign.

    The sign is that of the slide: after a slip, the spring of a stage may push backwards.
    """
    surface = result.scene.surfaces[index]
    along = 0.0
    drive = surface.drive
    if drive.drives_along_x:
        recorded = "f2_x" in result[surface.name]
        force = result[surface.name]["f2_x"] if recorded else _force_on_bars(result, index)
        along = float(np.sign(force[-1, 0]))
    if drive.stage is not None:
        moved = moved_by_stage(result, index, result.t) - ground
        moved = moved - moved[0]
        along = float(np.sign(moved[np.argmax(np.abs(moved))]))  # it may return to its start
        steps = along * np.diff(moved)
        if drive.stage.follows_schedule and np.any(steps < -ROUNDING * np.max(np.abs(moved))):
            raise InputError(
                f"{surface.name}.drive",
                "must have a stage that does not turn back, to start one "
                "slide; simulate the part of its schedule with the slide alone",
            )
    if along == 0.0:
        raise InputError(
            f"{surface.name}.drive", "must be one that pulls or pushes along x, to start a slide"
        )
    return force, along


def _force_on_bars(result: RunResult, index: int) -> np.ndarray:
    """The same force where it was not recorded, with the stage and the ramp of the run."""
    scene = result.scene
    state = result.state()
    surface = scene.surfaces[index]
    x = places_of_bars(result, surface.name)
    drive = surface.drive
    # Dampers take velocities, and a block's spring is not at each of its bars.
    is_shared = drive.block and (surface.elastic is not None or (surface.tilts and drive.stage))
    if drive.damps > 0.0 or is_shared:
        raise InputError(
            "output.series",
            f'must have "forces", without which the force on "{surface.name}" is known only of '
            "undamped springs to each bar, or to a block that neither bends nor tilts",
        )
    t = result.t[:, None]
    rest = surface.resting_bobs(seed=[scene.seed, index, 0])[:, 0] + surface.velocity[0] * state.t
    stage = rest + state.phases[index, 0]
    if drive.stage is not None:
        stage = stage + moved_by_stage(result, index, t)
    force = drive.force_along_x(x, t - state.begun[index, BEGUN.index("push_x")], stage)
    if force is None:
        raise InputError("output.series", f'must have "forces", as "{surface.name}" has {drive}')
    return force / surface.count if drive.block else force
