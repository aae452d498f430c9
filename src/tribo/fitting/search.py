"""Least squares from many starts in a box, with derivatives from differences in batches."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tribo.fitting.model import Model
from tribo.results.averages import CONFIDENCE, student

# Residual of a candidate that has no series, in standard deviations of the noise.
IMPOSSIBLE = 1e3
# Differences of parts of a range at first, and the smallest and largest at the end.
STEP = 1e-3
SMALLEST = 1e-6
LARGEST = 0.02
# Relative size of singular values that count as zero.
SINGULAR = 1e-7
# Evaluations of a local search from one start, and of one point of a profile.
MOST_LOCAL = 25
MOST_PROFILE = 8
# Distance of two minima that are the same, in parts of the ranges.
SAME = 1e-2


class Minimum(NamedTuple):
    """A point of the box, and the sum of the squares of its residuals."""

    parts: np.ndarray  # (parameters,) of the ranges
    chi2: float


class Residuals:
    """Differences of measured and simulated values, in units of the noise."""

    def __init__(self, model: Model, values: np.ndarray, noise: np.ndarray) -> None:
        """Take the measured values (times,) and their standard deviations (times,)."""
        self._model = model
        self._values = values
        self._noise = noise
        self.impossible = 0

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Residuals (points, times) at points of the box."""
        found = self._model(points)
        scale = np.sqrt(self._noise**2 + found.error**2)
        residuals = (found.values - self._values) / scale
        missing = ~np.isfinite(residuals).all(axis=1)
        self.impossible += int(np.count_nonzero(missing))
        residuals[missing] = IMPOSSIBLE
        return residuals

    def chi2(self, points: np.ndarray) -> np.ndarray:
        return np.asarray(np.sum(self(points) ** 2, axis=1))

    def derivative(self, point: np.ndarray, steps: np.ndarray, free: np.ndarray) -> np.ndarray:
        """Central differences by some of the parameters, (times, free), within the box."""
        up = np.repeat(point[None], free.size, axis=0)
        down = up.copy()
        rows = np.arange(free.size)
        up[rows, free] = np.minimum(point[free] + steps[free], 1.0)
        down[rows, free] = np.maximum(point[free] - steps[free], 0.0)
        both = self(np.concatenate([up, down]))
        width = up[rows, free] - down[rows, free]
        return np.asarray(((both[: free.size] - both[free.size :]) / width[:, None]).T)


def starts(residuals: Residuals, parameters: int, number: int, seed: int) -> list[Minimum]:
    """Points of a quasi-random sequence in the box, the best first."""
    from scipy.stats import qmc

    count = 2 ** int(np.ceil(np.log2(max(2, number))))
    points = qmc.Sobol(parameters, rng=seed).random(count)
    chi2 = residuals.chi2(points)
    order = np.argsort(chi2, kind="stable")
    return [Minimum(points[k], float(chi2[k])) for k in order]


def local(
    residuals: Residuals,
    start: np.ndarray,
    free: np.ndarray | None = None,
    most: int = MOST_LOCAL,
    steps: np.ndarray | None = None,
) -> Minimum:
    """The minimum that a local search reaches, in which only some parameters are `free`."""
    from scipy.optimize import least_squares

    free = np.arange(start.size) if free is None else free
    steps = np.full(start.size, STEP) if steps is None else steps
    if free.size == 0:
        return Minimum(start, float(residuals.chi2(start[None])[0]))

    def whole(x: np.ndarray) -> np.ndarray:
        point = start.copy()
        point[free] = np.clip(x, 0.0, 1.0)
        return point

    found = least_squares(
        lambda x: residuals(whole(x)[None])[0],
        np.clip(start[free], 1e-9, 1.0 - 1e-9),
        lambda x: residuals.derivative(whole(x), steps, free),
        bounds=(0.0, 1.0),
        xtol=1e-7,
        ftol=1e-8,
        gtol=1e-12,
        max_nfev=most,
    )
    return Minimum(whole(found.x), float(2.0 * found.cost))


def distinct(minima: list[Minimum]) -> list[Minimum]:
    """Minima of which none is close to a better one, the best first."""
    found: list[Minimum] = []
    for each in sorted(minima, key=lambda one: one.chi2):
        if all(np.max(np.abs(each.parts - other.parts)) > SAME for other in found):
            found.append(each)
    return found


class Curvature(NamedTuple):
    """The covariance of the parameters, in parts of their ranges, for noise of size 1."""

    covariance: np.ndarray  # (parameters, parameters); inf of those that are not determined
    steps: np.ndarray  # (parameters,) of the differences


def curvature(residuals: Residuals, point: np.ndarray, scale: float) -> Curvature:
    """The covariance at a minimum, from differences over about a standard error.

    The noise is `scale` times that of the residuals.  Slips make a series uneven on smaller steps.
    """
    every = np.arange(point.size)
    steps = np.full(point.size, STEP)
    covariance = np.full((point.size, point.size), np.inf)
    for _ in range(3):
        jacobian = residuals.derivative(point, steps, every)
        covariance = _inverse(jacobian)
        errors = scale * np.sqrt(np.diag(covariance))
        steps = np.clip(np.where(np.isfinite(errors), errors, LARGEST), SMALLEST, LARGEST)
    return Curvature(covariance, steps)


def _inverse(jacobian: np.ndarray) -> np.ndarray:
    """The inverse of J^T J; infinite variances in directions in which nothing changes."""
    _, sizes, rows = np.linalg.svd(jacobian, full_matrices=False)
    if not np.all(np.isfinite(sizes)) or sizes[0] == 0.0:
        return np.full((jacobian.shape[1],) * 2, np.inf)
    known = sizes > SINGULAR * sizes[0]
    covariance = (rows[known].T / sizes[known] ** 2) @ rows[known]
    lost = np.any(np.abs(rows[~known]) > 1e-3, axis=0)
    covariance[lost] = np.inf
    covariance[:, lost] = np.inf
    return np.asarray(covariance)


def quantile(known_noise: bool, degrees: int) -> float:
    """The number of standard errors in half a 95 % interval."""
    if not known_noise:
        return student(degrees)
    from scipy.special import ndtri

    return float(ndtri(0.5 * (1.0 + CONFIDENCE)))


def profile(
    residuals: Residuals,
    best: Minimum,
    covariance: np.ndarray,
    index: int,
    offsets: np.ndarray,
    steps: np.ndarray,
) -> list[Minimum]:
    """Minima over all other parameters where one is moved by some offsets, in parts of its range.

    Offsets that leave the box are at its edge.
    """
    others = np.delete(np.arange(best.parts.size), index)
    slope = np.zeros(best.parts.size)
    if np.isfinite(covariance[index]).all() and covariance[index, index] > 0.0:
        slope = covariance[index] / covariance[index, index]
    slope[index] = 1.0
    found = []
    for offset in offsets:
        start = np.clip(best.parts + offset * slope, 0.0, 1.0)
        found.append(local(residuals, start, others, MOST_PROFILE, steps))
    return found
