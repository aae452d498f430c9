"""Many runs of one scene, eight side by side in the lanes of registers."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.integrators.methods import Method
from tribo.integrators.nystrom import Nystrom
from tribo.integrators.step_control import LARGEST
from tribo.kernels.samples import Record, initial_state
from tribo.kernels.status import CODE, COMPLETED, PAUSED
from tribo.layout.interleaved import interleaved
from tribo.layout.lane_numbers import LaneNumbers
from tribo.layout.layout import Layout
from tribo.layout.loop_memory import together
from tribo.loops.batch import MemberStarts, Pool, RecordingLoop
from tribo.loops.batch_general import GeneralMembers
from tribo.loops.integrate import Columns, Setting

# Asperites of a scene whose members are run side by side, at most: eight asperites of one run fill
# registers as well.
MOST_ASPERITES = 64


def fit_lanes(layout: Layout, method: Method) -> bool:
    """Whether members of a scene, which can be run in batches, are run in lanes."""
    if isinstance(method.coefficients, Nystrom):
        fits = layout.core == layout.coordinates  # oscillators of one member stand side by side
    else:
        fits = method.splits
    small = layout.asperites.size <= MOST_ASPERITES
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
        self.layout = layout
        self._longest, self._order, self._alone = first_step, method.order, alone
        eight = interleaved(layout, own_numbers)
        self._memory, self._places_of_numbers = np.empty(0), np.empty((LANES, 0), np.int64)
        self._numbers: LaneNumbers | None = None
        if own_numbers:
            self._numbers = own = LaneNumbers(layout, eight.model)
            eight = eight._replace(model=own.model)
            self._memory, self._places_of_numbers = own.memory, own.places
        self.eight = eight
        self.coefficients: Any = method.coefficients
        coordinates, accounts = eight.room
        start = np.zeros(2 * coordinates)
        self._state = initial_state(start, accounts, method.remembers, method.splits)
        self._work = self.coefficients.workspace(eight.model, self._state)
        core = eight.q[0, : layout.core]
        self._recorded = np.concatenate([core, coordinates + core]), eight.s
        self._places = np.concatenate([eight.q, coordinates + eight.q], axis=1)
        self._own: list[np.ndarray] = []
        self._fresh: list[np.ndarray] = []
        self.prepare(layout, method)

    @abstractmethod
    def prepare(self, layout: Layout, method: Method) -> None:
        """Make what else the loop needs, and compile it."""

    @abstractmethod
    def fill_lanes(
        self, setting: Setting, starts: MemberStarts, numbers: np.ndarray, columns: Columns
    ) -> np.ndarray:
        """Run members side by side, and record their samples, (members x times, ...).

        Returns their counts, with PAUSED of those that need a loop of their own.
        """

    def fill(self, setting: Setting, starts: MemberStarts, columns: Columns) -> np.ndarray:
        """Run members, fill in their samples, and return their counts."""
        members = len(starts.y)
        numbers = np.empty((members, 0))
        if self._numbers is not None:
            assert starts.numbers is not None
            numbers = self._numbers.rows(starts.numbers)
        rows = tuple(
            each.reshape(each.shape[0] * each.shape[1], *each.shape[2:]) for each in columns
        )
        counts = self.fill_lanes(setting, starts, numbers, rows)
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
            counts[alone] = loop.fill(setting, starts.of_members(alone), theirs)
            self._alone.give_back(loop)
            for each, own in zip(columns, theirs, strict=True):
                each[alone] = own
        return counts

    def record(self, columns: Columns) -> Record:
        """These arrays for the loop."""
        return Record(*columns, *self._recorded)  # type: ignore[call-arg]

    def keep(self, items: tuple[Any, ...], others: list[np.ndarray]) -> Any:
        """Nested tuples in memory that :meth:`forget` restores, as it does some other arrays."""
        moved, numbers = together(items)
        self._own = [numbers, *others]
        self._fresh = [array.copy() for array in self._own]
        return moved

    def forget(self) -> None:
        """Forget the members that were run before."""
        for array, fresh in zip(self._own, self._fresh, strict=True):
            array[...] = fresh
