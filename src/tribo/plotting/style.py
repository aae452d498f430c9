"""Paper, ink and fonts: figures in the style of a journal, and how things are put on them.

Sizes of letters, gaps and margins are in points.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo.validation import InputError, as_path

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN, WIDE = 3.375, 5.1  # one and one-and-a-half columns of a journal [inch]
FILES = (".png", ".pdf", ".svg")  # kinds that a figure can be written as
POINTS_PER_INCH = 72.0
EDGE = 4.0  # of paper around a drawing [points]
SIDES = ("left", "right", "bottom", "top")

INK = "#1a1a1a"

STYLE: Any = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.minor.visible": True,
    "ytick.minor.visible": True,
    "lines.linewidth": 1.1,
    "savefig.dpi": 300,
    "pdf.fonttype": 42,  # letters stay letters, as journals ask for
}


def figure_path(field: str, path: Any) -> Path:
    """A path whose name ends on .png, .pdf or .svg.  Raises InputError."""
    place = as_path(path)
    if place.suffix.lower() not in FILES:
        raise InputError(field, f"must end on {', '.join(FILES)}, got {str(path)!r}")
    return place


def write(figure: Figure, path: Any) -> Path:
    """Write a figure into a file whose name ends on .png, .pdf or .svg.  Raises InputError."""
    place = figure_path("path", path)
    try:
        figure.savefig(place)
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError("path", f"{place} cannot be written ({why})") from None
    return place


def style() -> AbstractContextManager[None]:
    """Fonts and lines of a journal, for as long as the context lasts."""
    from matplotlib import rc_context

    return rc_context(STYLE)


def axes(width: float, height: float | None = None) -> Axes:
    """Axes of a new figure [inch]: with a height for a graph, without one for a drawing.

    A drawing fills its figure and has no frame; `trim` gives it the height that it needs.
    """
    from matplotlib.figure import Figure

    if height is not None:
        return Figure(figsize=(width, height), layout="constrained").add_subplot()
    ax = Figure(figsize=(width, width)).add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set_axis_off()
    return ax


def save(ax: Axes, stem: Path) -> list[Path]:
    """Write the figure that `ax` is in as ``stem.pdf`` and ``stem.png``."""
    paths = [stem.with_name(stem.name + suffix) for suffix in (".pdf", ".png")]
    for path in paths:
        # Without a date the same picture is the same file.
        stamp: Any = {"CreationDate": None} if path.suffix == ".pdf" else {}
        _figure(ax).savefig(path, metadata=stamp)
    return paths


def _figure(ax: Axes) -> Figure:
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure


def arrow(ax: Axes, start: Any, tip: Any, **properties: Any) -> None:
    """A straight arrow between two places."""
    drawn = {"arrowstyle": "-|>,head_length=0.5,head_width=0.2", "linewidth": 0.9, "color": INK}
    ax.annotate(
        "",
        xy=tuple(tip),
        xytext=tuple(start),
        arrowprops=drawn | {"shrinkA": 0, "shrinkB": 0, "mutation_scale": 8} | properties,
        zorder=1000,
    )


def note(
    ax: Axes, place: Any, text: str, away: tuple[float, float] = (0.0, 0.0), **properties: Any
) -> None:
    """A text beside a place, `away` from it [points]."""
    where: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 1001}
    ax.annotate(
        text, xy=tuple(place), xytext=away, textcoords="offset points", **(where | properties)
    )


def clock(times: Sequence[float]) -> list[str]:
    """Times with as many decimals as the longest of them needs."""
    decimals = max(len(f"{t:.6g}".partition(".")[2]) for t in times)
    return [f"$t = {t:.{decimals}f}$" for t in times]


def unit(ax: Axes, box: tuple[float, float, float, float], **margins: float) -> float:
    """The length that a point is, if a box is to fill the width of `ax` up to its margins."""
    width = ax.bbox.width / ax.figure.dpi * POINTS_PER_INCH
    return (box[1] - box[0]) / (width - margins.get("left", EDGE) - margins.get("right", EDGE))


def frame(ax: Axes, box: tuple[float, float, float, float], **margins: float) -> None:
    """Show a box (left, right, bottom, top) with margins of the same names [points]."""
    point = unit(ax, box, **margins)
    left, right, bottom, top = (point * margins.get(side, EDGE) for side in SIDES)
    ax.set_xlim(box[0] - left, box[1] + right)
    ax.set_ylim(box[2] - bottom, box[3] + top)
    ax.set_aspect("equal")


def trim(ax: Axes) -> None:
    """Give the figure that a drawing fills the height that the drawing needs."""
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    figure = _figure(ax)
    figure.set_figheight(figure.get_figwidth() * (top - bottom) / (right - left))
