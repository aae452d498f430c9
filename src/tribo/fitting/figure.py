"""The picture of a fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tribo.fitting.data import Trace
from tribo.plotting.curves import ASPECT, COLOURS, legend
from tribo.plotting.style import INK, WIDE, drawing_on

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw(trace: Trace, rest: np.ndarray, quantity: str, ax: Axes | None) -> Axes:
    """Draw data, fit and residuals; these are below the curves, around a line of their own."""
    t = trace.t
    values = trace.values
    with drawing_on(ax, WIDE, ASPECT * WIDE) as ax:
        floor = float(np.min(values)) - 2.0 * float(np.max(np.abs(rest)))
        floor -= 0.1 * float(np.ptp(values))
        size = max(0.5, min(2.0, 300.0 / t.size))
        ax.plot(t, values, ".", color=INK, markersize=2.0 * size, label="measured")
        ax.plot(t, values - rest, color=COLOURS[0], linewidth=1.1, label="fit")
        ax.axhline(floor, color=INK, linewidth=0.5)
        ax.plot(t, floor + rest, color=COLOURS[1], linewidth=0.6, label="residuals")
        ax.set(xlabel="$t$", ylabel=quantity, xlim=(t[0], t[-1]))
        legend(ax)
    return ax
