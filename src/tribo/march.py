"""One integration of a scene: a compiled time loop, called in chunks, and what it recorded."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.kernels.motion import place_bobs
from tribo.kernels.neighbours import refreshed
from tribo.kernels.records import CLOCK
from tribo.kernels.samples import STORED, Record, State, write_sample
from tribo.kernels.status import COMPLETED, NAMES, PAUSED
from tribo.layout import Layout
from tribo.ledger import Samples
from tribo.methods import Method

Progress = Callable[[float], None]  # told the time reached, a few times a second
CHUNK_SECONDS = 0.1  # between two looks at the keyboard


@dataclass(frozen=True, eq=False)
class March:
    """Raw samples of one integration, and what it took."""

    samples: Samples
    status: str
    steps: int
    evaluations: int
    seconds: float


def march(
    layout: Layout,
    method: Method,
    loop: Callable[..., Any],
    setting: Any,
    start: np.ndarray,
    times: np.ndarray,
    first_step: float,
    progress: Progress | None = None,
) -> March:
    """Integrate from `start` through `times`; `setting` is a step, or a Tolerance.

    Ends with the last time, or with whatever stops it: then the state reached is the last sample.
    """
    began = time.perf_counter()
    clocks, state = _at_rest(layout, start, first_step)
    record = _room(layout, times.size + 1)
    call = _bound(layout, method, loop, setting)
    budget = 256
    code = PAUSED
    try:
        while code == PAUSED:
            chunk_began = time.perf_counter()
            code = call(clocks, state, times, record, budget)
            taken = time.perf_counter() - chunk_began
            budget = int(np.clip(budget * CHUNK_SECONDS / max(taken, 1e-6), 16, 1e9))
            if progress is not None:
                progress(float(clocks.t[0]))
        status = NAMES[code]
    except KeyboardInterrupt:
        status = "Interrupted"
    seconds = time.perf_counter() - began
    done = int(clocks.sample[0])
    now = float(clocks.t[0])
    reached = times[:done]
    if done == 0 or reached[-1] != now:
        _record_now(layout, clocks, state, record)
        reached = np.append(reached, now)
    samples = Samples(reached, *(column[: reached.size] for column in record))
    return March(samples, status, int(clocks.steps[0]), int(clocks.evaluations[0]), seconds)


def compile_loop(layout: Layout, method: Method, loop: Callable[..., Any], setting: Any) -> float:
    """Have the loop compiled for this scene, or loaded from the disk cache; returns the seconds."""
    began = time.perf_counter()
    clocks, state = _at_rest(layout, layout.start, 0.0)
    _bound(layout, method, loop, setting)(clocks, state, np.ones(1), _room(layout, 1), 0)
    return time.perf_counter() - began


def _at_rest(layout: Layout, start: np.ndarray, first_step: float) -> tuple[Any, State]:
    """A clock at zero, and the state at the start."""
    clocks = np.zeros(1, CLOCK).view(np.recarray)
    clocks.h = first_step
    s = np.zeros(layout.accounts)
    return clocks, State(start.copy(), np.zeros(start.size), s, s.copy())


def _room(layout: Layout, times: int) -> Record:
    surfaces = len(layout.scene.surfaces)
    return Record(
        np.empty((times, 2 * layout.core)),
        np.empty((times, layout.accounts)),
        np.empty(times),
        np.empty(times),
        np.zeros((times, surfaces, STORED)),
    )


def _bound(
    layout: Layout, method: Method, loop: Callable[..., Any], setting: Any
) -> Callable[..., int]:
    """The loop with all but the moving parts given."""
    neighbours = layout.neighbours()
    noise: tuple[Any, ...] = ()
    if method.splits:
        noise = (np.random.default_rng([layout.scene.seed, 2]),)

    def call(clocks: Any, state: State, times: np.ndarray, record: Record, budget: int) -> int:
        code: int = loop(
            layout.model,
            neighbours,
            method.coefficients,
            setting,
            clocks,
            state,
            times,
            record,
            budget,
            *noise,
        )
        return code

    return call


def _record_now(layout: Layout, clocks: Any, state: State, record: Record) -> None:
    """Write the state in which a run stopped as one more sample."""
    model = layout.model
    now = float(clocks.t[0])
    place_bobs(model.asperites, model.bobs, now, state.y[: layout.coordinates])
    neighbours = refreshed(model, layout.neighbours())
    write_sample(model, neighbours, clocks[0], state, record)
