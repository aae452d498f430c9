"""One integration of a scene: a compiled time loop, called in chunks, and what it recorded."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tribo.integrators.methods import Method
from tribo.integrators.step_control import Tolerance
from tribo.kernels.equations_of_motion import place_bobs
from tribo.kernels.neighbours import refresh
from tribo.kernels.records import CLOCK, Neighbours
from tribo.kernels.samples import STORED, Record, State, initial_state, write_sample
from tribo.kernels.status import COMPLETED, NAMES, PAUSED
from tribo.plugins.compile_errors import COMPILE_ERRORS, compile_error
from tribo.potentials.from_ase import Call
from tribo.run.layout import Layout
from tribo.run.ledger import ASPERITE_KINDS, OPTIONAL_KINDS, Ledger, Samples, Table, bulk_ledger

Progress = Callable[[float], None]  # told the time reached, a few times a second
CHUNK_SECONDS = 0.1  # between two looks at the keyboard
SERIES_BYTES = 2**30  # of asperites' series, above which only their first and last are kept
ROOM = 1.5  # of what a list of neighbours wanted, when it had too little
PORTION_BYTES = 2**27  # of samples taken in at a time then


class Digest:
    """What is kept of a run whose samples are too many to hold: all but the asperites' series."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._times: list[np.ndarray] = []
        self._portions: list[Ledger] = []

    @staticmethod
    def wanted(layout: Layout, times: int) -> bool:
        """Whether that many samples of all asperites are too many to hold."""
        return times * _row_bytes(layout) > SERIES_BYTES

    def add(self, samples: Samples) -> None:
        """Take in a portion, whose first sample is the run's first."""
        books = bulk_ledger(self._layout, samples)
        new = slice(1 if self._portions else 0, None)
        self._portions.append(books.rows(new))
        self._times.append(samples.t[new])

    def series(self) -> tuple[np.ndarray, dict[str, Table], Table]:
        """Times, and the series of the surfaces as wholes and of the system."""
        portions = self._portions
        blocks = {
            name: _joined([portion.blocks[name] for portion in portions])
            for name in portions[0].blocks
        }
        system = _joined([portion.system for portion in portions])
        return np.concatenate(self._times), blocks, system


def _joined(tables: list[Table]) -> Table:
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


def _row_bytes(layout: Layout) -> int:
    """Memory of one sample, raw and as the ledger."""
    reported = len(ASPERITE_KINDS) + len(OPTIONAL_KINDS)
    return 8 * (2 * layout.core + layout.accounts + 2 * reported * layout.scene.count)


@dataclass(eq=False)
class Integration:
    """One integration: its raw samples, put together when first looked at, and what it took."""

    recorded: Callable[[], Samples]
    status: str
    counts: np.ndarray  # (2,) steps, and evaluations of all forces
    seconds: float

    @cached_property
    def samples(self) -> Samples:
        """The raw samples."""
        return self.recorded()

    @property
    def steps(self) -> int:
        """How many there were."""
        return int(self.counts[0])

    @property
    def evaluations(self) -> int:
        """How often all forces were looked at."""
        return int(self.counts[1])


def integrate(
    layout: Layout,
    method: Method,
    loop: Callable[..., Any],
    setting: Any,
    start: np.ndarray,
    times: np.ndarray,
    first_step: float,
    progress: Progress | None = None,
    digest: Digest | None = None,
) -> Integration:
    """Integrate from `start` through `times`; `setting` is a step, or a Tolerance.

    Ends with the last time, or with whatever stops it: then the state reached is the last sample.
    With a `digest`, samples are handed to it in portions, and only the first and the last kept.
    """
    began = time.perf_counter()
    clocks, state = _at_rest(layout, method, start, first_step)
    rows = times.size if digest is None else max(1, PORTION_BYTES // _row_bytes(layout))
    record = _room(layout, min(rows, times.size) + 1)
    if isinstance(setting, Tolerance):
        clocks.encounter_fraction = setting.encounter_fraction
    call = _bound(layout, method, loop, setting)
    samples: Samples | None = None
    status = NAMES[COMPLETED]
    for first in range(0, times.size, rows):
        portion = times[first : first + rows]
        clocks.sample = 0
        status = run_in_chunks(call, layout.calls, clocks, state, portion, record, progress)
        reached = portion[: int(clocks.sample[0])]
        if status != NAMES[COMPLETED] and (not reached.size or reached[-1] != clocks.t[0]):
            _record_now(layout, clocks, state, record)
            reached = np.append(reached, clocks.t[0])
        new = Samples(reached, *(column[: reached.size] for column in record))
        if digest is not None:
            digest.add(new if samples is None else samples.first().then(new))
            samples = new.ends() if samples is None else samples.first().then(new.last())
        else:
            samples = new
        if status != NAMES[COMPLETED]:
            break
    whole = samples
    assert whole is not None
    counts = np.array([clocks.steps[0], clocks.evaluations[0]])
    return Integration(lambda: whole, status, counts, time.perf_counter() - began)


def run_in_chunks(
    call: Callable[..., int],
    calls: tuple[Call, ...],
    clocks: Any,
    state: Any,
    times: np.ndarray,
    record: Any,
    progress: Progress | None,
) -> str:
    """Run through the times in chunks short enough to look at the keyboard between them."""
    budget = 256
    code = PAUSED
    for item in calls:
        item.error, item.interrupted = None, False
    try:
        while code == PAUSED:
            began = time.perf_counter()
            code = call(clocks, state, times, record, budget)
            taken = time.perf_counter() - began
            for item in calls:
                if item.error is not None:
                    return "CalculatorFailed"
                if item.interrupted:
                    return "Interrupted"
            budget = int(min(max(budget * CHUNK_SECONDS / max(taken, 1e-6), 16.0), 1e9))
            if progress is not None:
                progress(float(clocks["t"][0]))
    except KeyboardInterrupt:
        return "Interrupted"
    return NAMES[code]


def compile_loop(layout: Layout, method: Method, loop: Callable[..., Any], setting: Any) -> float:
    """Have the loop compiled for this scene, or loaded from the disk cache; returns the seconds."""
    began = time.perf_counter()
    clocks, state = _at_rest(layout, method, layout.start, 0.0)
    try:
        _bound(layout, method, loop, setting)(clocks, state, np.ones(1), _room(layout, 1), 0)
    except COMPILE_ERRORS as error:
        raise compile_error(layout.named_plugins, error) from None
    return time.perf_counter() - began


def _at_rest(
    layout: Layout, method: Method, start: np.ndarray, first_step: float
) -> tuple[Any, State]:
    """A clock at zero, and the state at the start."""
    clocks = np.zeros(1, CLOCK).view(np.recarray)
    clocks.h = first_step
    return clocks, initial_state(start, layout.accounts, method.remembers, method.splits)


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
        nonlocal neighbours
        neighbours = with_room(neighbours)
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


def with_room(neighbours: Neighbours | None) -> Neighbours | None:
    """The same list, or an empty one with more room if it had too little."""
    if neighbours is None or neighbours.start[-1] <= neighbours.index.size:
        return neighbours
    room = int(ROOM * neighbours.start[-1])
    return neighbours._replace(
        index=np.zeros(room, np.int64), place=np.full_like(neighbours.place, np.nan)
    )


def _record_now(layout: Layout, clocks: Any, state: State, record: Record) -> None:
    """Write the state in which a run stopped as one more sample."""
    model = layout.model
    now = float(clocks.t[0])
    place_bobs(model, now, state.y[: layout.coordinates])
    neighbours = layout.neighbours()
    for _ in range(2):
        neighbours = with_room(neighbours)
        refresh(model, neighbours)
    write_sample(model, neighbours, clocks[0], state, record)
