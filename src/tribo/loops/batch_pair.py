"""Many runs of one scene of two asperites, one after another."""

from __future__ import annotations

import numpy as np

from tribo.compiler.jit import EntryPoint, time_loop
from tribo.compiler.potential_numbers import numbers_of
from tribo.integrators.step_control import Tolerance
from tribo.kernels.records import CLOCK
from tribo.kernels.status import COUNTS
from tribo.layout.layout import Layout
from tribo.layout.member_numbers import LayoutOfMembers, MemberNumbers
from tribo.layout.pair_scene import factors_of, mobility_of, record_of
from tribo.ledger.pair_samples import PairSamples
from tribo.loops.batch import MemberRuns, MemberStarts
from tribo.loops.integrate import Setting
from tribo.loops.pair import Pair
from tribo.pair.loop import COLUMNS
from tribo.pair.members import pair_members
from tribo.pair.step_rows import LIMITS, STATE
from tribo.plugins.compile_errors import compiling
from tribo.plugins.sources import source_stamp

# Steps after which a member is left to a run of its own, which is guarded against no progress.
MOST_STEPS = 2048


class PairMembers:
    """The loop of single runs for many members, without Python between them.

    Raises InputError if the potential does not compile.
    """

    def __init__(self, pair: Pair) -> None:
        self._pair = pair
        self._times, self._size = pair.layout.times, pair.layout.start.size
        self._record, potential = pair.scene_arguments
        self._numbers = np.array([numbers_of(potential)], float)
        self._rows, self._clocks = pair.rows(), np.zeros(1, CLOCK)
        starts, samples, counts = np.empty((1, self._size)), self._room(1), self._counts(1)
        examples = self._arguments(self._record, self._numbers, starts, samples, counts)
        loop = time_loop(pair_members, source_stamp(pair.layout.plugins))
        with compiling(loop, pair.layout.named_plugins):
            self._loop = EntryPoint(loop, (potential,), examples)

    def run(self, setting: Setting, starts: MemberStarts) -> MemberRuns:
        """Run members with tolerances."""
        assert isinstance(setting, Tolerance)
        self._rows[LIMITS:STATE] = self._pair.limits(setting)
        self._clocks["encounter_fraction"] = setting.encounter_fraction
        record, potential, numbers = self._record, self._numbers, starts.numbers
        if numbers is not None:
            record = records_of(self._pair.layout, numbers)
            potential = np.ascontiguousarray(numbers.potential)
        members = len(starts.y)
        samples, counts = self._room(members), self._counts(members)
        y = np.ascontiguousarray(starts.y)
        self._loop(*self._arguments(record, potential, y, samples, counts))
        return pair_runs(self._pair, self._times, samples, counts, numbers)

    def _room(self, members: int) -> np.ndarray:
        return np.empty((self._times.size, members, COLUMNS))

    def _counts(self, members: int) -> np.ndarray:
        return np.empty((members, COUNTS), np.int64)

    def _arguments(
        self,
        record: np.ndarray,
        potential: np.ndarray,
        starts: np.ndarray,
        samples: np.ndarray,
        counts: np.ndarray,
    ) -> tuple[np.ndarray | int, ...]:
        """The arguments of the loop, behind the potential."""
        return (
            record,
            potential,
            self._rows,
            self._clocks,
            starts,
            np.empty(self._size),
            self._times,
            np.empty((self._times.size + 1, COLUMNS)),
            samples,
            counts,
            MOST_STEPS,
        )


def pair_runs(
    pair: Pair,
    times: np.ndarray,
    samples: np.ndarray,
    counts: np.ndarray,
    numbers: MemberNumbers | None,
) -> MemberRuns:
    """Runs of a pair's members from rows of the loop's record, (times, members, COLUMNS).

    With numbers of their own, or those of the scene.
    """
    layout, members = pair.layout, len(counts)
    rows = samples.reshape(-1, COLUMNS)
    found = PairSamples(np.repeat(times, members), rows, samples[0], pair.factors)
    if numbers is None:
        return MemberRuns(layout, found, counts)
    mobility = mobility_of(layout, numbers.asperites)
    own = found.with_factors(*factors_of(layout, numbers.asperites, mobility))
    return MemberRuns.of(LayoutOfMembers.of(layout, numbers), own, counts)


def records_of(layout: Layout, numbers: MemberNumbers) -> np.ndarray:
    """The scene of each member as the pair's loop reads it, (members,)."""
    mobility = mobility_of(layout, numbers.asperites)
    return record_of(numbers.asperites, layout.depths, numbers.charges, mobility)
