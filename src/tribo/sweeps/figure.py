"""A quantity of a sweep against one of its keys."""

from __future__ import annotations

from itertools import product
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
# Markers of points that share a value on the horizontal axis, one after the other.
MARKERS = ("o", "s", "^", "D")
POINTS: dict[str, Any] = {"markersize": 3.0, "capsize": 2.0, "linewidth": 1.0}
OPEN_MARKS = "open marks: no interval"


def sweep_lines(
    data: xarray.Dataset, name: str, against: str | None = None, ax: Axes | None = None
) -> Axes:
    """Draw a quantity against one key, with intervals and a line for each value of the others.

    Seeds are samples: of points that differ in nothing else, the mean and its interval are drawn.
    Where other points have intervals, marks of those without are open.  Points at one place, which
    differ in a key that is swept together with this one, have different marks.

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
        groups = _groups(values, order)
        together = [other for other in keys_on(data, places_of[key]) if other != key]
        beside = [other for other in places_of if places_of[other] in others]
        has_open = False
        for number, indices in enumerate(lines):
            at = dict(zip(others, indices, strict=True))
            of_line = [f"{k} = {data[k].values[at[places_of[k]]]}" for k in beside]
            how: Any = POINTS | {"color": COLOURS[number]}
            how["linestyle"] = DASHES[number % len(DASHES)] if joined else "none"
            for marker, own in zip(MARKERS, groups, strict=False):
                of_group = [_listed(k, data[k].values[own]) for k in together if len(groups) > 1]
                how |= {"marker": marker, "label": ", ".join([*of_line, *of_group])}
                half = None if bars is None else bars.isel(at).values[own]
                has_open |= _draw_points(ax, places[own], drawn.isel(at).values[own], half, how)
        at_end = "" if name.rpartition(".")[2] in AVERAGED else " at the end"
        ax.set(xlabel=key, ylabel=f"{name}{at_end}")
        if not numbers:
            ax.xaxis.set_minor_locator(NullLocator())
        title = f"bars: {meaning}" if meaning else None
        if title is not None and has_open:
            title += f"; {OPEN_MARKS}"
        if others or len(groups) > 1:
            legend(ax, title=title)
        elif title is not None:
            ax.set_title(title, fontsize=NOTE_SIZE)
    return ax


def _groups(values: np.ndarray, order: np.ndarray) -> list[np.ndarray]:
    """The indices of points in groups of which none has a value twice, each in an order.

    All are in one group where there would be more groups than markers.
    """
    listed = values.tolist()
    number = dict.fromkeys(listed, 0)
    place = np.zeros(values.size, int)
    for k in order:
        place[k] = number[listed[k]]
        number[listed[k]] += 1
    if place.max() >= len(MARKERS):
        return [order]
    return [order[place[order] == group] for group in range(place.max() + 1)]


def _listed(key: str, values: np.ndarray) -> str:
    """A key and its values at the points of a group, of many the first and the last."""
    found = [str(value) for value in dict.fromkeys(values.tolist())]
    return f"{key} = {', '.join(found)}" if len(found) < 4 else f"{key} = {found[0]} to {found[-1]}"


def _draw_points(
    ax: Axes, x: np.ndarray, y: np.ndarray, half: np.ndarray | None, how: dict[str, Any]
) -> bool:
    """Draw points with their error bars; whether some of them have none, whose marks are open.

    Nothing is drawn, nor named in the legend, where no point is finite.
    """
    is_drawn = np.isfinite(y)
    if not np.any(is_drawn):
        return False
    ax.errorbar(x, y, half, **how)
    if half is None:
        return False
    is_open = is_drawn & ~np.isfinite(half)
    marks: dict[str, Any] = {"marker": how["marker"], "markersize": how["markersize"]}
    marks |= {"color": how["color"], "markerfacecolor": "white", "linestyle": "none"}
    ax.plot(x[is_open], y[is_open], zorder=3, **marks)
    return bool(np.any(is_open))


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
        has_open = False
        for indices, colour in zip(lines, COLOURS, strict=False):
            at = dict(zip(others, indices, strict=True))
            own = data.isel(at)
            labels = [f"{_label(data[k])} {data[k].values[at[k]]:g}" for k in others]
            half_width = own["friction_half_width"].values
            how = POINTS | {"marker": MARKERS[0], "color": colour, "label": ", ".join(labels)}
            has_open |= _draw_points(ax, places, own["friction"].values, half_width, how)
        ax.set(xlabel=_label(data[name]), ylabel=f"friction on {data.attrs['surface']}")
        if name == "speed" and np.ptp(np.log10(np.abs(places))) >= 1.0:
            ax.set_xscale("log")
        title = OPEN_MARKS if has_open else None
        if others:
            legend(ax, title=title)
        elif title is not None:
            ax.set_title(title, fontsize=NOTE_SIZE)
    return ax
