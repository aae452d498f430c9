"""The heights of a surface: numbers, a roughness from which they are drawn, or a topography."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tribo.model.roughness import Roughness
from tribo.model.tables import from_table
from tribo.model.topography import Grid, Topography, as_topography, is_topography
from tribo.validation import inside, vector


def as_heights(value: object, grid: Grid) -> np.ndarray | Roughness | Topography | None:
    """The `heights` of a surface: (nx nz,) numbers [length], a roughness, a topography, or None.

    A topography of a file is kept with its heights at the asperites; of an object, the heights are
    kept alone.  Listed positions have the shape (n, 1) and the spacing (0, 0).
    """
    if value is None:
        return None
    shape, spacing, _ = grid
    if is_topography(value):
        with inside("heights"):
            topography = as_topography(value).on(grid)
        return topography if isinstance(topography.topography, str) else topography.heights
    if isinstance(value, (Roughness, Mapping)):
        with inside("heights"):
            roughness = from_table(Roughness, value, ["rms"])
            roughness.check(shape, spacing)
        return roughness
    return vector("heights", value, size=shape[0] * shape[1], unit="length")
