"""A histogram of works with its mirror image: which of w and -w is more probable."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from tribo.plotting.style import COLUMN, INK, drawing_on
from tribo.validation import POSITIVE, InputError, integer, number, vector

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OWN_COLOUR, MIRROR_COLOUR = "#0b62a4", "#d55e00"
# Height of the graph over its width.
ASPECT = 0.7


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

    Returns
    -------
    matplotlib.axes.Axes

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
        filled: Any = {"color": OWN_COLOUR, "alpha": 0.25, "linewidth": 0.0}
        ax.stairs(density, edges, fill=True, **filled)
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
        ax.legend(frameon=False, fontsize=7, loc="upper left")
    return ax
