"""What an experiment shows of a run: friction, its loops, maps of asperites, contacts over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.model.surface import Surface
from tribo.plotting.curves import ASPECT, COLOURS, finish
from tribo.plotting.marks import with_minus
from tribo.plotting.pose import nearest_sample
from tribo.plotting.style import COLUMN, INK, MEDIUM, NOTE_SIZE, drawing_on, figure_of
from tribo.results.averages import mean_text
from tribo.results.contacts import contacts
from tribo.results.force_averages import friction_force
from tribo.results.friction_loop import loop
from tribo.results.maps import friction_map
from tribo.results.run_result import RunResult
from tribo.validation import InputError, one_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# What a map of forces shows.
FORCES = ("friction", "normal")
# Decimals of places, relative to the extent of all, within which two are one.
SAME_PLACE = 9
# Discs that a figure in vectors has at most; more are an image in it.
MOST_VECTORS = 2000
# Height that a map's title and labels take, relative to the width of its figure.
ROOM_OF_MAP = 0.25


def draw_loop(result: RunResult, surface: str, position: object, ax: Axes | None) -> Axes:
    """Draw the force over the position, from the first cycle on, with the mean forces both ways."""
    found = loop(result, surface, position=position)
    later = result.t >= float(found.cycles["begin"].min())
    with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
        ax.plot(found.position[later], found.force[later], color=COLOURS[0], linewidth=0.9)
        for mean in (found.forward.mean, found.backward.mean):
            ax.axhline(mean, color=COLOURS[1], linewidth=0.8, linestyle="--")
        area = mean_text(found.area.mean, found.area.half_width, "±")
        ax.set_title(with_minus(f"area {area}"), fontsize=NOTE_SIZE)
        ax.set(xlabel="position", ylabel=f"force on {surface}")
    return ax


def draw_map(result: RunResult, surface: str, force: str, ax: Axes | None) -> Axes:
    """Draw the mean force of each asperite in colour, where its bob rests; of a row, over x."""
    one_of("force", force, FORCES)
    found = friction_map(result, surface)
    values = found[force].values
    if np.ptp(found["z"].values) > 0.0:
        return _draw_colours(result, surface, values, f"mean {force} force on {surface}", ax)
    with drawing_on(ax, COLUMN, 0.5 * COLUMN) as ax:
        ax.plot(found["x"].values, values, "o", color=COLOURS[0], markersize=3.0)
        ax.axhline(0.0, color=INK, linewidth=0.5)
        ax.set(xlabel="$x$", ylabel=f"mean {force} force")
        ax.set_title(surface, fontsize=NOTE_SIZE)
    return ax


def draw_contacts(result: RunResult, surface: str, ax: Axes | None) -> Axes:
    """Draw the share of asperites in contact over time."""
    found = contacts(result, surface)
    with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
        ax.plot(found["time"], found["share"], color=COLOURS[0], linewidth=0.9)
        ax.set(xlabel="$t$", ylabel=f"share of {surface} in contact", ylim=(0.0, 1.02))
        ax.set_xlim(float(result.t[0]), float(result.t[-1]))
    return ax


def draw_friction(result: RunResult, name: str, after: float | str | None, ax: Axes | None) -> Axes:
    """Draw the friction force on a surface over time, with its average and interval."""
    found = friction_force(result, name, after)
    with drawing_on(ax, COLUMN, ASPECT * COLUMN) as ax:
        mean = with_minus(mean_text(found.mean, found.half_width, "±"))
        label = f"mean {mean} (95 %)" if np.isfinite(found.half_width) else f"mean {mean}"
        low = found.mean - found.half_width
        high = found.mean + found.half_width
        later = [found.after, result.t[-1]]
        ax.plot(result.t, result[name].friction_force, color=COLOURS[0], linewidth=MEDIUM)
        ax.plot(later, [found.mean] * 2, color=COLOURS[1], linewidth=MEDIUM, label=label)
        ax.fill_between(later, low, high, color=COLOURS[1], alpha=0.3, linewidth=0.0)
        finish(ax, result, f"friction force on {name}")
    return ax


def draw_grid(
    result: RunResult, name: str, quantity: str, t: float | None, ax: Axes | None
) -> Axes:
    """Draw a quantity of every asperite of a grid in colour, over x and z."""
    sample = -1 if t is None else nearest_sample(result, t)
    table = result[name]
    if not _is_grid(result.scene.surfaces[result.scene.index_of(name)]):
        raise InputError("surface", f'must be a grid, got "{name}"')
    if quantity == "height":  # which is no series
        heights = _resting_bobs(result, name)[:, 1]
        title = f"height of {name}"
        return _draw_colours(result, name, heights - heights.mean(), title, ax, signed=False)
    if quantity in table and table[quantity].ndim == 2:
        return _draw_colours(result, name, table[quantity][sample], f"{quantity} of {name}", ax)
    raise InputError(
        "quantity",
        f'must be "height" or a series of each asperite, as "w1", got {quantity!r}; '
        'forces need output.series = "forces"',
    )


def _draw_colours(
    result: RunResult,
    name: str,
    values: np.ndarray,
    title: str,
    ax: Axes | None,
    signed: bool = True,
) -> Axes:
    """Draw values (n,) of the asperites of a surface in colour, over x and z of the resting bobs.

    Cells of a grid meet; elsewhere discs do not overlap.  Of signed values, zero is white.
    """
    surface = result.scene.surfaces[result.scene.index_of(name)]
    places = _resting_bobs(result, name)[:, [0, 2]]
    look: dict[str, Any] = {"cmap": "viridis"}
    if signed:
        strongest = float(np.percentile(np.abs(values), 99.5)) or 1.0  # no outlier decides
        look = {"cmap": "RdBu_r", "clim": (-strongest, strongest)}
    width, depth = np.ptp(places, axis=0)
    height = min(0.8, ROOM_OF_MAP + depth / max(width, depth)) * COLUMN
    with drawing_on(ax, COLUMN, height) as ax:
        if _is_grid(surface):
            look |= {"shading": "nearest", "rasterized": True}
            x = places[: surface.shape[0], 0]
            z = places[:: surface.shape[0], 1]
            image: Any = ax.pcolormesh(x, z, values.reshape(z.size, x.size), **look)
        else:
            image = _discs(ax, places, values, look)
        ax.set(xlabel="$x$", ylabel="$z$", aspect="equal")
        ax.tick_params(which="both", top=False, right=False)
        inset = ax.inset_axes((1.03, 0.0, 0.04, 1.0))
        extend = "both" if signed else "neither"
        figure_of(ax).colorbar(image, cax=inset, extend=extend, extendfrac=0.03)
        # A label beside the colours would be longer than they are high where a grid is narrow.
        ax.set_title(title, fontsize=NOTE_SIZE)
    return ax


def _discs(ax: Axes, places: np.ndarray, values: np.ndarray, look: dict[str, Any]) -> Any:
    """Draw discs at places (n, 2), each at most as wide as the way to its nearest neighbour."""
    from matplotlib.collections import EllipseCollection
    from scipy.spatial import KDTree

    extent = float(np.ptp(places, axis=0).max()) or 1.0
    _, first = np.unique(np.round(places / extent, SAME_PLACE), axis=0, return_index=True)
    unlike = places[first]
    apart = np.full(len(places), extent)
    if len(unlike) > 1:  # those of several asperites at one place lie over one another
        tree = KDTree(unlike)
        nearest = tree.query(unlike, k=2)[0][:, 1]
        apart = nearest[tree.query(places)[1]]
    sizes = np.minimum(apart, np.median(apart))
    where: dict[str, Any] = {"offsets": places, "offset_transform": ax.transData, "units": "xy"}
    edge: dict[str, Any] = {"edgecolors": "0.5", "linewidths": 0.3}
    edge["rasterized"] = len(places) > MOST_VECTORS
    discs = EllipseCollection(sizes, sizes, np.zeros(len(places)), **where, **edge, **look)
    discs.set_array(values)
    ax.add_collection(discs, autolim=False)
    low = places.min(axis=0) - sizes.max()
    high = places.max(axis=0) + sizes.max()
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    return discs


def _is_grid(surface: Surface) -> bool:
    """Whether asperites stand in rows and columns."""
    return surface.positions is None and min(surface.shape) > 1


def _resting_bobs(result: RunResult, name: str) -> np.ndarray:
    """(n, 3) places of the resting bobs of a surface, as in the series of the result."""
    index = result.scene.index_of(name)
    return result.scene.surfaces[index].resting_bobs(seed=[result.scene.seed, index, 0])
