"""How many force evaluations a run will take, from the first runs of its search for settings.

With a given step the evaluations are counted.  With an accuracy, the search for settings begins as
in a run of the scene, and ends after BUDGET seconds by the model of costs.  A search that is not
complete by then is extrapolated: by the part of the duration that its last run reached, and by the
ratios of the levels of the runs that are left.  No clock decides when it ends.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tribo.accuracy.choose_method import RATES, Choice
from tribo.accuracy.comparison import strictest
from tribo.accuracy.levels import fine_level
from tribo.accuracy.plan import Plan, make_plan
from tribo.accuracy.run_time import counted, evaluation_time, rate_of
from tribo.accuracy.search import FIRST
from tribo.accuracy.search_runs import COARSE_RUNS, PILOT_LEVEL
from tribo.accuracy.stop_times import StopTimes
from tribo.accuracy.tolerance_scales import first_step
from tribo.integrators.methods import Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import PAUSED, Status
from tribo.layout.layout import Layout
from tribo.ledger.sinks import StreamedLedger
from tribo.loops.cuts import up_to_runaway
from tribo.loops.general import GeneralLoop
from tribo.loops.guards import TRIALS
from tribo.loops.integrate import Columns, Integration, Reached, Setting, TimeLoop, integrate
from tribo.loops.select import Integrator

# Time of all runs of a search, by the model of costs [s].
BUDGET = 2.0
# Parts of the budget after which a run is looked at.
PARTS = 16


class OverBudgetError(Exception):
    """A run of the search reached the end of the budget."""


class Taken(NamedTuple):
    """The times at which a run of a search records, and the evaluations that it took."""

    times: np.ndarray
    evaluations: float


@dataclass(frozen=True)
class Prediction:
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
    """Runs a scene in search for settings, until all runs together have taken the budget.

    Attributes are the runs from the scene's own start, the part of the duration that the last of
    these reached, and the evaluations and seconds of all runs.
    """

    def __init__(self, layout: Layout, method: Method, threads: int = 1) -> None:
        super().__init__(layout, method, first_step(layout), threads=threads)
        self.finished: list[Taken] = []
        self.reached, self.evaluations, self.seconds = 1.0, 0.0, 0.0
        self._budget = 1e9 * BUDGET / evaluation_time(layout, method)
        self._portion = max(1, int(self._budget / (PARTS * RATES[method.name].step)))

    def __call__(
        self,
        setting: Setting,
        times: np.ndarray,
        start: np.ndarray | None = None,
        streamed: StreamedLedger | None = None,
        most: float | None = None,
    ) -> Integration:
        """Integrate through `times`.  Raises OverBudgetError."""
        self._own = start is None
        start = self.layout.start if start is None else start
        self._times, self._began = times, time.perf_counter()
        if self.pair is not None:
            assert isinstance(setting, Tolerance)
            run = self.pair.integrate(setting, start, times, None, Limit(self))
        else:
            first = self.first_step
            loop = GeneralLoop(self.layout, self.method, setting, start, first, self.threads)
            run = self._integrated(loop, times)
        if run.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        self._finish(run.evaluations)
        return run

    def _integrated(self, loop: GeneralLoop, times: np.ndarray) -> Integration:
        columns = loop.room(times.size + 1)
        while loop.advance(times, columns, self._portion) == PAUSED:
            self.check(loop)
        run = integrate(loop, times, columns=columns)
        return run if self.method.adaptive else up_to_runaway(self.layout, run)

    def check(self, loop: TimeLoop) -> None:
        """Raise OverBudgetError if a run has taken the rest of the budget."""
        clock = loop.clocks[0]
        if self.evaluations + clock["evaluations"] < self._budget:
            return
        if self._own:
            self.reached = self.part_of(float(clock["t"]))
        self._finish(float(clock["evaluations"]))
        raise OverBudgetError

    def part_of(self, t: float) -> float:
        """The part of the duration before a time."""
        begin, end = self.layout.times[[0, -1]]
        return float((t - begin) / (end - begin))

    def _finish(self, evaluations: float) -> None:
        """Note what the present run has taken."""
        self.seconds += time.perf_counter() - self._began
        self.evaluations += evaluations
        if self._own:
            self.finished.append(Taken(self._times, evaluations))


class Limit:
    """Ends a run of a pair, as checkpoints: after every so many trials, whatever the clock says."""

    def __init__(self, search: Search) -> None:
        self._search = search

    def restore(self, *_: object) -> Reached:
        """Nothing: all runs begin at the start."""
        return Reached()

    def due(self) -> bool:
        """Always."""
        return True

    def keep(
        self, loop: TimeLoop, columns: Columns, streamed: StreamedLedger | None, reached: Reached
    ) -> None:
        """Raise OverBudgetError where the run has taken the rest of the budget."""
        clock = loop.clocks[0]
        if reached.status is None and (clock["steps"] + clock["rejected"]) % TRIALS == 0:
            self._search.check(loop)


def predict(choice: Choice, search: Search) -> Prediction:
    """Predict the evaluations of a run.

    Raises InputError if the accuracy is out of reach, or names quantities that are not reported.
    """
    if choice.step is not None:
        count = counted(search.layout, choice.method, choice.step)
        return Prediction(count, "counted", make_plan(choice, search), search.layout.times.size)
    try:
        plan = make_plan(choice, search)
    except OverBudgetError:
        stops = StopTimes.for_samples(search.layout.times)
        samples = max(_samples(search), 2 * sum(t.size for t in stops))
        count, whole = extrapolated(choice, search), _whole(search)
        return Prediction(count, "extrapolated", None, samples, whole)
    assert plan.tuned is not None
    last, whole = plan.tuned.runs[-1], 0.0
    if last.status == Status.NO_PROGRESS:
        search.reached = search.part_of(float(last.samples.t[-1]))
        whole = _whole(search)
    return Prediction(float(plan.tuned.evaluations), "searched", plan, _samples(search), whole)


def _samples(search: Search) -> int:
    """Samples of all runs from the start."""
    return sum(run.times.size for run in search.finished)


def _whole(search: Search) -> float:
    """The evaluations that the last run would take at its mean rate, to its end."""
    return search.finished[-1].evaluations / max(search.reached, np.finfo(float).eps)


def extrapolated(choice: Choice, search: Search) -> float:
    """The evaluations of a search whose last run was not complete."""
    *done, last = search.finished
    whole = _whole(search)
    total = sum(run.evaluations for run in done) + whole
    method, slope = choice.method, rate_of(search.layout, choice.method).slope
    finer = fine_level(method) ** (-1.0 / slope)
    if method.adaptive and not done:  # the pilot
        assert choice.accuracy is not None
        level = FIRST * method.first_level * strictest(choice.accuracy)
        coarse = whole * (PILOT_LEVEL / min(level, PILOT_LEVEL)) ** (1.0 / slope)
        return total + (COARSE_RUNS + finer) * coarse
    stops = StopTimes.for_samples(search.layout.times)
    if np.array_equal(last.times, stops.fine):
        return total + COARSE_RUNS * whole / finer
    left = 1.0 if np.array_equal(last.times, stops.many) else 2.0
    return total + left * whole
