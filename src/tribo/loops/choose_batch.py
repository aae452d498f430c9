"""The loop by which members of a scene are run: in lanes or one by one, as a pair or not."""

from __future__ import annotations

from tribo.integrators.methods import Method
from tribo.layout.layout import Layout
from tribo.loops.batch import Batch, Pool
from tribo.loops.batch_general import GeneralMembers
from tribo.loops.batch_pair import PairMembers
from tribo.loops.lane_loop import NystromLanes, SplittingLanes, fit_lanes
from tribo.loops.pair import Pair


def choose_batch(
    layout: Layout,
    method: Method,
    first_step: float,
    own_numbers: bool = False,
    pair: Pair | None = None,
) -> Batch:
    """The fastest kind of batch that runs members of a scene by a method.

    A scene that is no pair has `has_batches`, and `fit_lanes` too if members have numbers of their
    own.  `first_step` is the longest one of an adaptive method [time].
    """
    if pair is not None:
        return Batch(lambda: PairMembers(pair))
    alone = Pool(lambda: GeneralMembers(layout, method, first_step))
    if not fit_lanes(layout, method):
        assert not own_numbers
        return Batch(alone.take)
    kind = SplittingLanes if method.splits else NystromLanes
    return Batch(lambda: kind(layout, method, first_step, own_numbers, alone))
