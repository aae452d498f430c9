"""How many threads share the work of one run, and how it is divided among them."""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
from numba import config

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.compiler.team import CLOSED, COUNTERS, OWN_NUMBERS, RANK, THREADS, Team
from tribo.integrators.methods import Method
from tribo.interrupts import held
from tribo.kernels.model import Tables
from tribo.model.scene import Scene
from tribo.system import THREADS_VARIABLE, available_cores
from tribo.validation import InputError, integer

# Chunks of rows of a pair of surfaces: one for so many asperites, and at most so many.  The
# reactions to neighbouring chunks overlap, so more chunks take longer.
ASPERITES_OF_CHUNK = 1250
MOST_CHUNKS = 16
# Tiles of all asperites, in which they drift and are kicked.
TILES = 48


class Threads(NamedTuple):
    """The number of threads of a run."""

    number: int
    why: str  # as the end of a sentence


def threads_of(model: Tables, method: Method, threads: int | None) -> Threads:
    """The number of threads of a run: as wanted, by TRIBO_THREADS, or that of cores.

    One where they do not pay.  Raises InputError if the number wanted is no positive integer.
    """
    wanted, why = wanted_threads(threads)
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return Threads(1, "since nothing is compiled")
    if not method.splits:
        return Threads(1, f"since {method.name} has one thread; splitting methods share their work")
    if model.team is None:
        return Threads(1, "since a step is too short to be shared")
    return Threads(min(wanted, TILES), why)


def wanted_threads(threads: int | None) -> tuple[int, str]:
    """The number of threads as given, by TRIBO_THREADS, or that of cores; and why.

    Raises InputError if it is no positive integer.
    """
    if threads is not None:
        return integer("threads", threads, 1), "as given"
    text = os.environ.get(THREADS_VARIABLE, "").strip()
    if not text:
        return available_cores(), "as many as there are cores"
    if not text.isdecimal() or int(text) < 1:
        raise InputError(THREADS_VARIABLE, f"must be a positive integer, got {text!r}")
    return int(text), f"by {THREADS_VARIABLE}"


def new_team(scene: Scene, model: Tables) -> Team:
    """How threads share the work of a loop."""
    counts = [surface.count for surface in scene.surfaces]
    chunks = min(max(max(counts) // ASPERITES_OF_CHUNK, 4), MOST_CHUNKS)
    columns = model.each.shape[1]
    tiles = tiles_of(model)
    counters = np.zeros(COUNTERS, np.int64)
    counters[THREADS] = 1
    return Team(
        counters=counters,
        taken=np.zeros(max(chunks, len(tiles)), np.int64),
        ranks=np.zeros((TILES, OWN_NUMBERS), np.int64),
        numbers=np.zeros(2),
        tiles=tiles,
        lengths=np.zeros(chunks, np.int64),
        begins=np.zeros(chunks + 1, np.int64),
        reach=np.zeros((chunks, 2), np.int64),
        reactions=room((chunks, 2, columns)),
    )


def tiles_of(model: Tables) -> np.ndarray:
    """Surface, place in it, and number of its tiles, for each tile, in the order of their places.

    So a part of them has the same part of each surface.  Works that are summed have one thread.
    """
    size = LANES * max(1, model.each.shape[1] // (TILES * LANES))
    tiles = []
    for k, surface in enumerate(model.surfaces):
        parts = 1 if model.sums else -(-int(surface.stop - surface.start) // size)
        tiles += [(k, part, parts) for part in range(parts)]
    return np.array(sorted(tiles, key=lambda tile: (tile[1] + 0.5) / tile[2]), np.int64)


@contextmanager
def assisted(team: Team, count: int, assist: Callable[[], Any]) -> Iterator[None]:
    """Let so many more threads share a time loop in this block; interrupts are raised after it."""
    if count == 0:
        yield
        return
    team.counters[[CLOSED, RANK, THREADS]] = 0, 0, 1 + count
    assistants: list[threading.Thread] = []
    with held():
        try:
            for _ in range(count):
                assistant = threading.Thread(target=assist, daemon=True)
                assistant.start()
                assistants.append(assistant)
            yield
        finally:
            team.counters[CLOSED] = 1
            for assistant in assistants:
                assistant.join()
