"""One integration of a scene: a compiled time loop, called in chunks, and its samples."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tribo.integrators.methods import Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.compiled import collector_paused
from tribo.kernels.equations_of_motion import place_bobs
from tribo.kernels.neighbours import refresh
from tribo.kernels.records import CLOCK, Neighbours
from tribo.kernels.samples import STORED, Record, State, initial_state, write_sample
from tribo.kernels.status import PAUSED, STATUS_OF_CODE, Status
from tribo.plugins.compile_errors import compiling
from tribo.potentials.from_ase import Call
from tribo.run.force_records import Records
from tribo.run.layout import Layout
from tribo.run.samples import Samples
from tribo.run.streamed_ledger import StreamedLedger, portion_size

Progress = Callable[[float], None]  # called with the time reached, a few times a second
Setting = float | Tolerance  # of a time loop: its step, or the tolerances of an adaptive one
Loop = Callable[..., int]  # a compiled time loop

# Seconds between two checks for an interrupt: short for a person, long against a call.
CHUNK_SECONDS = 0.1
# Steps of the first chunk: milliseconds for small scenes.
FIRST_CHUNK = 256
# Steps of any other chunk, at least: calls of fewer would cost more than their steps.
SMALLEST_CHUNK = 16
# Steps of any other chunk, at most: budgets are integers of 64 bits.
LARGEST_CHUNK = 1_000_000_000
# Seconds that a chunk counts as taking if the clock shows less.
LEAST_SECONDS = 1e-6
# Room of a neighbour list, in units of what it needed when it had too little: bobs that approach
# one another need somewhat more soon after.
EXTRA_ROOM = 1.5


@dataclass(eq=False)
class Integration:
    """One integration of the equations of motion.

    Attributes
    ----------
    recorded : callable
        Returns the raw samples.
    status : Status
        How the integration ended.
    counts : ndarray
        Steps and evaluations of all forces, its first two elements.
    seconds : float
        Wall time.
    """

    recorded: Callable[[], Samples]
    status: Status
    counts: np.ndarray
    seconds: float

    @cached_property
    def samples(self) -> Samples:
        """The raw samples, built when they are first needed."""
        return self.recorded()

    @property
    def steps(self) -> int:
        """Steps taken."""
        return int(self.counts[0])

    @property
    def evaluations(self) -> int:
        """Evaluations of all forces."""
        return int(self.counts[1])


def integrate(
    layout: Layout,
    method: Method,
    loop: Loop,
    setting: Setting,
    start: np.ndarray,
    times: np.ndarray,
    first_step: float,
    progress: Progress | None = None,
    streamed: StreamedLedger | None = None,
) -> Integration:
    """Integrate from `start` through `times`.

    Ends at the last time, or where something stops it; then the state reached is the last sample.

    Parameters
    ----------
    layout, method, loop : Layout, Method, callable
        The scene, the method, and its compiled time loop.
    setting : float or Tolerance
        The step, or the tolerances of an adaptive method.
    start : ndarray, (2 coordinates,)
        y at t = 0.
    times : ndarray, (times,)
        When to record.
    first_step : float
        The first step of an adaptive method [time].
    progress : callable, optional
        Called with the time reached.
    streamed : StreamedLedger, optional
        Takes in the samples, of which only the first and the last are kept then.
    """
    began = time.perf_counter()
    clocks, state = _at_rest(layout, method, start, first_step)
    rows = times.size if streamed is None else portion_size(layout)
    record = _room(layout, min(rows, times.size) + 1)
    if isinstance(setting, Tolerance):
        clocks.encounter_fraction = setting.encounter_fraction
    call = _bound(layout, method, loop, setting)
    samples: Samples | None = None
    status = Status.COMPLETED
    for first in range(0, times.size, rows):
        portion = times[first : first + rows]
        clocks.sample[:] = 0
        status = run_in_chunks(
            call, layout.calculator_calls, clocks, state, portion, record, progress
        )
        reached = portion[: int(clocks.sample[0])]
        if status != Status.COMPLETED and (not reached.size or reached[-1] != clocks.t[0]):
            _record_now(layout, clocks, state, record)
            reached = np.append(reached, clocks.t[0])
        new = Samples(reached, *(column[: reached.size] for column in record))
        if streamed is not None:
            streamed.add(new if samples is None else samples.first().then(new))
            new = new.ends() if samples is None else samples.first().then(new.last())
        samples = new
        if status != Status.COMPLETED:
            break
    whole = samples
    assert whole is not None
    counts = np.array([clocks.steps[0], clocks.evaluations[0]])
    return Integration(lambda: whole, status, counts, time.perf_counter() - began)


def run_in_chunks(
    call: Loop,
    calls: tuple[Call, ...],
    clocks: np.ndarray,
    state: State | np.ndarray,
    times: np.ndarray,
    record: Record | np.ndarray,
    progress: Progress | None,
) -> Status:
    """Run through the times in chunks, and check for an interrupt between them.

    The clock only decides how many steps a chunk has; loops give the same bits for any chunks.
    """
    budget = FIRST_CHUNK
    code = PAUSED
    for item in calls:
        item.error, item.interrupted = None, False
    try:
        while code == PAUSED:
            began = time.perf_counter()
            code = call(clocks, state, times, record, budget)
            taken = max(time.perf_counter() - began, LEAST_SECONDS)
            for item in calls:
                if item.error is not None:
                    return Status.CALCULATOR_FAILED
                if item.interrupted:
                    return Status.INTERRUPTED
            wanted = budget * CHUNK_SECONDS / taken
            budget = int(min(max(wanted, SMALLEST_CHUNK), LARGEST_CHUNK))
            if progress is not None:
                progress(float(clocks["t"][0]))
    except KeyboardInterrupt:
        return Status.INTERRUPTED
    return STATUS_OF_CODE[code]


def compile_loop(layout: Layout, method: Method, loop: Loop, setting: Setting) -> float:
    """Compile the loop for this scene, or load it from the disk cache; returns the seconds."""
    began = time.perf_counter()
    clocks, state = _at_rest(layout, method, layout.start, 0.0)
    with collector_paused(), compiling(loop, layout.named_plugins):
        _bound(layout, method, loop, setting)(clocks, state, np.ones(1), _room(layout, 1), 0)
    return time.perf_counter() - began


def _at_rest(
    layout: Layout, method: Method, start: np.ndarray, first_step: float
) -> tuple[Records, State]:
    """A clock at zero, and the state at the start."""
    clocks = np.zeros(1, CLOCK).view(np.recarray)
    clocks.h = first_step
    return clocks, initial_state(start, layout.accounts, method.remembers, method.splits)


def _room(layout: Layout, times: int) -> Record:
    """Arrays for so many samples."""
    surfaces = len(layout.scene.surfaces)
    return Record(
        np.empty((times, 2 * layout.core)),
        np.empty((times, layout.accounts)),
        np.empty(times),
        np.empty(times),
        np.zeros((times, surfaces, STORED)),
    )


def _bound(layout: Layout, method: Method, loop: Loop, setting: Setting) -> Loop:
    """The loop with its constant arguments given."""
    neighbours = layout.neighbours()
    noise: tuple[np.random.Generator, ...] = ()
    if method.splits:
        noise = (np.random.default_rng([layout.scene.seed, 2]),)

    def call(clocks: Records, state: State, times: np.ndarray, record: Record, budget: int) -> int:
        nonlocal neighbours
        neighbours = with_room(neighbours)
        return loop(
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

    return call


def with_room(neighbours: Neighbours | None) -> Neighbours | None:
    """The same list, or an empty one with more room if it had too little."""
    if neighbours is None or neighbours.start[-1] <= neighbours.index.size:
        return neighbours
    room = int(EXTRA_ROOM * neighbours.start[-1])
    return neighbours._replace(
        index=np.zeros(room, np.int64), place=np.full_like(neighbours.place, np.nan)
    )


def _record_now(layout: Layout, clocks: Records, state: State, record: Record) -> None:
    """Record the state in which a run stopped as one more sample."""
    model = layout.model
    now = float(clocks.t[0])
    place_bobs(model, now, state.y[: layout.coordinates])
    neighbours = layout.neighbours()
    for _ in range(2):
        neighbours = with_room(neighbours)
        refresh(model, neighbours)
    write_sample(model, neighbours, clocks[0], state, record)
