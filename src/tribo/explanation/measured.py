"""What is measured on a loop before a run: its speed, its arrays, and whether it was compiled."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numba import config

from tribo.accuracy.extremes import BYTES, PORTION
from tribo.accuracy.run_time import evaluation_time
from tribo.accuracy.stop_times import PARTS
from tribo.compiler.jit import time_loop
from tribo.integrators.methods import Method
from tribo.kernels.force_probe import ROWS
from tribo.layout.layout import Layout
from tribo.ledger.quantities import ASPERITE_QUANTITIES, FURTHER_OF_ASPERITES, OPTIONAL_QUANTITIES
from tribo.ledger.sinks import PORTION_BYTES, is_streamed
from tribo.loops.general import GeneralLoop
from tribo.loops.pair import has_pair_loop
from tribo.pair.loop import pair_collocation
from tribo.plugins.sources import source_stamp

# Time of the run that measures a speed, by the model of costs [s].
MEASURED = 0.05
# Bytes of a number.
NUMBER = 8


def compilations(layout: Layout, method: Method) -> int:
    """How often the loop of a scene and a method was compiled in this process."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return 0
    loop = pair_collocation if has_pair_loop(layout, method) else method.loop
    compiled: Any = time_loop(loop, source_stamp(layout.plugins))
    return sum(compiled.stats.cache_misses.values())


def seconds_of_evaluation(layout: Layout, method: Method, step: float, threads: int) -> float:
    """Of a short run with a given step from the start."""
    loop = GeneralLoop(layout, method, step, layout.start, 0.0, threads)
    steps = max(1, int(1e9 * MEASURED / evaluation_time(layout, method)))
    columns = loop.room(layout.times.size + 1)
    loop.advance(layout.times, columns, 1)
    before, began = int(loop.clocks["evaluations"][0]), time.perf_counter()
    loop.advance(layout.times, columns, steps)
    seconds = time.perf_counter() - began
    return seconds / max(1, int(loop.clocks["evaluations"][0]) - before)


def inactive_at_start(layout: Layout, method: Method) -> int:
    """Number of asperites that a run does not step at its start."""
    if not method.splits:
        return 0
    loop = GeneralLoop(layout, method, 1.0, layout.start, 0.0)
    loop.advance(layout.times[-1:], loop.room(1), 0)
    return loop.inactive


def bytes_of_run(layout: Layout, method: Method, samples: int, compared: bool) -> int:
    """Bytes of the arrays of a scene, of its loop and of so many samples in all runs.

    With what comparing runs takes, if they are compared.
    """
    loop = GeneralLoop(layout, method, 1.0, layout.start, 0.0)
    found = _bytes_in((vars(loop), layout.asperites, layout.surfaces), set())
    times = layout.times.size
    if is_streamed(layout, times):
        found += PORTION_BYTES + NUMBER * times * _kept_numbers(layout)
        samples -= times
    found += max(0, samples) * _bytes_in(loop.room(1), set())
    if compared:
        found += min(PORTION, BYTES * max(times, PARTS + 1) * layout.scene.count)
    if "forces" in layout.scene.output.series:
        found += NUMBER * times * ROWS * layout.model.each.shape[1]
    return found


def _kept_numbers(layout: Layout) -> int:
    """Numbers that ``output.keep`` names, at one time."""
    names = [name.rpartition(".") for name in layout.scene.output.keep or ()]
    counts = {s.name: s.count for s in layout.scene.surfaces}
    of_asperites = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES | FURTHER_OF_ASPERITES
    return sum(counts[s] if n in of_asperites else 1 for s, _, n in names)


def _bytes_in(item: Any, seen: set[int]) -> int:
    """Bytes of all arrays in nested tuples and dictionaries, each array once."""
    if isinstance(item, np.ndarray):
        new = id(item) not in seen
        seen.add(id(item))
        return item.nbytes if new else 0
    parts = item.values() if isinstance(item, dict) else item
    return sum(_bytes_in(p, seen) for p in parts) if isinstance(item, (dict, tuple)) else 0
