"""Maps of grids: a quantity of every asperite of a surface, over x and z."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.layout.scene_records import resting_bobs
from tribo.plotting.style import COLUMN, drawing_on, figure_of
from tribo.results.run_result import RunResult
from tribo.validation import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# The heights of a surface, which are no series.
HEIGHT = "height"
# Colours of heights, and of quantities that have a sign.
OF_HEIGHTS, OF_SIGNS = "viridis", "RdBu_r"
# Percentile of the magnitudes that has the strongest colour.
STRONGEST = 99.5
# Place of the scale of colours, in units of the map: left, bottom, width and height.
BAR = (1.03, 0.0, 0.04, 1.0)


def surface_map(
    result: RunResult, name: str, quantity: str, sample: int, ax: Axes | None = None
) -> Axes:
    """Draw a quantity of every asperite of a grid at a sample, over the place of its bob at rest.

    Raises InputError if the surface is no grid, or has no such series.
    """
    index = [surface.name for surface in result.scene.surfaces].index(name)
    surface = result.scene.surfaces[index]
    if surface.positions is not None or min(surface.shape) < 2:
        raise InputError("surface", f'must be a grid, got "{name}"')
    bobs = resting_bobs(result.scene, index).reshape(*surface.shape[::-1], 3)
    heights = bobs[..., 1] - bobs[..., 1].mean()
    values = heights if quantity == HEIGHT else _values(result, name, quantity, sample)
    values = values.reshape(heights.shape)
    strongest = np.percentile(np.abs(values), STRONGEST) or 1.0
    look: dict[str, Any] = {"cmap": OF_HEIGHTS}
    extend = "neither"
    if quantity != HEIGHT:
        look, extend = {"cmap": OF_SIGNS, "vmin": -strongest, "vmax": strongest}, "both"
    with drawing_on(ax, COLUMN, 0.8 * COLUMN) as ax:
        look |= {"shading": "nearest", "rasterized": True}
        image = ax.pcolormesh(bobs[0, :, 0], bobs[:, 0, 2], values, **look)
        ax.set(xlabel="$x$", ylabel="$z$")
        ax.set_aspect("equal")
        ax.tick_params(which="both", top=False, right=False)
        beside = ax.inset_axes(BAR)
        bar = figure_of(ax).colorbar(image, cax=beside, extend=extend, extendfrac=0.03)
        bar.set_label(f"{quantity} of {name}")
    return ax


def _values(result: RunResult, name: str, quantity: str, sample: int) -> np.ndarray:
    """A series of every asperite at a sample, (n,)."""
    table = result[name]
    if quantity not in table or table[quantity].ndim != 2:
        raise InputError(
            "quantity",
            f'must be "{HEIGHT}" or a series of each asperite, as "w1", got {quantity!r}; forces '
            'need output.series = "forces"',
        )
    return np.asarray(table[quantity][sample])
