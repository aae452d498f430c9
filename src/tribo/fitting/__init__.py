"""Parameters of a scene from a measured series, by least squares over runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

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
    degrees = trace.t.size - size
    if degrees < 1:
        raise InputError("data", f"must have more than {size} times, one for each parameter")
    sigma = None if noise is None else _noise(noise, trace)
    boolean("profiles", profiles)
    number_of_starts = STARTS * size if starts is None else integer("starts", starts, 2, 2**16)
    settings: dict[str, Any] = {"accuracy": accuracy, "method": method, "step": step}
    settings |= {"threads": threads, "engine": engine, "seed": integer("seed", seed, 0)}
    settings["allow_unresolved"] = allow_unresolved
    model = Model(scene, trace, quantity, box, members, settings)
    spread = float(np.ptp(trace.values))
    if spread == 0.0:
        raise InputError("data.values", "must change over time")
    tolerance = OF_RANGE * spread if sigma is None else OF_NOISE * float(np.min(sigma))
    middle = np.full((1, size), 0.5)
    corners = np.array([[0.1] * size, [0.9] * size])
    model = model.with_step(np.concatenate([middle, corners]), tolerance)
    # Residuals in units of the noise, or of a hundredth of the range.
    unit = np.full(trace.t.size, 0.01 * spread) if sigma is None else sigma
    residuals = search.Residuals(model, trace.values, unit)
    tried = search.starts(residuals, size, number_of_starts, seed)
    if residuals.impossible == len(tried):
        raise InputError("scene", "completes at none of the starts in the ranges; give others")
    minima = search.distinct([search.local(residuals, each.parts) for each in tried[:SEARCHED]])
    best = minima[0]
    scale = _scale(sigma, best, degrees)
    curvature = search.curvature(residuals, best.parts, scale)
    best = min(best, search.local(residuals, best.parts, steps=curvature.steps), key=_chi2)
    scale = _scale(sigma, best, degrees)
    curvature = search.curvature(residuals, best.parts, scale)
    width = box.high - box.low
    quantile = search.quantile(sigma is not None, degrees)
    with np.errstate(invalid="ignore"):
        covariance = scale**2 * curvature.covariance * np.outer(width, width)
    half_width = quantile * np.sqrt(np.diag(covariance))
    half_width = np.where(half_width < width, half_width, np.inf)  # beyond it nothing is known
    curves: dict[str, xarray.Dataset] = {}
    lowest = best
    if profiles:
        for k, key in enumerate(box.keys):
            part = min(half_width[k] / width[k], notes.WIDE)
            found = search.profile(
                residuals, best, curvature.covariance, k, PROFILE * part, curvature.steps
            )
            curves[key] = _profile(box, k, found, scale)
            lowest = min([lowest, *found], key=_chi2)
    series = model(best.parts[None])
    remarks = [
        *notes.of_curvature(box, best, half_width, covariance),
        *notes.on_profiles(curves, half_width, best.chi2 / scale**2, quantile, box),
        *notes.on_other_minima(minima, best, lowest, scale, box),
        *notes.on_residuals(trace.values - series.values[0], residuals, sigma, best, degrees),
    ]
    if members is not None:
        remarks.append(
            "errors of means over members are correlated over time, which intervals leave out; "
            "repeat the fit with another seed, or with more members, to see what they change"
        )
    values = dict(zip(box.keys, box.values(best.parts).tolist(), strict=True))
    return Fit(
        values=values,
        half_width=dict(zip(box.keys, half_width.tolist(), strict=True)),
        covariance=covariance,
        chi2=best.chi2 / scale**2,
        noise=float(0.01 * spread * scale) if sigma is None else noise,  # type: ignore[arg-type]
        residuals=_over_time(trace, trace.values - series.values[0], quantity),
        profiles=curves,
        notes=tuple(remarks),
        scene=with_values(scene, values),
        trace=trace,
        quantity=quantity,
        runs=model.runs,
        ranges={key: (float(a), float(b)) for key, a, b in zip(*box, strict=True)},
    )


def _scale(sigma: np.ndarray | None, best: search.Minimum, degrees: int) -> float:
    """The noise in units of that of the residuals: 1 where it is given."""
    if sigma is not None:
        return 1.0
    return max(float(np.sqrt(best.chi2 / degrees)), float(np.finfo(float).eps))


def _chi2(minimum: search.Minimum) -> float:
    return minimum.chi2


def _noise(noise: Any, trace: Trace) -> np.ndarray:
    if np.ndim(noise) == 0:
        return np.full(trace.t.size, number("noise", noise, POSITIVE))
    found = vector("noise", noise, size=trace.t.size)
    if not np.all(found > 0.0):
        raise InputError("noise", "must be positive at all times")
    return found


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
