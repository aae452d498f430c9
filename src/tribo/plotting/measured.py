"""What an experiment shows of a run: friction loops, maps of mean forces, contacts over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting.curves import ASPECT, COLOURS
from tribo.plotting.marks import with_minus
from tribo.plotting.style import COLUMN, INK, NOTE_SIZE, drawing_on, figure_of
from tribo.results.averages import mean_text
from tribo.results.contacts import contacts
from tribo.results.friction_loop import loop
from tribo.results.maps import friction_map
from tribo.results.run_result import RunResult
from tribo.validation import one_of

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
