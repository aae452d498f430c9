"""The guard of runs with adaptive steps: one that makes no progress stops by name."""

from __future__ import annotations

import numpy as np

# Most evaluations of all forces of a run: a minute for a pair of asperites, five for two of any
# other kind, at 0.06 and 0.3 us.  Equal steps are the user's own choice and have no bound.
MOST_EVALUATIONS = 1e9
# Trials of steps after which the progress of a run of two asperites is looked at: seconds.
TRIALS = 2**20
# The same at least, for any number of asperites.
FEWEST_TRIALS = 2**12


class ProgressGuard:
    """Predicts the evaluations of a run from its mean progress, after every so many trials.

    No clock decides: the trials and the prediction are the same on every machine, and do not
    depend on the chunks of steps in which a run is made.

    Parameters
    ----------
    clocks : ndarray, (1,)
        How far the run has come.
    beginning, end : float
        First and last time of the run [time].
    asperites : int
        How many there are.
    """

    def __init__(self, clocks: np.ndarray, beginning: float, end: float, asperites: int) -> None:
        self._clock = clocks[0]
        self._beginning, self._end = beginning, end
        self._every = max(FEWEST_TRIALS, 2 * TRIALS // asperites)

    def within(self, budget: int) -> int:
        """At most so many steps, and no more than until the next look."""
        return int(min(budget, self._every - self._trials % self._every))

    def is_hopeless(self) -> bool:
        """Whether it is time to look, and the run would take too many evaluations."""
        if self._trials == 0 or self._trials % self._every != 0:
            return False
        done = float(self._clock["t"]) - self._beginning
        whole = float(self._clock["evaluations"]) * (self._end - self._beginning)
        return whole > MOST_EVALUATIONS * done

    @property
    def _trials(self) -> int:
        return int(self._clock["steps"] + self._clock["rejected"])
