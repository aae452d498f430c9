"""Many runs of one scene of two asperites in the lanes of registers, of which the ends are kept."""

from __future__ import annotations

import numpy as np

from tribo.integrators.nystrom import Nystrom
from tribo.integrators.step_control import Tolerance
from tribo.kernels.compiled import EntryPoint, time_loop
from tribo.kernels.simd import LANES
from tribo.pair import lanes
from tribo.pair.lanes import GROUPS, coefficients, pair_members_in_lanes
from tribo.pair.loop import COLUMNS
from tribo.pair.step import FIRST, OF_J, OF_V1, OF_V2
from tribo.plugins.compile_errors import compiling
from tribo.plugins.sources import source_stamp
from tribo.run.member_samples import MemberRuns
from tribo.run.members import MOST_STEPS, PairMemberSamples
from tribo.run.pair_adapter import Pair

Arguments = tuple[np.ndarray | int, ...]


def has_lanes(pair: Pair) -> bool:
    """Whether all that is reported of a scene follows from its motion by conservation of energy.

    At most one asperite may be free, and neither surface may move along y.
    """
    (record,) = pair.scene_arguments[0]
    levers = [record[f"lever_x{i}"] == record[f"lever_y{i}"] != 0.0 for i in (1, 2)]
    arms = record["arm1"] != 0.0 and record["arm2"] != 0.0
    across = not np.any(pair.layout.asperites.vy) and record["gap_y"] != 0.0
    return bool(arms and across and any(levers) and record["lever_x1"] and record["lever_x2"])


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

    Raises
    ------
    InputError
        If the potential does not compile.
    """

    def __init__(self, pair: Pair, method: Nystrom, duration: float) -> None:
        self._pair = pair
        self._times = np.array([0.0, duration])
        self._stages = method.c.size
        flat = coefficients(method)
        self._table = np.zeros((-(-flat.size // LANES), LANES))
        self._table.flat[: flat.size] = flat
        examples = self._arguments(np.zeros((1, LANES)), *self._memory(1))
        loop = time_loop(pair_members_in_lanes, source_stamp(pair.layout.plugins))
        with compiling(loop, pair.layout.named_plugins):
            self._loop = EntryPoint(loop, pair.scene_arguments, examples)

    def run(self, tolerance: Tolerance, starts: np.ndarray) -> MemberRuns:
        """Run members from `starts` (members, 2 coordinates), in this thread."""
        limits = self._pair.limits(tolerance)[0]
        bounds = np.zeros((1, LANES))
        bounds[0, [lanes.UNIT1, lanes.UNIT2, lanes.UNITK]] = 1.0 / limits[[OF_V1, OF_V2, OF_J]]
        bounds[0, lanes.FIRST] = limits[FIRST]
        bounds[0, lanes.NEAR] = tolerance.encounter_fraction
        bounds[0, lanes.END] = self._times[-1]
        bounds[0, lanes.MOST_TRIALS] = MOST_STEPS
        samples, counts = self._memory(len(starts))
        self._loop(*self._arguments(bounds, samples, counts, np.ascontiguousarray(starts)))
        found = PairMemberSamples(self._times, samples, self._pair.factors)
        return MemberRuns(self._pair.layout, found, counts)

    def _memory(self, members: int) -> tuple[np.ndarray, np.ndarray]:
        return np.empty((2, members, COLUMNS)), np.empty((members, 3), np.int64)

    def _arguments(
        self,
        bounds: np.ndarray,
        samples: np.ndarray,
        counts: np.ndarray,
        starts: np.ndarray | None = None,
    ) -> Arguments:
        """The arguments of the loop, behind the scene."""
        return (
            np.zeros((GROUPS * (lanes.F + 3 * self._stages), LANES)),
            self._table,
            bounds,
            np.empty((1, self._pair.layout.start.size)) if starts is None else starts,
            samples,
            counts,
            np.empty((GROUPS, LANES), np.int64),
            self._stages,
        )
