"""Means of independent members, their intervals, and how many members an interval takes.

Student's interval, for a number of members that was fixed beforehand: with s the standard deviation
of all n, the mean is known to t(n - 1) s / sqrt(n).  Student, Biometrika 6 (1908) 1.

Stein's, for a wanted half-width d: with s that of the first n0 members alone,

    n = max(n0, floor((t(n0 - 1) s / d)^2) + 1) ,   half-width t(n0 - 1) s / sqrt(n) <= d .

Its coverage is exact for normal values, whatever n becomes, because a sample's mean and variance
are independent.  Looking at the interval as members come, and stopping when it is narrow enough,
has none such: it stops too often where the variance happens to look small.
C. Stein, Ann. Math. Stat. 16 (1945) 243.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

CONFIDENCE = 0.95


class Interval(NamedTuple):
    """Means and half-widths of their intervals, each of the shape of one member's values."""

    mean: np.ndarray
    half_width: np.ndarray


def student(degrees: int) -> float:
    """The quantile t of Student's distribution that a two-sided interval goes to."""
    from scipy.special import stdtrit

    return float(stdtrit(degrees, 0.5 * (1.0 + CONFIDENCE)))


def interval(values: np.ndarray, first: int | None = None) -> Interval:
    """Mean over members, and its interval; `values` is (members, ...).

    Student's, of all members; or Stein's, if their number was found from the `first` ones.
    """
    sample = values[:first]
    degrees = len(sample) - 1
    spread = np.std(sample, axis=0, ddof=1)
    return Interval(np.mean(values, axis=0), student(degrees) * spread / np.sqrt(len(values)))


def members_needed(sample: np.ndarray, half_width: float) -> float:
    """How many members Stein's rule takes by the values (n0, ...) of the first n0; may be inf."""
    largest = float(np.max(np.std(sample, axis=0, ddof=1)))
    if largest == 0.0:
        return float(len(sample))
    if half_width == 0.0 or not np.isfinite(largest):
        return np.inf
    ratio = student(len(sample) - 1) * largest / half_width
    return max(float(len(sample)), np.floor(ratio**2) + 1.0)
