"""How much memory a run will take: the arrays of the scene, the state, samples and the ledger."""

from __future__ import annotations

from typing import Any

import numpy as np

from tribo.accuracy.stop_times import StopTimes
from tribo.integrators.methods import Method
from tribo.kernels.samples import STORED
from tribo.run.layout import Layout
from tribo.run.quantities import ASPERITE_QUANTITIES, OPTIONAL_QUANTITIES
from tribo.run.streamed_ledger import PORTION_BYTES, exceeds_memory

# Bytes of a number.
NUMBER = 8
# Vectors of coordinates, velocities and accounts that a step keeps, beside one for each of its
# evaluations: the state, its rounding errors and rates of change, and a copy.
VECTORS = 6
# Ledgers of the fine run that are held at once: its own, and a part of it beside the run compared.
LEDGERS = 2.5


def memory_of_run(layout: Layout, method: Method, evaluations_of_step: int, step: bool) -> int:
    """Bytes of all arrays that a run holds at once, at most.

    Parameters
    ----------
    layout : Layout
        The scene.
    method : Method
        How time advances.
    evaluations_of_step : int
        Evaluations of all forces in a step.
    step : bool
        Whether the step is given; runs with an accuracy are compared with coarser ones.

    Returns
    -------
    int
    """
    kept = VECTORS if method.splits else VECTORS + min(evaluations_of_step, 2 + 2 * method.order)
    state = NUMBER * kept * (2 * layout.coordinates + layout.accounts)
    samples = layout.times.size
    if exceeds_memory(layout, samples):
        series = float(PORTION_BYTES)
    elif step:
        series = samples * (_raw_sample(layout) + LEDGERS * _ledger_row(layout))
    else:
        few, many, fine = (times.size for times in StopTimes.for_samples(layout.times))
        series = (2 * few + many + fine) * _raw_sample(layout)
        series += fine * LEDGERS * _ledger_row(layout)
    return round(_bytes_of(layout.model) + _bytes_of(layout.neighbours()) + state + series)


def _raw_sample(layout: Layout) -> int:
    """Bytes of one sample of a time loop."""
    own = 2 * layout.core + layout.accounts + 2
    return NUMBER * (own + STORED * len(layout.scene.surfaces))


def _ledger_row(layout: Layout) -> int:
    """Bytes of one time of the ledger."""
    optional = any(s.langevin for s in layout.scene.surfaces) or bool(layout.scene.fields)
    names = len(ASPERITE_QUANTITIES) + (len(OPTIONAL_QUANTITIES) if optional else 0)
    return NUMBER * names * layout.scene.count


def _bytes_of(item: Any) -> int:
    """Bytes of all arrays in nested tuples."""
    if isinstance(item, np.ndarray):
        return item.nbytes
    return sum(_bytes_of(part) for part in item) if isinstance(item, tuple) else 0
