"""How much memory a run will take: the arrays of the scene, the state, samples and the ledger."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tribo.integrators.methods import Method
from tribo.kernels.samples import STORED
from tribo.run.layout import Layout
from tribo.run.quantities import (
    ASPERITE_QUANTITIES,
    FURTHER_OF_ASPERITES,
    OPTIONAL_QUANTITIES,
    reported,
)
from tribo.run.streamed_ledger import PORTION_BYTES, is_streamed

# Bytes of a number.
NUMBER = 8
# Vectors of coordinates, velocities and accounts that a step keeps, beside one for each of its
# evaluations: the state, its rounding errors and rates of change, and a copy.
VECTORS = 6
# Ledgers that are held at once, in units of that of the run: with its terms, and where runs are
# compared with that of the other run too.  Measured by benchmarks/predictions.py on rows and grids.
LEDGERS = 1.9
LEDGERS_COMPARED = 3.2
# Bytes of all that does not grow with the scene, without and with runs compared; measured there on
# pairs.
LEAST = 50_000
LEAST_COMPARED = 1_300_000


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
    samples, raw, row = layout.times.size, _raw_sample(layout), _ledger_row(layout)
    if kept:
        series = LEAST_COMPARED + kept * raw + samples * LEDGERS_COMPARED * row
    elif is_streamed(layout, samples):
        series = float(PORTION_BYTES) + samples * _kept_row(layout)
    else:
        series = LEAST + samples * (raw + LEDGERS * row)
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


def _ledger_row(layout: Layout) -> int:
    """Bytes of one time of the ledger."""
    optional = any(s.langevin for s in layout.scene.surfaces) or bool(layout.scene.fields)
    names = reported(layout.scene.output.ledger, optional, optional).asperites
    further = sum(s.count * len(layout.further[s.name]) for s in layout.scene.surfaces)
    return NUMBER * (len(names) * layout.scene.count + further)


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
