"""What graphs over time share: colours, the look of a result's lines, axes and legends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo.model.surface import Surface
from tribo.plotting.style import CYCLE
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Colours of surfaces, and of the parts of an energy budget, one after the other.
COLOURS = CYCLE * 8
# Width of thin lines, as of all paths in a phase plot [points].
PATH_WIDTH = 0.7
# Height of a graph over its width.
ASPECT = 0.66


class Look(NamedTuple):
    """What tells the lines of one result from those of others in the same graph."""

    label: str = ""
    linestyle: Any = "-"

    def named(self, name: str) -> str:
        """The name of a line in the legend."""
        return f"{self.label}: {name}" if self.label else name


PLAIN = Look()


def swing_of(result: RunResult, surface: Surface) -> np.ndarray:
    """(times, asperites) angles of pendulums from their rest, relative to the bars [rad]."""
    series = result[surface.name]
    return np.asarray(series.theta - surface.rest - series.phi)


def finish(ax: Axes, result: RunResult, ylabel: str) -> None:
    """Add the line of zero, the labels and the legend of a graph over time."""
    ax.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    ax.set(xlabel="$t$", ylabel=ylabel, xlim=(result.t[0], result.t[-1]))
    legend(ax)


def legend(ax: Axes, lines: Sequence[Any] = (), names: Sequence[str] = ()) -> None:
    """Names of lines, or of all, above the graph, clear of the curves, at most three in a row."""
    handles, labels = (lines, names) if lines else ax.get_legend_handles_labels()
    number = max(1, len(labels))
    ax.legend(
        handles,
        labels,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=math.ceil(number / math.ceil(number / 3)),
        frameon=False,
        fontsize=7.5,
        borderaxespad=0.2,
        columnspacing=1.2,
    )
