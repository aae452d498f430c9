"""What graphs share: colours and dashes of lines, axes and legends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.model.surface import Surface
from tribo.plotting.style import CYCLE, NOTE_SIZE, figure_of
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.legend import Legend

# Colours of surfaces, and of the parts of an energy budget, one after the other.
COLOURS = CYCLE * 8
# Letters of a legend in an inch, and those that a sample of a line takes.
LETTERS = 28.5
OF_LINE = 8
# Height of a graph over its width.
ASPECT = 0.66
# Line styles of the results of a comparison, one after the other.
DASHES: tuple[Any, ...] = ("-", (0, (4, 2)), (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5)))


def named(name: str, label: str) -> str:
    """The name of a line in a graph of several results, each with a label; else as it is."""
    return f"{label}: {name}" if label else name


def swing_of(result: RunResult, surface: Surface) -> np.ndarray:
    """(times, asperites) angles of pendulums from their rest, relative to the bars [rad]."""
    series = result[surface.name]
    return np.asarray(series.theta - surface.rest - series.phi)


def finish(ax: Axes, result: RunResult, ylabel: str) -> None:
    """Add the line of zero, the labels and the legend of a graph over time."""
    ax.axhline(0.0, color="0.6", linewidth=0.5, linestyle="-", zorder=0)
    ax.set(xlabel="$t$", ylabel=ylabel, xlim=(result.t[0], result.t[-1]))
    legend(ax)


def legend(
    ax: Axes, lines: Sequence[Any] = (), names: Sequence[str] = (), title: str | None = None
) -> Legend:
    """Names of lines, or of all, above the graph, clear of the curves.

    There are at most three in a row, and no more than fit above the graph.  The size is that of
    tribo's style also on Axes of another style.
    """
    handles, labels = (lines, names) if lines else ax.get_legend_handles_labels()
    number = max(1, len(labels))
    longest = OF_LINE + max(map(len, labels), default=0)
    width = ax.get_position().width * figure_of(ax).get_figwidth()
    most = min(3, max(1, int(LETTERS * width / longest)))
    return ax.legend(
        handles,
        labels,
        title=title,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=math.ceil(number / math.ceil(number / most)),
        frameon=False,
        fontsize=NOTE_SIZE,
        title_fontsize=NOTE_SIZE,
        borderaxespad=0.2,
        columnspacing=1.2,
    )
