"""The style of tribo's figures, their Axes and their files."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from tribo.files import replace_file
from tribo.validation import InputError, as_path

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Widths of one and of one and a half columns of a journal, and of its page [inch].
COLUMN = 3.375
WIDE = 5.1
PAGE = 6.2
# Names of files that a figure can be written to end on one of these.
FILES = (".png", ".pdf", ".svg")
# Colour of text, edges and arrows.
INK = "#1a1a1a"
# Size of notes in a figure, and of legends, as in tribo.mplstyle [points].
NOTE_SIZE = 7.5
# Widths of the line of a single surface, and of thin lines [points].
MEDIUM = 1.1
THIN = 0.7
# Largest number of an axis whose ticks have no power of ten.
LEAST_PLAIN = 1e-3
MOST_PLAIN = 1e5
# Least span of such an axis, relative to its largest number.
LEAST_SPAN = 0.05
# Colours of lines, in order; people with any colour vision can tell the first two apart.
CYCLE = ("#0b62a4", "#d55e00", "#1f8a70", "#7d2f86", "#8a6f00", "#c2185b", "#607d8b")


def style() -> AbstractContextManager[None]:
    """Apply tribo's fonts and lines while the context lasts.

    Functions that make their own Axes, and `save`, apply it themselves.
    """
    from matplotlib.rcsetup import cycler
    from matplotlib.style import context

    return context(["tribo.plotting.tribo", {"axes.prop_cycle": cycler(color=CYCLE)}])


def axes(width: float = COLUMN, height: float | None = None) -> Axes:
    """Make the Axes of a new figure for a graph, in tribo's style.

    Parameters
    ----------
    width : float
        Width of the figure [inch].
    height : float, optional
        Height of the figure [inch]; 0.62 of the width without it.
    """
    from tribo.plotting.shown import ShownAxes, ShownFigure

    height = 0.62 * width if height is None else height
    with style():
        figure = ShownFigure(figsize=(width, height), layout="constrained")
        return figure.add_subplot(axes_class=ShownAxes)


def with_powers_at_ticks(ax: Axes) -> None:
    """Let each tick have its power of ten, as in SI units.

    matplotlib writes one power at the end of an axis, over legends and notes.
    """
    from matplotlib.ticker import FuncFormatter, ScalarFormatter

    for axis in (ax.xaxis, ax.yaxis):
        low, high = axis.get_view_interval()
        largest = max(abs(low), abs(high))
        is_scalar = type(axis.get_major_formatter()) is ScalarFormatter
        is_wide = abs(high - low) > LEAST_SPAN * largest  # else four digits do not tell ticks apart
        if is_scalar and is_wide and not LEAST_PLAIN <= largest < MOST_PLAIN:
            axis.set_major_formatter(FuncFormatter(_with_power))


def _with_power(value: float, place: int) -> str:
    """A number with few digits, as 2e-9."""
    mantissa, _, exponent = f"{value:.4g}".partition("e")
    text = f"{mantissa}e{int(exponent)}" if exponent else mantissa
    return text.replace("-", "\N{MINUS SIGN}")


@contextmanager
def drawing_on(ax: Axes | None, width: float, height: float | None = None) -> Iterator[Axes]:
    """Yield the given Axes, or new ones in tribo's style, of that size [inch].

    Without a height they are those of a drawing: they fill the figure, have no frame and no labels,
    and the figure gets the height of what is drawn at the end.
    """
    if ax is not None:
        yield ax
        with_powers_at_ticks(ax)
        return
    from tribo.plotting.shown import ShownAxes, ShownFigure

    with style():
        if height is not None:
            ax = axes(width, height)
        else:
            figure = ShownFigure(figsize=(width, width))
            ax = figure.add_axes((0.0, 0.0, 1.0, 1.0), axes_class=ShownAxes)
            ax.set_axis_off()
        yield ax
        with_powers_at_ticks(ax)
    if height is None:
        left, right = ax.get_xlim()
        bottom, top = ax.get_ylim()
        figure_of(ax).set_figheight(width * (top - bottom) / (right - left))


def save(drawing: Axes | Figure, path: str | Path) -> Path:
    """Write a figure to a file.

    The same figure gives the same bytes: PDF and SVG files have no date.

    Parameters
    ----------
    drawing : matplotlib.axes.Axes or matplotlib.figure.Figure
        The figure, or Axes in it.
    path : str or Path
        Name of the file, which ends in .png, .pdf or .svg.

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
    """The path of a figure's file.  Raises InputError about a field if its ending is another."""
    place = as_path(path)
    if place.suffix.lower() not in FILES:
        raise InputError(field, f"must end on {', '.join(FILES)}, got {str(path)!r}")
    return place


def figure_of(drawing: Axes | Figure) -> Figure:
    """The outermost figure of Axes or of a figure."""
    figure = drawing.get_figure(root=True)
    assert figure is not None
    return figure
