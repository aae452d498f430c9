"""A mean over time with the band that it is known to, and the members that it is of."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo import plotting
from tribo.plotting import INK, WIDE
from tribo.validation import InputError

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

MEMBERS, BAND = "#7fadd0", "#d7301f"
SHOWN = 100  # members, of which more would only blacken the picture


def save(data: xarray.Dataset, name: str, path: Any) -> Path:
    """Draw one quantity, as "upper.W", into a .png, .pdf or .svg file; returns its path."""
    from matplotlib.figure import Figure

    with plotting.style():
        figure = Figure(figsize=(WIDE, 0.55 * WIDE), layout="constrained")
        mean_band(figure.add_subplot(), data, name)
        return plotting.write(figure, path)


def mean_band(ax: Axes, data: xarray.Dataset, name: str) -> None:
    """Draw members of an ensemble, faint, their mean and its interval.  Raises InputError."""
    if f"{name}_mean" not in data:
        known = [str(key)[:-5] for key in data.data_vars if str(key).endswith("_mean")]
        raise InputError("name", f"{name!r} is no mean; there are {', '.join(known)}")
    time = data["time"].values
    complete = data[name].values[data["status"].values == "completed"]
    shown = complete[:SHOWN]
    mean, half = data[f"{name}_mean"].values, data[f"{name}_half_width"].values
    opacity = min(1.0, max(0.15, 3.0 / len(shown)))
    faint: Any = {
        "color": MEMBERS,
        "linewidth": 0.5,
        "alpha": opacity,
    }
    lines = ax.plot(time, shown.T, **faint)
    band = ax.fill_between(time, mean - half, mean + half, color=BAND, alpha=0.45, linewidth=0.0)
    (middle,) = ax.plot(time, mean, color=INK, linewidth=1.0)
    ax.set(xlabel="$t$", ylabel=name, xlim=(time[0], time[-1]))
    few = "" if len(shown) == len(complete) else f"{len(shown)} of "
    labels = [f"{few}{len(complete)} members", "95 % interval of the mean", "mean"]
    legend = ax.legend([lines[0], band, middle], labels, frameon=False, loc="best")
    for handle in legend.get_lines():
        handle.set_alpha(1.0)
    ax.margins(y=0.05)
