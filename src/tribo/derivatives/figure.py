"""The tornado picture of a sensitivity: the parameters that matter most on top."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting.curves import COLOURS
from tribo.plotting.style import INK, WIDE, drawing_on
from tribo.validation import InputError, one_of

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

# Height of a bar [inch].
ROW = 0.28


def tornado(data: xarray.Dataset, quantity: str | None = None, ax: Axes | None = None) -> Axes:
    """Draw the relative derivatives of a quantity, the largest on top, with their intervals.

    A bar says by how many per cent the quantity changes if the key grows by one per cent.

    Parameters
    ----------
    data : xarray.Dataset
        The data set that :func:`tribo.sensitivity` returns.
    quantity : str, optional
        One of its quantities; by default the first.
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure.

    Raises
    ------
    InputError
        If there is no such quantity, or no key has a relative derivative.
    """
    names = [str(name) for name in data["quantity"].values]
    name = names[0] if quantity is None else one_of("quantity", quantity, names)
    own = data.sel(quantity=name)
    relative = own["relative"].values
    known = np.flatnonzero(np.isfinite(relative))
    if known.size == 0:
        raise InputError("data", f'has no relative derivative of "{name}": values are zero')
    order = known[np.argsort(np.abs(relative[known]))]
    widths = own["relative_half_width"].values[order]
    labels = [str(key) for key in own["key"].values[order]]
    with drawing_on(ax, WIDE, 0.8 + ROW * order.size) as ax:
        colours = [COLOURS[0] if value >= 0.0 else COLOURS[1] for value in relative[order]]
        bars: dict[str, Any] = {"ecolor": INK, "capsize": 2.0, "error_kw": {"linewidth": 0.8}}
        places = np.arange(order.size)
        ax.barh(places, relative[order], 0.7, xerr=widths, color=colours, **bars)
        ax.axvline(0.0, color=INK, linewidth=0.6)
        ax.set_yticks(places, labels)
        ax.tick_params(axis="y", which="both", length=0.0)
        ax.minorticks_off()
        ax.set(
            xlabel=f"change of {name} (%) for 1 % of the parameter", ylim=(-0.6, order.size - 0.4)
        )
    return ax
