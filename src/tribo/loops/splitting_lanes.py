"""Members of an ensemble by a splitting method, eight at a time in the lanes of registers."""

from __future__ import annotations

from typing import Any

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.integrators.methods import Method
from tribo.integrators.splitting_members import LOST, WATCHED, splitting_members
from tribo.integrators.step_control import count_of_steps
from tribo.kernels.langevin import Deviates
from tribo.kernels.records import CLOCK
from tribo.kernels.status import CODE, COMPLETED, COUNTS, EVALUATIONS, PAUSED, STEPS
from tribo.layout.compiled import entry_point
from tribo.layout.layout import Layout
from tribo.ledger.samples import sample_columns
from tribo.loops.batch import MemberStarts, padded
from tribo.loops.integrate import Columns, Setting
from tribo.loops.lane_loop import LaneLoop

# Steps of a call of the loop, at most, since an interrupt waits for its end.
MOST_STEPS = 4096
# Normal deviates that are drawn at once for a member, at most: 256 kB for eight.
MOST_DEVIATES = 4096


class SplittingLanes(LaneLoop):
    """The loop of a splitting method."""

    def prepare(self, layout: Layout, method: Method) -> None:
        """Make clocks and scratch, and compile the loop."""
        self._clocks = np.zeros(1, CLOCK).view(np.recarray)
        watch = room((WATCHED, LANES))
        self._state, self._work, self._watch = self.keep(
            (self._state, self._work, watch), [self._clocks]
        )
        self._draws = self.coefficients.kicks.size * deviates_of_substep(self.layout)
        columns = sample_columns(layout, LANES)
        examples = self._arguments(1.0, columns, 0, np.empty((0, LANES)))
        self._entry = entry_point(layout, splitting_members, (self.eight.model,), examples)

    def fill_lanes(
        self, setting: Setting, starts: MemberStarts, numbers: np.ndarray, columns: Columns
    ) -> np.ndarray:
        """Run members eight by eight: with equal steps, all of them end together."""
        assert isinstance(setting, float)
        members, times = len(starts.y), self.layout.times.size
        chosen = np.arange(padded(members)).clip(max=members - 1)
        counts = np.empty((members, COUNTS), np.int64)
        for first in range(0, members, LANES):
            own = chosen[first : first + LANES]
            rows = slice(first * times, (first + LANES) * times)
            some = tuple(each[rows] for each in columns)
            self._memory[self._places_of_numbers] = numbers[own]
            lost = self._run_eight(setting, starts.y[own], starts.seeds[own].tolist(), some)
            counts[own, CODE] = np.where(lost, PAUSED, COMPLETED)
            clock = self._clocks[0]
            counts[own, STEPS], counts[own, EVALUATIONS] = clock.steps, clock.evaluations
        return counts

    def _run_eight(
        self, step: float, starts: np.ndarray, seeds: list[int], columns: Columns
    ) -> np.ndarray:
        """Run eight members; which of them need a loop of their own, (8,)."""
        self.forget()
        self._state.y[self._places] = starts
        generators = [np.random.default_rng([seed, 2]) for seed in seeds] if self._draws else []
        left = int(np.sum(count_of_steps(np.diff(self.layout.times), step)))
        code = PAUSED
        while code == PAUSED:
            budget = max(1, min(left, MOST_STEPS, MOST_DEVIATES // max(1, self._draws)))
            deviates = np.empty((budget * self._draws, LANES))
            for lane, generator in enumerate(generators):
                deviates[:, lane] = generator.standard_normal(len(deviates))
            code = self._entry(*self._arguments(step, columns, budget, deviates))
            left -= budget
        lost: np.ndarray = (self._watch[LOST] > 0.0) | (code != COMPLETED)
        return lost

    def _arguments(
        self, step: float, columns: Columns, budget: int, deviates: np.ndarray
    ) -> tuple[Any, ...]:
        """The arguments of the loop, behind the model."""
        return (
            self.coefficients,
            step,
            self._clocks,
            self._state,
            self.layout.times,
            self.record(columns),
            budget,
            self._watch,
            Deviates(deviates, np.zeros(1, np.int64)),
            self._work,
        )


def deviates_of_substep(layout: Layout) -> int:
    """Normal deviates that a member takes for a substep of its reservoirs."""
    noisy = [s for s in layout.surfaces if max(s["temperature"], s["swing_temperature"]) > 0.0]
    return sum(
        int(s["end"] - s["start"]) * (4 * (s["gamma"] > 0.0) + 2 * (s["swing_gamma"] > 0.0))
        for s in noisy
    )
