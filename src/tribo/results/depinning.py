"""The force at which a pulled or pushed surface starts to slide."""

from typing import NamedTuple

import numpy as np

from tribo.layout.scene_records import resting_bobs
from tribo.model.drives import Pulled, Pushed
from tribo.model.fields import Corrugation
from tribo.model.scene import Scene
from tribo.results.averages import interval
from tribo.results.run_result import RunResult
from tribo.validation import POSITIVE, InputError, number


class Depinning(NamedTuple):
    """The drive's force along x at which an asperite starts to slide.

    Attributes
    ----------
    mean : float
        The mean over the asperites that started to slide [force].
    half_width : float
        Half-width of its 95 % interval, as of independent asperites; NaN where fewer than two or
        not all started.  Bars that springs couple start together and count as one.
    each : ndarray, (asperites,)
        Force of each asperite; NaN where it did not start. Bars that springs couple share one
        number, their average.
    times : ndarray, (asperites,)
        Times at which the force was largest [time].
    """

    mean: float
    half_width: float
    each: np.ndarray
    times: np.ndarray


def depinning(result: RunResult, name: str, distance: float | None = None) -> Depinning:
    """The force at which a surface starts to slide; see :meth:`tribo.Result.depinning`."""
    x = result[name]["x_bar"]
    index = [surface.name for surface in result.scene.surfaces].index(name)
    surface = result.scene.surfaces[index]
    force, along = _force(result, index, x)
    if surface.springs:
        x, force = x.mean(axis=1, keepdims=True), force.mean(axis=1, keepdims=True)
    if distance is None:
        distance = _half_period(result.scene, name)
    distance = number("distance", distance, POSITIVE, "length")
    slid = along * (x - x[0]) >= distance
    stuck = ~np.logical_or.accumulate(slid, axis=0)
    starts = slid.any(axis=0)
    if not starts.any():
        raise InputError(
            "distance",
            f'must be one that "{name}" moves, got {distance:g}, and its bars move by '
            f"{np.max(along * (x - x[0])):.3g} at most; run for longer or with more force",
        )
    places = np.argmax(np.where(stuck, along * force, -np.inf), axis=0)
    each = np.where(starts, force[places, np.arange(starts.size)], np.nan)
    known = starts.all() and starts.size > 1
    half_width = float(interval(each).half_width) if known else np.nan
    return Depinning(float(np.nanmean(each)), half_width, each, result.t[places])


def _force(result: RunResult, index: int, x: np.ndarray) -> tuple[np.ndarray, float]:
    """The x component of the drive's force on each asperite, (times, asperites), and its sign.

    The sign is that of the slide: after a slip, the spring of a stage may push backwards.
    """
    surface, t = result.scene.surfaces[index], result.t[:, None]
    drive = surface.drive
    if isinstance(drive, Pulled) and drive.speed != 0.0:
        rest = resting_bobs(result.scene, index)[:, 0]
        return np.asarray(drive.stiffness * (rest + drive.speed * t - x)), np.sign(drive.speed)
    if isinstance(drive, Pushed):
        force = np.broadcast_to(drive.force[0] + drive.rate[0] * t, x.shape)
        return force, np.sign(force[-1, 0])
    raise InputError(
        f"{surface.name}.drive", "must be one that pulls with a speed or pushes, to start a slide"
    )


def _half_period(scene: Scene, name: str) -> float:
    """Half of the period of the field on a surface, or else of the surfaces in contact with it."""
    corrugations = [f.potential for f in scene.fields if name in f.on]
    periods = [each.period for each in corrugations if isinstance(each, Corrugation)]
    if not periods:
        others = [s for s in scene.surfaces if s.name != name and s.positions is None]
        periods = [s.spacing[0] for s in others if s.shape[0] > 1 and s.spacing[0] > 0.0]
    if len(set(periods)) != 1:
        raise InputError("distance", "is missing, and the scene has no period along x; give it")
    return 0.5 * periods[0]
