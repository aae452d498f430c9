"""Parameters of a scene from a measured series, by least squares over runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo.accuracy.comparison import Accuracy
from tribo.ensembles.engines import Engine
from tribo.fitting import notes, search
from tribo.fitting.data import Trace, trace_of
from tribo.fitting.found import Fit
from tribo.fitting.model import Box, Model
from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.validation import POSITIVE, InputError, boolean, instance, integer, number, vector

if TYPE_CHECKING:
    import xarray

# Starts in the box for each parameter, and how many of the best are searched from.
STARTS = 32
SEARCHED = 4
# Part of the noise, or without one of the range of the data, by which steps may change a series.
OF_NOISE = 0.05
OF_RANGE = 1e-3
# Points of a profile, in half-widths.
PROFILE = np.array([-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0])


def fit(
    scene: Scene,
    data: Any,
    ranges: Mapping[str, Sequence[float]],
    quantity: str,
    *,
    noise: float | Sequence[float] | np.ndarray | None = None,
    members: int | None = None,
    starts: int | None = None,
    profiles: bool = True,
    seed: int = 0,
    accuracy: Accuracy | None = None,
    method: str | None = None,
    step: float | None = None,
    threads: int | None = None,
    engine: Engine | None = None,
    allow_unresolved: bool = False,
) -> Fit:
    """Find the values of parameters at which a scene gives a measured series.

    Least squares from the best of many starts in the box of the ranges: a series with slips has
    many local minima.  Candidates are the points of sweeps, so that they run side by side where
    those do.

    Parameters
    ----------
    scene : Scene
        The scene; its duration covers the times of the data.
    data : tuple, xarray.DataArray, str or Path
        ``(t, values)``, an array over a dimension of times, or the name of a CSV file with columns
        of times and values, in the units of the scene; times from the start of the run.
    ranges : mapping
        Key -> (low, high), as ``{"field.amplitude": (0.05, 0.2)}``, with the keys of
        :func:`tribo.sweep`.
    quantity : str
        The quantity that was measured, with one value at a time, as "upper.pull_force".
    noise : float or array_like, (times,), optional
        Standard deviation of the data, independent at each time; without it, it follows from the
        residuals, and chi^2 says nothing about the scene.
    members : int, optional
        Number of runs at each candidate whose mean is fitted, needed where the scene is random.
        All candidates have the same seeds, and the standard error of the mean adds to the noise.
    starts : int, optional
        Number of starts, a power of 2; by default 32 for each parameter.
    profiles : bool
        Whether profiles of chi^2 are computed, which check the intervals.
    seed : int
        The seed of the starts, and of members.
    accuracy, method, step, threads, engine, allow_unresolved
        As for :func:`tribo.sweep`.  By default all candidates have one step, which changes the
        series by less than a twentieth of the noise.

    Returns
    -------
    Fit
        Values, intervals, profiles and notes.  See `notes` before you use the values.

    Raises
    ------
    InputError
        If an argument cannot be used, or no candidate has a series.
    """
    instance(Scene)("scene", scene)
    box = Box.of(ranges)
    trace = trace_of(data, quantity)
    size = len(box.keys)
    scatter = _scatter_of(noise, trace, size)
    boolean("profiles", profiles)
    number_of_starts = STARTS * size if starts is None else integer("starts", starts, 2, 2**16)
    settings: dict[str, Any] = {"accuracy": accuracy, "method": method, "step": step}
    settings |= {"threads": threads, "engine": engine, "seed": integer("seed", seed, 0)}
    settings["allow_unresolved"] = allow_unresolved
    model = Model(scene, trace, quantity, box, members, settings)
    model = model.with_step(_middle_and_corners(size), scatter.tolerance)
    residuals = search.Residuals(model, trace.values, scatter.unit)
    tried = search.starts(residuals, size, number_of_starts, seed)
    if residuals.impossible == len(tried):
        raise InputError("scene", "completes at none of the starts in the ranges; give others")
    minima = search.distinct([search.local(residuals, each.parts) for each in tried[:SEARCHED]])
    best, curvature = _refined(residuals, minima[0], scatter)
    scale = scatter.scale(best)
    covariance, half_width = _intervals(box, curvature, scale, scatter)
    curves: dict[str, xarray.Dataset] = {}
    lowest = best
    if profiles:
        curves, lowest = _profiles(box, residuals, best, curvature, half_width, scale)
    left = trace.values - model(best.parts[None]).values[0]
    remarks = [
        *notes.of_curvature(box, best, half_width, covariance),
        *notes.on_profiles(curves, half_width, best.chi2 / scale**2, scatter.quantile, box),
        *notes.on_other_minima(minima, best, lowest, scale, box),
        *notes.on_residuals(left, residuals, scatter.sigma, best, scatter.degrees),
        *notes.on_members(members),
    ]
    values = dict(zip(box.keys, box.values(best.parts).tolist(), strict=True))
    return Fit(
        values=values,
        half_width=dict(zip(box.keys, half_width.tolist(), strict=True)),
        covariance=covariance,
        chi2=best.chi2 / scale**2,
        noise=float(scatter.unit[0] * scale) if scatter.sigma is None else noise,  # type: ignore[arg-type]
        residuals=_over_time(trace, left, quantity),
        profiles=curves,
        notes=tuple(remarks),
        scene=with_values(scene, values),
        trace=trace,
        quantity=quantity,
        runs=model.runs,
        ranges={key: (float(a), float(b)) for key, a, b in zip(*box, strict=True)},
    )


class _Scatter(NamedTuple):
    """How far data may be from the series of a scene."""

    sigma: np.ndarray | None  # (times,) of the noise; None where it follows from the residuals
    unit: np.ndarray  # (times,) of residuals: the noise, or a hundredth of the range of the data
    tolerance: float  # by which a step may change a series
    degrees: int  # of freedom: times less parameters

    def scale(self, best: search.Minimum) -> float:
        """The noise in units of the residuals: 1 where it is given."""
        if self.sigma is not None:
            return 1.0
        return max(float(np.sqrt(best.chi2 / self.degrees)), float(np.finfo(float).eps))

    @property
    def quantile(self) -> float:
        """The number of standard errors in half a 95 % interval."""
        return search.quantile(self.sigma is not None, self.degrees)


def _scatter_of(noise: Any, trace: Trace, parameters: int) -> _Scatter:
    """Check the noise, and that there are enough data.  Raises InputError."""
    degrees = trace.t.size - parameters
    if degrees < 1:
        raise InputError("data", f"must have more than {parameters} times, one for each parameter")
    sigma = None if noise is None else _noise(noise, trace)
    spread = float(np.ptp(trace.values))
    if spread == 0.0:
        raise InputError("data.values", "must change over time")
    if sigma is None:
        unit = np.full(trace.t.size, 0.01 * spread)
        return _Scatter(None, unit, OF_RANGE * spread, degrees)
    return _Scatter(sigma, sigma, OF_NOISE * float(np.min(sigma)), degrees)


def _noise(noise: Any, trace: Trace) -> np.ndarray:
    """Standard deviations of the data, (times,), from one number or from one for each time."""
    if np.ndim(noise) == 0:
        return np.full(trace.t.size, number("noise", noise, POSITIVE))
    found = vector("noise", noise, size=trace.t.size)
    if not np.all(found > 0.0):
        raise InputError("noise", "must be positive at all times")
    return found


def _middle_and_corners(parameters: int) -> np.ndarray:
    """Points of the box at which a step for all candidates is found."""
    parts = (0.5, 0.1, 0.9)
    return np.array([[part] * parameters for part in parts])


def _refined(
    residuals: search.Residuals, start: search.Minimum, scatter: _Scatter
) -> tuple[search.Minimum, search.Curvature]:
    """The minimum that differences over about a standard error lead to, and its curvature."""
    curvature = search.curvature(residuals, start.parts, scatter.scale(start))
    again = search.local(residuals, start.parts, steps=curvature.steps)
    best = min(start, again, key=_chi2)
    return best, search.curvature(residuals, best.parts, scatter.scale(best))


def _intervals(
    box: Box, curvature: search.Curvature, scale: float, scatter: _Scatter
) -> tuple[np.ndarray, np.ndarray]:
    """The covariance of the values, and half-widths of their 95 % intervals."""
    width = box.high - box.low
    with np.errstate(invalid="ignore"):
        covariance = scale**2 * curvature.covariance * np.outer(width, width)
    half_width = scatter.quantile * np.sqrt(np.diag(covariance))
    return covariance, np.where(half_width < width, half_width, np.inf)  # beyond, nothing is known


def _profiles(
    box: Box,
    residuals: search.Residuals,
    best: search.Minimum,
    curvature: search.Curvature,
    half_width: np.ndarray,
    scale: float,
) -> tuple[dict[str, xarray.Dataset], search.Minimum]:
    """chi^2 over each parameter, minimal over the others, and the lowest minimum of all."""
    curves = {}
    lowest = best
    for k, key in enumerate(box.keys):
        part = min(half_width[k] / (box.high[k] - box.low[k]), notes.WIDE)
        offsets = PROFILE * part
        found = search.profile(residuals, best, curvature.covariance, k, offsets, curvature.steps)
        curves[key] = _profile(box, k, found, scale)
        lowest = min([lowest, *found], key=_chi2)
    return curves, lowest


def _chi2(minimum: search.Minimum) -> float:
    return minimum.chi2


def _over_time(trace: Trace, values: np.ndarray, quantity: str) -> xarray.DataArray:
    import xarray

    about = {"long_name": f"measured less simulated {quantity}"}
    return xarray.DataArray(values, {"time": trace.t}, ("time",), "residuals", about)


def _profile(box: Box, index: int, found: Sequence[search.Minimum], scale: float) -> xarray.Dataset:
    import xarray

    values = box.values(np.array([each.parts for each in found]))[:, index]
    chi2 = np.array([each.chi2 for each in found]) / scale**2
    order = np.argsort(values, kind="stable")
    places = {"value": ("value", values[order], {"long_name": box.keys[index]})}
    return xarray.Dataset({"chi2": ("value", chi2[order])}, places)
