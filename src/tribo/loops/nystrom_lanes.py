"""Members of an ensemble by an adaptive Nystrom method, eight in the lanes of registers."""

from __future__ import annotations

from typing import Any

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.integrators.lane_queue import Queue, queue_of
from tribo.integrators.methods import Method
from tribo.integrators.nystrom_members import TRIED, Starts, nystrom_members
from tribo.integrators.step_control import Tolerance
from tribo.kernels.records import CLOCK
from tribo.kernels.samples import empty_state
from tribo.kernels.status import PAUSED
from tribo.layout.compiled import entry_point
from tribo.layout.layout import Layout
from tribo.ledger.samples import sample_columns
from tribo.loops.batch import MemberStarts
from tribo.loops.general import unit_setting
from tribo.loops.integrate import Columns, Setting, first_step_at
from tribo.loops.lane_loop import LaneLoop

# Trials of a call of the loop, since an interrupt waits for its end: of 64 asperites some 0.3 s.
TRIALS = 1024


class NystromLanes(LaneLoop):
    """The loop of a Nystrom method."""

    def prepare(self, layout: Layout, method: Method) -> None:
        """Make clocks and scratch, and compile the loop."""
        self._clocks = np.zeros(LANES, CLOCK).view(np.recarray)
        speeds = room((3, self.eight.model.each.shape[1]))
        tried, new = room((TRIED, LANES)), empty_state(self._state)
        self._state, *self._scratch = self.keep(
            (self._state, tried, self._work, speeds, new), [self._clocks]
        )
        tolerance = unit_setting(layout, method)
        assert isinstance(tolerance, Tolerance)
        none = np.empty((0, layout.start.size)), np.empty((0, self._places_of_numbers.shape[1]))
        columns = sample_columns(layout, 1)
        examples = self._arguments(tolerance, queue_of(0, LANES), *none, columns, 0)
        self._entry = entry_point(layout, nystrom_members, (self.eight.model,), examples)

    def fill_lanes(
        self, setting: Setting, starts: MemberStarts, numbers: np.ndarray, columns: Columns
    ) -> np.ndarray:
        """Run members side by side; their motion has no noise, and takes no seeds."""
        assert isinstance(setting, Tolerance)
        self.forget()
        self._clocks["encounter_fraction"] = setting.encounter_fraction
        queue, y = queue_of(len(starts.y), LANES), np.ascontiguousarray(starts.y)
        arguments = self._arguments(setting, queue, y, numbers, columns, TRIALS)
        while self._entry(*arguments) == PAUSED:
            pass
        return queue.counts

    def _in_lanes(self, tolerance: Tolerance) -> Tolerance:
        """Tolerances with a number for each lane; 1 for what fills blocks."""
        y, s = np.ones_like(self._state.y), np.ones_like(self._state.s)
        y[self._places] = tolerance.y
        s[self.eight.s + np.arange(LANES)[:, None]] = tolerance.s
        return tolerance._replace(y=y, s=s)

    def _arguments(
        self,
        tolerance: Tolerance,
        queue: Queue,
        starts: np.ndarray,
        numbers: np.ndarray,
        columns: Columns,
        budget: int,
    ) -> tuple[Any, ...]:
        """The arguments of the loop, behind the model."""
        first_step = first_step_at(tolerance, self._longest, self._order)
        places = self._places, numbers, self._places_of_numbers
        return (
            self.coefficients,
            self._in_lanes(tolerance),
            self._clocks,
            self._state,
            self.layout.times,
            self.record(columns),
            budget,
            queue,
            Starts(starts, *places, self._memory, first_step),
            *self._scratch,
        )
