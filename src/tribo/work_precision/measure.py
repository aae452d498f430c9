"""Runs of every method on a scene, with their errors against a reference.

Every method that takes the scene is run at one setting after another, from coarse to fine, and
compared with a reference, the finest run of a method that suits the scene.  The runs of a method
end when their error reaches that of the reference, when finer settings gain nothing, or when the
method's share of the time is used up.
"""

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

from tribo import interrupts
from tribo.accuracy.choose_method import choose
from tribo.accuracy.comparison import check_observables, distance, excess_of_request, safety
from tribo.accuracy.levels import FLOOR, ToleranceScales, setting_at, tolerance_scales
from tribo.accuracy.scales import reported_scales
from tribo.integrators import methods
from tribo.kernels.status import Status
from tribo.layout.layout import lay_out
from tribo.ledger.ledger import Ledger, assemble
from tribo.loops.select import Integrator
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.simulation import prepare
from tribo.validation import POSITIVE, InputError, number
from tribo.work_precision.diagram import GOALS, Reference, Row, WorkPrecision, with_front

# Methods of the reference, of which the first that can integrate the scene is taken: for smooth
# forces, and for forces whose derivatives jump, which no polynomial of gauss-radau-15 fits.
FOR_SMOOTH = ("gauss-radau-15",)
FOR_ROUGH = ("rkn8", "dop853")
# Accuracy of the reference, the smallest that can be asked for.
FINEST = 1e-13
# Ratio of two levels of a method that chooses its steps: half a digit.
LEVEL_RATIO = 10.0**0.5
# Ratio of two steps of a method with equal steps.
STEP_RATIO = 2.0**0.5
# A finer setting gains something if its error is below this times the best so far.
GAIN = 0.9
# A finer setting makes another run if it takes more than this times the evaluations of the last.
MORE = 1.05
# Settings in a row that gain nothing, after which a method ends.
STALLED = 6
# Recorded times, at which errors are compared: so few that samples shorten few steps.
TIMES = 9


def work_precision(
    scene: Scene,
    names: Iterable[str] | None = None,
    observables: Iterable[str] = (),
    seconds: float = 30.0,
    progress: Callable[[str], None] | None = None,
    report: Callable[[WorkPrecision], None] | None = None,
) -> WorkPrecision:
    """Measure error against cost for several methods.

    Parameters
    ----------
    scene : Scene
        The scene to run.
    names : iterable of str, optional
        Names of methods; all without it.  Methods that cannot integrate the scene are left out.
    observables : iterable of str
        Names as "w1" or "upper.W", whose largest error counts; all reported quantities without any.
    seconds : float
        About the time that all runs may take together, compilation and reference not included.
    progress : callable, optional
        Called with the name of each method before its runs.
    report : callable, optional
        Called with all runs so far, before each method is compiled.

    Raises
    ------
    InputError
        The scene has thermal noise or stops early, or a name cannot be used.
    KeyboardInterrupt
        The attribute ``result`` has the WorkPrecision of the runs that ended before, if any did.
    """
    scene = replace(scene, output=Output(times=tuple(np.linspace(0.0, scene.duration, TIMES))))
    named = [methods.named(name) for name in names] if names else list(methods.METHODS.values())
    taken = [method for method in named if not methods.refusal(method, scene)]
    if scene.is_noisy:
        raise InputError("scene", "has thermal noise, with which no two runs agree; measure means")
    if not taken:
        raise InputError("methods", f"must integrate this scene, got {[m.name for m in named]}")
    watched = tuple(observables)
    seconds = number("seconds", seconds, POSITIVE, "s")
    layout = lay_out(scene)
    check_observables(layout, watched, "observables")
    if progress:
        progress("reference")
    truth, scales, reference = _reference(scene, watched)
    automatic = {goal: choose(layout, goal, None, None).method.name for goal in GOALS}
    compiling: dict[str, float] = {}
    rows: list[Row] = []

    def so_far(status: Status = Status.INTERRUPTED) -> WorkPrecision:
        marked = tuple(with_front(rows, reference.error))
        return WorkPrecision(marked, reference, compiling, automatic, status)

    try:
        for method in taken:
            if report:
                report(so_far())
            if progress:
                progress(method.name)
            integrator = Integrator(lay_out(scene), method)
            compiling[method.name] = integrator.compile_seconds
            share = seconds / len(taken)
            for row in _curve(integrator, truth, scales, watched, reference.error, share):
                rows.append(row)  # each before an interrupt can end the next
    except KeyboardInterrupt:
        interrupts.answer()
        if not rows:
            raise
        raise interrupts.Interrupted(so_far()) from None
    return so_far(Status.COMPLETED)


def _reference(scene: Scene, watched: tuple[str, ...]) -> tuple[Ledger, ToleranceScales, Reference]:
    """The ledger of the finest run, the scales it had, and an estimate of its error."""
    rough = bool(np.isfinite(scene.smoothness))
    candidates = FOR_ROUGH if rough else FOR_SMOOTH
    name = next(n for n in candidates if not methods.refusal(methods.named(n), scene))
    simulation = prepare(scene, FINEST, name, progress=False)
    result = simulation.compute_first()
    finest = simulation.finest
    if result.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    if result.status != Status.COMPLETED:
        raise InputError("scene", f"must run to its end, but ends by {result.status}")
    scales = reported_scales(simulation.layout, result.ledger)
    bounds = {k: v for k, v in result.error_estimate.items() if v is not None}
    error = excess_of_request(bounds, scales, 1.0) / safety(rough)
    measured = tolerance_scales(simulation.layout, finest.samples)
    return result.ledger, measured, Reference(name, error, finest.seconds)


def _curve(
    integrator: Integrator,
    truth: Ledger,
    tolerance_scales: ToleranceScales,
    watched: tuple[str, ...],
    floor: float,
    seconds: float,
) -> Iterator[Row]:
    """Runs of one method, from coarse to fine, for about `seconds`."""
    began = time.perf_counter()
    layout = integrator.layout
    method = integrator.method
    times = layout.scene.times
    scales = reported_scales(layout, truth)
    ratio = LEVEL_RATIO if method.adaptive else STEP_RATIO**method.order
    level = 0.3  # the coarsest
    best = np.inf
    most = 0
    stalled = 0
    while stalled < STALLED and best > floor and time.perf_counter() - began < seconds:
        setting = setting_at(layout, method, tolerance_scales, level)
        run = integrator(setting, times)
        if run.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        if run.status == Status.COMPLETED and run.evaluations > most:
            taken = run.seconds
            if taken < 0.02:  # s: short runs are timed three times, and the shortest time counts
                taken = min(taken, *(integrator(setting, times).seconds for _ in range(2)))
            error = distance(assemble(layout, run.samples), truth, scales, watched)
            shown = level if setting.step is None else setting.step
            yield Row(method.name, shown, error, run.evaluations, taken)
            stalled = 0 if error < GAIN * best else stalled + 1
            best = min(best, error)
            most = int(MORE * run.evaluations)
        level /= ratio
        if level < FLOOR**2:
            return
