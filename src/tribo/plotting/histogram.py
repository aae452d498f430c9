"""Histograms of the members of an ensemble: of a quantity, and of works with their mirror image."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from tribo.plotting.curves import legend
from tribo.plotting.marks import with_minus
from tribo.plotting.style import COLUMN, CYCLE, INK, drawing_on
from tribo.results.averages import interval, mean_text
from tribo.validation import POSITIVE, InputError, integer, number, vector

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OWN_COLOUR, MIRROR_COLOUR = CYCLE[:2]
FILLED: dict[str, Any] = {"color": OWN_COLOUR, "alpha": 0.25, "linewidth": 0.0}
# Height of the graph over its width.
ASPECT = 0.7


def histogram(values: ArrayLike, label: str, ax: Axes | None = None) -> Axes:
    """Draw how many members have a value, with the mean and its 95 % interval.

    Parameters
    ----------
    values : array_like, (members,)
        Values of a quantity; those that are not finite are left out.
    label : str
        Name of the quantity.
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure.

    Raises
    ------
    InputError
        Fewer than two values are finite.
    """
    known = np.ravel(np.asarray(values, float))
    known = known[np.isfinite(known)]
    if known.size < 2:
        raise InputError("values", f"must have two finite ones, got {known.size}")
    mean, half = (float(number) for number in interval(known))
    with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
        counts, edges = np.histogram(known, "auto")
        ax.stairs(counts, edges, fill=True, **FILLED)
        ax.stairs(counts, edges, color=OWN_COLOUR, label=f"{known.size} members")
        ax.axvspan(mean - half, mean + half, color=MIRROR_COLOUR, alpha=0.3, linewidth=0.0)
        shown = with_minus(f"mean {mean_text(mean, half, '±')} (95 %)")
        ax.axvline(mean, color=MIRROR_COLOUR, linewidth=1.0, label=shown)
        ax.set(xlabel=label, ylabel="members", ylim=(0.0, 1.05 * counts.max()))
        legend(ax)
    return ax


def reflected_histogram(
    work: ArrayLike,
    temperature: float | None = None,
    bins: int = 60,
    label: str = "$w$",
    ax: Axes | None = None,
) -> Axes:
    """Draw the density of works on a logarithmic axis, and that of the works with other signs.

    Parameters
    ----------
    work : array_like, (members,)
        Works w, or gains of energy [energy].
    temperature : float, optional
        Temperature T [energy].  With it, exp(w / T) times the density of -w is drawn too, which
        is that of w where the motion and the starts are the same with time reversed.
    bins : int
        Number of bins, which are symmetric about zero; an even one.
    label : str
        Label of the axis of works.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in.

    Raises
    ------
    InputError
        The works are no list of numbers that differ from zero, or another argument cannot be used.
    """
    works = vector("work", work)
    top = float(np.max(np.abs(works), initial=0.0))
    if top == 0.0:
        raise InputError("work", "must have values that differ from zero")
    if integer("bins", bins, 2) % 2:
        raise InputError("bins", f"must be even, got {bins}")
    edges = np.linspace(-top, top, bins + 1)
    density = np.histogram(works, edges)[0] / (works.size * np.diff(edges))
    middle = 0.5 * (edges[1:] + edges[:-1])
    with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
        ax.stairs(density, edges, fill=True, **FILLED)
        ax.stairs(density, edges, color=OWN_COLOUR, linewidth=1.1, label="$P(w)$")
        ax.stairs(density[::-1], edges, color=MIRROR_COLOUR, linewidth=0.8, label="$P(-w)$")
        if temperature is not None:
            factor = np.exp(middle / number("temperature", temperature, POSITIVE, "energy"))
            known = density[::-1] > 0.0
            marks: Any = {"color": INK, "marker": ".", "markersize": 2.5, "linestyle": "none"}
            weighted = (factor * density[::-1])[known]
            ax.plot(middle[known], weighted, label="$e^{w/T} P(-w)$", **marks)
        ax.axvline(0.0, color=INK, linewidth=0.5)
        low = density[density > 0.0]
        ax.set(yscale="log", xlabel=label, ylabel="density", xlim=(-top, top))
        ax.set_ylim(0.5 * low.min(), 3.0 * low.max())
        legend(ax)
    return ax
