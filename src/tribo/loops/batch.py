"""Many runs of one scene: what they begin from, what they give, and the loops that run them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.kernels.status import CODE, COMPLETED
from tribo.layout.layout import Layout
from tribo.layout.scene_records import MemberNumbers
from tribo.ledger.reactions import add_reactions
from tribo.ledger.samples import Samples, sample_columns
from tribo.loops.integrate import Columns, Setting

T = TypeVar("T")


class MemberStarts(NamedTuple):
    """Members before their runs."""

    y: np.ndarray  # (members, 2 coordinates) at t = 0
    seeds: np.ndarray  # (members,) from which noise is drawn
    numbers: MemberNumbers | None = None  # where members have numbers of their own

    def of_members(self, selected: np.ndarray | slice) -> MemberStarts:
        """Some of them."""
        numbers = None if self.numbers is None else self.numbers.of_members(selected)
        return MemberStarts(self.y[selected], self.seeds[selected], numbers)

    def pieces(self, size: int) -> list[MemberStarts]:
        """So many of them at a time."""
        firsts = range(0, len(self.y), size)
        return [self.of_members(slice(first, first + size)) for first in firsts]


class MemberRuns(NamedTuple):
    """The runs of some members."""

    layout: Layout  # by which the samples are read
    samples: Samples  # without a meaning for members that did not complete
    # (members, COUNTS); the code is PAUSED where a member needs a run of its own.
    counts: np.ndarray

    @property
    def complete(self) -> np.ndarray:
        """Which members reached the end, (members,)."""
        return np.asarray(self.counts[:, CODE] == COMPLETED)

    @classmethod
    def of(cls, layout: Layout, samples: Samples, counts: np.ndarray) -> MemberRuns:
        """The runs with these samples, to which the reactions on driven bars are added."""
        if layout.model.pivots is not None:
            add_reactions(layout, samples.y, samples.s, samples.at_start(samples.y))
        return cls(layout, samples, counts)

    def of_members(self, selected: np.ndarray) -> MemberRuns:
        """The runs of some members, by their indices or a mask."""
        layout = self.layout
        if layout.numbers is not None:
            layout = replace(layout, numbers=layout.numbers.of_members(selected))
        return MemberRuns(layout, self.samples.of_members(selected), self.counts[selected])


class MemberLoop(Protocol):
    """A compiled loop over members, with memory of its own."""

    def run(self, setting: Setting, starts: MemberStarts) -> MemberRuns:
        """Run members with a step or tolerances."""


class RecordingLoop(ABC):
    """A loop over members that records samples as those of single runs, member by member."""

    layout: Layout

    @abstractmethod
    def fill(self, setting: Setting, starts: MemberStarts, columns: Columns) -> np.ndarray:
        """Run members, fill in their samples (members, times, ...), and return their counts."""

    def run(self, setting: Setting, starts: MemberStarts) -> MemberRuns:
        """Run members with a step or tolerances, and return their samples."""
        layout, times, members = self.layout, self.layout.times, len(starts.y)
        columns = sample_columns(layout, padded(members), times.size)
        counts = self.fill(setting, starts, columns)
        each_time = (
            np.swapaxes(each[:members], 0, 1).reshape(times.size * members, *each.shape[2:])
            for each in columns
        )
        samples = Samples.of_runs(members, np.repeat(times, members), *each_time)
        if starts.numbers is not None:
            layout = replace(layout, numbers=starts.numbers, member_times=times.size)
        return MemberRuns.of(layout, samples, counts)


def padded(members: int) -> int:
    """So many members, rounded up to whole blocks."""
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
        """Run members with a step or tolerances, in this thread.

        What a member gives depends on that member alone.
        """
        loop = self.take()
        runs = loop.run(setting, starts)
        self.give_back(loop)
        return runs
