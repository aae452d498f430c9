"""Runs by legs: a loop that stops at each kink of a schedule, and goes on with other numbers.

The loops of :mod:`tribo.integrators` end steps at the times that they are given.  So a kink is a
further such time, whose sample the next one replaces.  A clock has the leg, so that a run continues
from its memory, and kernels find in the table of the model the numbers of that leg.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from tribo.kernels.status import COMPLETED, PAUSED
from tribo.layout.layout import Layout

# Takes times, and steps at most, and returns the code of a status.
Call = Callable[[np.ndarray, int], int]


class LegsOfLoop:
    """Lets one loop run leg by leg; `model` is the loop's own."""

    def __init__(self, layout: Layout, model: Any) -> None:
        self._legs = layout.legs
        self._table = model.schedules
        self._present = -1  # the leg whose numbers the table has

    @property
    def is_one(self) -> bool:
        """Whether there are no kinks."""
        return self._legs.kinks.size == 0

    def set_leg(self, leg: int) -> None:
        """Let kernels read the numbers of a leg."""
        if leg != self._present:
            self._table[...] = self._legs.tables[leg]
            self._present = leg

    def advance(
        self, clock: Any, times: np.ndarray, budget: int, call: Call, keeps_rates: bool
    ) -> int:
        """Run through the times, in `budget` steps at most; returns the code of a status.

        `call` runs the loop.  If it `keeps_rates` of a state, they are computed again in each leg.
        """
        begun = _trials(clock)
        while True:
            self._enter(clock, times, call, keeps_rates)
            left = budget - (_trials(clock) - begun)
            stops, is_sample = self.stops(int(clock.leg), times)
            code = call(stops, left)
            if code != COMPLETED or stops is times:
                return code
            if not is_sample:
                clock.sample -= 1
            if _trials(clock) - begun >= budget:
                return PAUSED

    def stops(self, leg: int, times: np.ndarray) -> tuple[np.ndarray, bool]:
        """The times of a leg and of those before; whether the kink at its end is among `times`."""
        legs = self._legs
        if leg == legs.kinks.size or legs.kinks[leg] >= times[-1] - legs.same:
            return times, True
        kink = legs.kinks[leg]
        after = int(np.searchsorted(times, kink + legs.same, side="right"))
        if after > 0 and times[after - 1] >= kink - legs.same:
            return times[:after], True
        return np.append(times[:after], kink), False

    def each(self, times: np.ndarray) -> Iterator[tuple[int, np.ndarray, bool]]:
        """Every leg with its :meth:`stops`, up to the last of the times."""
        leg = int(self._legs.of_times(times[:1])[0])
        while True:
            stops, is_sample = self.stops(leg, times)
            yield leg, stops, is_sample
            if stops is times:
                return
            leg += 1

    def _enter(self, clock: Any, times: np.ndarray, call: Call, keeps_rates: bool) -> None:
        """Let the present leg be that of the clock's time."""
        kinks = self._legs.kinks
        before = int(clock.leg)
        leg = before
        while leg < kinks.size and clock.t >= kinks[leg] - self._legs.same:
            leg += 1
        self.set_leg(leg)
        clock.leg = leg
        if leg > before and keeps_rates and clock.evaluations > 0:
            evaluations = int(clock.evaluations)
            clock.evaluations = 0  # so that the loop begins as at the start of a run
            clock.last_step = 0.0
            call(times, 0)
            clock.evaluations += evaluations


def _trials(clock: Any) -> int:
    return int(clock.steps + clock.rejected)
