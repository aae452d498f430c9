"""Many runs of one scene, eight side by side in the lanes of registers, in threads."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from tribo.integrators.methods import Method
from tribo.integrators.nystrom import Nystrom
from tribo.integrators.step_control import LARGEST
from tribo.kernels.status import COMPLETED, PAUSED
from tribo.layout.layout import Layout
from tribo.layout.member_numbers import LayoutOfMembers, MemberNumbers
from tribo.ledger.member_samples import MemberRuns, MemberSamples
from tribo.ledger.samples import Samples
from tribo.loops.batch_general import GeneralMembers
from tribo.loops.integrate import Setting
from tribo.loops.lane_loop import padded
from tribo.loops.nystrom_lanes import NystromLanes
from tribo.loops.splitting_lanes import SplittingLanes
from tribo.pair.members import CODE

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


class MembersInLanes:
    """Runs members of a scene, eight at once, in threads.

    What a member gives depends on that member alone.  One that needs more care than the loop takes,
    at encounters that a step would jump or where numbers are not finite, is run alone.

    Parameters
    ----------
    layout : Layout
        The scene, for which `fit_lanes` is true.
    method : Method
        How time advances.
    first_step : float
        The longest first step of an adaptive method [time].
    own_numbers : bool
        Whether members differ in numbers too.
    """

    def __init__(
        self, layout: Layout, method: Method, first_step: float, own_numbers: bool = False
    ) -> None:
        self._layout, self._method, self._first_step = layout, method, first_step
        self._own_numbers = own_numbers
        self._alone = GeneralMembers(layout, method, first_step)
        self._idle: list[SplittingLanes | NystromLanes] = []

    def run(
        self,
        setting: Setting,
        starts: np.ndarray,
        seeds: np.ndarray | None = None,
        numbers: MemberNumbers | None = None,
    ) -> MemberRuns:
        """Run members with `starts` (members, 2 coordinates) and `seeds`, in this thread.

        Seeds matter where there is noise.  The samples of members that did not complete are zeros;
        with `numbers` of their own, those that need a loop of their own have the status PAUSED.
        """
        loop = self._free_loop()
        members, times = len(starts), self._layout.times
        seeds = np.zeros(members, np.int64) if seeds is None else seeds
        columns = loop.room(padded(members))
        counts = loop.run(setting, starts, seeds, columns, numbers)
        self._idle.append(loop)
        rows = members * times.size
        each_time = [
            np.swapaxes(each[:rows].reshape(members, times.size, *each.shape[1:]), 0, 1)
            for each in columns
        ]
        whole = counts[:, CODE] == COMPLETED
        for each in each_time:
            others = tuple(axis for axis in range(each.ndim) if axis != 1)
            whole &= np.all(np.abs(each) <= LARGEST, axis=others)
        alone = np.flatnonzero(~whole)
        if numbers is not None:
            counts[alone, CODE] = PAUSED
            for each in each_time:
                each[:, alone] = 0.0
        elif alone.size:
            runs = self._alone.run(setting, starts[alone], seeds[alone])
            counts[alone] = runs.counts
            for each, field in zip(each_time, fields(Samples)[1:], strict=True):
                own = getattr(runs.samples, field.name)
                each[:, alone] = own.reshape(times.size, alone.size, *own.shape[1:])
        samples = (each.reshape(rows, *each.shape[2:]) for each in each_time)
        repeated = np.repeat(times, members)
        layout = self._layout if numbers is None else LayoutOfMembers.of(self._layout, numbers)
        return MemberRuns.of(layout, MemberSamples(members, repeated, *samples), counts)

    def _free_loop(self) -> SplittingLanes | NystromLanes:
        """A loop that no thread uses."""
        try:
            return self._idle.pop()
        except IndexError:
            layout, method, own = self._layout, self._method, self._own_numbers
            if method.splits:
                return SplittingLanes(layout, method, own)
            return NystromLanes(layout, method, own, self._first_step)


def members_of(
    layout: Layout, method: Method, first_step: float, own_numbers: bool
) -> MembersInLanes | GeneralMembers:
    """Runs members of a scene that can be run in batches, in lanes where they fit.

    Parameters as those of `MembersInLanes`; members with numbers of their own do fit.
    """
    if fit_lanes(layout, method):
        return MembersInLanes(layout, method, first_step, own_numbers)
    assert not own_numbers
    return GeneralMembers(layout, method, first_step)
