"""Parameters of a scene from a measured series, by least squares over runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.accuracy.comparison import Accuracy
from tribo.ensembles.engines import Engine
from tribo.files import strict_json
from tribo.fitting import search
from tribo.fitting.data import Trace, trace_of
from tribo.fitting.model import Box, Model
from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.validation import POSITIVE, InputError, boolean, instance, integer, number, vector

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

# Starts in the box for each parameter, and how many of the best are searched from.
STARTS = 32
SEARCHED = 4
# Part of the noise, or without one of the range of the data, by which steps may change a series.
OF_NOISE = 0.05
OF_RANGE = 1e-3
# Points of a profile, in half-widths.
PROFILE = np.array([-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0])
# Part of the range that a half-width exceeds where the data do not determine a parameter.
WIDE = 0.5
# Part of its range by which a parameter is away from its ends, at least.
AT_END = 1e-3
# Correlation of two parameters that determine little more than a combination of them.
CORRELATED = 0.99
# Change of chi^2 at one half-width, relative to that of a parabola, where intervals hold.
PARABOLIC = (0.5, 2.0)
# Standard errors of the correlation of neighbouring residuals that is noted.
NOTED = 4.0


@dataclass(eq=False)
class Fit:
    """Parameters of a scene that fit a measured series best.

    Attributes
    ----------
    values : dict of str to float
        The values of the parameters, by their keys.
    half_width : dict of str to float
        Half-widths of their 95 % intervals, from the curvature of chi^2; inf where the data do not
        determine a parameter.
    covariance : ndarray, (parameters, parameters)
        Of the values, in their order and units.
    chi2 : float
        The sum of the squares of residuals over noise; with unknown noise, over that found.
    noise : float or ndarray
        The standard deviation of the data: given, or found from the residuals.
    residuals : xarray.DataArray, (time,)
        Measured less simulated values.
    profiles : dict of str to xarray.Dataset
        For each key ``chi2`` (value,), the smallest one over all other parameters; the 95 % interval
        is where it exceeds that of the fit by less than 3.84.
    notes : tuple of str
        What to know: parameters that are not determined, other minima, correlated residuals.
    scene : Scene
        The scene with the values.
    trace : Trace
        The measured series, with `t` and `values`.
    runs : int
        Number of points that were simulated.
    """

    values: dict[str, float]
    half_width: dict[str, float]
    covariance: np.ndarray
    chi2: float
    noise: float | np.ndarray
    residuals: xarray.DataArray
    profiles: dict[str, xarray.Dataset]
    notes: tuple[str, ...]
    scene: Scene
    trace: Trace
    quantity: str
    runs: int
    ranges: Mapping[str, tuple[float, float]] = field(repr=False)

    def __str__(self) -> str:
        lines = [
            f"{key} = {value:.6g} +- {self.half_width[key]:.2g}"
            for key, value in self.values.items()
        ]
        degrees = self.trace.t.size - len(self.values)
        lines.append(f"chi^2 = {self.chi2:.5g} with {degrees} degrees of freedom, {self.runs} runs")
        return "\n".join([*lines, *self.notes])

    __repr__ = __str__

    def to_json(self) -> str:
        """Values, half-widths, covariance, chi^2, noise and notes as one object of strict JSON."""
        noise = self.noise
        return strict_json(
            {
                "values": self.values,
                "half_width": self.half_width,
                "covariance": self.covariance.tolist(),
                "chi2": self.chi2,
                "noise": noise.tolist() if isinstance(noise, np.ndarray) else noise,
                "degrees_of_freedom": self.trace.t.size - len(self.values),
                "runs": self.runs,
                "notes": list(self.notes),
            }
        )

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the measured and the fitted series, and the residuals below zero of their own."""
        from tribo.fitting.figure import draw

        return draw(self, ax)


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
    scale = 1.0 if sigma is not None else float(np.sqrt(best.chi2 / degrees))
    curvature = search.curvature(residuals, best.parts, scale)
    best = min(best, search.local(residuals, best.parts, steps=curvature.steps), key=_chi2)
    scale = 1.0 if sigma is not None else float(np.sqrt(best.chi2 / degrees))
    curvature = search.curvature(residuals, best.parts, scale)
    width = box.high - box.low
    quantile = search.quantile(sigma is not None, degrees)
    with np.errstate(invalid="ignore"):
        covariance = scale**2 * curvature.covariance * np.outer(width, width)
    half_width = quantile * np.sqrt(np.diag(covariance))
    curves: dict[str, xarray.Dataset] = {}
    lowest = best
    if profiles:
        for k, key in enumerate(box.keys):
            part = min(half_width[k] / width[k], WIDE)
            found = search.profile(
                residuals, best, curvature.covariance, k, PROFILE * part, curvature.steps
            )
            curves[key] = _profile(box, k, found, scale)
            lowest = min([lowest, *found], key=_chi2)
    series = model(best.parts[None])
    notes = [
        *_notes(box, best, half_width, covariance),
        *_notes_on_profiles(curves, half_width, best.chi2 / scale**2, quantile, box),
        *_other_minima(minima, best, lowest, scale, box),
        *_notes_on_residuals((trace.values - series.values[0]), residuals, sigma, best, degrees),
    ]
    values = dict(zip(box.keys, box.values(best.parts).tolist(), strict=True))
    return Fit(
        values=values,
        half_width=dict(zip(box.keys, half_width.tolist(), strict=True)),
        covariance=covariance,
        chi2=best.chi2 / scale**2,
        noise=float(0.01 * spread * scale) if sigma is None else noise,  # type: ignore[arg-type]
        residuals=_over_time(trace, trace.values - series.values[0], quantity),
        profiles=curves,
        notes=tuple(notes),
        scene=with_values(scene, values),
        trace=trace,
        quantity=quantity,
        runs=model.runs,
        ranges={key: (float(a), float(b)) for key, a, b in zip(*box, strict=True)},
    )


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


def _notes(
    box: Box, best: search.Minimum, half_width: np.ndarray, covariance: np.ndarray
) -> list[str]:
    """What the curvature says of parameters that the data do not determine."""
    notes = []
    width = box.high - box.low
    for k, key in enumerate(box.keys):
        if not half_width[k] < WIDE * width[k]:
            notes.append(
                f"{key} is not determined: its interval is wider than its range; fix it, or measure "
                "a quantity that depends on it"
            )
        if not AT_END < best.parts[k] < 1.0 - AT_END:
            end = "upper" if best.parts[k] > 0.5 else "lower"
            notes.append(f"{key} is at the {end} end of its range; give a wider one")
    errors = np.sqrt(np.diag(covariance))
    for i in range(len(box.keys)):
        for j in range(i):
            if not (np.isfinite(errors[i]) and np.isfinite(errors[j])):
                continue
            correlation = covariance[i, j] / (errors[i] * errors[j])
            if abs(correlation) > CORRELATED:
                notes.append(
                    f"{box.keys[j]} and {box.keys[i]} are determined in a combination alone: their "
                    f"correlation is {correlation:.4f}"
                )
    return notes


def _notes_on_profiles(
    curves: Mapping[str, xarray.Dataset],
    half_width: np.ndarray,
    chi2: float,
    quantile: float,
    box: Box,
) -> list[str]:
    """Where chi^2 is no parabola, so that intervals from its curvature do not hold."""
    notes = []
    for k, (key, curve) in enumerate(curves.items()):
        if not half_width[k] < WIDE * (box.high - box.low)[k]:
            continue
        middle = len(PROFILE) // 2
        ratios = (curve["chi2"].values[[middle - 2, middle + 2]] - chi2) / quantile**2
        if not np.all((PARABOLIC[0] < ratios) & (ratios < PARABOLIC[1])):
            notes.append(
                f"the interval of {key} is not that of a parabola: one half-width away, chi^2 grows "
                f"by {ratios[0]:.2g} and {ratios[1]:.2g} of what it should; read it off the profile"
            )
    return notes


def _other_minima(
    minima: Sequence[search.Minimum],
    best: search.Minimum,
    lowest: search.Minimum,
    scale: float,
    box: Box,
) -> list[str]:
    """Other points that fit as well, or better than the fit."""
    notes = []
    if lowest.chi2 < best.chi2 - 0.5 * scale**2:
        place = ", ".join(
            f"{key} = {value:.4g}"
            for key, value in zip(box.keys, box.values(lowest.parts), strict=True)
        )
        notes.append(f"a profile found a better fit at {place}; start from more points (starts)")
    for other in minima[1:]:
        away = np.max(np.abs(other.parts - best.parts)) > search.SAME
        if away and other.chi2 < best.chi2 + 4.0 * scale**2:
            place = ", ".join(
                f"{key} = {value:.4g}"
                for key, value in zip(box.keys, box.values(other.parts), strict=True)
            )
            notes.append(f"another minimum fits as well: {place}")
    return notes


def _notes_on_residuals(
    rest: np.ndarray,
    residuals: search.Residuals,
    sigma: np.ndarray | None,
    best: search.Minimum,
    degrees: int,
) -> list[str]:
    """Residuals that are not the independent noise that intervals take them for."""
    notes = []
    rest = rest / (1.0 if sigma is None else sigma)
    correlation = float(rest[1:] @ rest[:-1] / (rest @ rest)) if np.any(rest) else 0.0
    if abs(correlation) > NOTED / np.sqrt(rest.size):
        notes.append(
            f"neighbouring residuals have the correlation {correlation:.2f}: the noise is not "
            "independent, or the scene lacks something, and intervals are too narrow"
        )
    limit = degrees + NOTED * np.sqrt(2.0 * degrees)
    if sigma is not None and best.chi2 > limit:
        notes.append(
            f"chi^2 is {best.chi2:.4g} with {degrees} degrees of freedom: the scene does not "
            "describe the data within their noise, and intervals are too narrow"
        )
    if residuals.impossible:
        notes.append(f"{residuals.impossible} candidates did not complete, and count as bad fits")
    return notes
