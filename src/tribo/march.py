"""One integration of a scene: a compiled time loop, called in chunks, and what it recorded."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.kernels.contact import contact_energy
from tribo.kernels.motion import place_bobs
from tribo.kernels.records import CLOCK
from tribo.kernels.runge_kutta import Record, State
from tribo.kernels.status import COMPLETED, NAMES, PAUSED
from tribo.layout import Layout
from tribo.methods import Method

Progress = Callable[[float], None]  # told the time reached, a few times a second
CHUNK_SECONDS = 0.1  # between two looks at the keyboard


@dataclass(frozen=True, eq=False)
class March:
    """Raw samples of one integration, and what it took; see tribo.layout for y and s."""

    t: np.ndarray  # (times,)
    y: np.ndarray  # (times, 2 coordinates)
    s: np.ndarray  # (times, accounts)
    u: np.ndarray  # (times,) contact energy
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
    clocks = np.zeros(1, CLOCK).view(np.recarray)
    clocks.h = first_step
    clocks.closest = np.inf
    state = State(
        start.copy(),
        np.zeros(start.size),
        np.zeros(layout.accounts),
        np.zeros(layout.accounts),
    )
    record = Record(
        np.empty((times.size, start.size)),
        np.empty((times.size, layout.accounts)),
        np.empty(times.size),
    )
    budget = 256
    code = PAUSED
    try:
        while code == PAUSED:
            chunk_began = time.perf_counter()
            code = loop(
                layout.model, method.coefficients, setting, clocks, state, times, record, budget
            )
            taken = time.perf_counter() - chunk_began
            budget = int(np.clip(budget * CHUNK_SECONDS / max(taken, 1e-6), 16, 1e9))
            if progress is not None:
                progress(float(clocks.t[0]))
        status = NAMES[code]
    except KeyboardInterrupt:
        status = "Interrupted"
    seconds = time.perf_counter() - began
    done = int(clocks.sample[0])
    t, y, s, u = times[:done], record.y[:done], record.s[:done], record.contact_energy[:done]
    if status != NAMES[COMPLETED]:
        t, y, s, u = _with_last(layout, clocks, state, t, y, s, u)
    return March(t, y, s, u, status, int(clocks.steps[0]), int(clocks.evaluations[0]), seconds)


def _with_last(
    layout: Layout, clocks: Any, state: State, *samples: np.ndarray
) -> tuple[np.ndarray, ...]:
    """The samples, and the state in which a run stopped as one more."""
    t, y, s, u = samples
    now = float(clocks.t[0])
    if t.size and t[-1] == now:
        return samples
    model = layout.model
    place_bobs(model.asperites, model.bobs, now, state.y[: layout.coordinates])
    energy = contact_energy(model.contacts, model.surfaces, model.bobs)
    return (
        np.append(t, now),
        np.vstack([y, state.y]),
        np.vstack([s, state.s]),
        np.append(u, energy),
    )


def compile_loop(layout: Layout, method: Method, loop: Callable[..., Any], setting: Any) -> float:
    """Have the loop compiled for this scene, or loaded from the disk cache; returns the seconds."""
    began = time.perf_counter()
    y, s = layout.start, np.zeros(layout.accounts)
    clocks = np.zeros(1, CLOCK).view(np.recarray)
    record = Record(np.empty((1, y.size)), np.empty((1, s.size)), np.empty(1))
    state = State(y.copy(), y.copy(), s, s.copy())
    loop(layout.model, method.coefficients, setting, clocks, state, np.ones(1), record, 0)
    return time.perf_counter() - began
