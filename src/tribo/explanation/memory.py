"""How much memory a run will take: the arrays of the scene, the state, and samples."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tribo.accuracy.extremes import BYTES, PORTION
from tribo.accuracy.stop_times import PARTS
from tribo.integrators.methods import Method
from tribo.kernels.samples import STORED
from tribo.run.layout import Layout
from tribo.run.quantities import (
    ASPERITE_QUANTITIES,
    FURTHER_OF_ASPERITES,
    OPTIONAL_QUANTITIES,
)
from tribo.run.streamed_ledger import PORTION_BYTES, is_streamed

# Bytes of a number.
NUMBER = 8
# Vectors of coordinates, velocities and accounts that a step keeps, beside one for each of its
# evaluations: the state, its rounding errors and rates of change, and a copy.
VECTORS = 6
# Bytes that are held while the last values are computed, in units of the samples; measured by
# benchmarks/predictions.py on rows and grids.  Series that are read need more.
SAMPLES_AND_ENDS = 1.45
# Bytes of all that does not grow with the scene, without and with runs compared; measured there on
# pairs.
LEAST = 110_000
LEAST_COMPARED = 250_000


def memory_of_run(layout: Layout, method: Method, stages: int, kept: int) -> int:
    """Bytes of all arrays that a run holds at once, at most.

    Parameters
    ----------
    layout : Layout
        The scene.
    method : Method
        How time advances.
    stages : int
        Evaluations of all forces in a step.
    kept : int
        Samples of all runs of a search for settings, which are kept; 0 without one.

    Returns
    -------
    int
    """
    samples, raw = layout.times.size, _raw_sample(layout)
    series = 0.0
    if is_streamed(layout, samples):
        series += PORTION_BYTES + samples * _kept_row(layout)
    if kept:
        stops = max(samples, PARTS + 1)
        compared = min(PORTION, BYTES * stops * layout.scene.count)
        series += LEAST_COMPARED + kept * raw + compared
    elif series == 0.0:
        series += LEAST + SAMPLES_AND_ENDS * samples * raw
    return round(scene_bytes(layout, method, stages) + series)


def scene_bytes(layout: Layout, method: Method, stages: int) -> int:
    """Bytes of the arrays of a scene and of its state, without samples."""
    vectors = VECTORS if method.splits else VECTORS + stages
    coordinates, accounts = layout.room
    state = NUMBER * vectors * (2 * coordinates + accounts)
    tables = (layout.model, layout.neighbours(method.splits), layout.asperites, layout.surfaces)
    return state + _bytes_of(tables) + _bytes_of_rotations(layout, method, stages)


def _bytes_of_rotations(layout: Layout, method: Method, stages: int) -> int:
    """Bytes of what splitting methods keep of their baths' rotations in each kick of a step."""
    if not method.splits:
        return 0
    baths = (layout.model.bath, layout.model.torsional)
    return 3 * stages * sum(table[0].nbytes for table in baths if table is not None)


def _raw_sample(layout: Layout) -> int:
    """Bytes of one sample of a time loop."""
    own = 2 * layout.core + layout.accounts + 2 + math.prod(layout.sampled_baths)
    return NUMBER * (own + STORED * len(layout.scene.surfaces))


def _kept_row(layout: Layout) -> int:
    """Bytes of one time of what ``output.keep`` names, of asperites and while it is joined."""
    names = [name.rpartition(".") for name in layout.scene.output.keep or ()]
    counts = {s.name: s.count for s in layout.scene.surfaces}
    of_asperites = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES | FURTHER_OF_ASPERITES
    return 2 * NUMBER * sum(counts[s] if n in of_asperites else 1 for s, _, n in names)


def _bytes_of(item: Any) -> int:
    """Bytes of all arrays in nested tuples."""
    if isinstance(item, np.ndarray):
        return item.nbytes
    return sum(_bytes_of(part) for part in item) if isinstance(item, tuple) else 0
