"""Error against time and against evaluations, one curve a method, the Pareto front marked."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo import plotting
from tribo.plotting.style import INK, WIDE
from tribo.work_precision import Row, WorkPrecision

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

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


def save(found: WorkPrecision, path: Any) -> Path:
    """Draw the figure into a file whose name ends on .png, .pdf or .svg; returns its path."""
    with plotting.style():
        return plotting.write(draw(found), path)


def draw(found: WorkPrecision) -> Figure:
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
