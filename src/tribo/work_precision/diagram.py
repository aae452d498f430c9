"""The runs of several methods on a scene: a table, what an accuracy costs, and a figure."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from tribo import plotting
from tribo.integrators import methods
from tribo.kernels.status import Status
from tribo.plotting.style import INK, PAGE, WIDE, drawing_on

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Errors for which the cheapest run is named, in units of the scales.
GOALS = (1e-3, 1e-6, 1e-9, 1e-12)
# The cost on the horizontal axis of a diagram.
CostName = Literal["seconds", "force_evaluations"]
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
# Label of the axis of each cost.
COSTS = {"seconds": "time (s)", "force_evaluations": "evaluations of all forces"}


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
class Cheapest:
    """The cheapest run for an error, and what one digit more costs.

    Attributes
    ----------
    goal : float
        The largest error wanted, in units of the scales.
    row : Row or None
        The fastest run with at most that error; None if there is none.
    digit_more : float or None
        Evaluations by the same method for a tenth of the error, in units of those of `row`; None if
        it had no such run.
    automatic : str or None
        The method that tribo chooses for this accuracy; None if that is not known.
    automatic_row : Row or None
        The fastest run with at most that error by this method.
    """

    goal: float
    row: Row | None
    digit_more: float | None
    automatic: str | None
    automatic_row: Row | None

    def as_json(self) -> dict[str, object]:
        """An item of ``cheapest`` in the output of ``tribo accuracy --json``."""
        keys = ("method", "setting", "force_evaluations", "seconds")
        chosen = self.automatic_row
        return {
            "error": self.goal,
            **{key: getattr(self.row, key, None) for key in keys},
            "digit_more": self.digit_more,
            "automatic_method": self.automatic,
            "automatic_seconds": None if chosen is None else chosen.seconds,
        }

    def __str__(self) -> str:
        """The cheapest setting for an error, the cost of one digit more, and tribo's choice."""
        row = self.row
        chosen = self.automatic_row
        choice = ""
        if row is None:
            return f"error {self.goal:.0e}: no run reached it"
        kind = "tolerance" if methods.METHODS[row.method].adaptive else "step"
        digit = "was not reached"
        if self.digit_more is not None:
            free = self.digit_more == 1.0
            digit = "is free" if free else f"takes {self.digit_more:.2f} times as many"
        if self.automatic == row.method:
            choice = "; tribo chooses it too"
        elif self.automatic is not None:
            seconds = "" if chosen is None else f", {chosen.seconds:.2g} s"
            choice = f"; tribo chooses {self.automatic}{seconds}"
        return (
            f"error {self.goal:.0e}: {row.method} with {kind} {row.setting:.2g} is the cheapest, "
            f"{row.force_evaluations} evaluations, {row.seconds:.2g} s; one digit more {digit}"
            f"{choice}"
        )


def with_front(rows: list[Row], floor: float) -> Iterator[Row]:
    """The rows, with those marked that no other is at least as fast and as accurate as.

    Errors below `floor`, the reference's own, count as equal.
    """
    places = [(row.seconds, max(row.error, floor)) for row in rows]
    for row, own in zip(rows, places, strict=True):
        beating = (p for p in places if p != own and p[0] <= own[0] and p[1] <= own[1])
        yield replace(row, front=not any(beating))


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
    automatic : mapping
        Accuracy -> the method that tribo chooses for it.
    status : Status
        "completed", or "Interrupted" where an interrupt left out runs.
    """

    rows: tuple[Row, ...]
    reference: Reference
    compile_seconds: dict[str, float]
    automatic: Mapping[float, str] = field(default_factory=dict)
    status: Status = Status.COMPLETED

    def to_json(self) -> str:
        """All runs as one JSON object, as ``tribo accuracy --json`` prints them."""
        table = {
            "rows": [asdict(row) for row in self.rows],
            "reference": asdict(self.reference),
            "compile_seconds": self.compile_seconds,
            "cheapest": [self.cheapest(goal).as_json() for goal in GOALS],
            "status": self.status,
        }
        return json.dumps(table, indent=1)

    def cheapest(self, goal: float) -> Cheapest:
        """The cheapest run for an error, relative to the scales, and what one digit more costs."""
        row = self.best(goal)
        digit_more = None
        if row is not None:
            finer = self.best(0.1 * goal, row.method)
            if finer is not None:
                digit_more = max(1.0, finer.force_evaluations / row.force_evaluations)
        chosen = self.automatic.get(goal)
        of_chosen = None if chosen is None else self.best(goal, chosen)
        return Cheapest(goal, row, digit_more, chosen, of_chosen)

    @property
    def automatic_rows(self) -> list[Row]:
        """For each goal, the fastest run that reached it by the method that tribo chooses."""
        rows = [self.cheapest(goal).automatic_row for goal in GOALS]
        return [row for row in dict.fromkeys(rows) if row is not None]

    def best(self, error: float, method: str | None = None) -> Row | None:
        """The fastest run with at most that error [scales], by one method if named; else None."""
        good = [row for row in self.rows if row.error <= error and method in (None, row.method)]
        return min(good, key=lambda row: row.seconds, default=None)

    def __str__(self) -> str:
        """A table of all runs, and the cheapest of them for each goal."""
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
        lines += [str(self.cheapest(goal)) for goal in GOALS]
        if self.status != Status.COMPLETED:
            lines.append(f"{self.status}: the runs up to there")
        return "\n".join(lines)

    def plot(self, cost: CostName = "seconds", ax: Axes | None = None) -> Axes:
        """Draw error against cost, on new axes if none are given."""
        with drawing_on(ax, WIDE, 0.7 * WIDE) as ax:
            if cost == "seconds":
                front = sorted((row for row in self.rows if row.front), key=lambda row: row.seconds)
                style: Any = {"linewidth": 5.0, "solid_capstyle": "round", "zorder": 0.5}
                places = [row.seconds for row in front], [row.error for row in front]
                ax.plot(*places, color="#ffd92f", label="front", **style)
            for name in dict.fromkeys(row.method for row in self.rows):
                own = [row for row in self.rows if row.method == name]
                colour, marker = STYLES.get(name, (INK, "x"))
                style = {"color": colour, "marker": marker, "markersize": 2.6, "linewidth": 0.8}
                ax.plot(*self._places(own, cost), label=name, **style)
            if self.automatic_rows:
                style = {"marker": "o", "markersize": 7.5, "fillstyle": "none", "color": INK}
                style |= {"markeredgewidth": 0.8, "linestyle": "none", "label": "automatic choice"}
                ax.plot(*self._places(self.automatic_rows, cost), **style)
            style = {"color": "0.5", "linewidth": 0.6, "linestyle": (0, (4, 2))}
            ax.axhline(self.reference.error, label="error of reference", **style)
            ax.set(xscale="log", yscale="log", xlabel=COSTS[cost])
            # Larger errors are of methods that are unstable at such steps.
            ax.set_ylim(top=min(ax.get_ylim()[1], 3.0))
            ax.set_ylabel("largest error, in units of its scale")
        return ax

    def _places(self, rows: list[Row], cost: str) -> tuple[list[float], list[float]]:
        """Costs and errors; none far below that of the reference, where it means nothing."""
        least = max(0.1 * self.reference.error, 1e-17)
        return [getattr(row, cost) for row in rows], [max(row.error, least) for row in rows]

    def save_figure(self, path: str | Path) -> Path:
        """Draw error against time and against evaluations into a .png, .pdf or .svg file."""
        from matplotlib.figure import Figure

        with plotting.style():
            figure = Figure(figsize=(PAGE, 0.5 * PAGE), layout="constrained")
            left, right = figure.subplots(1, 2, sharey=True)
            self.plot("seconds", left)
            self.plot("force_evaluations", right).set_ylabel("")
            front, *handles = left.get_legend_handles_labels()[0]
            place: Any = {"loc": "outside right"}  # unknown to the types of matplotlib
            figure.legend(handles=[*handles, front], **place)
            return plotting.save(figure, path)
