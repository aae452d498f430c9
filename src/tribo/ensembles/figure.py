"""The members of an ensemble over time, their mean and its confidence interval."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tribo.plotting.curves import legend
from tribo.plotting.style import CYCLE, INK, WIDE, drawing_on
from tribo.results.averages import interval
from tribo.validation import InputError, one_of

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

MEMBER_COLOUR, INTERVAL_COLOUR = CYCLE[:2]
# Opacity of one member's line: OPACITY / members, but at least FAINTEST.
OPACITY = 10.0
FAINTEST = 0.25
# Members drawn at most: with more their lines would cover the figure.
MOST_MEMBERS = 100


def mean_band(data: xarray.Dataset, name: str, ax: Axes | None = None) -> Axes:
    """Draw the members of an ensemble, their mean and its confidence interval.

    Parameters
    ----------
    data : xarray.Dataset
        The data set that :func:`tribo.ensemble` returns.
    name : str
        A quantity with a mean, as "upper.W", or one that was kept at all times, with
        ``at="samples"``, as "upper.friction_force".
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure.
    """
    known = [str(key) for key in data.data_vars if data[key].dims == ("member", "time")]
    one_of("name", name, known)
    time = data["time"].values
    complete = data[name].values[data["status"].values == "completed"]
    shown = complete[:MOST_MEMBERS]
    if f"{name}_mean" in data:
        mean, half = (data[f"{name}_{of}"].values for of in ("mean", "half_width"))
    elif len(complete) > 1:
        mean, half = interval(complete)
    else:
        raise InputError("name", f"needs two members that completed, got {len(complete)}")
    opacity = min(1.0, max(FAINTEST, OPACITY / len(shown)))
    with drawing_on(ax, WIDE, 0.55 * WIDE) as ax:
        lines = ax.plot(time, shown.T, color=MEMBER_COLOUR, linewidth=0.5, alpha=opacity)
        filled: Any = {"color": INTERVAL_COLOUR, "alpha": 0.45, "linewidth": 0.0}
        band = ax.fill_between(time, mean - half, mean + half, **filled)
        (middle,) = ax.plot(time, mean, color=INK, linewidth=1.0)
        ax.set(xlabel="$t$", ylabel=name, xlim=(time[0], time[-1]))
        few = "" if len(shown) == len(complete) else f"{len(shown)} of "
        labels = [f"{few}{len(complete)} members", "95 % interval of the mean", "mean"]
        for handle in legend(ax, [lines[0], band, middle], labels).get_lines():
            handle.set_alpha(1.0)
        ax.margins(y=0.05)
    return ax
