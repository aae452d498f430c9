"""Means of independent members, their intervals, and the members that an interval takes.

Student's interval is for a number of members that was fixed beforehand.  With s the standard
deviation of all n, its half-width is t(n - 1) s / sqrt(n).  Student, Biometrika 6 (1908) 1.

Stein's interval is for a wanted half-width d.  With s that of the first n0 members alone,

    n = max(n0, floor((t(n0 - 1) s / d)^2) + 1) ,   half-width t(n0 - 1) s / sqrt(n) <= d .

Its coverage is exact for normal values, whatever n becomes, because the mean and the variance of a
sample are independent.  Adding members until the interval is narrow enough has lower coverage: it
stops too often where the variance happens to be small.
C. Stein, Ann. Math. Stat. 16 (1945) 243.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

# Probability that an interval contains the exact mean.
CONFIDENCE = 0.95


def student(degrees: int) -> float:
    """The quantile t of Student's distribution at the end of a two-sided interval."""
    from scipy.special import stdtrit

    return float(stdtrit(degrees, 0.5 * (1.0 + CONFIDENCE)))


class Interval(NamedTuple):
    """Means and half-widths of their intervals, each of the shape of one member's values."""

    mean: np.ndarray
    half_width: np.ndarray


def interval(values: np.ndarray, first_stage: int | None = None) -> Interval:
    """The mean over independent members, from (members, ...), and its interval.

    With `first_stage`, the members whose spread determined the number of all, the interval is
    Stein's; without it, Student's.
    """
    sample = values[:first_stage]
    degrees = len(sample) - 1
    spread = np.std(sample, axis=0, ddof=1)
    return Interval(np.mean(values, axis=0), student(degrees) * spread / np.sqrt(len(values)))


def members_needed(sample: np.ndarray, half_width: float) -> float:
    """The number of members by Stein's rule, from values (n0, ...) of the first n0; may be inf."""
    largest = float(np.max(np.std(sample, axis=0, ddof=1)))
    if largest == 0.0:
        return float(len(sample))
    if half_width == 0.0 or not np.isfinite(largest):
        return np.inf
    ratio = student(len(sample) - 1) * largest / half_width
    return max(float(len(sample)), np.floor(ratio**2) + 1.0)
