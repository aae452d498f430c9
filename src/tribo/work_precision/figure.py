"""The figure of a work-precision diagram: error against time and against evaluations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo import plotting
from tribo.plotting.style import INK, WIDE
from tribo.work_precision.rows import Reference, Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
# Diameter of the rings round the runs of the methods that tribo chooses [points].
RING = 7.5
# Largest error shown; larger ones are of methods that are unstable at such steps.
LARGEST_ERROR = 3.0
# Label of the axis of each cost.
COSTS = {"seconds": "time [s]", "force_evaluations": "evaluations of all forces"}


def draw(
    rows: Sequence[Row], reference: Reference, chosen: Sequence[Row], cost: str, ax: Axes | None
) -> Axes:
    """Draw error against a cost, on new axes if none are given."""
    if ax is None:
        with plotting.style():
            return draw(rows, reference, chosen, cost, plotting.axes(WIDE, 0.7 * WIDE))
    if cost == "seconds":
        _draw_front(ax, rows)
    for name in dict.fromkeys(row.method for row in rows):
        own = [row for row in rows if row.method == name]
        colour, marker = STYLES.get(name, (INK, "x"))
        style: Any = {"color": colour, "marker": marker, "markersize": 2.6, "linewidth": 0.8}
        errors = [_shown_error(row, reference) for row in own]
        ax.plot([getattr(row, cost) for row in own], errors, label=name, **style)
    _draw_choices(ax, chosen, reference, cost)
    ax.axhline(reference.error, color="0.5", linewidth=0.6, linestyle=(0, (4, 2)))
    ax.set(xscale="log", yscale="log", xlabel=COSTS[cost])
    ax.set_ylim(top=min(ax.get_ylim()[1], LARGEST_ERROR))
    ax.set_ylabel("largest error, in units of its scale")
    return ax


def save(
    rows: Sequence[Row], reference: Reference, chosen: Sequence[Row], path: str | Path
) -> Path:
    """Draw both diagrams into a file, side by side, with one legend."""
    from matplotlib.figure import Figure

    with plotting.style():
        figure = Figure(figsize=(1.35 * WIDE, 0.62 * WIDE), layout="constrained")
        left, right = figure.subplots(1, 2, sharey=True)
        draw(rows, reference, chosen, "seconds", left)
        draw(rows, reference, chosen, "force_evaluations", right).set_ylabel("")
        front, *handles = left.get_legend_handles_labels()[0]
        style: Any = {"loc": "outside right", "fontsize": 7.5, "frameon": False}
        figure.legend(handles=[*handles, front], **style)
        return plotting.save(figure, path)


def _draw_choices(ax: Axes, chosen: Sequence[Row], reference: Reference, cost: str) -> None:
    """Draw rings round the fastest runs, for each goal, of the method that tribo chooses."""
    if chosen:
        style: Any = {"linestyle": "none", "marker": "o", "markersize": RING, "fillstyle": "none"}
        ax.plot(
            [getattr(row, cost) for row in chosen],
            [_shown_error(row, reference) for row in chosen],
            color=INK,
            markeredgewidth=0.8,
            label="automatic choice",
            **style,
        )


def _draw_front(ax: Axes, rows: Sequence[Row]) -> None:
    """Draw a line along the runs of the front."""
    front = sorted((row for row in rows if row.front), key=lambda row: row.seconds)
    style: Any = {"linewidth": 5.0, "solid_capstyle": "round", "zorder": 0.5, "label": "front"}
    ax.plot(
        [row.seconds for row in front], [row.error for row in front], color=FRONT_COLOUR, **style
    )


def _shown_error(row: Row, reference: Reference) -> float:
    """An error, but not far below that of the reference, where it means nothing."""
    return max(row.error, 0.1 * reference.error, 1e-17)
