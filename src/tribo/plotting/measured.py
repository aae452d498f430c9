"""What an experiment shows of a run: friction, its loops, maps of asperites, contacts over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.layout.scene_records import resting_bobs
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
# Asperites up to which each has a mark of the largest size [points].
MARK = 14.0


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
    """Draw the mean force of each asperite in colour, where its bob rests."""
    one_of("force", force, FORCES)
    found = friction_map(result, surface)
    values = found[force].values
    strongest = float(np.percentile(np.abs(values), 99.5)) or 1.0
    x, z = found["x"].values, found["z"].values
    is_grid = np.ptp(z) > 0.0
    with drawing_on(ax, COLUMN, (0.8 if is_grid else 0.5) * COLUMN) as ax:
        size = min(MARK, 200.0 / max(2.0, values.size ** (0.5 if is_grid else 1.0)))
        marks: dict[str, Any] = {"c": values, "s": size**2, "marker": "s", "linewidths": 0.0}
        colours: dict[str, Any] = {"cmap": "RdBu_r", "vmin": -strongest, "vmax": strongest}
        image = ax.scatter(x, z if is_grid else values, **marks, **colours)
        if is_grid:
            ax.set(ylabel="$z$", aspect="equal")
        else:
            ax.axhline(0.0, color=INK, linewidth=0.5)
            ax.set(ylabel=f"mean {force} force")
        ax.set(xlabel="$x$")
        inset = ax.inset_axes((1.03, 0.0, 0.04, 1.0))
        figure_of(ax).colorbar(image, cax=inset).set_label(f"mean {force} force on {surface}")
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
        label = with_minus(mean_text(found.mean, found.half_width, "±"))
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
    index = [each.name for each in result.scene.surfaces].index(name)
    grid = result.scene.surfaces[index]
    table = result[name]
    if grid.positions is not None or min(grid.shape) < 2:
        raise InputError("surface", f'must be a grid, got "{name}"')
    bobs = resting_bobs(result.scene, index).reshape(*grid.shape[::-1], 3)
    if quantity == "height":  # which is no series
        values = bobs[..., 1] - bobs[..., 1].mean()
        look: dict[str, Any] = {"cmap": "viridis"}
    elif quantity in table and table[quantity].ndim == 2:
        values = table[quantity][sample].reshape(bobs.shape[:2])
        strongest = np.percentile(np.abs(values), 99.5) or 1.0  # no outlier decides
        look = {"cmap": "RdBu_r", "vmin": -strongest, "vmax": strongest}
    else:
        raise InputError(
            "quantity",
            f'must be "height" or a series of each asperite, as "w1", got {quantity!r}; '
            'forces need output.series = "forces"',
        )
    with drawing_on(ax, COLUMN, 0.8 * COLUMN) as ax:
        look |= {"shading": "nearest", "rasterized": True}
        image = ax.pcolormesh(bobs[0, :, 0], bobs[:, 0, 2], values, **look)
        ax.set(xlabel="$x$", ylabel="$z$", aspect="equal")
        ax.tick_params(which="both", top=False, right=False)
        extend = "neither" if quantity == "height" else "both"
        inset = ax.inset_axes((1.03, 0.0, 0.04, 1.0))
        bar = figure_of(ax).colorbar(image, cax=inset, extend=extend, extendfrac=0.03)
        bar.set_label(f"{quantity} of {name}")
    return ax
