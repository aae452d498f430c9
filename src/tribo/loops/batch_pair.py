"""Many runs of one scene of two asperites, which differ in their starts."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from tribo.compiler.jit import EntryPoint, time_loop
from tribo.compiler.potential_numbers import numbers_of
from tribo.integrators.step_control import Tolerance
from tribo.kernels.records import CLOCK
from tribo.layout.layout import Layout
from tribo.layout.member_numbers import LayoutOfMembers, MemberNumbers
from tribo.layout.pair_factors import Factors, factors_of
from tribo.ledger.member_samples import MemberRuns, MemberSamples
from tribo.ledger.pair_samples import PairSamples
from tribo.loops.pair import Pair, mobility_of, record_of
from tribo.pair.loop import COLUMNS
from tribo.pair.members import pair_members
from tribo.pair.step_rows import LIMITS, STATE
from tribo.plugins.compile_errors import compiling
from tribo.plugins.sources import source_stamp

# Steps after which a member is left to a run of its own, which is guarded against no progress.
MOST_STEPS = 2048


class PairMemberSamples(PairSamples, MemberSamples):
    """The samples of several runs of a pair, which stay in the loop's record.

    Parameters
    ----------
    t : ndarray, (times,)
        When they were recorded; the first is the start of the runs.
    record : ndarray, (times, members, COLUMNS)
        Rows of the loop's record.
    factors : Factors
        Of the scene's layout.
    """

    def __init__(self, t: np.ndarray, record: np.ndarray, factors: Factors) -> None:
        self.members = record.shape[1]
        rows = record.reshape(-1, COLUMNS)
        first = np.tile(record[0], (t.size, 1))
        super().__init__(np.repeat(t, self.members), rows, first, factors)

    @cached_property
    def y(self) -> np.ndarray:  # type: ignore[override]
        """Coordinates and their rates, (times x members, 2 coordinates).

        Each is a multiple of one column: a product of matrices takes as long as half of the runs.
        """
        state = self._factors.state[:, :COLUMNS]
        columns = np.argmax(np.abs(state), axis=1)
        return self._record[:, columns] * state[np.arange(len(state)), columns]

    def of_members(self, selected: np.ndarray) -> PairMemberSamples:
        """The samples of some members, by their indices or a mask."""
        t = self.t[:: self.members]
        record = self._record.reshape(t.size, self.members, COLUMNS)[:, selected]
        return PairMemberSamples(t, np.ascontiguousarray(record), self._factors)

    def with_factors(self, state: np.ndarray, accounts: np.ndarray) -> MemberSamples:
        """The samples as they are where each member has factors of its own.

        They are those of :func:`tribo.layout.pair_factors.factors_of`, (members, ..., columns).
        """
        columns = self._columns.reshape(-1, self.members, state.shape[2]).swapaxes(0, 1)
        y, s = (
            (columns @ factors.swapaxes(1, 2)).swapaxes(0, 1).reshape(self.t.size, -1)
            for factors in (state, accounts)
        )
        return MemberSamples(
            self.members, self.t, y, s, self.contact, self.field, self.stored, self.baths
        )


class Memory(NamedTuple):
    """Arrays of the loop over members, in the order of its arguments."""

    clocks: np.ndarray
    starts: np.ndarray
    start: np.ndarray
    times: np.ndarray
    record: np.ndarray
    samples: np.ndarray
    counts: np.ndarray


class PairMembers:
    """Runs members of a scene of two asperites, in threads.

    Parameters
    ----------
    pair : Pair
        The scene and the loop of its single runs.
    times : ndarray, (times,)
        When to record; the first is 0.

    Raises
    ------
    InputError
        If the potential does not compile.
    """

    def __init__(self, pair: Pair, times: np.ndarray) -> None:
        self._pair = pair
        self._times = times
        self._record, potential = pair.scene_arguments
        self._numbers = np.array([numbers_of(potential)], float)
        examples = (self._record, self._numbers, pair.rows(), *self._memory(1), MOST_STEPS)
        loop = time_loop(pair_members, source_stamp(pair.layout.plugins))
        with compiling(loop, pair.layout.named_plugins):
            self._loop = EntryPoint(loop, (potential,), examples)

    def run(
        self, tolerance: Tolerance, starts: np.ndarray, numbers: MemberNumbers | None = None
    ) -> MemberRuns:
        """Run members from `starts` (members, 2 coordinates), in this thread.

        With `numbers` of their own, or those of the scene.
        """
        layout = self._pair.layout
        rows = self._pair.rows()
        rows[LIMITS:STATE] = self._pair.limits(tolerance)
        memory = self._memory(len(starts))
        memory.clocks["encounter_fraction"] = tolerance.encounter_fraction
        memory.starts[...] = starts
        record, potential = self._record, self._numbers
        if numbers is not None:
            record, potential = records_of(layout, numbers), np.ascontiguousarray(numbers.potential)
        self._loop(record, potential, rows, *memory, MOST_STEPS)
        samples = PairMemberSamples(self._times, memory.samples, self._pair.factors)
        return member_runs(layout, samples, memory.counts, numbers)

    def _memory(self, members: int) -> Memory:
        """Memory for so many members."""
        size, times = self._pair.layout.start.size, self._times
        return Memory(
            np.zeros(1, CLOCK),
            np.empty((members, size)),
            np.empty(size),
            times,
            np.empty((times.size + 1, COLUMNS)),
            np.empty((times.size, members, COLUMNS)),
            np.empty((members, 3), np.int64),
        )


def member_runs(
    layout: Layout, samples: PairMemberSamples, counts: np.ndarray, numbers: MemberNumbers | None
) -> MemberRuns:
    """Runs of a pair's members, with numbers of their own or those of the scene."""
    if numbers is None:
        return MemberRuns(layout, samples, counts)
    mobility = mobility_of(layout, numbers.asperites)
    own = samples.with_factors(*factors_of(layout, numbers.asperites, mobility))
    return MemberRuns.of(LayoutOfMembers.of(layout, numbers), own, counts)


def records_of(layout: Layout, numbers: MemberNumbers) -> np.ndarray:
    """The scene of each member as the pair's loop reads it, (members,)."""
    mobility = mobility_of(layout, numbers.asperites)
    return record_of(numbers.asperites, layout.depths, numbers.charges, mobility)
