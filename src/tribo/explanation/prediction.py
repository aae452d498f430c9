"""What a run will take: its force evaluations, their time, and its memory.

With a given step the evaluations are counted.  With an accuracy, the search for settings begins as
in a run of the scene, and ends after BUDGET seconds by the model of costs.  A search that is not
complete by then is extrapolated: by the part of the duration that its last run reached, and by the
ratios of the levels of the runs that are left.  No clock decides when it ends.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from tribo.accuracy.choose_method import Choice
from tribo.accuracy.comparison import strictest
from tribo.accuracy.extremes import BYTES, PORTION
from tribo.accuracy.found_settings import FoundSettings
from tribo.accuracy.levels import fine_level
from tribo.accuracy.plan import make_plan
from tribo.accuracy.run_time import counted, evaluation_time, rate_of
from tribo.accuracy.search import FIRST
from tribo.accuracy.search_runs import COARSE_RUNS, PILOT_LEVEL
from tribo.accuracy.stop_times import PARTS, StopTimes
from tribo.accuracy.tolerance_scales import first_step
from tribo.explanation.explanation import Predicted
from tribo.integrators.methods import Method
from tribo.kernels.force_probe import ROWS
from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.ledger.ledger import Ledger, assemble
from tribo.ledger.samples import Samples
from tribo.ledger.sinks import PORTION_BYTES, StreamedLedger, is_streamed
from tribo.loops.general import GeneralLoop
from tribo.loops.guards import MOST_PREDICTED, most_evaluations, reach_of
from tribo.loops.integrate import Integration, Setting
from tribo.loops.select import Integrator

# Time of all runs of a search, by the model of costs [s].
BUDGET = 2.0
# Time of the run that measures a speed with a given step, by the model of costs [s].
MEASURED = 0.05


class OverBudgetError(Exception):
    """A run of the search would exceed the budget."""


class Search(Integrator):
    """Runs a scene in search for settings, until all runs together would exceed the budget.

    Attributes are the evaluations and seconds of all runs, and a step that would exceed the budget
    at once; of the runs from the scene's own start their number and samples, and of the last of
    these its times, its evaluations to the end at the mean rate, and those that are left.
    """

    def __init__(self, layout: Layout, method: Method, threads: int = 1) -> None:
        super().__init__(layout, method, first_step(layout), threads=threads)
        self.evaluations, self.seconds = 0, 0.0
        self.step: float | None = None
        self.runs = self.samples = 0
        self.times, self.whole, self.left = layout.times, 0.0, 0.0
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
                self._count(times, count, 0.0)
                raise OverBudgetError
        run = super().__call__(setting, times, start, most=min(rest, most))
        if run.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        self.seconds += run.seconds
        self.evaluations += run.evaluations
        if start is None:
            reached = float((run.samples.t[-1] - times[0]) / (times[-1] - times[0]))
            whole = run.evaluations / max(reached, np.finfo(float).eps)
            self._count(times, whole, run.evaluations)
        if run.status == Status.NO_PROGRESS and rest < most:
            raise OverBudgetError
        return run

    def _count(self, times: np.ndarray, whole: float, taken: float) -> None:
        self.runs, self.samples = self.runs + 1, self.samples + times.size
        self.times, self.whole, self.left = times, whole, whole - taken


def predict(choice: Choice, search: Search) -> tuple[Predicted, float | None]:
    """Predict the cost of a run, and its step where all steps are equal and known.

    Raises InputError if the accuracy is out of reach, or names quantities that are not reported.
    """
    layout, method, plan = search.layout, search.method, None
    began = time.perf_counter()
    try:
        plan = make_plan(choice, search)
        basis, evaluations, samples = "searched", float(search.evaluations), search.samples
    except OverBudgetError:
        basis, evaluations = "extrapolated", _extrapolated(choice, search)
        samples = max(search.samples, 2 * sum(t.size for t in StopTimes.for_samples(layout.times)))
    beside = time.perf_counter() - began - search.seconds
    if choice.step is not None:
        basis, samples, beside = "counted", layout.times.size, 0.0
        evaluations = counted(layout, method, choice.step, layout.times)
    tuned = None if plan is None else plan.tuned
    predicted = Predicted(
        force_evaluations=round(evaluations),
        seconds=_seconds_of_evaluation(choice, search) * evaluations + beside,
        memory_bytes=bytes_of_run(layout, method, samples, choice.step is None),
        basis=basis,
        met=None if tuned is None else tuned.met,
        stop=_stop(search, tuned),
    )
    return predicted, plan.setting if plan and isinstance(plan.setting, float) else None


def _seconds_of_evaluation(choice: Choice, search: Search) -> float:
    """In the runs of the search or, with equal steps and no such runs, in a short run."""
    if search.evaluations:
        return search.seconds / search.evaluations
    step = choice.step or search.step
    assert step is not None
    layout, each = search.layout, evaluation_time(search.layout, search.method)
    loop = GeneralLoop(layout, search.method, step, layout.start, 0.0, search.threads)
    columns = loop.room(layout.times.size + 1)
    loop.advance(layout.times, columns, 1)
    before, began = int(loop.clocks["evaluations"][0]), time.perf_counter()
    loop.advance(layout.times, columns, max(1, int(1e9 * MEASURED / each)))
    seconds = time.perf_counter() - began
    return seconds / max(1, int(loop.clocks["evaluations"][0]) - before)


def _stop(search: Search, tuned: FoundSettings | None) -> str:
    """Why the run will stop as NoProgress, and what would do; empty if it should not."""
    scene = search.layout.scene
    too_many = search.whole > MOST_PREDICTED * most_evaluations(scene)
    ended = tuned is not None and tuned.runs[-1].status == Status.NO_PROGRESS
    if not (ended or (search.method.adaptive and too_many)):
        return ""
    return (
        f"{reach_of(scene, search.whole, search.layout.beginning)}; give a lower accuracy, a "
        "shorter duration, more max_evaluations, or a method and a step"
    )


def _extrapolated(choice: Choice, search: Search) -> float:
    """The evaluations of a search whose last run was not complete."""
    method, slope = choice.method, rate_of(search.layout, choice.method).slope
    total, last = search.evaluations + search.left, search.whole
    finer = fine_level(method) ** (-1.0 / slope)
    if method.adaptive and search.runs == 1:  # the pilot
        assert choice.accuracy is not None
        level = FIRST * method.first_level * strictest(choice.accuracy)
        coarse = last * (PILOT_LEVEL / min(level, PILOT_LEVEL)) ** (1.0 / slope)
        return total + (COARSE_RUNS + finer) * coarse
    stops = StopTimes.for_samples(search.layout.times)
    if np.array_equal(search.times, stops.fine):
        return total + COARSE_RUNS * last / finer
    return total + last * (1.0 if np.array_equal(search.times, stops.many) else 2.0)


def bytes_of_run(layout: Layout, method: Method, samples: int, compared: bool) -> int:
    """Bytes of a scene, its loop, so many samples in all runs, all series, and comparing runs."""
    loop = GeneralLoop(layout, method, 1.0, layout.start, 0.0)
    found = _bytes_in(vars(loop), layout.asperites, layout.surfaces)
    times = layout.times.size
    series = assemble(layout, Samples.at_zero(layout))
    if is_streamed(layout, times):
        series = series.only(layout.scene.output.keep or ())
        found += PORTION_BYTES
        samples -= times
    found += times * _bytes_of_time(layout, series)
    found += max(0, samples) * _bytes_in(loop.room(1))
    if compared:
        found += min(PORTION, BYTES * max(times, PARTS + 1) * layout.scene.count)
    if "forces" in layout.scene.output.series:
        found += times * ROWS * layout.model.each[0].nbytes
    return found


def _bytes_of_time(layout: Layout, series: Ledger) -> int:
    """Bytes of all series at one time."""
    surfaces = layout.scene.surfaces
    of_asperites = sum(len(series.surfaces[each.name]) * each.count for each in surfaces)
    of_wholes = sum(len(series.blocks[each.name]) for each in surfaces)
    return 8 * (of_asperites + of_wholes + len(series.system))


def _bytes_in(*items: Any) -> int:
    """Bytes of all arrays in nested tuples and dictionaries, each array once."""
    return sum({id(array): array.nbytes for array in _arrays(items)}.values())


def _arrays(item: Any) -> Iterator[np.ndarray]:
    if isinstance(item, np.ndarray):
        yield item
    elif isinstance(item, (dict, tuple)):
        for part in item.values() if isinstance(item, dict) else item:
            yield from _arrays(part)
