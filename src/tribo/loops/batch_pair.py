"""Many runs of one scene of two asperites, one after another."""

from __future__ import annotations

from typing import Any

import numpy as np

from tribo.compiler.numbers_in_lanes import numbers_of
from tribo.integrators.step_control import Tolerance
from tribo.kernels.records import CLOCK
from tribo.kernels.status import COUNTS
from tribo.layout.compiled import entry_point
from tribo.layout.layout import Layout
from tribo.layout.member_numbers import MemberNumbers
from tribo.layout.pair_scene import factors_of, mobility_of, record_of
from tribo.ledger.pair_samples import PairSamples
from tribo.loops.batch import MemberRuns, MemberStarts
from tribo.loops.integrate import Setting
from tribo.loops.pair import Pair
from tribo.pair.loop import COLUMNS, pair_members
from tribo.pair.step_rows import LIMITS, STATE

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
        examples = self._arguments(self._record, self._numbers, np.empty((1, self._size)))
        self._loop = entry_point(pair.layout, pair_members, (potential,), examples)

    def run(self, setting: Setting, starts: MemberStarts) -> MemberRuns:
        """Run members with tolerances."""
        assert isinstance(setting, Tolerance)
        self._rows[LIMITS:STATE] = self._pair.limits(setting)
        self._clocks["encounter_fraction"] = setting.encounter_fraction
        record, potential, numbers = self._record, self._numbers, starts.numbers
        if numbers is not None:
            record = records_of(self._pair.layout, numbers)
            potential = np.ascontiguousarray(numbers.potential)
        arguments = self._arguments(record, potential, np.ascontiguousarray(starts.y))
        self._loop(*arguments)
        samples, counts = arguments[-3:-1]
        return pair_runs(self._pair, self._times, samples, counts, numbers)

    def _arguments(
        self, record: np.ndarray, potential: np.ndarray, starts: np.ndarray
    ) -> tuple[Any, ...]:
        """The arguments of the loop, behind the potential; samples and counts before the last."""
        members, times = len(starts), self._times.size
        return (
            record,
            potential,
            self._rows,
            self._clocks,
            starts,
            np.empty(self._size),
            self._times,
            np.empty((times + 1, COLUMNS)),
            np.empty((times, members, COLUMNS)),
            np.empty((members, COUNTS), np.int64),
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
    layout, each_time = pair.layout, np.repeat(times, len(counts))
    found = PairSamples(each_time, samples.reshape(-1, COLUMNS), samples[0], pair.factors)
    if numbers is None:
        return MemberRuns(layout, found, counts)
    mobility = mobility_of(layout, numbers.asperites)
    own = found.with_factors(*factors_of(layout, numbers.asperites, mobility))
    return MemberRuns.of(layout.of_members(numbers), own, counts)


def records_of(layout: Layout, numbers: MemberNumbers) -> np.ndarray:
    """The scene of each member as the pair's loop reads it, (members,)."""
    mobility = mobility_of(layout, numbers.asperites)
    return record_of(numbers.asperites, layout.depths, numbers.charges, mobility)
