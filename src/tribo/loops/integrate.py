"""One integration of a scene: a time loop in chunks, its samples, and a guard of its progress."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from tribo import interrupts
from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import COUNTS, EVALUATIONS, PAUSED, STATUS_OF_CODE, STEPS, Status
from tribo.ledger.motion import add_reactions
from tribo.ledger.samples import Samples
from tribo.ledger.sinks import StreamedLedger, portion_size
from tribo.loops.driver import Chunks, OfSize, drive
from tribo.loops.stiffness import FIRST_LOOK, Stiffness
from tribo.loops.time_loop import Columns, Memory, TimeLoop
from tribo.model.scene import Scene

# Most work of a run with adaptive steps [force evaluations x asperites], where the scene's numerics
# give no bound: 6 to 13 s at the 0.03 to 0.06 us that benchmarks/calibrate.py measures for an
# asperite.
MOST_WORK = 2e8
# Evaluations that runs of any number of asperites may take.
ALWAYS_ALLOWED = 1e7
# A run stops if its mean progress predicts this times the evaluations that it may take: the start
# of a run may be its slowest part.
MOST_PREDICTED = 3.0
# Trials of steps after which the progress of a run of two asperites is looked at: a second.
TRIALS = 2**18
# The same at least, for any number of asperites.
FEWEST_TRIALS = 2**12
# Evaluations of a trial, of which no method takes many more.
OF_A_TRIAL = 20
# Looks at the progress of a run that takes all evaluations that it may, at least; a trial takes
# nine or more of them.
LOOKS = 100
Progress = Callable[[float], None]  # called with the time reached, a few times a second
# Seconds between two checks for an interrupt: short for a person, long against a call.
CHUNK_SECONDS = 0.1
# Steps of the first chunk: a person does not notice the time they take, even with a million
# asperites.
FIRST_CHUNK = 1
# Largest ratio of the steps of a chunk to those of the one before: the first steps may be much
# cheaper than later ones.
CHUNK_GROWTH = 16
# Steps of any chunk, at most: budgets are integers of 64 bits.
LARGEST_CHUNK = 1_000_000_000
# Seconds that a chunk counts as taking if the clock shows less.
LEAST_SECONDS = 1e-6


def most_evaluations(scene: Scene) -> float:
    """Force evaluations that a run with adaptive steps may take."""
    given = scene.numerics.max_evaluations
    return max(MOST_WORK / scene.count, ALWAYS_ALLOWED) if given is None else given


def reach_of(scene: Scene, whole: float, begin: float) -> str:
    """What a run takes at its mean rate from `begin`, and may take, as a part of a sentence."""
    most = most_evaluations(scene)
    reach = begin + (scene.duration - begin) * min(1.0, most / whole)
    return (
        f"the whole run would take about {whole:.2g} evaluations of all forces, and may take "
        f"{most:.2g}, which reach about t = {reach:.2g}"
    )


class ProgressGuard:
    """Predicts the evaluations of a run, of which it may take `most`, from its mean progress.

    No clock decides: the prediction is the same on every machine, for any chunks of steps.
    """

    def __init__(
        self, clocks: np.ndarray, beginning: float, end: float, asperites: int, most: float
    ) -> None:
        """Look at the progress often enough for the evaluations that are allowed."""
        self._clock = clocks[0]
        self._beginning = beginning
        self._end = end
        self._most = most
        every = max(FEWEST_TRIALS, min(2 * TRIALS // asperites, int(most / LOOKS)))
        # So often that a run which may take few evaluations does not take many times as many.
        self._every = max(1, min(every, int(most / OF_A_TRIAL)))

    def within(self, budget: int) -> int:
        """At most so many steps, and no more than until the next look."""
        return int(min(budget, self._every - self._trials % self._every))

    def is_hopeless(self) -> bool:
        """Whether it is time to look, and the run would take too many evaluations."""
        if self._trials == 0 or self._trials % self._every != 0:
            return False
        done = float(self._clock["t"]) - self._beginning
        taken = float(self._clock["evaluations"])
        predicted = taken * (self._end - self._beginning)
        if taken > self._most:
            return True
        known = self._trials >= FEWEST_TRIALS  # fewer do not predict the rest
        return known and predicted > MOST_PREDICTED * self._most * done

    @property
    def _trials(self) -> int:
        return int(self._clock["steps"] + self._clock["rejected"])


class StiffnessGuard:
    """Looks whether equal steps resolve the stiffest motion that a run has met.

    It looks after numbers of steps that double, which do not depend on chunks, and at the end.
    """

    def __init__(self, loop: TimeLoop, step: float) -> None:
        self._loop = loop
        self._step = step

    def within(self, budget: int) -> int:
        """At most so many steps, and no more than until the next look."""
        steps = self._steps
        look = FIRST_LOOK
        while look <= steps:
            look *= 2
        return min(budget, look - steps)

    def is_due_and_exceeded(self) -> bool:
        """Whether it is time to look, and the steps do not resolve the motion."""
        looks, rest = divmod(self._steps, FIRST_LOOK)
        return rest == 0 and looks.bit_count() == 1 and self.is_exceeded()

    def is_exceeded(self) -> bool:
        stiffness = self._loop.stiffness()
        return stiffness is not None and bool(stiffness.exceeds(self._step))

    @property
    def _steps(self) -> int:
        return int(self._loop.clocks["steps"][0])


@dataclass(eq=False)
class Reached:
    """How far an integration has come: whole portions, what of them is held, and how it ended."""

    portions: int = 0  # that a streamed ledger has taken in
    held: Samples | None = None  # of these portions
    status: Status | None = None  # None while it goes on


class Checkpoints(Protocol):
    """Where an integration keeps what it has reached while it goes on."""

    def restore(self, loop: TimeLoop, columns: Columns, streamed: StreamedLedger | None) -> Reached:
        """Fill in what was kept, if anything: portions, samples of the next one, and memory."""

    def due(self) -> bool:
        """Whether it is time to keep what was reached."""

    def keep(
        self, loop: TimeLoop, columns: Columns, streamed: StreamedLedger | None, reached: Reached
    ) -> None:
        """Keep the portions and samples so far, and the memory."""


@dataclass(eq=False)
class Integration:
    samples: Samples  # raw
    status: Status
    counts: np.ndarray  # (COUNTS,) steps, and evaluations of all forces
    seconds: float  # wall time
    # Returns all that the time loop needs to continue from the end.
    remembered: Callable[[], Memory]
    # Steps in which bobs passed an encounter far below k_B T, and the last two bobs.
    passages: tuple[int, ...] = (0, 0, 0)
    failures: tuple[str, ...] = ()  # errors that ASE calculators raised
    cut: bool = False  # whether the samples end before the memory
    stiffness: Stiffness | None = None  # that it has met; None without reservoirs

    @cached_property
    def memory(self) -> Memory:
        """All that the time loop needs to continue from the end, built when it is first needed."""
        return self.remembered()

    def without_samples(self) -> Integration:
        """The same with the first sample and the last two alone."""
        return replace(self, samples=self.samples.last_interval())

    def up_to(self, last: int, status: Status) -> Integration:
        """The part of the run up to a sample, with another status."""
        kept = self.samples.at(self.samples.t[: last + 1])
        return replace(self, samples=kept, status=status, cut=True)

    @property
    def steps(self) -> int:
        return int(self.counts[STEPS])

    @property
    def evaluations(self) -> int:
        return int(self.counts[EVALUATIONS])


def first_step_at(tolerance: Tolerance, longest: float, order: int) -> float:
    """The first step of a run, shorter with finer tolerances.

    Two runs that began with the same step would share its error, which no step control has seen.
    """
    return longest * tolerance.level ** (1.0 / order)


def integrate(
    loop: TimeLoop,
    times: np.ndarray,
    progress: Progress | None = None,
    streamed: StreamedLedger | None = None,
    checkpoints: Checkpoints | None = None,
    columns: Columns | None = None,
    most: float | None = None,
    resolved: bool = False,
) -> Integration:
    """Integrate through `times`; where something stops it, the state reached is the last sample.

    `streamed` takes in the samples, of which only the first and the last two are kept then.
    `columns` are those of a loop that has begun, and adaptive steps may take `most` force
    evaluations, those of the scene without it.  If equal steps have to be `resolved`, the run stops
    where they do not resolve the stiffest motion.
    """
    step = loop.step
    guard = StiffnessGuard(loop, step) if resolved and step is not None else None
    began = time.perf_counter()
    rows = times.size if streamed is None else portion_size(loop.layout)
    columns = columns or loop.room(min(rows, times.size) + 1)
    reached = Reached() if checkpoints is None else checkpoints.restore(loop, columns, streamed)
    cut = False

    def between(t: float) -> None:
        if checkpoints is not None and checkpoints.due():
            checkpoints.keep(loop, columns, streamed, reached)
        if progress is not None:
            progress(t)

    for first in range(rows * reached.portions, times.size, rows):
        portion = times[first : first + rows]
        held = reached.held
        status = reached.status or run_in_chunks(loop, portion, columns, between, most, guard)
        ended = status != Status.COMPLETED or first + rows >= times.size
        if ended and checkpoints is not None and reached.status is None:
            # An interrupt ends the program, not the integration, which can be continued.
            reached.status = None if status == Status.INTERRUPTED else status
            checkpoints.keep(loop, columns, streamed, reached)
        memory, counts, passages = _reached(loop, status)
        new = _recorded(loop, portion, columns, status)
        if loop.before is not None and first == 0:
            new = loop.before.then(new)
        if loop.layout.model.pivots is not None:
            start = (new if held is None else held).y[:1]
            add_reactions(loop.layout, new.y, new.s, start)
        # No other name holds on to samples, whose memory large scenes need for the next ones.
        earlier = 0 if held is None else held.t.size
        held = new if held is None else held.then(new)
        if streamed is not None:
            end = streamed.add(held, earlier)
            if end is not None:
                status = end[1]
                held = held.at(held.t[: end[0] + 1])
                cut = True
            held = held.last_interval(loop.layout.beginning)
        reached = Reached(reached.portions + 1, held)
        if status == Status.COMPLETED and ended and guard is not None and guard.is_exceeded():
            status = Status.STEP_TOO_LONG
        if status != Status.COMPLETED:
            break
        if not ended:
            loop.clocks["sample"] = 0
    assert held is not None
    seconds = time.perf_counter() - began
    failures = tuple(call.failure for call in loop.calls if call.error is not None)
    return Integration(
        held, status, counts, seconds, lambda: memory, passages, failures, cut, loop.stiffness()
    )


def _reached(loop: TimeLoop, status: Status) -> tuple[Memory, np.ndarray, tuple[int, ...]]:
    """Memory, counts and passages of a loop, which goes on to record where it has stopped."""
    memory = loop.memory()
    counts = np.zeros(COUNTS)
    if status != Status.COMPLETED:
        memory = {name: array.copy() for name, array in memory.items()}
    names = ("steps", "evaluations", "passages", "passing", "passed")
    counts[STEPS], counts[EVALUATIONS], passages, *last = (loop.clocks[name][0] for name in names)
    bobs = (int(np.argmax(loop.layout.places.columns == column)) for column in last)
    return memory, counts, (int(passages), *bobs)


def _recorded(loop: TimeLoop, times: np.ndarray, columns: Columns, status: Status) -> Samples:
    """The samples of a run, and the state in which it stopped as one more."""
    done = int(loop.clocks["sample"][0])
    t = float(loop.clocks["t"][0])
    if status == Status.COMPLETED or (done and times[done - 1] == t):
        return loop.samples(times[:done], columns)
    # The loop records a sample that is due before it takes a step.
    loop.clocks["sample"] = 0
    loop.clocks["t_low"] = 0.0
    loop.clocks["evaluations"] = 1
    loop.forget_neighbours()
    rest = tuple(column[done:] for column in columns)
    drive(lambda steps: loop.advance(np.array([t]), rest, steps), OfSize(1))
    return loop.samples(np.append(times[:done], t), columns)


class RunChunks(Chunks):
    """Chunks of a single run: between them it is looked at, and shows its progress.

    The clock only decides how many steps a chunk has; loops give the same bits for any chunks.
    `resolved` ends a run whose steps are too long.
    """

    def __init__(
        self,
        loop: TimeLoop,
        end: float,
        progress: Progress | None,
        most: float | None,
        resolved: StiffnessGuard | None,
    ) -> None:
        """Begin with a chunk of a few steps."""
        layout = loop.layout
        most = most_evaluations(layout.scene) if most is None else most
        self._loop = loop
        self._guard = ProgressGuard(loop.clocks, layout.beginning, end, layout.scene.count, most)
        self._resolved = resolved
        self._progress = progress
        self._budget = FIRST_CHUNK
        self._began = 0.0
        self.status: Status | None = None  # that ended a run which could go on

    def steps(self) -> int:
        """At most so many that an interrupt is answered soon, and that no look is missed."""
        chunk = self._guard.within(self._budget)
        if self._resolved is not None:
            chunk = self._resolved.within(chunk)
        self._began = time.perf_counter()
        return chunk

    def goes_on(self, code: int) -> bool:
        """Find what ends the run, if anything; else choose the next chunk and show the progress."""
        taken = max(time.perf_counter() - self._began, LEAST_SECONDS)
        self.status = self._stopped(code)
        if self.status is not None:
            return False
        wanted = self._budget * min(CHUNK_SECONDS / taken, CHUNK_GROWTH)
        self._budget = int(min(max(wanted, FIRST_CHUNK), LARGEST_CHUNK))
        if self._progress is not None:
            self._progress(float(self._loop.clocks["t"][0]))
        return True

    def _stopped(self, code: int) -> Status | None:
        """What ends a run that could go on.  Raises KeyboardInterrupt from a user's own calls."""
        loop = self._loop
        for item in loop.calls:
            if item.error is not None:
                return Status.CALCULATOR_FAILED
            if item.interrupted:
                raise KeyboardInterrupt
        if code != PAUSED:
            return None
        if loop.adaptive and self._guard.is_hopeless():
            return Status.NO_PROGRESS
        if self._resolved is not None and self._resolved.is_due_and_exceeded():
            return Status.STEP_TOO_LONG
        return None


def run_in_chunks(
    loop: TimeLoop,
    times: np.ndarray,
    columns: Columns,
    progress: Progress | None = None,
    most: float | None = None,
    resolved: StiffnessGuard | None = None,
) -> Status:
    """Run through the times; see :class:`RunChunks`."""
    for item in loop.calls:
        item.error = None
        item.interrupted = False
    chunks = RunChunks(loop, float(times[-1]), progress, most, resolved)
    try:
        code = drive(lambda steps: loop.advance(times, columns, steps), chunks)
    except KeyboardInterrupt:
        interrupts.answer()
        return Status.INTERRUPTED
    return chunks.status or STATUS_OF_CODE[code]
