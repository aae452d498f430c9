"""A quantity of a sweep against one of its keys."""

from __future__ import annotations

from itertools import cycle, product
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.ledger.quantities import AVERAGED
from tribo.plotting.curves import COLOURS, DASHES, legend
from tribo.plotting.style import COLUMN, NOTE_SIZE, WIDE, drawing_on
from tribo.results.averages import interval
from tribo.validation import InputError, one_of

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

# What error bars show, by the ending of the variable that has them, the first that there is.
BARS = {
    "_half_width": "95 % interval of the mean over members",
    "_time_half_width": "95 % interval of the average over time",
    "_error": "error estimate",
}
# The key whose values are samples.
SEED = "seed"


def sweep_lines(
    data: xarray.Dataset, name: str, against: str | None = None, ax: Axes | None = None
) -> Axes:
    """Draw a quantity against one key, with intervals and a line for each value of the others.

    Seeds are samples: of points that differ in nothing else, the mean and its interval are drawn.

    Parameters
    ----------
    data : xarray.Dataset
        The data set that :func:`tribo.sweep` returns.
    name : str
        A quantity with one value at each point, as "upper.W" or "upper.friction_force"; with
        members their mean is drawn.  Also a quantity of asperites, as "upper.w1", if the surface
        has one.
    against : str, optional
        The key on the horizontal axis; by default the first.  Of keys that are swept together, each
        is possible.
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure.
    """
    from matplotlib.ticker import NullLocator

    data = with_single_asperites_as_numbers(data)
    dimensions = keys_of(data)
    one_of("name", name, quantities(data))
    places_of = {key: dimension for dimension in dimensions for key in keys_on(data, dimension)}
    if against in dimensions:  # also by the name of keys that are swept together
        against = keys_on(data, against)[0]
    key = next(iter(places_of)) if against is None else one_of("against", against, places_of)
    drawn, bars, meaning = _points(data, name, averaged=places_of[key] != SEED)
    others = [other for other in dimensions if other != places_of[key] and other in drawn.dims]
    lines = list(product(*(range(data.sizes[other]) for other in others)))
    if len(lines) > 12:  # more cannot be told apart
        raise InputError("data", f"has {len(lines)} lines; select values with data.sel or isel")
    with drawing_on(ax, WIDE, 0.55 * WIDE) as ax:
        values = data[key].values
        numbers = values.dtype.kind in "fiu"
        places = values if numbers else values.astype(str)  # or categories
        order = np.argsort(values, kind="stable") if numbers else np.arange(values.size)
        # Points of one value differ in keys that are swept together with this one; words have no
        # values between them.
        joined = numbers and len({*values.tolist()}) == values.size
        for number, indices in enumerate(lines):
            at = dict(zip(others, indices, strict=True))
            half = None if bars is None else bars.isel(at).values[order]
            beside = [other for other in places_of if places_of[other] in others]
            label = ", ".join(f"{k} = {data[k].values[at[places_of[k]]]}" for k in beside)
            how: Any = {"marker": "o", "markersize": 3.0, "capsize": 2.0, "linewidth": 1.0}
            how["linestyle"] = DASHES[number % len(DASHES)] if joined else "none"
            ax.errorbar(places[order], drawn.isel(at).values[order], half, label=label, **how)
        at_end = "" if name.rpartition(".")[2] in AVERAGED else " at the end"
        ax.set(xlabel=key, ylabel=f"{name}{at_end}")
        if not numbers:
            ax.xaxis.set_minor_locator(NullLocator())
        title = f"bars: {meaning}" if meaning else None
        if others:
            legend(ax, title=title)
        elif title is not None:
            ax.set_title(title, fontsize=NOTE_SIZE)
    return ax


def _points(
    data: xarray.Dataset, name: str, averaged: bool
) -> tuple[xarray.DataArray, xarray.DataArray | None, str]:
    """What is drawn, its error bars, and what these show; `averaged` over seeds or not."""
    drawn = data[f"{name}_mean" if f"{name}_mean" in data else name]
    if averaged and data.sizes.get(SEED, 0) > 1:
        found = interval(drawn.transpose(SEED, ...).values)
        one = drawn.isel({SEED: 0})
        meaning = "95 % interval of the mean over seeds"
        return one.copy(data=found.mean), one.copy(data=found.half_width), meaning
    ending = next((end for end in BARS if f"{name}{end}" in data), None)
    return (drawn, None, "") if ending is None else (drawn, data[f"{name}{ending}"], BARS[ending])


def ends(data: xarray.Dataset) -> xarray.DataArray:
    """The statuses of the runs, or else of the points."""
    return data["status" if "status" in data else "point_status"]


def keys_of(data: xarray.Dataset) -> list[str]:
    """The dimensions of the points: keys, or a short name of several that are swept together."""
    return [str(key) for key in ends(data).dims if key != "member"]


def keys_on(data: xarray.Dataset, dimension: str) -> list[str]:
    """The keys whose values are along a dimension of the points, in order.

    Before version 0.3 the dimension of several keys had their names, with commas.
    """
    if dimension in data.coords:
        return [dimension]
    own = [str(name) for name in data.coords if data[name].dims == (dimension,)]
    return own or dimension.split(",")


def with_single_asperites_as_numbers(data: xarray.Dataset) -> xarray.Dataset:
    """The same without the dimensions of surfaces that have one asperite."""
    sizes = {str(name): size for name, size in data.sizes.items()}
    single = [name for name, size in sizes.items() if name.endswith("_asperite") and size == 1]
    return data.squeeze(single, drop=True)


def quantities(data: xarray.Dataset) -> list[str]:
    """The quantities that have one value at each point, or a mean over its members."""
    keys = tuple(keys_of(data))
    data = with_single_asperites_as_numbers(data)
    names = [str(name) for name in data.data_vars if data[name].dims == keys]
    means = [name.removesuffix("_mean") for name in names if name.endswith("_mean")]
    return means or [name for name in names if "." in name and not name.endswith(tuple(BARS))]


def _label(axis: xarray.DataArray) -> str:
    """The label of an axis of a friction law."""
    return str(axis.attrs.get("long_name", axis.name))


def law_lines(data: xarray.Dataset, against: str | None = None, ax: Axes | None = None) -> Axes:
    """Draw a friction law, one line with its 95 % intervals for each of the other values.

    Parameters
    ----------
    data : xarray.Dataset
        The data set that :func:`tribo.friction_law` returns.
    against : str, optional
        "load", "speed" or "temperature"; by default the first that has several values.  Speeds
        are on a logarithmic axis if they range over a decade or more.
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure of the width of a column.
    """
    names = [str(name) for name in data["friction"].dims]
    several = [name for name in names if data.sizes[name] > 1]
    name = (several or names)[0] if against is None else one_of("against", against, names)
    others = [other for other in names if other != name]
    lines = list(product(*(range(data.sizes[other]) for other in others)))
    if len(lines) > 12:  # more cannot be told apart
        raise InputError("data", f"has {len(lines)} lines; select values with data.sel or isel")
    with drawing_on(ax, COLUMN, 0.75 * COLUMN) as ax:
        places = data[name].values
        for indices, colour in zip(lines, cycle(COLOURS), strict=False):
            at = dict(zip(others, indices, strict=True))
            own = data.isel(at)
            labels = [f"{_label(data[k])} {data[k].values[at[k]]:g}" for k in others]
            half_width = own["friction_half_width"].values
            style: Any = {"marker": "o", "markersize": 3.0, "capsize": 2.0, "linewidth": 1.0}
            style |= {"color": colour, "label": ", ".join(labels)}
            ax.errorbar(places, own["friction"].values, half_width, **style)
        ax.set(xlabel=_label(data[name]), ylabel=f"friction on {data.attrs['surface']}")
        if name == "speed" and np.ptp(np.log10(np.abs(places))) >= 1.0:
            ax.set_xscale("log")
        if others:
            legend(ax)
    return ax
