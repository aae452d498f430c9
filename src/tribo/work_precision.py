"""Work-precision diagrams: the error of every method on a scene against its cost.

Every method that takes the scene is run at one setting after another, from coarse to fine, and
compared with a reference, the finest run of a method that suits the scene.  The runs of a method
end when their error reaches that of the reference, when finer settings gain nothing, or when the
method's share of the time is used up.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from tribo.accuracy.estimate import check_observables, distance, excess_of_request, safety
from tribo.accuracy.levels import setting_at
from tribo.accuracy.plan import integrator_for
from tribo.accuracy.scales import FLOOR, ToleranceScales, reported_scales, tolerance_scales
from tribo.integrators import methods
from tribo.kernels.status import Status
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.plotting.style import INK, WIDE
from tribo.run.layout import lay_out
from tribo.run.ledger import Ledger, assemble
from tribo.run.loop_selection import Integrator
from tribo.simulation import prepare
from tribo.validation import POSITIVE, InputError, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Methods of the reference, the first that can integrate the scene.  The polynomial of
# gauss-radau-15 does not fit forces whose derivatives jump.
FOR_SMOOTH, FOR_ROUGH = ("gauss-radau-15",), ("rkn8", "dop853")
# Accuracy of the reference, the smallest that can be asked for.
FINEST = 1e-13
# First level of the settings.
COARSEST = 0.3
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
# Runs shorter than this [s] are timed three times, and the shortest time counts.
REPEAT_BELOW = 0.02
# Recorded times, at which errors are compared: so few that samples shorten few steps.
TIMES = 9
# Colour and marker of each method; families share a hue.
STYLES = {
    "midpoint": ("#a6a6a6", "o"),
    "rk4": ("#6e6e6e", "s"),
    "dop853": (INK, "D"),
    "rkn8": ("#6baed6", "o"),
    "rkn12": ("#08519c", "s"),
    "gauss-radau-15": ("#7d2f86", "^"),
    "gauss-8": ("#c994c7", "v"),
    "verlet": ("#fdae6b", "o"),
    "kahan-li-6": ("#e6550d", "s"),
    "kahan-li-8": ("#a63603", "D"),
    "blanes-moan-6": ("#2fae8c", "^"),
}
# Colour of the line along the front.
FRONT_COLOUR = "#ffd92f"
# Largest error shown; larger ones are of methods that are unstable at such steps.
LARGEST_ERROR = 3.0
# Label of the axis of each cost.
COSTS = {"seconds": "time [s]", "force_evaluations": "evaluations of all forces"}

# The cost on the horizontal axis of a diagram.
CostName = Literal["seconds", "force_evaluations"]


@dataclass(frozen=True)
class Row:
    """One run of one method.

    Attributes
    ----------
    method : str
        The method's name.
    setting : float
        The level of its tolerances, or its step [time].
    error : float
        The largest error of all observables, in units of their scales.
    force_evaluations : int
        Evaluations of all forces.
    seconds : float
        Time of the run.
    front : bool
        Whether no other run is both faster and more accurate.
    """

    method: str
    setting: float
    error: float
    force_evaluations: int
    seconds: float
    front: bool = False


@dataclass(frozen=True)
class Reference:
    """The run that others are compared with.

    Attributes
    ----------
    method : str
        The method's name.
    error : float
        An estimate of its own error, in units of the scales.
    seconds : float
        Time of the run.
    """

    method: str
    error: float
    seconds: float


@dataclass(frozen=True)
class WorkPrecision:
    """Runs of several methods, and their errors; ``print`` shows a table.

    Attributes
    ----------
    rows : tuple of Row
        All runs, method by method, from coarse to fine.
    reference : Reference
        The run that they are compared with.
    compile_seconds : dict
        Method -> time to compile it, which is not in the time of its runs.
    """

    rows: tuple[Row, ...]
    reference: Reference
    compile_seconds: dict[str, float]

    def to_json(self) -> str:
        """JSON as ``tribo accuracy --json`` prints it."""
        return json.dumps(asdict(self), indent=1)

    def best(self, error: float) -> Row | None:
        """The fastest run with at most that error, in units of the scales; None if there is none.

        Parameters
        ----------
        error : float
            Relative to the scales.

        Returns
        -------
        Row or None
        """
        good = [row for row in self.rows if row.error <= error]
        return min(good, key=lambda row: row.seconds, default=None)

    def __str__(self) -> str:
        lines = [
            f"{'method':>15} {'setting':>9} {'error':>9} {'evaluations':>12} "
            f"{'seconds':>10}   front"
        ]
        for row in self.rows:
            lines.append(
                f"{row.method:>15} {row.setting:9.2e} {row.error:9.1e} "
                f"{row.force_evaluations:12d} {row.seconds:10.2e}   {'*' if row.front else ''}"
            )
        lines.append(
            f"errors are against {self.reference.method}, whose own error is about "
            f"{self.reference.error:.1e}; compiling took {sum(self.compile_seconds.values()):.1f} s"
        )
        return "\n".join(lines)

    def plot(self, cost: CostName = "seconds", ax: Axes | None = None) -> Axes:
        """Draw error against cost.

        Parameters
        ----------
        cost : {"seconds", "force_evaluations"}
            The horizontal axis.
        ax : matplotlib.axes.Axes, optional
            Where to draw; a new figure without it.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from tribo import plotting

        if ax is None:
            with plotting.style():
                return self.plot(cost, plotting.axes(WIDE, 0.7 * WIDE))
        if cost == "seconds":
            _draw_front(ax, self)
        for name in dict.fromkeys(row.method for row in self.rows):
            rows = [row for row in self.rows if row.method == name]
            colour, marker = STYLES.get(name, (INK, "x"))
            style: Any = {"color": colour, "marker": marker, "markersize": 2.6, "linewidth": 0.8}
            errors = [_shown_error(row, self.reference) for row in rows]
            ax.plot([getattr(row, cost) for row in rows], errors, label=name, **style)
        ax.axhline(self.reference.error, color="0.5", linewidth=0.6, linestyle=(0, (4, 2)))
        ax.set(xscale="log", yscale="log", xlabel=COSTS[cost])
        ax.set_ylim(top=min(ax.get_ylim()[1], LARGEST_ERROR))
        ax.set_ylabel("largest error, in units of its scale")
        return ax

    def save_figure(self, path: str | Path) -> Path:
        """Draw error against time and against evaluations.

        Parameters
        ----------
        path : str or Path
            A .png, .pdf or .svg file.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        from tribo import plotting

        with plotting.style():
            return plotting.save(_figure(self), path)


def _draw_front(ax: Axes, found: WorkPrecision) -> None:
    """Draw a line along the runs of the front."""
    front = sorted((row for row in found.rows if row.front), key=lambda row: row.seconds)
    style: Any = {"linewidth": 5.0, "solid_capstyle": "round", "zorder": 0.5, "label": "front"}
    ax.plot(
        [row.seconds for row in front], [row.error for row in front], color=FRONT_COLOUR, **style
    )


def _figure(found: WorkPrecision) -> Figure:
    """Both diagrams side by side, with one legend."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(1.35 * WIDE, 0.62 * WIDE), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    found.plot("seconds", left)
    found.plot("force_evaluations", right).set_ylabel("")
    front, *handles = left.get_legend_handles_labels()[0]
    style: Any = {"loc": "outside right", "fontsize": 7.5, "frameon": False}
    figure.legend(handles=[*handles, front], **style)
    return figure


def _shown_error(row: Row, reference: Reference) -> float:
    """An error, but not far below that of the reference, where it means nothing."""
    return max(row.error, 0.1 * reference.error, 1e-17)


def work_precision(
    scene: Scene,
    names: Iterable[str] | None = None,
    observables: Iterable[str] = (),
    seconds: float = 30.0,
    progress: Callable[[str], None] | None = None,
) -> WorkPrecision:
    """Measure error against cost for several methods.

    Parameters
    ----------
    scene : Scene
        What is run.
    names : iterable of str, optional
        Names of methods; all without it.  Methods that cannot integrate the scene are left out.
    observables : iterable of str
        Names as "w1" or "upper.W", whose largest error counts; all reported quantities without any.
    seconds : float
        About the time that all runs may take together, compilation and reference not included.
    progress : callable, optional
        Called with the name of each method before its runs.

    Returns
    -------
    WorkPrecision

    Raises
    ------
    InputError
        The scene has thermal noise or stops early, or a name cannot be used.
    """
    scene = replace(scene, output=Output(times=tuple(np.linspace(0.0, scene.duration, TIMES))))
    named = [methods.named(name) for name in names] if names else list(methods.METHODS.values())
    taken = [method for method in named if not methods.refusal(method, scene)]
    if methods.noisy(scene):
        raise InputError("scene", "must have no thermal noise, with which no two runs agree")
    if not taken:
        raise InputError("methods", f"must integrate this scene, got {[m.name for m in named]}")
    watched, seconds = tuple(observables), number("seconds", seconds, POSITIVE, "s")
    check_observables(lay_out(scene), watched, "observables")
    if progress:
        progress("reference")
    truth, scales, reference = _reference(scene, watched)
    rows: list[Row] = []
    compiled = {}
    for method in taken:
        if progress:
            progress(method.name)
        integrator = integrator_for(lay_out(scene), method)
        compiled[method.name] = integrator.compile_seconds
        share = seconds / len(taken)
        rows += _curve(integrator, truth, scales, watched, reference.error, share)
    return WorkPrecision(tuple(with_front(rows, reference.error)), reference, compiled)


def _reference(scene: Scene, watched: tuple[str, ...]) -> tuple[Ledger, ToleranceScales, Reference]:
    """The ledger of the finest run, the scales it had, and an estimate of its error."""
    rough = bool(np.isfinite(scene.smoothness))
    candidates = FOR_ROUGH if rough else FOR_SMOOTH
    name = next(n for n in candidates if not methods.refusal(methods.named(n), scene))
    simulation = prepare(scene, FINEST, name)
    result, finest = simulation.compute_first(), simulation.finest
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
    layout, method = integrator.layout, integrator.method
    times, scales = layout.scene.times, reported_scales(layout, truth)
    ratio = LEVEL_RATIO if method.adaptive else STEP_RATIO**method.order
    level = COARSEST
    best, most = np.inf, 0
    stalled = 0
    while stalled < STALLED and best > floor and time.perf_counter() - began < seconds:
        setting = setting_at(layout, method, tolerance_scales, level)
        run = integrator(setting, times)
        if run.status == Status.COMPLETED and run.evaluations > most:
            taken = run.seconds
            if taken < REPEAT_BELOW:
                taken = min(taken, *(integrator(setting, times).seconds for _ in range(2)))
            error = distance(assemble(layout, run.samples), truth, scales, watched)
            shown = setting if isinstance(setting, float) else level
            yield Row(method.name, shown, error, run.evaluations, taken)
            stalled = 0 if error < GAIN * best else stalled + 1
            best, most = min(best, error), int(MORE * run.evaluations)
        level /= ratio
        if level < FLOOR**2:
            return


def with_front(rows: list[Row], floor: float) -> Iterator[Row]:
    """The rows, with those marked that no other is at least as fast and as accurate as.

    Errors below `floor`, the reference's own, count as equal.
    """
    errors = [max(row.error, floor) for row in rows]
    for row, error in zip(rows, errors, strict=True):
        beaten = any(
            (other.seconds, theirs) != (row.seconds, error)
            and other.seconds <= row.seconds
            and theirs <= error
            for other, theirs in zip(rows, errors, strict=True)
        )
        yield replace(row, front=not beaten)
