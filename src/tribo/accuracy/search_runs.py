"""The runs of a search: when they stop, how many they are, what they cost and should cost."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from tribo.accuracy import levels
from tribo.accuracy.cost_model import evaluation_time, rate_of
from tribo.kernels.status import Status
from tribo.loops.integrate import Integration, most_evaluations
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting

# Level of the tolerances of the pilot run: three digits are enough for scales.
PILOT_LEVEL = 1e-3
# Most pilot runs, with smaller and smaller scales; four reach those of 1e-60 of the first guess.
PILOTS = 8
# A run stops after this times the evaluations expected from the last: errors of rounding then
# control its steps.  With rods of 1e5, a tenth of the level took eight times the evaluations.
UNEXPECTED = 4.0
# But not before this fraction of the evaluations that any run may take.
UNNOTICED = 0.02
# Coarse runs of a round, which the fine run is compared with.
COARSE_RUNS = 2

# Parts of the duration after which a fine run stops, for steps of its own even with few samples.
PARTS = 32
# Most inner stops of a coarse run: each shortens a step.
MOST_STOPS = 256
# Stops closer than this part of the duration are one: steps between them would be of rounding.
SAME = 1e-9

# Called before each run with its number, how many runs there will be unless more rounds are needed,
# and the predicted seconds of those that are left, or None while the pilot has not shown them.
Announce = Callable[[int, int, float | None], None]


class StopTimes(NamedTuple):
    """Times at which a fine run and two coarse ones stop, so that no two share their steps.

    Every fourth inner time of the fine run belongs to the first coarse run, others to the second.
    """

    few: np.ndarray
    many: np.ndarray
    fine: np.ndarray

    @classmethod
    def for_samples(cls, times: np.ndarray) -> StopTimes:
        """For a run that is recorded at `times`, and also stops after each of PARTS equal parts."""
        parts = np.linspace(times[0], times[-1], PARTS + 1)
        k = np.searchsorted(times, parts).clip(1, times.size - 1)
        off = np.minimum(np.abs(parts - times[k - 1]), np.abs(parts - times[k]))
        further = parts[off > SAME * (times[-1] - times[0])]
        return cls.split(np.sort(np.concatenate([times, further])))

    @classmethod
    def split(cls, times: np.ndarray) -> StopTimes:
        """For a fine run that stops at `times`."""
        inner = times[1:-1]
        fourth = np.arange(inner.size) % 4 == 3
        few, many = (_thinned(times, inner[mine]) for mine in (fourth, ~fourth))
        return cls(few, many, times)


def _thinned(times: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """At most MOST_STOPS of the inner times, and both ends."""
    if inner.size > MOST_STOPS:
        inner = inner[np.linspace(0, inner.size - 1, MOST_STOPS).astype(int)]
    return np.concatenate([times[:1], inner, times[-1:]])


class SearchRuns:
    """Runs the scene with one setting after another, and counts; see :data:`Announce`."""

    def __init__(self, integrator: Integrator, announce: Announce | None) -> None:
        """Count from now on, and plan the runs that a search takes at least."""
        self.layout = integrator.layout
        self.method = integrator.method
        self.most = most_evaluations(self.layout.scene)
        self.spent = 0  # evaluations of all runs
        self.interrupted = False
        # Level and evaluations of the last run that completed.
        self.known: tuple[float, float] = (1.0, np.inf)
        self._integrator = integrator
        self._announce = announce
        self.began = time.perf_counter()
        # Numbers of the last run, and of all that are planned.
        self._number = 0
        self._of = 0
        self._left: float | None = None  # seconds of those, until they are announced
        self.plan(self.method.adaptive + 1 + COARSE_RUNS)

    def pilot(self, times: np.ndarray) -> tuple[Setting, Integration, levels.ToleranceScales]:
        """The setting, run and scales of a run whose tolerances resolve what it finds.

        Energies and rates below the tolerances of a run are its errors, such as oscillations of a
        stiff pendulum that feels no force yet; the next run has tolerances relative to them.
        """
        scales = levels.first_guess(self.layout)
        for _ in range(PILOTS):
            setting = levels.setting_at(self.layout, self.method, scales, PILOT_LEVEL)
            run = self.attempt(setting, times)
            found = levels.tolerance_scales(self.layout, run.samples)
            resolved = min(found.energy / scales.energy, found.rate / scales.rate) >= PILOT_LEVEL
            if run.status != Status.COMPLETED or resolved:
                break
            scales = found
        return setting, run, found

    def expected(self, level: float) -> float:
        """Evaluations of a run at a level, by those of the last one and the order of the method."""
        before, evaluations = self.known
        return evaluations * (before / level) ** (1.0 / self.method.order)

    def run(
        self, setting: Setting, times: np.ndarray, level: float, rounded: bool = False
    ) -> Integration:
        most = max(UNEXPECTED * self.expected(level), UNNOTICED * self.most)
        run = self.attempt(setting, times, most=min(self.most, most), rounded=rounded)
        if run.status == Status.COMPLETED:
            self.known = (level, run.evaluations)
        return run

    def attempt(
        self, setting: Setting, times: np.ndarray, start: np.ndarray | None = None, **limits: Any
    ) -> Integration:
        """A run that counts as one of the search; arguments are those of an Integrator."""
        self._number += 1
        if self._announce is not None:
            self._announce(self._number, max(self._number, self._of), self._left)
            self._left = None
        run = self._integrator(setting, times, start, **limits)
        self.spent += run.evaluations
        self.interrupted |= run.status == Status.INTERRUPTED
        return run

    def plan(self, further: int) -> None:
        self._of = self._number + further

    def plan_round(self, level: float, last: Integration | None) -> None:
        """Plan a round at a level; its time follows from the last run, or the model of costs."""
        self.plan(1 + COARSE_RUNS)
        if self._announce is not None:
            self._left = self._seconds(level, last)

    def _seconds(self, level: float, last: Integration | None) -> float:
        """An estimate of the time that the runs of a round take, from that of earlier ones [s]."""
        layout = self.layout
        method = self.method
        rate = rate_of(layout, method)
        finer = levels.fine_level(method) * level
        before, evaluations = self.known
        coarse = (before / level) ** (1.0 / rate.slope) * evaluations
        each = 1e-9 * evaluation_time(layout, method)
        if not method.adaptive:
            coarse = layout.run_time / levels.equal_step(layout, method, level) * rate.step
        elif last is not None and last.evaluations > 0:
            each = last.seconds / last.evaluations
        fine = (level / finer) ** (1.0 / rate.slope) * coarse
        return each * (fine + COARSE_RUNS * coarse)
