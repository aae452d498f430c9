"""How much memory a run will take: the arrays of the scene, the state, and samples."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tribo.accuracy.extremes import BYTES, PORTION
from tribo.accuracy.stop_times import PARTS
from tribo.integrators.methods import Method
from tribo.kernels.force_probe import ROWS
from tribo.kernels.samples import STORED
from tribo.layout.contact_distance import has_contact_distance
from tribo.layout.layout import Layout
from tribo.layout.loop_memory import scratch_bytes
from tribo.ledger.quantities import (
    ASPERITE_QUANTITIES,
    FURTHER_OF_ASPERITES,
    OPTIONAL_QUANTITIES,
)
from tribo.ledger.sinks import PORTION_BYTES, is_streamed
from tribo.ledger.watched import MOST_LOOKS

# Bytes of a number.
NUMBER = 8
# Vectors of coordinates, velocities and accounts that a step keeps, beside one for each of its
# evaluations: the state, its rounding errors and rates of change, and a copy.
VECTORS = 6
# Bytes that are held while the last values are computed, in units of the samples, beside these;
# measured by benchmarks/predictions.py on rows and grids.  Series that are read need more.
ENDS = 0.45
# Arrays that are held while contacts are looked for, in units of the places of all bobs; measured
# by tracemalloc on two grids of 50 x 50.
PLACES = 2.5
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
    series, last = 0.0, 0.0
    if is_streamed(layout, samples):
        series += PORTION_BYTES + samples * _kept_row(layout)
    else:
        last = max(_for_notes(layout, samples), _for_forces(layout, samples))
    if kept:
        stops = max(samples, PARTS + 1)
        compared = min(PORTION, BYTES * stops * layout.scene.count)
        series += LEAST_COMPARED + kept * raw + max(compared, last)
    elif series == 0.0:
        series += LEAST + samples * raw + max(ENDS * samples * raw, last)
    return round(scene_bytes(layout, method, stages) + series)


def scene_bytes(layout: Layout, method: Method, stages: int) -> int:
    """Bytes of the arrays of a scene and of its state, without samples."""
    vectors = VECTORS if method.splits else VECTORS + stages
    coordinates, accounts = layout.room
    state = NUMBER * vectors * (2 * coordinates + accounts)
    neighbours = layout.neighbours(method.splits)
    tables = (layout.model, neighbours, layout.asperites, layout.surfaces)
    held = _bytes_of(tables) + scratch_bytes(layout.model)
    return state + held + _bytes_of_rotations(layout, method, stages)


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


def _for_notes(layout: Layout, samples: int) -> float:
    """Bytes that are held while contacts are looked for, in some of many samples."""
    return _places(layout, min(samples, MOST_LOOKS))


def _for_forces(layout: Layout, samples: int) -> float:
    """Bytes of the forces in all samples and of what their averages need, if they are recorded."""
    if "forces" not in layout.scene.output.series:
        return 0.0
    found = NUMBER * samples * ROWS * layout.model.each.shape[1]
    return found + _places(layout, samples)


def _places(layout: Layout, samples: int) -> float:
    """Bytes of the places of bobs in so many samples; 0 where no contact has a range."""
    scene = layout.scene
    if not any(has_contact_distance(scene, surface) for surface in scene.surfaces):
        return 0.0
    return PLACES * 3 * NUMBER * samples * scene.count


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
