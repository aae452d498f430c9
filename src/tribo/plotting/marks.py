"""Marks on drawings: arrows, notes, times, margins.  Sizes of gaps and margins are in points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo.plotting.style import INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

POINTS_PER_INCH = 72.0
# Margin around a drawing [points].
EDGE = 4.0


class Box(NamedTuple):
    """A part of a drawing, in the units of its Axes."""

    left: float
    right: float
    bottom: float
    top: float


def arrow(ax: Axes, start: ArrayLike, tip: ArrayLike, **properties: Any) -> None:
    """Draw a straight arrow; the properties are those of matplotlib's ``FancyArrowPatch``."""
    drawn = {"arrowstyle": "-|>,head_length=0.5,head_width=0.2", "linewidth": 0.9, "color": INK}
    fixed = {"shrinkA": 0, "shrinkB": 0, "mutation_scale": 8}
    ax.annotate(
        "", xy=_pair(tip), xytext=_pair(start), arrowprops=drawn | fixed | properties, zorder=1000
    )


def note(
    ax: Axes,
    position: ArrayLike,
    text: str,
    offset: tuple[float, float] = (0.0, 0.0),
    **properties: Any,
) -> None:
    """Write a text, displaced by `offset` points; the properties are those of ``Axes.annotate``."""
    where: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 1001} | properties
    ax.annotate(text, xy=_pair(position), xytext=offset, textcoords="offset points", **where)


def with_minus(text: str) -> str:
    """A text of numbers, with minus signs for its hyphens."""
    return text.replace("-", "\N{MINUS SIGN}")


def _pair(position: ArrayLike) -> tuple[float, float]:
    x, y = np.asarray(position, float)
    return float(x), float(y)


def time_labels(times: Sequence[float]) -> list[str]:
    """Times as text, all with as many decimals as the longest of them needs."""
    if any("e" in f"{t:.6g}" for t in times):
        return [f"$t = {with_power(t)}$" for t in times]
    decimals = max(len(f"{t:.6g}".partition(".")[2]) for t in times)
    return [f"$t = {t:.{decimals}f}$" for t in times]


def with_power(value: float) -> str:
    """A number as a mantissa times a power of ten, in mathematical text."""
    mantissa, _, exponent = f"{value:.3e}".partition("e")
    return rf"{float(mantissa):g} \times 10^{{{int(exponent)}}}" if value else "0"


def point_length(ax: Axes, low: float, high: float, **margins: float) -> float:
    """The length of one point if this range fills the width of `ax` up to its margins [length]."""
    width = ax.bbox.width / ax.figure.dpi * POINTS_PER_INCH
    return (high - low) / (width - margins.get("left", EDGE) - margins.get("right", EDGE))


def frame(ax: Axes, box: Box, **margins: float) -> None:
    """Show a part of a drawing, with margins `left`, `right`, `bottom` and `top` [points]."""
    point = point_length(ax, box.left, box.right, **margins)
    left, right, bottom, top = (point * margins.get(side, EDGE) for side in Box._fields)
    ax.set_xlim(box.left - left, box.right + right)
    ax.set_ylim(box.bottom - bottom, box.top + top)
    ax.set_aspect("equal")
