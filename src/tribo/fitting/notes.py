"""What to know of a fit before its values are used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from tribo.fitting import search
from tribo.fitting.model import Box

if TYPE_CHECKING:
    import xarray

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


def of_curvature(
    box: Box, best: search.Minimum, half_width: np.ndarray, covariance: np.ndarray
) -> list[str]:
    """What the curvature says of parameters that the data do not determine."""
    notes = []
    width = box.high - box.low
    for k, key in enumerate(box.keys):
        if not half_width[k] < WIDE * width[k]:
            notes.append(
                f"{key} is not determined: its interval is wider than its range; fix it, or "
                "measure a quantity that depends on it"
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


def on_profiles(
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
        middle = curve.sizes["value"] // 2
        ratios = (curve["chi2"].values[[middle - 2, middle + 2]] - chi2) / quantile**2
        if not np.all((PARABOLIC[0] < ratios) & (ratios < PARABOLIC[1])):
            notes.append(
                f"the interval of {key} is not that of a parabola: one half-width away, chi^2 "
                f"grows by {ratios[0]:.2g} and {ratios[1]:.2g} of what it should; read it off the "
                "profile"
            )
    return notes


def on_other_minima(
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


def on_residuals(
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


def on_members(members: int | None) -> list[str]:
    """What means over members leave out of the intervals."""
    if members is None:
        return []
    return [
        "errors of means over members are correlated over time, which intervals leave out; "
        "repeat the fit with another seed, or with more members, to see what they change"
    ]
