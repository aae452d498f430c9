"""Many runs of one scene of two asperites in the lanes of registers, of which the ends are kept."""

from __future__ import annotations

import numpy as np

from tribo.compiler.jit import EntryPoint, time_loop
from tribo.compiler.lanes import LANES
from tribo.compiler.potential_numbers import numbers_of
from tribo.integrators.nystrom import Nystrom
from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import PAUSED
from tribo.layout.member_numbers import MemberNumbers
from tribo.ledger.member_samples import MemberRuns
from tribo.loops.batch_pair import MOST_STEPS, PairMemberSamples, member_runs, records_of
from tribo.loops.pair import Pair
from tribo.pair import lanes
from tribo.pair.forces import PairScene
from tribo.pair.lanes import GROUPS, coefficients, pair_members_in_lanes
from tribo.pair.loop import COLUMNS
from tribo.pair.members import CODE
from tribo.pair.step_rows import FIRST, OF_J, OF_V1, OF_V2
from tribo.plugins.compile_errors import compiling
from tribo.plugins.sources import source_stamp

Arguments = tuple[np.ndarray | int | None, ...]


def has_lanes(pair: Pair) -> bool:
    """Whether all that is reported of a scene follows from its motion by conservation of energy.

    At most one asperite may be free, and neither surface may move along y.
    """
    along_x = all(surface.velocity[1] == 0.0 for surface in pair.layout.scene.surfaces)
    return bool(along_x and _follow_from_motion(pair.scene_arguments[0])[0])


def _follow_from_motion(records: np.ndarray) -> np.ndarray:
    """Whether the ledgers of pairs that do not move along y do so, (members,)."""
    used = [records[name] != 0.0 for name in ("arm1", "arm2", "lever_x1", "lever_x2", "gap_y")]
    forced = [records[f"lever_x{i}"] == records[f"lever_y{i}"] for i in (1, 2)]
    return np.asarray(np.logical_and.reduce(used) & np.logical_or.reduce(forced))


class PairLanes:
    """Runs members of a scene of two asperites in lanes, by an explicit method.

    Parameters
    ----------
    pair : Pair
        The scene, for which `has_lanes` is true.
    method : Nystrom
        The method.
    duration : float
        Of the runs [time].
    own_numbers : bool
        Whether members have numbers of their own.

    Raises
    ------
    InputError
        If the potential does not compile.
    """

    def __init__(
        self, pair: Pair, method: Nystrom, duration: float, own_numbers: bool = False
    ) -> None:
        self._pair = pair
        self._times = np.array([0.0, duration])
        self._stages = method.c.size
        flat = coefficients(method)
        self._table = np.zeros((-(-flat.size // LANES), LANES))
        self._table.flat[: flat.size] = flat
        (record,), potential = pair.scene_arguments
        numbers = len(PairScene._fields) + len(numbers_of(potential))
        scenes = np.zeros((1, numbers)) if own_numbers else None
        rows = lanes.F + 3 * self._stages + (numbers if own_numbers else 0)
        self._rows = GROUPS * rows
        examples = self._arguments(scenes, np.zeros((1, LANES)), *self._memory(1))
        loop = time_loop(pair_members_in_lanes, source_stamp(pair.layout.plugins))
        with compiling(loop, pair.layout.named_plugins):
            self._loop = EntryPoint(loop, (PairScene(*record.item()), potential), examples)

    def run(
        self, tolerance: Tolerance, starts: np.ndarray, numbers: MemberNumbers | None = None
    ) -> MemberRuns:
        """Run members from `starts` (members, 2 coordinates), in this thread.

        With `numbers` of their own, where they have such.  Those whose ledger does not follow from
        their motion have the status PAUSED.
        """
        limits = self._pair.limits(tolerance)[0]
        bounds = np.zeros((1, LANES))
        bounds[0, [lanes.UNIT1, lanes.UNIT2, lanes.UNITK]] = 1.0 / limits[[OF_V1, OF_V2, OF_J]]
        bounds[0, lanes.FIRST] = limits[FIRST]
        bounds[0, lanes.NEAR] = tolerance.encounter_fraction
        bounds[0, lanes.END] = self._times[-1]
        bounds[0, lanes.MOST_TRIALS] = MOST_STEPS
        samples, counts = self._memory(len(starts))
        scenes, others = None, np.zeros(len(starts), bool)
        if numbers is not None:
            records = records_of(self._pair.layout, numbers)
            scenes = np.column_stack(
                [records.view(float).reshape(len(starts), -1), numbers.potential]
            )
            others = ~_follow_from_motion(records) | np.any(numbers.velocity[..., 1], axis=1)
        starts = np.ascontiguousarray(starts)
        self._loop(*self._arguments(scenes, bounds, samples, counts, starts))
        counts[others, CODE] = PAUSED
        found = PairMemberSamples(self._times, samples, self._pair.factors)
        return member_runs(self._pair.layout, found, counts, numbers)

    def _memory(self, members: int) -> tuple[np.ndarray, np.ndarray]:
        return np.empty((2, members, COLUMNS)), np.empty((members, 3), np.int64)

    def _arguments(
        self,
        scenes: np.ndarray | None,
        bounds: np.ndarray,
        samples: np.ndarray,
        counts: np.ndarray,
        starts: np.ndarray | None = None,
    ) -> Arguments:
        """The arguments of the loop, behind the scene."""
        return (
            scenes,
            np.zeros((self._rows, LANES)),
            self._table,
            bounds,
            np.empty((1, self._pair.layout.start.size)) if starts is None else starts,
            samples,
            counts,
            np.empty((GROUPS, LANES), np.int64),
            self._stages,
        )
