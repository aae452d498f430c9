"""What a run will take: its evaluations, their time and its memory; what limits its steps.

With an accuracy, the search for settings begins as in a run of the scene, and ends after BUDGET
seconds by the model of costs, not by a clock.  It is then extrapolated: by the part of the duration
that its last run reached, and by the ratios of the levels of the runs that are left.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tribo.accuracy.choose_method import Choice
from tribo.accuracy.comparison import strictest
from tribo.accuracy.cost_model import counted, evaluation_time, rate_of, steps_towards
from tribo.accuracy.extremes import BYTES, PORTION
from tribo.accuracy.levels import fine_level
from tribo.accuracy.plan import make_plan
from tribo.accuracy.search import FIRST, FoundSettings
from tribo.accuracy.search_runs import COARSE_RUNS, PARTS, PILOT_LEVEL, StopTimes
from tribo.integrators.methods import Method
from tribo.kernels.probe import TABLES
from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.ledger.ledger import assemble
from tribo.ledger.samples import Samples
from tribo.ledger.sinks import PORTION_BYTES, StreamedLedger, is_streamed
from tribo.loops import resolution
from tribo.loops.general import GeneralLoop
from tribo.loops.integrate import MOST_PREDICTED, Integration, most_evaluations, reach_of
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting

# Time of all runs of a search, by the model of costs [s].
BUDGET = 1.0
# Time of the run that measures a speed with a given step, by the model of costs [s].
MEASURED = 0.05
# Samples times asperites whose recording is measured.
NUMBERS_RECORDED = 100_000
# The phase of the fastest motion in a step [rad] that is still well resolved.
RESOLVED = 0.1


@dataclass(frozen=True)
class Predicted:
    """Predicted cost of a run.

    Attributes
    ----------
    force_evaluations : int
        Evaluations of all forces, in the run and in those that estimate its error.
    seconds : float
        Time of these runs on this machine, without compiling [s]; with that of the series of
        samples that memory does not hold.
    memory_bytes : int
        Bytes of the arrays of the scene, of the loop, of all samples, and of all series.
    basis : str
        "counted" from a given step, "searched" by the runs that find the settings, or
        "extrapolated" from the first of these.
    met : bool or None
        Whether the run will meet its accuracy; None if the search is not complete, or with a step.
    stop : str
        Why the run will stop, and what would do; empty if it should not.
    status : str
        The status with which it will stop; "completed" if it should not.
    """

    force_evaluations: int
    seconds: float
    memory_bytes: int
    basis: str
    met: bool | None
    stop: str = ""
    status: str = str(Status.COMPLETED)


class OverBudgetError(Exception):
    """A run of the search would exceed the budget."""


class Search(Integrator):
    """Runs a scene in search for settings, until all runs together would exceed the budget.

    `evaluations` are those of all runs.  `runs` has, of each from the scene's own start, the times,
    the evaluations to the end at the mean rate, and those that are left.
    """

    def __init__(self, layout: Layout, method: Method, threads: int = 1) -> None:
        super().__init__(layout, method, threads=threads)
        self.evaluations = 0
        self.runs: list[tuple[np.ndarray, float, float]] = []
        self._budget = 1e9 * BUDGET / evaluation_time(layout, method)

    def __call__(
        self,
        setting: Setting,
        times: np.ndarray,
        start: np.ndarray | None = None,
        streamed: StreamedLedger | None = None,
        most: float | None = None,
        rounded: bool = False,
        resolved: bool = False,
    ) -> Integration:
        """Integrate through `times`.  Raises OverBudgetError or KeyboardInterrupt."""
        rest = self._budget - self.evaluations
        most = most or most_evaluations(self.layout.scene)
        if setting.step is not None:
            count = counted(self.layout, self.method, setting.step, times)
            if count > rest:
                self.runs.append((times, count, count))
                raise OverBudgetError
        run = super().__call__(setting, times, start, most=min(rest, most), rounded=rounded)
        if run.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        self.evaluations += run.evaluations
        if start is None:
            reached = float((run.samples.t[-1] - times[0]) / (times[-1] - times[0]))
            whole = run.evaluations / max(reached, np.finfo(float).eps)
            self.runs.append((times, whole, whole - run.evaluations))
        if run.status == Status.NO_PROGRESS and rest < most:
            raise OverBudgetError
        return run


def predict(choice: Choice, search: Search) -> tuple[Predicted, float | None]:
    """Predict the cost of a run, and its step where all steps are equal and known."""
    layout = search.layout
    method = search.method
    tuned = None
    step = choice.step
    began = time.perf_counter()
    try:
        plan = make_plan(choice, search)
        tuned = plan.tuned
        step = plan.setting.step or step
        basis = "searched"
        evaluations = float(search.evaluations)
        samples = sum(times.size for times, _, _ in search.runs)
    except OverBudgetError:
        basis = "extrapolated"
        evaluations = _extrapolated(choice, search)
        samples = 2 * sum(times.size for times in StopTimes.for_samples(layout.times))
    seconds = time.perf_counter() - began
    if search.evaluations:
        each = seconds / search.evaluations
    else:  # nothing is measured of a run that ends where it starts
        each = 0.0 if tuned is not None else _measured(search, step)
    if choice.step is not None:
        assert step is not None
        basis = "counted"
        samples = layout.times.size
        evaluations = counted(layout, method, step, layout.times)
    stop, status = _stop(search, tuned)
    recorded = 0.0
    if is_streamed(layout, layout.times.size):
        recorded = layout.times.size * _recording_time(layout, method)
    predicted = Predicted(
        force_evaluations=round(evaluations),
        seconds=each * evaluations + recorded,
        memory_bytes=bytes_of_run(layout, method, samples, choice.step is None),
        basis=basis,
        met=None if tuned is None else tuned.met,
        stop=stop,
        status=str(status),
    )
    return predicted, step


def _measured(search: Search, step: float | None) -> float:
    """Seconds of an evaluation in a short run with equal steps, after the first of them."""
    layout = search.layout
    first = search.first_step
    loop = GeneralLoop(
        layout, search.method, Setting(step=step or first), layout.start, 0.0, search.threads
    )
    columns = loop.room(layout.times.size + 1)
    evaluations = loop.clocks.evaluations
    loop.advance(layout.times, columns, 1)
    before = int(evaluations[0])
    began = time.perf_counter()
    steps = int(1e9 * MEASURED / evaluation_time(layout, search.method))
    loop.advance(layout.times, columns, max(1, steps))
    return (time.perf_counter() - began) / max(1, int(evaluations[0]) - before)


def _recording_time(layout: Layout, method: Method) -> float:
    """Seconds that a run takes for the series of each sample, where memory does not hold them all.

    Measured with some samples of the start, as their values do not matter.
    """
    size = min(layout.times.size, max(2, NUMBERS_RECORDED // layout.scene.count))
    start = Samples.at_zero(layout).rows(np.zeros(size, int))
    samples = replace(start, t=layout.times[:size])
    streamed = StreamedLedger(layout, guarded=not method.adaptive)
    streamed.add(samples.rows(slice(0, 2)), 0)  # finds what all portions share
    began = time.perf_counter()
    streamed.add(samples, 0)
    return (time.perf_counter() - began) / size


def _stop(search: Search, tuned: FoundSettings | None) -> tuple[str, Status]:
    """Why a run will stop, and what would do; empty if it should not.  Its status."""
    last = None if tuned is None else tuned.runs[-1]
    if last is not None and last.evaluations == 0:
        where = f"it ends where it starts, at t = {last.samples.t[0]:g}; change the start"
        return where, last.status
    scene = search.layout.scene
    whole = search.runs[-1][1] if search.runs else 0.0
    too_many = search.method.adaptive and whole > MOST_PREDICTED * most_evaluations(scene)
    if not too_many and (last is None or last.status != Status.NO_PROGRESS):
        return "", Status.COMPLETED
    reason = (
        f"{reach_of(scene, whole, search.layout.beginning)}; give a lower accuracy, a shorter "
        "duration, more max_evaluations, or a method and a step"
    )
    return reason, Status.NO_PROGRESS


def _extrapolated(choice: Choice, search: Search) -> float:
    """The evaluations of a search whose last run was not complete."""
    method = choice.method
    slope = rate_of(search.layout, method).slope
    times, last, left = search.runs[-1]
    stops = StopTimes.for_samples(search.layout.times)
    finer = fine_level(method) ** (-1.0 / slope)
    if method.adaptive and len(search.runs) == 1:  # the pilot
        assert choice.accuracy is not None
        level = min(FIRST * method.first_level * strictest(choice.accuracy), PILOT_LEVEL)
        coarse = last * (PILOT_LEVEL / level) ** (1.0 / slope)
        runs = COARSE_RUNS + finer
    elif np.array_equal(times, stops.fine):
        coarse = last / finer
        runs = COARSE_RUNS
    else:
        coarse = last
        runs = 1.0 if np.array_equal(times, stops.many) else 2.0
    return search.evaluations + left + runs * coarse


def bytes_of_run(layout: Layout, method: Method, samples: int, compared: bool) -> int:
    """Bytes of a scene, its loop, so many samples in all runs, all series, and comparing these."""
    loop = GeneralLoop(layout, method, Setting(step=1.0), layout.start, 0.0)
    times = layout.times.size
    found = loop.bytes
    series = assemble(layout, Samples.at_zero(layout))
    if is_streamed(layout, times):
        series = series.only(layout.scene.output.keep or ())
        found += PORTION_BYTES
        samples -= times
    numbers = sum(len(table) for table in (*series.blocks.values(), series.system))
    numbers += sum(len(series.surfaces[each.name]) * each.count for each in layout.scene.surfaces)
    found += 8 * times * numbers
    found += max(0, samples) * sum(column.nbytes for column in loop.room(1))
    if compared:
        found += min(PORTION, BYTES * max(times, PARTS + 1) * layout.scene.count)
    if "forces" in layout.scene.output.series:
        found += times * 2 * TABLES * layout.model.each[0].nbytes
    return found


# Each motion's frequency (of encounters the steps in a unit of time), and what would slow it.
MOTIONS: dict[str, tuple[Callable[[Layout], float], str]] = {
    "pendulums": (resolution.pendulum_frequency, "a smaller kappa or a larger inertia"),
    "bars on springs": (resolution.spring_frequency, "softer springs and drives, or heavier bars"),
    "bath oscillators": (resolution.bath_frequency, "a bath of lower frequencies, or langevin"),
    "bobs in a field": (resolution.corrugation_frequency, "a smaller amplitude or longer period"),
    "bobs in the minimum of a contact": (
        resolution.contact_frequency,
        "a potential that is less deep or longer in range, or a larger inertia",
    ),
    "bars under a plug-in's force": (resolution.user_frequency, "a force that varies less"),
    "encounters of bobs": (
        lambda layout: steps_towards(layout) / layout.run_time,
        "a larger gap, a smaller velocity, or a potential that is softer at short distances",
    ),
}


def slow_motion(layout: Layout, step: float | None) -> str:
    """The motion for which a run takes the shortest steps, and what would allow longer ones."""
    frequency, name = max((motion[0](layout), name) for name, motion in MOTIONS.items())
    if frequency == 0.0:
        return ""
    cure = f"{MOTIONS[name][1]} would allow longer steps"
    if step is not None and step * frequency < RESOLVED:
        cure = f"a step of {RESOLVED / frequency:.2g}, not {step:.2g}, resolves it"
    return (
        f"the fastest motion is that of {name}, at {frequency:.3g} rad per unit of time, for "
        f"{frequency * layout.scene.duration:.2g} rad in all; {cure}"
    )
