"""Student's quantile, for intervals of means.  Student, Biometrika 6 (1908) 1."""

from __future__ import annotations

# Probability that an interval contains the exact mean.
CONFIDENCE = 0.95


def student(degrees: int) -> float:
    """The quantile t of Student's distribution at the end of a two-sided interval."""
    from scipy.special import stdtrit

    return float(stdtrit(degrees, 0.5 * (1.0 + CONFIDENCE)))
