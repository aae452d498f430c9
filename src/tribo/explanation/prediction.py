"""How many force evaluations a run will take, from the first runs of its search for settings.

With a given step the evaluations are counted.  With an accuracy, the search for settings begins as
in a run of the scene, and ends after BUDGET seconds by the model of costs.  A search that is not
complete by then is extrapolated: by the part of the duration that its last run reached, and by the
ratios of the levels of the runs that are left.  No clock decides when it ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tribo.accuracy.choose_method import Choice
from tribo.accuracy.comparison import strictest
from tribo.accuracy.levels import fine_level
from tribo.accuracy.plan import Plan, make_plan
from tribo.accuracy.run_time import counted, evaluation_time, rate_of
from tribo.accuracy.search import FIRST
from tribo.accuracy.search_runs import COARSE_RUNS, PILOT_LEVEL
from tribo.accuracy.stop_times import StopTimes
from tribo.accuracy.tolerance_scales import first_step
from tribo.integrators.methods import Method
from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.ledger.sinks import StreamedLedger
from tribo.loops.guards import most_evaluations
from tribo.loops.integrate import Integration, Setting
from tribo.loops.select import Integrator

# Time of all runs of a search, by the model of costs [s].
BUDGET = 2.0


class OverBudgetError(Exception):
    """A run of the search would exceed the budget."""


class Taken(NamedTuple):
    """The times at which a run records, its evaluations, and the part of them that it reached."""

    times: np.ndarray
    evaluations: float
    reached: float

    @property
    def whole(self) -> float:
        """The evaluations to the end, at the mean rate."""
        return self.evaluations / max(self.reached, np.finfo(float).eps)


class Prediction(NamedTuple):
    """The evaluations of a run, and how they are known.

    Attributes
    ----------
    evaluations : float
        Evaluations of all forces, of all runs that a result needs.
    basis : str
        "counted" from a given step, "searched" by all runs of the search, or "extrapolated" from
        its first runs.
    plan : Plan or None
        The settings that were found; None where the search is not complete.
    samples : int
        Samples of all runs, which are kept until the end of a search.
    whole : float
        Evaluations that the last run of the search would take to its end, if it is not complete;
        else 0.
    """

    evaluations: float
    basis: str
    plan: Plan | None
    samples: int
    whole: float = 0.0


class Search(Integrator):
    """Runs a scene in search for settings, until all runs together would exceed the budget.

    Attributes are the runs from the scene's own start, equal steps that would exceed the budget at
    once, and the evaluations and seconds of all runs.
    """

    def __init__(self, layout: Layout, method: Method, threads: int = 1) -> None:
        super().__init__(layout, method, first_step(layout), threads=threads)
        self.finished: list[Taken] = []
        self.step: float | None = None
        self.evaluations, self.seconds = 0, 0.0
        self._budget = 1e9 * BUDGET / evaluation_time(layout, method)

    def __call__(
        self,
        setting: Setting,
        times: np.ndarray,
        start: np.ndarray | None = None,
        streamed: StreamedLedger | None = None,
        most: float | None = None,
    ) -> Integration:
        """Integrate through `times`.  Raises OverBudgetError or KeyboardInterrupt."""
        rest, most = self._budget - self.evaluations, most or most_evaluations(self.layout.scene)
        if isinstance(setting, float):
            count = counted(self.layout, self.method, setting, times)
            if count > rest:
                self.step = setting
                self.finished.append(Taken(times, count, 1.0))
                raise OverBudgetError
        run = super().__call__(setting, times, start, most=min(rest, most))
        if run.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        self.seconds += run.seconds
        self.evaluations += run.evaluations
        if start is None:
            reached = float((run.samples.t[-1] - times[0]) / (times[-1] - times[0]))
            self.finished.append(Taken(times, run.evaluations, reached))
        if run.status == Status.NO_PROGRESS and rest < most:
            raise OverBudgetError
        return run


def predict(choice: Choice, search: Search) -> Prediction:
    """Predict the evaluations of a run.

    Raises InputError if the accuracy is out of reach, or names quantities that are not reported.
    """
    times = search.layout.times
    if choice.step is not None:
        count = counted(search.layout, choice.method, choice.step, times)
        return Prediction(count, "counted", make_plan(choice, search), times.size)
    try:
        plan = make_plan(choice, search)
    except OverBudgetError:
        samples = max(_samples(search), 2 * sum(t.size for t in StopTimes.for_samples(times)))
        whole = search.finished[-1].whole
        return Prediction(_extrapolated(choice, search), "extrapolated", None, samples, whole)
    assert plan.tuned is not None
    ended = plan.tuned.runs[-1].status == Status.NO_PROGRESS
    whole = search.finished[-1].whole if ended else 0.0
    return Prediction(plan.tuned.evaluations, "searched", plan, _samples(search), whole)


def _samples(search: Search) -> int:
    """Samples of all runs from the start."""
    return sum(run.times.size for run in search.finished)


def _extrapolated(choice: Choice, search: Search) -> float:
    """The evaluations of a search whose last run was not complete."""
    *done, last = search.finished
    total = sum(run.evaluations for run in done) + last.whole
    method, slope = choice.method, rate_of(search.layout, choice.method).slope
    finer = fine_level(method) ** (-1.0 / slope)
    if method.adaptive and not done:  # the pilot
        assert choice.accuracy is not None
        level = FIRST * method.first_level * strictest(choice.accuracy)
        coarse = last.whole * (PILOT_LEVEL / min(level, PILOT_LEVEL)) ** (1.0 / slope)
        return total + (COARSE_RUNS + finer) * coarse
    stops = StopTimes.for_samples(search.layout.times)
    if np.array_equal(last.times, stops.fine):
        return total + COARSE_RUNS * last.whole / finer
    return total + last.whole * (1.0 if np.array_equal(last.times, stops.many) else 2.0)
