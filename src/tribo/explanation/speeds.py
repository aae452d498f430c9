"""The speed of time loops on this machine: measured once, and kept beside their machine code.

Speeds are for display only.
"""

from __future__ import annotations

import json
import time
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba import config

from tribo.accuracy.run_time import evaluation_time, pairs_of_bobs
from tribo.compiler.jit import code_stamp, time_loop
from tribo.explanation.prediction import Search
from tribo.integrators.methods import Method
from tribo.layout.layout import Layout
from tribo.loops.general import GeneralLoop
from tribo.loops.pair import has_pair_loop
from tribo.pair.loop import pair_collocation
from tribo.plugins.sources import source_stamp
from tribo.system import replace

# Name of the file, in the folder of the machine code.
FILE = "speeds.json"
# Time of the run that measures a speed, by the model of costs [s].
MEASURED = 0.05


def loop_of(layout: Layout, method: Method) -> Any:
    """The compiled loop of a scene and a method."""
    loop = pair_collocation if has_pair_loop(layout, method) else method.loop
    return time_loop(loop, source_stamp(layout.plugins))


def compilations(loop: Any) -> int:
    """How often a loop was compiled in this process."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return 0
    return sum(loop.stats.cache_misses.values())


def kept_speed(layout: Layout, method: Method, threads: int, measure: Callable[[], float]) -> float:
    """Nanoseconds of an evaluation of a scene of this kind; measured if none are kept."""
    path = path_of(layout, method)
    kept = _read(path)
    key = _kind(layout, method, threads)
    if key not in kept:
        kept[key] = measure()
        _write(path, kept)
    return kept[key]


def measured(search: Search, step: float) -> float:
    """Nanoseconds of an evaluation, by a short run with a given step from the start."""
    layout, method = search.layout, search.method
    loop = GeneralLoop(layout, method, step, layout.start, 0.0, search.threads)
    steps = max(1, int(1e9 * MEASURED / evaluation_time(layout, method)))
    times = layout.times
    columns = loop.room(times.size + 1)
    loop.advance(times, columns, 1)
    before, began = int(loop.clocks["evaluations"][0]), time.perf_counter()
    loop.advance(times, columns, steps)
    seconds = time.perf_counter() - began
    return 1e9 * seconds / max(1, int(loop.clocks["evaluations"][0]) - before)


def inactive_at_start(layout: Layout, method: Method) -> int:
    """Number of asperites that a run does not step at its start."""
    if not method.splits:
        return 0
    loop = GeneralLoop(layout, method, 1.0, layout.start, 0.0)
    loop.advance(layout.times[-1:], loop.room(1), 0)
    return loop.inactive


def path_of(layout: Layout, method: Method) -> Path | None:
    """The file beside the machine code; None where that is not kept."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return None
    folder = loop_of(layout, method).stats.cache_path
    return None if folder is None else Path(folder) / FILE


def _kind(layout: Layout, method: Method, threads: int) -> str:
    """What the speed of a scene depends on, in one line."""
    scene = layout.scene
    pairs, listed = pairs_of_bobs(layout)
    potentials = [type(item.potential).__name__ for item in scene.interactions]
    sizes = f"{scene.count} {layout.coordinates} {pairs}{' listed' if listed else ''}"
    sizes += f" threads {threads}"
    return " ".join([method.name, sizes, *potentials, *sorted(scene.effects)])


def _read(path: Path | None) -> dict[str, float]:
    """The speeds of this version of the package."""
    try:
        table = json.loads(path.read_text(encoding="utf-8")) if path is not None else {}
        return {str(key): float(ns) for key, ns in table.get(code_stamp(), {}).items()}
    except (OSError, ValueError, AttributeError):
        return {}


def _write(path: Path | None, speeds: dict[str, float]) -> None:
    """Keep the speeds, if the folder can be written."""
    if path is None:
        return
    new = path.with_name(f"{path.name}.{uuid.uuid4().hex}")
    try:
        new.write_text(json.dumps({code_stamp(): speeds}, indent=1), encoding="utf-8")
        replace(new, path)
    except OSError:
        new.unlink(missing_ok=True)
