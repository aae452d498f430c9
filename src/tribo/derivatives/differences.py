"""Richardson's extrapolation of central differences, and the choice among its steps."""

from typing import NamedTuple

import numpy as np

from tribo.results.averages import student


class Differences(NamedTuple):
    """Values of a quantity at steps up and down, each step half of the one before."""

    steps: np.ndarray  # (steps,)
    up: np.ndarray  # (steps, members)
    down: np.ndarray  # (steps, members)


class Derivative(NamedTuple):
    """A derivative, the half-width of its error, and the larger one of its two steps."""

    value: float
    half_width: float
    step: float


def best_of_ladder(differences: Differences, errors: np.ndarray) -> Derivative | None:
    """The extrapolation with the smallest error; None if no step has one.

    `errors` (steps,) are the sums of the errors of the values up and down.  The members of each are
    independent of one another, and the same at all steps.  An error is at least the difference from
    the next longer step, and from the next shorter one beyond its own error of runs: two long steps
    may agree by chance.
    """
    steps = differences.steps
    slopes = (differences.up - differences.down) / (2.0 * steps[:, None])
    own = errors / (2.0 * steps)
    # Of the steps k and k + 1: free of the error in the square of the step.
    extrapolated = (4.0 * slopes[1:] - slopes[:-1]) / 3.0
    of_runs = (4.0 * own[1:] + own[:-1]) / 3.0
    means = np.mean(extrapolated, axis=1)
    members = extrapolated.shape[1]
    if members > 1:
        spread = np.std(extrapolated, axis=1, ddof=1)
        of_runs = of_runs + student(members - 1) * spread / np.sqrt(members)
    candidates = []
    for k in range(1, len(means)):
        apart = abs(means[k] - means[k - 1])
        if k + 1 < len(means) and np.isfinite(means[k + 1]):
            apart = max(apart, abs(means[k + 1] - means[k]) - of_runs[k + 1])
        half_width = apart + of_runs[k]
        if np.isfinite(half_width):
            candidates.append(Derivative(float(means[k]), float(half_width), float(steps[k])))
    return min(candidates, key=lambda each: each.half_width, default=None)
