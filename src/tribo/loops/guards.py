"""The guard of runs with adaptive steps: one that makes no progress stops by name."""

from __future__ import annotations

import numpy as np

from tribo.model.scene import Scene

# Most work of a run with adaptive steps [force evaluations x asperites], where the scene's numerics
# give no bound: 6 to 13 s at the 0.03 to 0.06 us that benchmarks/calibrate.py measures for an
# asperite.
MOST_WORK = 2e8
# Evaluations that runs of any number of asperites may take.
ALWAYS_ALLOWED = 1e7
# A run stops if its mean progress predicts this times the evaluations that it may take: the start
# of a run may be its slowest part.
MOST_PREDICTED = 3.0
# Trials of steps after which the progress of a run of two asperites is looked at: a second.
TRIALS = 2**18
# The same at least, for any number of asperites.
FEWEST_TRIALS = 2**12
# Looks at the progress of a run that takes all evaluations that it may, at least; a trial takes
# nine or more of them.
LOOKS = 100


def most_evaluations(scene: Scene) -> float:
    """Force evaluations that a run with adaptive steps may take."""
    given = scene.numerics.max_evaluations
    return max(MOST_WORK / scene.count, ALWAYS_ALLOWED) if given is None else given


def reach_of(scene: Scene, whole: float, begin: float) -> str:
    """What a run would take and may take, and how far it may come, as a part of a sentence.

    At its mean rate the whole run from `begin` would take `whole` evaluations.
    """
    most = most_evaluations(scene)
    reach = begin + (scene.duration - begin) * min(1.0, most / whole)
    return (
        f"the whole run would take about {whole:.2g} evaluations of all forces, and may take "
        f"{most:.2g}, which reach about t = {reach:.2g}"
    )


class ProgressGuard:
    """Predicts the evaluations of a run from its mean progress, after every so many trials.

    No clock decides: the trials and the prediction are the same on every machine, and do not depend
    on the chunks of steps in which a run is made.  The run may take `most` evaluations.
    """

    def __init__(
        self, clocks: np.ndarray, beginning: float, end: float, asperites: int, most: float
    ) -> None:
        self._clock = clocks[0]
        self._beginning, self._end, self._most = beginning, end, most
        every = min(2 * TRIALS // asperites, int(most / LOOKS))
        self._every = max(FEWEST_TRIALS, every)

    def within(self, budget: int) -> int:
        """At most so many steps, and no more than until the next look."""
        return int(min(budget, self._every - self._trials % self._every))

    def is_hopeless(self) -> bool:
        """Whether it is time to look, and the run would take too many evaluations."""
        if self._trials == 0 or self._trials % self._every != 0:
            return False
        done = float(self._clock["t"]) - self._beginning
        taken = float(self._clock["evaluations"])
        predicted = taken * (self._end - self._beginning)
        return taken > self._most or predicted > MOST_PREDICTED * self._most * done

    @property
    def _trials(self) -> int:
        return int(self._clock["steps"] + self._clock["rejected"])
