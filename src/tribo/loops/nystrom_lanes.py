"""Members of an ensemble by an adaptive Nystrom method, eight in the lanes of registers."""

from __future__ import annotations

from typing import Any

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.integrators.methods import Method
from tribo.integrators.nystrom_members import TRIED, Queue, nystrom_members
from tribo.integrators.step_control import Tolerance
from tribo.kernels.records import CLOCK
from tribo.kernels.samples import empty_state
from tribo.kernels.status import PAUSED
from tribo.layout.layout import Layout
from tribo.layout.member_numbers import MemberNumbers
from tribo.loops.integrate import Columns, Setting, first_step_at
from tribo.loops.lane_loop import LaneLoop

# Trials of a call of the loop, since an interrupt waits for its end: of 64 asperites some 0.3 s.
TRIALS = 1024


class NystromLanes(LaneLoop):
    """The loop of a Nystrom method.

    Parameters
    ----------
    layout, method, own_numbers
        As those of `LaneLoop`.
    first_step : float
        The longest first step [time].

    Raises
    ------
    InputError
        If a plug-in does not compile.
    """

    def __init__(
        self, layout: Layout, method: Method, own_numbers: bool, first_step: float
    ) -> None:
        super().__init__(layout, method, own_numbers)
        self._longest, self._order = first_step, method.order
        self._clocks = np.zeros(LANES, CLOCK).view(np.recarray)
        self._held = np.full(LANES, -1)
        speeds = room((3, self.eight.model.each.shape[1]))
        tried, new = room((TRIED, LANES)), empty_state(self._state)
        self._state, *self._scratch = self.keep(
            (self._state, tried, self._work, speeds, new), [self._clocks, self._held]
        )
        n = self.layout.start.size
        tolerance = Tolerance(np.ones(n), np.ones(self.layout.accounts), 1.0, 1.0)
        none = np.empty((0, n)), np.empty((0, self._places_of_numbers.shape[1]))
        queue = self._queue(tolerance, *none)
        examples = self._arguments(self._in_lanes(tolerance), queue, self.room(1), 0)
        self._entry = self.compile(nystrom_members, examples)

    def run(
        self,
        tolerance: Setting,
        starts: np.ndarray,
        seeds: np.ndarray,
        columns: Columns,
        numbers: MemberNumbers | None,
    ) -> np.ndarray:
        """Run members from `starts` (members, 2 coordinates), and record their samples.

        Returns their counts, (members, 3): PAUSED of those that need a loop of their own.  The
        motion has no noise, and takes no seeds.
        """
        assert isinstance(tolerance, Tolerance)
        self.forget()
        self._clocks["encounter_fraction"] = tolerance.encounter_fraction
        queue = self._queue(tolerance, starts, self.rows_of(numbers, len(starts)))
        arguments = self._arguments(self._in_lanes(tolerance), queue, columns, TRIALS)
        while self._entry(*arguments) == PAUSED:
            pass
        return queue.counts

    def _queue(self, tolerance: Tolerance, starts: np.ndarray, numbers: np.ndarray) -> Queue:
        """Members from their starts, with numbers of their own."""
        counts = np.zeros((len(starts), 3), np.int64)
        first_step = first_step_at(tolerance, self._longest, self._order)
        return Queue(
            np.ascontiguousarray(starts),
            self._places,
            numbers,
            self._places_of_numbers,
            self._memory,
            counts,
            self._held,
            np.zeros(1, np.int64),
            first_step,
        )

    def _in_lanes(self, tolerance: Tolerance) -> Tolerance:
        """Tolerances with a number for each lane; 1 for what fills blocks."""
        y, s = np.ones_like(self._state.y), np.ones_like(self._state.s)
        y[self._places] = tolerance.y
        s[self.eight.s + np.arange(LANES)[:, None]] = tolerance.s
        return tolerance._replace(y=y, s=s)

    def _arguments(
        self, tolerance: Tolerance, queue: Queue, columns: Columns, budget: int
    ) -> tuple[Any, ...]:
        """The arguments of the loop, behind the model."""
        return (
            self.coefficients,
            tolerance,
            self._clocks,
            self._state,
            self.layout.times,
            self.record(columns),
            budget,
            queue,
            *self._scratch,
        )
