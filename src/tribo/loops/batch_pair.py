"""Many runs of one scene of two asperites: one after another, or in the lanes of registers."""

from typing import Any

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.numbers_in_lanes import numbers_of
from tribo.integrators.nystrom import Nystrom
from tribo.kernels.records import CLOCK
from tribo.kernels.status import CODE, COUNTS, PAUSED
from tribo.lanes.refill import queue_of
from tribo.ledger.pair_samples import PairSamples
from tribo.loops.batch import MemberRuns, MemberStarts
from tribo.loops.pair import Pair, entry_of
from tribo.loops.setting import Setting
from tribo.pair import lanes
from tribo.pair.forces import PAIR_NUMBERS, PairScene
from tribo.pair.lanes import GROUPS, coefficients, pair_members_in_lanes
from tribo.pair.loop import COLUMNS, pair_members
from tribo.pair.step_rows import FIRST, LIMITS, OF_J, OF_V1, OF_V2, STATE

# Steps after which a member is left to a run of its own, which is guarded against no progress.
MOST_STEPS = 2048


# Arguments of the loop in lanes that each call makes: memory, method, samples, and the queue.
MADE = (1, 2, 4, 5)


class PairMembers:
    """The loop of single runs for many members.  Raises InputError if the potential fails."""

    def __init__(self, pair: Pair) -> None:
        """Compile the loop, which takes the numbers of members as arguments."""
        self._pair = pair
        self._times = pair.layout.times
        self._record = pair.record
        self._numbers = pair.numbers
        self._rows = pair.rows()
        self._clocks = np.zeros(1, CLOCK)
        starts = np.empty((1, pair.layout.start.size))
        examples = self._arguments(self._record, self._numbers, starts)
        self._loop = entry_of(pair_members, "members", (pair.units,), examples)

    def run(self, setting: Setting, starts: MemberStarts) -> MemberRuns:
        """The runs of some members; those whose start the loop cannot have are PAUSED."""
        tolerance = setting.of_adaptive_steps()
        self._rows[LIMITS:STATE] = self._pair.limits(setting)
        self._clocks["encounter_fraction"] = tolerance.encounter_fraction
        record = self._record
        addresses = self._numbers
        numbers = starts.numbers
        if numbers is not None:
            record = self._pair.members(numbers).record
            potential = np.ascontiguousarray(numbers.potential)
            addresses = addresses.repeat(len(potential))
            if potential.shape[1] > 0:
                addresses = potential.ctypes.data + potential.strides[0] * np.arange(len(potential))
        self._clocks["evaluations"] = 0
        arguments = self._arguments(record, addresses, np.ascontiguousarray(starts.y))
        self._loop(*arguments)
        records = arguments[-2].reshape(len(starts.y), -1, COLUMNS)
        records = records.swapaxes(0, 1)  # (times + 1, members, COLUMNS)
        counts = records[-1, :, :COUNTS].astype(np.int64)
        counts[self._pair.lacks(starts.y), CODE] = PAUSED
        return _pair_runs(self._pair, self._times, records[:-1], counts, starts)

    def _arguments(
        self, record: np.ndarray, addresses: np.ndarray, starts: np.ndarray
    ) -> tuple[Any, ...]:
        """The arguments of the loop, behind the potential; records before the last."""
        times = self._times
        records = np.empty((len(starts) * (times.size + 1), COLUMNS))
        members = record, addresses
        return members, self._rows, self._clocks, starts, times, records, MOST_STEPS


def _pair_runs(
    pair: Pair, times: np.ndarray, samples: np.ndarray, counts: np.ndarray, starts: MemberStarts
) -> MemberRuns:
    """Runs of a pair's members from rows of its record, (times, members, COLUMNS)."""
    layout = pair.layout
    each_time = times.repeat(len(counts))
    numbers = starts.numbers
    found = PairSamples(each_time, samples.reshape(-1, COLUMNS), samples[0], pair.factors)
    if numbers is None:
        return MemberRuns(layout, found, counts)
    own = pair.members(numbers)
    return MemberRuns.of(own.layout(times.size), found.with_factors(*own.factors), counts)


def has_lanes(pair: Pair) -> bool:
    """Whether all that is reported of a scene follows from its motion by conservation of energy.

    At most one asperite may be free, and neither surface may move along y.
    """
    along_x = all(surface.velocity[1] == 0.0 for surface in pair.layout.scene.surfaces)
    return bool(along_x and _follow_from_motion(pair.record)[0])


def _follow_from_motion(records: np.ndarray) -> np.ndarray:
    """Whether the ledgers of pairs that do not move along y do so, (members,)."""
    used = [records[name] != 0.0 for name in ("arm1", "arm2", "lever_x1", "lever_x2", "gap_y")]
    forced = [records[f"lever_x{i}"] == records[f"lever_y{i}"] for i in (1, 2)]
    return np.asarray(np.logical_and.reduce(used) & np.logical_or.reduce(forced))


class PairLanes:
    """A loop over members of a scene with `has_lanes`, by an explicit method.

    Members whose ledger does not follow from their motion have the status PAUSED.  Raises
    InputError if the potential does not compile.
    """

    def __init__(self, pair: Pair, method: Nystrom, own_numbers: bool = False) -> None:
        """Compile the loop, with records in memory where members have `own_numbers`."""
        self._pair = pair
        self._times = np.array([0.0, pair.layout.scene.duration])
        self._stages = method.c.size
        self._table = coefficients(method)
        (record,) = pair.record
        numbers = PAIR_NUMBERS + len(numbers_of(pair.potential))
        scenes = np.zeros((1, numbers)) if own_numbers else None
        rows = lanes.F + 3 * self._stages + own_numbers * numbers
        self._memory = GROUPS, rows, LANES  # its shape
        starts = np.empty((1, pair.layout.start.size))
        examples = self._arguments(scenes, np.zeros(lanes.MOST_TRIALS + 1), starts)
        fixed = PairScene(*record.item()), pair.units_in_lanes(own_numbers)
        self._loop = entry_of(pair_members_in_lanes, own_numbers, fixed, examples, MADE)

    def run(self, setting: Setting, starts: MemberStarts) -> MemberRuns:
        """The runs of some members, at their ends; those that lanes cannot have are PAUSED."""
        y = np.ascontiguousarray(starts.y)
        numbers = starts.numbers
        scenes = None
        others = self._pair.lacks(y)
        if numbers is not None:
            records = self._pair.members(numbers).record
            scenes = np.column_stack([records.view(float).reshape(len(y), -1), numbers.potential])
            others |= ~_follow_from_motion(records) | np.any(numbers.velocity[..., 1], axis=1)
        arguments = self._arguments(scenes, self._limits(setting), y)
        self._loop(*arguments)
        samples, queue = arguments[-2:]
        queue.counts[others, CODE] = PAUSED
        return _pair_runs(self._pair, self._times, samples, queue.counts, starts)

    def _limits(self, setting: Setting) -> np.ndarray:
        """UNIT1 to MOST_TRIALS."""
        tolerance = setting.of_adaptive_steps()
        limits = self._pair.limits(setting)[0]
        units = 1.0 / limits[[OF_V1, OF_V2, OF_J]]
        others = limits[FIRST], tolerance.encounter_fraction, self._times[-1], MOST_STEPS
        return np.array([*units, *others])

    def _arguments(
        self, scenes: np.ndarray | None, bounds: np.ndarray, starts: np.ndarray
    ) -> tuple[Any, ...]:
        """The arguments of the loop, behind the scene; samples and queue are the last."""
        members = len(starts)
        memory = np.zeros(self._memory)
        samples = np.empty((2, members, COLUMNS))
        queue = queue_of(members, GROUPS * LANES)
        method = self._table, bounds, self._stages
        return scenes, memory, method, starts, samples, queue
