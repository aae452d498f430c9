"""Works: names, colours, sums and curves.

The work on a surface is that of its external forces, W: the sum of the works of each of them on the
asperites.  Works inside the surface, w_int, are beside it.  The total of an asperite is w, the work
of all forces on it.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo.plotting.marks import POINTS_PER_INCH
from tribo.plotting.style import INK
from tribo.results.run_result import RunResult
from tribo.validation import must_be

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D


class Work(NamedTuple):
    """How a work is drawn; its pseudowork has the same colour, and is dashed."""

    subscript: str
    colour: str
    meaning: str


WORKS = {
    "w1": Work("1", "#0b62a4", "friction"),
    "w2": Work("2", "#d55e00", "drive"),
    "wL": Work("L", "#1f8a70", "left end of bar"),
    "wR": Work("R", "#7d2f86", "right end of bar"),
    "w_field": Work(r"{\rm field}", "#c2185b", "fields"),
    "w_T": Work("T", "#607d8b", "reservoir"),
    "w_int": Work(r"{\rm int}", "#8a6f00", "internal"),
    "w": Work("", INK, "all forces"),
    "W": Work("", INK, "all external"),
}
TOTALS = ("w", "W")
# Dashes of pseudoworks.
DASHED = (0, (4, 2))


def symbol(name: str) -> str:
    """The symbol of a work or pseudowork, for matplotlib."""
    work = name.removesuffix("_ps")
    below = [WORKS[work].subscript, r"{\rm ps}" if work != name else ""]
    letter = "W" if work == "W" else "w"
    return f"${letter}_{{{'{,}'.join(filter(None, below))}}}$"


def look(name: str) -> dict[str, Any]:
    """Colour, dashes and width of the line of a work or pseudowork."""
    work = name.removesuffix("_ps")
    style: dict[str, Any] = {"color": WORKS[work].colour, "label": name}
    style |= {"linestyle": DASHED} if work != name else {}
    return style | ({"linewidth": 1.6, "zorder": 3} if name in TOTALS else {})


def pseudowork_sample() -> Line2D:
    """The line of a legend that stands for all pseudoworks."""
    from matplotlib.lines import Line2D

    return Line2D([], [], color=INK, linestyle=DASHED)


def works_of(result: RunResult, surface: str, asperite: int | None) -> dict[str, np.ndarray]:
    """Works and pseudoworks by name, (times,): of one asperite, or of the surface.

    Raises InputError where those of single asperites are not kept.
    """
    ledger = result.scene.output.ledger
    if asperite is not None and ledger != "asperites":
        raise must_be("output.ledger", '"asperites" for works of single asperites', ledger)
    series = result[surface]
    whole = "w" if asperite is not None else "W"
    works = [work for work in WORKS if work not in TOTALS or work == whole]
    names = [name for name in with_pseudoworks(works) if name in series]
    if asperite is not None:
        return {name: series[name][:, asperite] for name in names}
    return {name: total(series[name]) for name in names}


def with_pseudoworks(works: Iterable[str]) -> list[str]:
    """The names of works, each followed by that of its pseudowork."""
    return [name for work in works for name in (work, f"{work}_ps")]


def total(values: np.ndarray) -> np.ndarray:
    """The sum over asperites, (times,), of values of each or of a surface."""
    return np.asarray(values).reshape(len(values), -1).sum(axis=1)


def draw_works(
    ax: Axes, result: RunResult, works: dict[str, np.ndarray], span: tuple[float, float] | None
) -> dict[str, Line2D]:
    """Draw works over a span of time, each labelled at its end; returns the lines by name.

    Works that are zero throughout are left out, and so is the total pseudowork.
    """
    from matplotlib.ticker import MaxNLocator

    span = span or (float(result.t[0]), float(result.t[-1]))
    lines: dict[str, Line2D] = {}
    for name in sorted(works, key=lambda name: name.endswith("_ps")):
        if np.any(works[name]) and name not in ("w_ps", "W_ps"):
            (lines[name],) = ax.plot(result.t, works[name], **look(name))
    ax.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    ax.set(xlabel="$t$", xlim=span)
    ax.xaxis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10]))
    if lines:
        _label_ends(ax, {symbol(name): line for name, line in lines.items()}, span[1])
    return lines


def _label_ends(ax: Axes, lines: dict[str, Line2D], t: float) -> None:
    """Write labels right of the frame, each beside the end of its line and clear of the others."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high)
    values = np.array([np.interp(t, *np.asarray(line.get_data())) for line in lines.values()])
    height = ax.bbox.height / ax.figure.dpi * POINTS_PER_INCH
    levels = spread((values - low) / (high - low), 11.0 / height)  # points between labels
    for (label, line), value, level in zip(lines.items(), values, levels, strict=True):
        colour = line.get_color()
        pointer = {"arrowstyle": "-", "color": colour, "linewidth": 0.5, "shrinkA": 0}
        ax.annotate(
            label,
            xy=(1.0, (value - low) / (high - low)),
            xytext=(1.06, level),
            xycoords="axes fraction",
            va="center",
            color=colour,
            arrowprops=pointer | {"relpos": (0.0, 0.5)},
        )


def spread(levels: np.ndarray, gap: float) -> np.ndarray:
    """Move levels (n,), from 0 to 1, at least `gap` apart, and keep their order.

    They move as little as possible in least squares, and stay from 0 to 1 as far as there is room.
    """
    from scipy.optimize import isotonic_regression

    order = np.argsort(levels, kind="stable")
    below = gap * np.arange(len(levels))
    # Levels less the gaps below them must not decrease.
    pooled = isotonic_regression(levels[order] - below).x
    apart = np.empty(len(levels))
    apart[order] = np.clip(pooled, 0.0, 1.0 - below[-1]) + below
    return apart
