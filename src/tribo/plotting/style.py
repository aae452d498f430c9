"""The style of tribo's figures, their files, and the marks that are put on them.

Sizes of letters, gaps and margins are in points.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo.files import replace_file
from tribo.validation import InputError, as_path

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

# Widths of one and of one and a half columns of a journal, and of its page [inch].
COLUMN, WIDE, PAGE = 3.375, 5.1, 6.2

# Names of files that a figure can be written to end on one of these.
FILES = (".png", ".pdf", ".svg")

POINTS_PER_INCH = 72.0

# Margin around a drawing [points].
EDGE = 4.0

# Sides of a box, in the order of its four numbers.
SIDES = ("left", "right", "bottom", "top")

# Colour of text, edges and arrows.
INK = "#1a1a1a"

# Colours of lines, in order; people with any colour vision can tell the first two apart.
CYCLE = ("#0b62a4", "#d55e00", "#2fae8c", "#7d2f86", "#8a6f00", "#c2185b", "#607d8b")

STYLE: Any = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.prop_cycle": f"cycler('color', {CYCLE})",
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.minor.visible": True,
    "ytick.minor.visible": True,
    "lines.linewidth": 1.1,
    "savefig.dpi": 300,
    # TrueType: text in a PDF file stays text, as journals require.
    "pdf.fonttype": 42,
    # The same figure is the same SVG file.
    "svg.hashsalt": "tribo",
}


def style() -> AbstractContextManager[None]:
    """Apply tribo's fonts and lines while the context lasts.

    Functions that make their own Axes, and `save`, apply it themselves.

    Returns
    -------
    context manager
    """
    from matplotlib import rc_context

    return rc_context(STYLE)


def axes(width: float = COLUMN, height: float | None = None) -> Axes:
    """Make the Axes of a new figure for a graph, in tribo's style.

    Parameters
    ----------
    width : float
        Width of the figure [inch].
    height : float, optional
        Height of the figure [inch]; 0.62 of the width without it.

    Returns
    -------
    matplotlib.axes.Axes
    """
    from tribo.plotting.shown import ShownAxes, ShownFigure

    height = 0.62 * width if height is None else height
    with style():
        figure = ShownFigure(figsize=(width, height), layout="constrained")
        return figure.add_subplot(axes_class=ShownAxes)


def drawing_axes(width: float = COLUMN) -> Axes:
    """Make the Axes of a new figure for a drawing: they fill it and have no frame and no labels.

    Parameters
    ----------
    width : float
        Width of the figure [inch]; `trim` sets the height that the drawing needs.

    Returns
    -------
    matplotlib.axes.Axes
    """
    from tribo.plotting.shown import ShownAxes, ShownFigure

    with style():
        figure = ShownFigure(figsize=(width, width))
        ax = figure.add_axes((0.0, 0.0, 1.0, 1.0), axes_class=ShownAxes)
    ax.set_axis_off()
    return ax


@contextmanager
def drawing_on(ax: Axes | None, width: float, height: float | None = None) -> Iterator[Axes]:
    """Yield the given Axes, or new ones in tribo's style: of a drawing if there is no height.

    A drawing on new Axes is trimmed at the end.

    Parameters
    ----------
    ax : matplotlib.axes.Axes or None
        Axes to draw in.
    width, height : float
        Size of new Axes [inch].

    Yields
    ------
    matplotlib.axes.Axes
    """
    if ax is not None:
        yield ax
        return
    with style():
        ax = drawing_axes(width) if height is None else axes(width, height)
        yield ax
    if height is None:
        trim(ax)


def save(drawing: Axes | Figure, path: str | Path) -> Path:
    """Write a figure to a file.

    The same figure gives the same bytes: PDF and SVG files have no date.

    Parameters
    ----------
    drawing : matplotlib.axes.Axes or matplotlib.figure.Figure
        The figure, or Axes in it.
    path : str or Path
        Name of the file, which ends in .png, .pdf or .svg.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If the name ends otherwise, or the file cannot be written.
    """
    place = figure_path("path", path)
    kind = place.suffix.lower()
    undated = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}
    content = io.BytesIO()
    with style():
        figure_of(drawing).savefig(content, format=kind[1:], metadata=undated.get(kind))
    replace_file(place, content.getvalue())
    return place


def figure_path(field: str, path: str | Path) -> Path:
    """The path of a figure's file.

    Parameters
    ----------
    field : str
        Name of the parameter in messages.
    path : str or path
        It has to end on one of `FILES`.

    Returns
    -------
    pathlib.Path

    Raises
    ------
    InputError
        If it has another ending.
    """
    place = as_path(path)
    if place.suffix.lower() not in FILES:
        raise InputError(field, f"must end on {', '.join(FILES)}, got {str(path)!r}")
    return place


def figure_of(drawing: Axes | Figure) -> Figure:
    """The outermost figure of Axes or of a figure."""
    figure = drawing.get_figure(root=True)
    assert figure is not None
    return figure


def arrow(ax: Axes, start: ArrayLike, tip: ArrayLike, **properties: Any) -> None:
    """Draw a straight arrow.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        Axes to draw in.
    start, tip : array_like, (2,)
        Its ends in the units of the axes.
    **properties
        Of matplotlib's ``FancyArrowPatch``.
    """
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
    """Write a text into a figure.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        Axes to draw in.
    position : array_like, (2,)
        Place in the units of the axes.
    text : str
        The text.
    offset : tuple of float, optional
        Displacement of the text from `position` [points].
    **properties
        Of matplotlib's ``Axes.annotate``.
    """
    where: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 1001} | properties
    ax.annotate(text, xy=_pair(position), xytext=offset, textcoords="offset points", **where)


def _pair(position: ArrayLike) -> tuple[float, float]:
    import numpy as np

    x, y = np.asarray(position, float)
    return float(x), float(y)


def time_labels(times: Sequence[float]) -> list[str]:
    """Times as text, all with as many decimals as the longest of them needs.

    Parameters
    ----------
    times : sequence of float
        Times of a scene.

    Returns
    -------
    list of str
    """
    decimals = max(len(f"{t:.6g}".partition(".")[2]) for t in times)
    return [f"$t = {t:.{decimals}f}$" for t in times]


def point_length(ax: Axes, box: tuple[float, float, float, float], **margins: float) -> float:
    """The length that one point is if a box fills the width of `ax` up to its margins.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
    box : tuple of float
        Left, right, bottom and top [length].
    **margins : float
        Margins ``left`` and ``right``, where they are not EDGE [points].

    Returns
    -------
    float
        [length]
    """
    width = ax.bbox.width / ax.figure.dpi * POINTS_PER_INCH
    return (box[1] - box[0]) / (width - margins.get("left", EDGE) - margins.get("right", EDGE))


def frame(ax: Axes, box: tuple[float, float, float, float], **margins: float) -> None:
    """Show a part of a drawing with margins around it.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        Axes to draw in.
    box : tuple of float
        Left, right, bottom and top in the units of the axes.
    **margins : float
        `left`, `right`, `bottom` and `top` [points].
    """
    point = point_length(ax, box, **margins)
    left, right, bottom, top = (point * margins.get(side, EDGE) for side in SIDES)
    ax.set_xlim(box[0] - left, box[1] + right)
    ax.set_ylim(box[2] - bottom, box[3] + top)
    ax.set_aspect("equal")


def trim(ax: Axes) -> None:
    """Set the height of a figure to that of the drawing which fills it.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        Axes of the drawing.
    """
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    figure = figure_of(ax)
    figure.set_figheight(figure.get_figwidth() * (top - bottom) / (right - left))


def colour_bar(
    ax: Axes, colours: PathCollection, place: tuple[float, float], width: float, height: float
) -> None:
    """Draw the scale of the swings in a box, whose place and size are in the units of `ax`."""
    inset = ax.inset_axes((*place, width, height), transform=ax.transData)
    bar = figure_of(ax).colorbar(colours, cax=inset, orientation="horizontal", extend="both")
    bar.set_label("swing (rad)", fontsize=7.0, labelpad=0.0)
    bar.ax.tick_params(labelsize=6.0, top=False, pad=1.0)
    bar.ax.minorticks_off()
