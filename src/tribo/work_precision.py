"""What accuracy costs on a scene: error against time and against evaluations, method by method.

Every method that takes the scene is run at one setting after another, from coarse to fine, and
compared with one reference, the finest run of a method that suits the scene.  A method's turn ends
when it has come as near to the reference as that is good for, when finer settings gain nothing, or
when its share of the time is used up.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.accuracy import scales as acc
from tribo.accuracy.estimate import check_observables, distance, excess_of_request, safety
from tribo.accuracy.plan import integrator_for
from tribo.accuracy.search import setting_at
from tribo.integrators import methods
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.plotting.style import INK, WIDE
from tribo.run.integrator import Integrator
from tribo.run.layout import lay_out
from tribo.run.ledger import Ledger, assemble
from tribo.simulation import prepare
from tribo.validation import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SMOOTH, ROUGH = "gauss-radau-15", "dop853"  # methods of the reference, by what the potentials are
FINEST = 1e-13  # accuracy asked of the reference
COARSEST = 0.3  # first level of the settings
LEVEL_RATIO = 10.0**0.5  # between two settings of a method that chooses its steps
STEP_RATIO = 2.0**0.5  # between two settings of one that does not
GAIN = 0.9  # of the best error: less gained than that, and a finer setting has gained nothing
MORE = 1.05  # times the evaluations of the run before: other settings are no other run
STALLED = 6  # settings that gain nothing, after which a method is done
REPEAT_BELOW = 0.02  # seconds: shorter runs are timed again, and the least counts
TIMES = 9  # at which errors are looked at, so that no step is cut short by samples
LOOKS = {  # colour and marker; families share a hue
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
FRONT = "#ffd92f"
WRONG = 3.0  # errors larger than that, of methods that are not stable yet, are not shown


@dataclass(frozen=True)
class Row:
    """One run of one method."""

    method: str
    setting: float  # tolerance level, or step
    error: float  # the largest of the observables', each in units of its scale
    force_evaluations: int
    seconds: float
    front: bool = False  # no run was both faster and better

    def as_json(self) -> dict[str, Any]:
        """The row as ``tribo accuracy --json`` prints it."""
        return dict(self.__dict__)


@dataclass(frozen=True)
class WorkPrecision:
    """All runs, and what they were compared with."""

    rows: tuple[Row, ...]
    reference: dict[str, Any]  # method, estimate of its own error, seconds
    compile_seconds: dict[str, float]  # by method, apart from the runs

    def to_json(self) -> str:
        """As ``tribo accuracy --json`` prints it."""
        return json.dumps(
            {
                "rows": [row.as_json() for row in self.rows],
                "reference": self.reference,
                "compile_seconds": self.compile_seconds,
            },
            indent=1,
        )

    def best(self, error: float) -> Row | None:
        """The fastest run of those that are at least that good."""
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
        reference = self.reference
        lines.append(
            f"errors against {reference['method']}, itself good to {reference['error']:.1e}; "
            f"compiling took {sum(self.compile_seconds.values()):.1f} s"
        )
        return "\n".join(lines)

    def save_figure(self, path: str | Path) -> Path:
        """Draw error against time and against evaluations into a file; returns its path."""
        from tribo import plotting

        with plotting.style():
            return plotting.save(_figure(self), path)


def work_precision(
    scene: Scene,
    names: Iterable[str] | None = None,
    observables: Iterable[str] = (),
    seconds: float = 30.0,
    progress: Callable[[str], None] | None = None,
) -> WorkPrecision:
    """Measure error against cost for every method, or for those named.

    `observables` are names as "w1" or "upper.W"; without any, errors are the largest over all
    reported quantities.  `seconds` is about how long all runs together may take, compiling apart.
    `progress` is told each method's name as its turn comes.  Raises InputError.
    """
    scene = replace(scene, output=Output(times=tuple(np.linspace(0.0, scene.duration, TIMES))))
    wanted = [methods.named(name) for name in names] if names else list(methods.METHODS.values())
    taken = [method for method in wanted if not methods.refusal(method, scene)]
    if methods.noisy(scene):
        raise InputError("scene", "has a reservoir that makes noise: no digit is the same twice")
    if not taken:
        raise InputError("methods", f"none of {[m.name for m in wanted]} takes this scene")
    watched = tuple(observables)
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
        rows += _curve(integrator, truth, scales, watched, reference["error"], share)
    return WorkPrecision(tuple(with_front(rows, reference["error"])), reference, compiled)


def _reference(
    scene: Scene, watched: tuple[str, ...]
) -> tuple[Ledger, acc.ToleranceScales, dict[str, Any]]:
    """The finest run, the scales it had, and how good it is by its own estimate."""
    rough = np.isfinite(scene.smoothness)
    name = ROUGH if rough else SMOOTH  # whose polynomial does not span the joints of a switch
    simulation = prepare(scene, FINEST, name)
    check_observables(simulation.layout, watched, "observables")
    result, finest = simulation.compute_first(), simulation.finest
    if result.status != "completed":
        raise InputError("scene", f"does not run to its end: {result.status}")
    scales = acc.reported_scales(simulation.layout, result.ledger)
    bounds = {k: v for k, v in result.error_estimate.items() if v is not None}
    error = excess_of_request(bounds, scales, 1.0) / safety(rough)
    inner = acc.tolerance_scales(simulation.layout, finest.samples)
    return result.ledger, inner, {"method": name, "error": error, "seconds": finest.seconds}


def _curve(
    integrator: Integrator,
    truth: Ledger,
    inner: acc.ToleranceScales,
    watched: tuple[str, ...],
    floor: float,
    seconds: float,
) -> Iterator[Row]:
    """Runs of one method, coarse to fine."""
    began = time.perf_counter()
    layout, method = integrator.layout, integrator.method
    times, scales = layout.scene.times, acc.reported_scales(layout, truth)
    ratio = LEVEL_RATIO if method.adaptive else STEP_RATIO**method.order
    level = COARSEST
    best, most = np.inf, 0
    stalled = 0
    while stalled < STALLED and best > floor and time.perf_counter() - began < seconds:
        setting = setting_at(layout, method, inner, level)
        run = integrator(setting, times)
        if run.status == "completed" and run.evaluations > most:
            taken = run.seconds
            if taken < REPEAT_BELOW:
                taken = min(taken, *(integrator(setting, times).seconds for _ in range(2)))
            error = distance(assemble(layout, run.samples), truth, scales, watched)
            shown = setting if isinstance(setting, float) else level
            yield Row(method.name, shown, error, run.evaluations, taken)
            stalled = 0 if error < GAIN * best else stalled + 1
            best, most = min(best, error), int(MORE * run.evaluations)
        level /= ratio
        if level < acc.FLOOR**2:
            return


def with_front(rows: list[Row], floor: float) -> Iterator[Row]:
    """The rows, those marked as the front that none other is at least as fast and as good as.

    Errors below `floor`, the reference's own, cannot be told apart.
    """
    told = [max(row.error, floor) for row in rows]
    for row, error in zip(rows, told, strict=True):
        beaten = any(
            (other.seconds, mine) != (row.seconds, error)
            and other.seconds <= row.seconds
            and mine <= error
            for other, mine in zip(rows, told, strict=True)
        )
        yield replace(row, front=not beaten)


def _figure(found: WorkPrecision) -> Figure:
    """Both diagrams side by side, with one legend."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(1.35 * WIDE, 0.62 * WIDE), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    _panel(left, found, "seconds", "time [s]", front=True)
    _panel(right, found, "force_evaluations", "evaluations of all forces", front=False)
    left.set_ylim(top=min(left.get_ylim()[1], WRONG))
    left.set_ylabel("largest error, in units of its scale")
    handles, labels = right.get_legend_handles_labels()
    front, names = left.get_legend_handles_labels()
    style: Any = {"loc": "outside right", "fontsize": 7.5, "frameon": False}
    figure.legend(handles=[*handles, front[0]], labels=[*labels, names[0]], **style)
    return figure


def _panel(ax: Axes, found: WorkPrecision, cost: str, label: str, front: bool) -> None:
    """Error against one cost."""
    if front:
        best = sorted((row for row in found.rows if row.front), key=lambda row: row.seconds)
        style: Any = {"color": FRONT, "linewidth": 5.0, "solid_capstyle": "round", "zorder": 0.5}
        ax.plot([row.seconds for row in best], [row.error for row in best], label="front", **style)
    for name in dict.fromkeys(row.method for row in found.rows):
        rows = [row for row in found.rows if row.method == name]
        colour, marker = LOOKS.get(name, (INK, "x"))
        ax.plot(
            [getattr(row, cost) for row in rows],
            [_shown(row, found) for row in rows],
            color=colour,
            marker=marker,
            markersize=2.6,
            linewidth=0.8,
            label=name,
        )
    ax.axhline(found.reference["error"], color="0.5", linewidth=0.6, linestyle=(0, (4, 2)))
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel(label)


def _shown(row: Row, found: WorkPrecision) -> float:
    """An error, no smaller than what the reference can tell."""
    return max(row.error, 0.1 * float(found.reference["error"]), 1e-17)
