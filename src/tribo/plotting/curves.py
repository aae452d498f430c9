"""Curves of a whole result: lines for few asperites, bands for many."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo.model.surface import Surface
from tribo.plotting.style import COLUMN, CYCLE, drawing_on
from tribo.results.averages import Average
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Above this number of asperites of a surface, angles are a band rather than lines.
MOST_LINES = 6
# Percentiles of the asperites between which a band lies.
BAND = (5.0, 95.0)
# Most paths of a phase plot: more cover one another.
MOST_PATHS = 200
# Colours of surfaces, and of the parts of an energy budget, one after the other.
COLOURS = CYCLE * 8
# Widths of lines, one surface after the other: equal curves are both seen [points].
WIDTHS = (2.6, 1.0)
# Width of lines where there is one surface, and of all paths in a phase plot [points].
WIDTH, PATH_WIDTH = 1.1, 0.7
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


def angles(result: RunResult, look: Look, ax: Axes | None) -> Axes:
    """Draw swings over time [rad]."""
    with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
        for k, surface in enumerate(result.scene.surfaces):
            swing = swing_of(result, surface)
            line: dict[str, Any] = {"linewidth": _width(result, k), "linestyle": look.linestyle}
            line |= {"color": COLOURS[k], "label": look.named(surface.name)}
            if surface.count <= MOST_LINES:
                for other in ax.plot(result.t, swing, **line)[1:]:
                    other.set_label("_")
                continue
            low, middle, high = np.percentile(swing, [BAND[0], 50.0, BAND[1]], axis=1)
            ax.plot(result.t, middle, **line)
            ax.fill_between(result.t, low, high, color=COLOURS[k], alpha=0.2, linewidth=0.0)
        finish(ax, result, "swing (rad)")
    return ax


def phase(result: RunResult, look: Look, ax: Axes | None) -> Axes:
    """Draw the angular velocity of pendulums over their swing."""
    with drawing_on(ax, COLUMN, 0.8 * COLUMN) as ax:
        for k, surface in enumerate(result.scene.surfaces):
            number = min(surface.count, MOST_PATHS)
            shown = np.unique(np.linspace(0, surface.count - 1, number).astype(int))
            swing = swing_of(result, surface)[:, shown]
            rate = result[surface.name].omega[:, shown]
            line: dict[str, Any] = {"color": COLOURS[k], "linestyle": look.linestyle}
            width = PATH_WIDTH * _width(result, k)
            faint = max(0.08, min(1.0, 4.0 / len(shown)))
            ax.plot(swing, rate, linewidth=width, alpha=faint, **line)
            ax.plot(swing[-1], rate[-1], "o", color=COLOURS[k], markersize=2.5)
            ax.plot([], [], label=look.named(surface.name), **line)
        ax.set(xlabel="swing (rad)", ylabel=r"$\omega$ (rad / time)")
        legend(ax)
    return ax


def friction(result: RunResult, surface: str, found: Average, look: Look, ax: Axes | None) -> Axes:
    """Draw the friction force on a surface over time, with its average and interval."""
    with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
        interval = f" ± {found.half_width:.1g}" * math.isfinite(found.half_width)
        low, high = found.mean - found.half_width, found.mean + found.half_width
        later, line = [found.after, result.t[-1]], {"linewidth": WIDTH, "linestyle": look.linestyle}
        ax.plot(result.t, result[surface].friction_force, color=COLOURS[0], **line)
        label = look.named(f"{found.mean:.3g}{interval}")
        ax.plot(later, [found.mean] * 2, color=COLOURS[1], label=label, **line)
        ax.fill_between(later, low, high, color=COLOURS[1], alpha=0.3, linewidth=0.0)
        finish(ax, result, f"friction force on {surface}")
    return ax


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


def _width(result: RunResult, index: int) -> float:
    return WIDTHS[index % 2] if len(result.scene.surfaces) > 1 else WIDTH
