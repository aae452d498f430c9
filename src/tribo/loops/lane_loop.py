"""Members of an ensemble, eight side by side in the lanes of registers."""

import math
from abc import abstractmethod
from typing import Any

import numpy as np

from tribo.compiler.jit import EntryPoint
from tribo.compiler.kept import keep
from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.integrators.methods import Method
from tribo.integrators.nystrom import Nystrom
from tribo.integrators.step_control import LARGEST, Tolerance, count_of_steps
from tribo.integrators.stiffness import MOVED, WATCH_ROWS
from tribo.kernels.langevin import Deviates
from tribo.kernels.records import CLOCK
from tribo.kernels.samples import Record, empty_state, initial_state
from tribo.kernels.status import CODE, COMPLETED, COUNTS, EVALUATIONS, PAUSED, STEPS
from tribo.lanes.refill import TRIED, Queue, Starts, queue_of
from tribo.lanes.steps import LOST, WATCHED, nystrom_members, splitting_members
from tribo.layout.contacts import NO_NEIGHBOURS
from tribo.layout.layout import Layout
from tribo.ledger.samples import sample_columns
from tribo.loops.batch import GeneralMembers, MemberStarts, Pool, RecordingLoop, padded
from tribo.loops.driver import Chunks, OfSize, drive
from tribo.loops.general import remembered, unit_setting
from tribo.loops.integrate import first_step_at
from tribo.loops.interleaved import interleaved, rows_of_numbers
from tribo.loops.legs import LegsOfLoop
from tribo.loops.setting import Setting
from tribo.loops.time_loop import Columns
from tribo.threads.model_units import fulfil, loop_units, rate_units, step_units
from tribo.threads.writable_memory import shared_loop

# Asperites of a scene whose members are run side by side, at most: eight asperites of one run fill
# registers as well.
MOST_ASPERITES = 64
# Trials of a call of the loop, since an interrupt waits for its end: of 64 asperites some 0.3 s.
TRIALS = 1024
# Equal steps of a call, at most, likewise.
MOST_STEPS = 4096
# Normal deviates that are drawn at once for a member, at most: 256 kB for eight.
MOST_DEVIATES = 4096


def fit_lanes(layout: Layout, method: Method) -> bool:
    """Whether members of a scene, which can be run in batches, are run in lanes."""
    if isinstance(method.coefficients, Nystrom):
        fits = layout.core == layout.coordinates  # oscillators of one member stand side by side
    else:
        fits = method.splits
    elastic = any(surface.elastic is not None for surface in layout.scene.surfaces)
    if layout.surfaces.block.any() or elastic:  # whose sums are over the asperites of one run
        return False
    small = layout.asperites.size <= MOST_ASPERITES
    # Adaptive steps of members pass kinks at times of their own.
    fits = fits and (method.splits or layout.legs.kinks.size == 0)
    return fits and small and layout.model.sums is None and not layout.calculator_calls


class LaneLoop(RecordingLoop):
    """A scene for eight members of an ensemble, and memory of its own for their loop.

    A member that needs more care than the loop takes, at encounters that a step would jump or where
    numbers are not finite, is run by a loop of `alone`; one with numbers of its own is left with
    the status PAUSED and samples of zeros.  Raises InputError if a plug-in does not compile.
    """

    def __init__(
        self,
        layout: Layout,
        method: Method,
        first_step: float,
        own_numbers: bool,
        alone: Pool[GeneralMembers],
    ) -> None:
        """Lay out eight members, and compile their loop."""
        self.layout = layout
        self._alone = alone
        self._longest = first_step
        self._order = method.order
        self.eight = eight = interleaved(layout, own_numbers)
        self._kept = keep(eight.model), keep(NO_NEIGHBOURS)
        fulfil(loop_units(eight.model))
        self._legs = LegsOfLoop(layout, eight.model)
        self.coefficients: Any = method.coefficients
        coordinates, accounts = eight.room
        start = np.zeros(2 * coordinates)
        self._state = initial_state(start, accounts, remembered(layout, method), method.splits)
        self._work = self.coefficients.workspace(eight.model, self._state)
        core = eight.q[0, : layout.core]
        self._watched_places = eight.q[:, : layout.core]  # (8, core)
        self._recorded = np.concatenate([core, coordinates + core]), eight.s
        self._places = np.concatenate([eight.q, coordinates + eight.q], axis=1)
        self.prepare(unit_setting(layout, method))

    @abstractmethod
    def prepare(self, setting: Setting) -> None:
        """Make clocks and scratch, and compile the loop."""

    @abstractmethod
    def run_in_lanes(
        self,
        setting: Setting,
        starts: MemberStarts,
        numbers: np.ndarray,
        columns: Columns,
        sums: np.ndarray,
    ) -> np.ndarray:
        """Run members side by side, and record (members x times, ...).

        Returns their counts, with PAUSED of those that need a loop of their own.
        """

    def fill(
        self, setting: Setting, starts: MemberStarts, columns: Columns, sums: np.ndarray
    ) -> np.ndarray:
        """Run members into columns; those that do not complete run again one by one.

        With numbers of their own they are PAUSED, with zeros, and run elsewhere.
        """
        members = len(starts.y)
        numbers = np.empty((members, 0))
        assert starts.numbers is not None or self.eight.memory.size == 0
        if starts.numbers is not None:
            numbers = rows_of_numbers(self.layout.scene, starts.numbers)
        rows = tuple(each.reshape(math.prod(each.shape[:2]), *each.shape[2:]) for each in columns)
        counts = self.run_in_lanes(setting, starts, numbers, rows, sums)
        whole = counts[:, CODE] == COMPLETED
        for each in columns:
            whole &= np.all(np.abs(each[:members]) <= LARGEST, axis=tuple(range(1, each.ndim)))
        alone = np.flatnonzero(~whole)
        if starts.numbers is not None:
            counts[alone, CODE] = PAUSED
            for each in columns:
                each[alone] = 0.0
        elif alone.size:
            loop = self._alone.take()
            theirs = tuple(each[alone] for each in columns)
            sums_alone = sums[alone] if sums.size else sums
            counts[alone] = loop.fill(setting, starts.of_members(alone), theirs, sums_alone)
            if sums.size:
                sums[alone] = sums_alone
            self._alone.give_back(loop)
            for each, own in zip(columns, theirs, strict=True):
                each[alone] = own
        return counts

    def record(self, columns: Columns) -> Any:
        """These arrays for the loop."""
        return keep(Record(*columns, *self._recorded))  # type: ignore[call-arg]


class NystromLanes(LaneLoop):
    def prepare(self, setting: Setting) -> None:
        """Keep a clock for each lane and memory of trials, and compile the loop."""
        self._clocks = np.zeros(LANES, CLOCK).view(np.recarray)
        fulfil(rate_units(self.eight.model))
        speeds = room((3, self.eight.model.each.shape[1]))
        layout = self.layout
        tried = room((TRIED, LANES))
        new = empty_state(self._state)
        self._state, *self._scratch = self.keep(
            (self._state, tried, self._work, speeds, new), [self._clocks]
        )
        none = np.empty((0, layout.start.size)), np.empty((0, self.eight.numbers.shape[1]))
        columns = sample_columns(layout, 1)
        tolerance = setting.of_adaptive_steps()
        before, behind = self._arguments(tolerance, queue_of(0, LANES), *none, columns)
        examples = *before, 0, *behind
        self._entry = EntryPoint(shared_loop(nystrom_members), self._kept, examples)

    def run_in_lanes(
        self,
        setting: Setting,
        starts: MemberStarts,
        numbers: np.ndarray,
        columns: Columns,
        sums: np.ndarray,
    ) -> np.ndarray:
        """Run members side by side; their motion has no noise, and takes no seeds."""
        tolerance = setting.of_adaptive_steps()
        self.forget()
        self._clocks["encounter_fraction"] = tolerance.encounter_fraction
        queue = queue_of(len(starts.y), LANES)
        y = np.ascontiguousarray(starts.y)
        before, behind = self._arguments(tolerance, queue, y, numbers, columns)
        drive(lambda trials: self._entry(*before, trials, *behind), OfSize(TRIALS))
        return queue.counts

    def _arguments(
        self,
        tolerance: Tolerance,
        queue: Queue,
        starts: np.ndarray,
        numbers: np.ndarray,
        columns: Columns,
    ) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """The arguments of the loop between the model and the budget, and those behind it.

        Tolerances of what fills packs are 1.
        """
        y = np.ones_like(self._state.y)
        s = np.ones_like(self._state.s)
        y[self._places] = tolerance.y
        s[self.eight.s + np.arange(LANES)[:, None]] = tolerance.s
        first_step = first_step_at(tolerance, self._longest, self._order)
        places = self._places, numbers, self.eight.numbers
        begin = Starts(starts, *places, self.eight.memory, first_step)
        state = keep(self._state)
        times = self.layout.times
        record = self.record(columns)
        kept = keep(tolerance._replace(y=y, s=s))
        before = self.coefficients, kept, self._clocks, state, times, record
        return before, (keep(queue), keep(begin), *map(keep, self._scratch))


class KnownSteps(Chunks):
    """Chunks for a known number of steps: no more deviates are drawn than are used."""

    def __init__(self, count: int, most: int) -> None:
        self._left = count
        self._most = most

    def steps(self) -> int:
        """All steps that are left, but at most so many."""
        chunk = max(1, min(self._left, self._most))
        self._left -= chunk
        return chunk


class SplittingLanes(LaneLoop):
    def prepare(self, setting: Setting) -> None:
        """Keep one clock for all lanes and count deviates of a step, and compile the loop."""
        self._clocks = np.zeros(1, CLOCK).view(np.recarray)
        watch = room((WATCHED, LANES))
        speeds = room((3, self.eight.model.each.shape[1]))
        self._state, self._watch, *self._scratch = self.keep(
            (self._state, watch, self._work, speeds), [self._clocks]
        )
        nothing = Deviates(np.empty((0, LANES)), np.zeros(1, np.int64))
        fulfil(step_units(self.eight.model, self._state, self._work, nothing, listed=False))
        self._draws = self.coefficients.kicks.size * deviates_of_substep(self.layout)
        columns = sample_columns(self.layout, LANES)
        step = setting.of_equal_steps()
        times = self.layout.times
        examples = self._arguments(step, times, columns, 0, np.empty((0, LANES)))
        self._entry = EntryPoint(shared_loop(splitting_members), self._kept, examples)

    def run_in_lanes(
        self,
        setting: Setting,
        starts: MemberStarts,
        numbers: np.ndarray,
        columns: Columns,
        sums: np.ndarray,
    ) -> np.ndarray:
        """Run members eight by eight: with equal steps, all of them end together."""
        step = setting.of_equal_steps()
        members = len(starts.y)
        times = self.layout.times.size
        chosen = np.arange(padded(members)).clip(max=members - 1)
        counts = np.empty((members, COUNTS), np.int64)
        for first in range(0, members, LANES):
            own = chosen[first : first + LANES]
            rows = slice(first * times, (first + LANES) * times)
            some = tuple(each[rows] for each in columns)
            self.eight.memory[self.eight.numbers] = numbers[own]
            lost = self._run_eight(step, starts.y[own], starts.seeds[own].tolist(), some)
            counts[own, CODE] = np.where(lost, PAUSED, COMPLETED)
            clock = self._clocks[0]
            counts[own, STEPS] = clock.steps
            counts[own, EVALUATIONS] = clock.evaluations
            if sums.size:
                found = self._state.memory[MOVED - WATCH_ROWS :, self._watched_places]
                sums[own] = np.moveaxis(found, 1, 0)
        return counts

    def _run_eight(
        self, step: float, starts: np.ndarray, seeds: list[int], columns: Columns
    ) -> np.ndarray:
        """Run eight members; which of them need a loop of their own, (8,)."""
        self.forget()
        self._state.y[self._places] = starts
        most = min(MOST_STEPS, MOST_DEVIATES // max(1, self._draws))
        generators = [np.random.default_rng([seed, 2]) for seed in seeds] if self._draws else []
        code = COMPLETED
        begin = self.layout.times[0]
        for leg, stops, is_sample in self._legs.each(self.layout.times):
            self._legs.set_leg(leg)
            ahead = np.append(begin, stops[stops > begin])
            begin = stops[-1]
            left = int(np.sum(count_of_steps(np.diff(ahead), step)))

            def advance(steps: int, stops: np.ndarray = stops) -> int:
                deviates = np.empty((steps * self._draws, LANES))
                for lane, generator in enumerate(generators):
                    deviates[:, lane] = generator.standard_normal(len(deviates))
                arguments = self._arguments(step, stops, columns, steps, deviates)
                return int(self._entry(*arguments))

            code = drive(advance, KnownSteps(left, most))
            if code != COMPLETED:
                break
            if not is_sample:
                self._clocks[0].sample -= 1
        return np.asarray((self._watch[LOST] > 0.0) | (code != COMPLETED))

    def _arguments(
        self,
        step: float,
        times: np.ndarray,
        columns: Columns,
        budget: int,
        deviates: np.ndarray,
    ) -> tuple[Any, ...]:
        """The arguments of the loop, behind the model."""
        state = keep(self._state)
        record = self.record(columns)
        run = self._clocks, state, times, record, budget
        noise = Deviates(deviates, np.zeros(1, np.int64))
        return self.coefficients, step, *run, self._watch, noise, *map(keep, self._scratch)


def deviates_of_substep(layout: Layout) -> int:
    """Normal deviates that a member takes for a substep of its reservoirs."""
    s = layout.surfaces
    noisy = np.maximum(s["temperature"], s["swing_temperature"]) > 0.0
    each = 4 * (s["gamma"] > 0.0) + 2 * (s["swing_gamma"] > 0.0)
    return int(np.sum(noisy * (s["end"] - s["start"]) * each))
