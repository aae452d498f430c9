"""Many runs of one scene: what they begin from and give, and the loop that takes one by one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numba import config

from tribo.compiler.kept import keep
from tribo.compiler.lanes import LANES
from tribo.integrators.methods import Method
from tribo.kernels.status import CODE, COMPLETED, COUNTS, EVALUATIONS, PAUSED, STEPS
from tribo.layout.layout import Layout
from tribo.layout.scene_records import MemberNumbers
from tribo.ledger.motion import add_reactions
from tribo.ledger.samples import Samples, sample_columns
from tribo.ledger.sinks import exceeds_memory
from tribo.loops import integrate
from tribo.loops.driver import Chunks, drive
from tribo.loops.general import GeneralLoop, in_packs, is_damped, unit_setting
from tribo.loops.setting import Setting
from tribo.loops.stiffness import Stiffness, stiffness_of
from tribo.loops.time_loop import Columns, TimeLoop
from tribo.threads.writable_memory import arrays_in, together

T = TypeVar("T")
# Steps of a call of the loop, at most, since an interrupt waits for its end; no more than the guard
# of a run's progress lets pass before its first look.
MOST_STEPS = integrate.FEWEST_TRIALS


class MemberStarts(NamedTuple):
    """Members before their runs."""

    y: np.ndarray  # (members, 2 coordinates) at t = 0
    seeds: np.ndarray  # (members,) from which noise is drawn
    numbers: MemberNumbers | None = None  # where members have numbers of their own

    def of_members(self, selected: np.ndarray | slice) -> MemberStarts:
        numbers = None if self.numbers is None else self.numbers.of_members(selected)
        return MemberStarts(self.y[selected], self.seeds[selected], numbers)

    def pieces(self, size: int) -> list[MemberStarts]:
        """So many of them at a time."""
        firsts = range(0, len(self.y), size)
        return [self.of_members(slice(first, first + size)) for first in firsts]


class MemberRuns(NamedTuple):
    layout: Layout  # by which the samples are read
    samples: Samples  # without a meaning for members that did not complete
    # (members, COUNTS); the code is PAUSED where a member needs a run of its own.
    counts: np.ndarray
    stiffness: Stiffness | None = None  # that each has met; None without reservoirs

    @property
    def complete(self) -> np.ndarray:
        """Which members reached the end, (members,)."""
        complete: np.ndarray = self.counts[:, CODE] == COMPLETED
        return complete

    @classmethod
    def of(
        cls,
        layout: Layout,
        samples: Samples,
        counts: np.ndarray,
        stiffness: Stiffness | None = None,
    ) -> MemberRuns:
        """The runs with these samples, to which the reactions on driven bars are added."""
        if layout.model.pivots is not None:
            add_reactions(layout, samples.y, samples.s, samples.at_start(samples.y))
        return cls(layout, samples, counts, stiffness)

    def beside(self, *others: MemberRuns) -> MemberRuns:
        """These runs and those of further members, none of which have numbers of their own."""
        samples = self.samples.beside(*(each.samples for each in others))
        counts = np.concatenate([each.counts for each in (self, *others)])
        return MemberRuns(self.layout, samples, counts)

    def of_members(self, selected: np.ndarray) -> MemberRuns:
        """The runs of some members, by their indices or a mask."""
        layout = self.layout
        if layout.numbers is not None:
            layout = replace(layout, numbers=layout.numbers.of_members(selected))
        stiffness = self.stiffness and self.stiffness.of_members(selected)
        samples = self.samples.of_members(selected)
        return MemberRuns(layout, samples, self.counts[selected], stiffness)


class MemberLoop(Protocol):
    """A compiled loop over members, with memory of its own."""

    def run(self, setting: Setting, starts: MemberStarts) -> MemberRuns:
        """Run members with a step or tolerances."""


class RecordingLoop(ABC):
    """A loop over members that records samples as those of single runs, member by member."""

    layout: Layout
    watches = True  # whether it measures the stiffness that reservoirs and equal steps meet
    _own: list[np.ndarray]
    _fresh: list[np.ndarray]

    def keep(self, items: tuple[Any, ...], others: Iterable[np.ndarray]) -> Any:
        """Nested tuples in memory that :meth:`forget` restores, as it does some other arrays."""
        moved, numbers = together(items)
        self._own = [numbers, *others]
        self._fresh = [array.copy() for array in self._own]
        return moved

    def forget(self) -> None:
        for array, fresh in zip(self._own, self._fresh, strict=True):
            array[...] = fresh

    @abstractmethod
    def fill(
        self, setting: Setting, starts: MemberStarts, columns: Columns, sums: np.ndarray
    ) -> np.ndarray:
        """Run members, fill in their samples (members, times, ...), and return their counts.

        With reservoirs, `sums` (members, 3, core) over their kicks are filled in, too.
        """

    def run(self, setting: Setting, starts: MemberStarts) -> MemberRuns:
        """The runs of some members; with a step and reservoirs also the stiffness that they met."""
        layout = self.layout
        times = self.layout.times
        members = len(starts.y)
        columns = sample_columns(layout, padded(members), times.size)
        watched = self.watches and is_damped(layout) and setting.step is not None
        sums = np.zeros((members if watched else 0, 3, layout.core))
        counts = self.fill(setting, starts, columns, sums)
        stiffness = None
        if watched:
            steps = int(np.max(counts[:, STEPS]))
            stiffness = stiffness_of(layout, sums, steps, setting.of_equal_steps(), starts.numbers)
        each_time = (np.concatenate(np.swapaxes(each[:members], 0, 1)) for each in columns)
        samples = Samples.of_runs(members, np.repeat(times, members), *each_time)
        if starts.numbers is not None:
            layout = replace(layout, numbers=starts.numbers, member_times=times.size)
        return MemberRuns.of(layout, samples, counts, stiffness)


def padded(members: int) -> int:
    """So many members, rounded up to whole packs."""
    return -(-members // LANES) * LANES


class Pool(Generic[T]):
    """Loops of one kind, made by `new`, each of which one thread uses at a time."""

    def __init__(self, new: Callable[[], T]) -> None:
        self._new = new
        self._idle: list[T] = []

    def take(self) -> T:
        """A loop that no thread uses; one that is not given back is not used again."""
        try:
            return self._idle.pop()
        except IndexError:
            return self._new()

    def give_back(self, loop: T) -> None:
        """Let other threads use the loop."""
        self._idle.append(loop)


class Batch(Pool[MemberLoop]):
    """Runs members of a scene, in any number of threads."""

    def run(self, setting: Setting, starts: MemberStarts) -> MemberRuns:
        """Run members in this thread; what a member gives depends on that member alone."""
        loop = self.take()
        runs = loop.run(setting, starts)
        self.give_back(loop)
        return runs


def has_batches(layout: Layout) -> bool:
    """Whether members need no results of their own, as force series and ASE calculators do."""
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    elastic = any(surface.elastic is not None for surface in layout.scene.surfaces)
    alone = layout.calculator_calls or elastic or layout.scene.output.series
    return compiled and not (alone or exceeds_memory(layout, layout.times.size))


class MemberChunks(Chunks):
    """Chunks of a member, whose progress is looked at where the first one does not end it."""

    def __init__(self, loop: TimeLoop) -> None:
        self._loop = loop
        self._guard: integrate.ProgressGuard | None = None

    def steps(self) -> int:
        return MOST_STEPS if self._guard is None else self._guard.within(MOST_STEPS)

    def goes_on(self, code: int) -> bool:
        """Whether a paused member makes progress; from its second chunk on, this is looked at."""
        if code != PAUSED:  # nearly always
            return False
        loop = self._loop
        if self._guard is None:
            times = loop.layout.times
            scene = loop.layout.scene
            most = integrate.most_evaluations(scene)
            guard = integrate.ProgressGuard(loop.clocks, times[0], times[-1], scene.count, most)
            self._guard = guard
        return not (loop.adaptive and self._guard.is_hopeless())


class GeneralMembers(GeneralLoop, RecordingLoop):
    """A loop for members of a scene with `has_batches`; `first_step` [time] is the longest one."""

    def __init__(self, layout: Layout, method: Method, first_step: float) -> None:
        """Compile the loop, and keep its memory, into which members are loaded."""
        setting = unit_setting(layout, method)
        super().__init__(layout, method, setting, layout.start, first_step)
        self.watches = method.splits
        self._longest = first_step
        others = arrays_in((self.clocks, self._neighbours.active))
        self.state, self._scratch = self.keep((self.state, self._scratch), others)
        self._clock_before = self._fresh[1]  # the first of the others, behind the numbers
        self._hold()
        q = layout.places.q
        coordinates = layout.room[0]
        self._places = np.concatenate([q, coordinates + q])

    def fill(
        self, setting: Setting, starts: MemberStarts, columns: Columns, sums: np.ndarray
    ) -> np.ndarray:
        """Run members from their seeds; the samples of those that did not complete are zeros."""
        self._constants = self._method.coefficients, keep(in_packs(setting, self.layout))
        tolerance = setting.tolerance
        if tolerance is not None:
            before = self._clock_before
            before["h"] = integrate.first_step_at(tolerance, self._longest, self._method.order)
            before["encounter_fraction"] = tolerance.encounter_fraction
        counts = np.empty((len(starts.y), COUNTS), np.int64)
        clock = self.clocks.view(np.ndarray)[0]
        for m, count in enumerate(counts):
            own = tuple(each[m] for each in columns)
            self.forget()
            self.forget_neighbours()
            self.state.y[self._places] = starts.y[m]
            if self._noise is not None:
                self._noise = np.random.default_rng([int(starts.seeds[m]), 2])
            count[CODE] = self._to_end(own)
            if sums.size:
                sums[m] = self.stiffness_sums
            count[STEPS] = clock["steps"]
            count[EVALUATIONS] = clock["evaluations"]
            if count[CODE] != COMPLETED:
                for each in own:
                    each[...] = 0.0
        return counts

    def _to_end(self, columns: Columns) -> int:
        """Run the member through the times of the scene; PAUSED if it makes no progress."""
        times = self.layout.times
        return drive(lambda steps: self.advance(times, columns, steps), MemberChunks(self))
