"""The search for settings that keep an accuracy.

A pilot run measures the scales from which local tolerances are made; methods with equal steps need
none.  Each round then compares a fine run with two coarse ones.  The search ends when their
difference meets the request, when finer settings gain nothing, or when the scene amplifies
round-off beyond the request.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from tribo.accuracy.comparison import (
    ABORTED,
    FROM_OUTSIDE,
    Accuracy,
    Attempt,
    error_bounds,
    measure_amplification,
    observables,
    out_of_reach,
    strictest,
)
from tribo.accuracy.estimate import excess_of_request, rounding
from tribo.accuracy.levels import (
    NEAR,
    coarsest_level,
    equal_steps,
    fine_level,
    finest_level,
    setting_at,
    work,
)
from tribo.accuracy.run_time import evaluation_time, rate_of
from tribo.accuracy.scales import EPSILON, first_guess, tolerance_scales
from tribo.accuracy.stop_times import StopTimes
from tribo.integrators.methods import Method
from tribo.kernels.status import Status
from tribo.run.integrate import Integration, Setting
from tribo.run.layout import Layout
from tribo.run.progress_guard import most_evaluations
from tribo.validation import InputError

# Level of the tolerances of the pilot run: three digits are enough for scales.
PILOT_LEVEL = 1e-3
# Most pilot runs.  Each finds smaller scales until they are those of the motion; where these are
# tiny, 1e-60 of the first guess, four are enough.
PILOTS = 8
# First level, in units of that which a method states for estimates of twice a difference: they are
# three times the difference.
FIRST = 2.0 / 3.0
# Rounds of lower levels, after which a request counts as out of reach.
ROUNDS = 6
# A round stalls if its estimate exceeds this fraction of the one before.
STALLED = 0.5
# Stalled rounds in a row, after which round-off is taken for the limit.
MOST_STALLS = 2
# The next level is at most this times the last one; its square if the error is unknown.
LOWER = 0.1
# The next level aims at this fraction of the request.
AIM = 0.3
# Requests below this measure the amplification at once, because rounding counts in their estimate.
# Others do so if the first round misses them: where nothing moves but by weak forces, a change of
# the start matters a thousand times more than rounding, which is relative to what it rounds.
TIGHT = 1e-9
# Work of a long run [force evaluations x asperites], which is refused early if its request is out
# of reach: 20 s at the 0.13 us that benchmarks/calibrate.py measures for an asperite.  The tries of
# `cheapest_setting` end after as much work.
LONG_RUN = 1.5e8
# The next round takes this fraction of equal steps that are too long.
SHORTER = 0.25
# Statuses of runs whose equal steps are too long.
TOO_LONG = (Status.ENCOUNTER_JUMPED, Status.NOT_FINITE, Status.NOT_CONVERGED)
# A run stops after this times the evaluations expected from the last by the order of the method,
# since errors of rounding, which do not fall with the step, then control its steps.  With rods of
# 1e5 and longer, a tenth of the level took eight times the evaluations instead of 1.3 times.
UNEXPECTED = 4.0
# But not before this fraction of the evaluations that any run may take.
UNNOTICED = 0.02
# Levels closer than this are not told apart.
CLOSE = 3.0
# Largest error, relative to the scales, of a run that is delivered where finer ones stop.
KNOWN = 0.01
# Estimates below this many times the effect of rounding gain too little from finer settings.
MOST_ROUNDED = 3.0
# Evaluations of a search, in units of those of the run that it delivers, beyond which no further
# round begins.  Five rounds of a method of order 8 take eight to ten times as many.
MOST_COST = 10.0
# Work [force evaluations x asperites] of searches that may take more than that: 0.2 s.
SHORT_SEARCH = 1.5e6
# Coarse runs of a round, which the fine run is compared with.
COARSE_RUNS = 2


class Errors(NamedTuple):
    """Error estimates of a run.

    Attributes
    ----------
    run
        whose errors they are
    amplification
        that was known when they were made
    bounds
        on the errors, by quantity
    excess
        the largest bound in units of the accuracy
    """

    run: Integration
    amplification: float | None
    bounds: dict[str, float]
    excess: float


@dataclass(frozen=True)
class FoundSettings:
    """Settings that a search found.

    Attributes
    ----------
    coarse, fine
        setting of the runs that estimate the error, and of the run that is delivered
    level
        of the fine setting, relative to the scales
    runs
        of the search, in order; the last is the one to deliver, and the two before it those that it
        was compared with, if it was
    amplification
        of a small change of the start; None where it was not measured
    met
        whether the fine run kept the accuracy
    evaluations
        of all forces, in all runs of the search
    seconds
        wall time of the search
    costly
        whether a further round would have cost too much
    stopped
        the status of runs with finer settings, if these stopped
    errors
        of the run to deliver; None if it was compared with no other
    """

    coarse: Setting
    fine: Setting
    level: float
    runs: tuple[Integration, ...]
    amplification: float | None
    met: bool
    evaluations: int
    seconds: float
    costly: bool = False
    stopped: Status | None = None
    errors: Errors | None = None


# Called before each run with its number, how many runs there will be unless more rounds are needed,
# and the predicted seconds of those that are left, or None while the pilot has not shown them.
Announce = Callable[[int, int, float | None], None]


def find_settings(
    layout: Layout,
    method: Method,
    accuracy: Accuracy,
    stops: StopTimes,
    attempt: Attempt,
    announce: Announce | None = None,
) -> FoundSettings:
    """Settings of which a fine run agrees with two coarse ones within `accuracy`, if there are any.

    Parameters
    ----------
    layout
        the scene
    method
        of all runs
    accuracy
        the largest relative error of everything, or of each quantity by name
    stops
        of the three runs of each round
    attempt
        runs the scene with a setting
    announce
        see :data:`Announce`

    Returns
    -------
    FoundSettings
        those whose error estimate is nearest to the request, whether they keep it or not

    Raises
    ------
    InputError
        if the accuracy is out of reach and its runs would be long, or if equal steps would be too
        many
    """
    search = _Search(layout, method, accuracy, stops, attempt, announce)
    level = FIRST * method.first_level * strictest(accuracy)
    level = min(max(level, finest_level(method)), coarsest_level(layout, method))
    if not search.run_pilot(level):
        return search.found()
    for _ in range(ROUNDS):
        if not search.allows(level):
            break
        if not search.run_round(level):
            break
        lower = search.next_level(level)
        if lower is None:
            break
        level = lower
    return search.found()


@dataclass
class _Round:
    """A fine run, and the two coarse ones that it is compared with."""

    level: float  # of the coarse runs
    coarse: Setting
    fine: Setting
    runs: list[Integration] = field(default_factory=list)  # the fine one is the last
    excess: float = np.inf  # the largest estimate of the fine run relative to the request
    errors: Errors | None = None  # of the fine run

    @property
    def finest(self) -> Integration:
        """The fine run."""
        return self.runs[-1]

    @property
    def stopped(self) -> Status | None:
        """The status of a run that stopped, if there is one."""
        return next((r.status for r in self.runs if r.status != Status.COMPLETED), None)


class _Search:
    """The runs of a search, in order, and what they show."""

    def __init__(
        self,
        layout: Layout,
        method: Method,
        accuracy: Accuracy,
        stops: StopTimes,
        attempt: Attempt,
        announce: Announce | None,
    ) -> None:
        self.layout, self.method, self.stops = layout, method, stops
        self.accuracy, self.wanted = accuracy, strictest(accuracy)
        self.most = most_evaluations(layout.scene)
        self.runs: list[Integration] = []
        self.rounds: list[_Round] = []
        self.amplification: float | None = None
        self.reached = np.inf  # the last level of a round that completed, or of the pilot
        self.too_fine = 0.0  # the loosest level at which runs stopped
        # Level and evaluations of the last run that completed.
        self.known: tuple[float, float] = (1.0, np.inf)
        self.stalls = 0
        self.costly = False
        self.spent = 0  # evaluations of all runs
        self._attempt_run, self._announce = attempt, announce
        self._began = time.perf_counter()
        self._number, self._of = 0, 0  # of the last run, and of all that are planned
        self._left: float | None = None  # seconds of those, until they are announced
        self._plan(method.adaptive + 1 + COARSE_RUNS)

    def run_pilot(self, level: float) -> bool:
        """Run the pilot of an adaptive method; none with equal steps.

        Returns whether another run can come farther.  Refuses an accuracy out of reach if the fine
        run of the first round, at `level`, would be long.
        """
        if not self.method.adaptive:
            return True
        setting, pilot = _resolved(self.layout, self.method, self.stops.few, self._attempt)
        self.runs.append(pilot)
        if pilot.status in ABORTED:
            self.rounds.append(_Round(level, setting, setting, [pilot]))
            return False
        if pilot.status != Status.COMPLETED:
            return True
        self._plan(1 + COARSE_RUNS)
        self.reached, self.known = PILOT_LEVEL, (PILOT_LEVEL, pilot.evaluations)
        longer = self._expected(fine_level(self.method) * level) / pilot.evaluations
        if longer * work(self.layout, pilot) < LONG_RUN:
            return True
        amplification = self._amplification(setting, pilot)
        if amplification is not None and amplification * EPSILON > self.wanted:
            raise InputError(
                "accuracy",
                out_of_reach(self.wanted, amplification).removeprefix("accuracy ")
                + "; name the observables that matter, or give a method and a step; tribo.ensemble "
                "averages over many starts",
            )
        return True

    def allows(self, level: float) -> bool:
        """Whether a round is short enough; refuses the accuracy if the first has too many steps."""
        few = equal_steps(self.layout, self.method, fine_level(self.method) * level)
        if few > self.most:
            if self.runs:
                return False
            raise InputError(
                "accuracy",
                f"would take {self.method.name} {few:.0e} steps, more than {self.most:.0e}; give a "
                "larger accuracy, a method that chooses its steps, or max_evaluations",
            )
        coarse, fine = self._expected(level), self._expected(fine_level(self.method) * level)
        self.costly = bool(self.rounds) and not self._affords(COARSE_RUNS * coarse + fine)
        return not self.costly

    def run_round(self, level: float) -> bool:
        """A fine run, and two coarse ones at `level`; whether it was not too costly."""
        layout, method = self.layout, self.method
        scales = (
            tolerance_scales(layout, self.runs[-1].samples) if self.runs else first_guess(layout)
        )
        finer = fine_level(method) * level
        near = NEAR * fine_level(method) ** (1.0 / method.order)
        coarse = setting_at(layout, method, scales, level)
        fine = setting_at(layout, method, scales, finer, near)
        self._plan(1 + COARSE_RUNS, self._seconds(level))
        finest = self._run(fine, self.stops.fine, finer)
        last = _Round(level, coarse, fine, [finest])
        self.costly = bool(self.rounds) and not self._affords(COARSE_RUNS * self._expected(level))
        if self.costly:
            return False
        self.rounds.append(last)
        for times in (self.stops.few, self.stops.many):
            if last.stopped is None:
                last.runs.insert(-1, self._run(coarse, times, level))
        self.runs.append(finest)
        if last.stopped is None:
            self.reached = level
        return True

    def next_level(self, level: float) -> float | None:
        """The level of the round after one at `level`; None if the search ends."""
        last = self.rounds[-1]
        if last.stopped in FROM_OUTSIDE:
            return None
        if self.method.adaptive and last.stopped is not None:
            self.too_fine = max(self.too_fine, level)
            return None if self.spent > self.most else self._looser()
        finest = finest_level(self.method)
        shorter = level * SHORTER**self.method.order
        fine = last.finest
        can_be_too_long = not self.method.adaptive and work(self.layout, fine) < SHORTER * LONG_RUN
        if can_be_too_long and last.stopped in TOO_LONG:
            return shorter
        before = self.rounds[-2].excess if len(self.rounds) > 1 else np.inf
        if last.stopped is None:
            if self.wanted < TIGHT:
                self._measure(last)
            last.excess = self._excess(last)
        if can_be_too_long and len(self.rounds) == 1 and last.excess * self.wanted > 1.0:
            self.amplification, last.excess = None, np.inf
            return shorter
        excess = last.excess
        if excess > 1.0 and self.amplification is None and last.stopped is None:
            self._measure(last)
            last.excess = self._excess(last)
        self.stalls = self.stalls + 1 if excess > STALLED * before else 0
        if self.spent > self.most or excess <= 1.0 or level <= finest or self.stalls == MOST_STALLS:
            return None
        if last.stopped is None and self._is_out_of_reach(last):
            return None
        lower = AIM / excess if np.isfinite(excess) else LOWER**2
        lower = max(level * min(LOWER, lower), finest)
        return lower if lower > self.too_fine else self._looser()

    def found(self) -> FoundSettings:
        """The settings and runs of the best round."""
        chosen, stopped = self._best(), None
        if self.too_fine > 0.0:
            stopped = next(item.stopped for item in self.rounds if item.stopped is not None)
        others = [run for run in self.runs if run not in chosen.runs]
        return FoundSettings(
            chosen.coarse,
            chosen.fine,
            fine_level(self.method) * chosen.level,
            (*others, *chosen.runs),
            self.amplification,
            chosen.excess <= 1.0,
            self.spent,
            time.perf_counter() - self._began,
            self.costly,
            stopped,
            chosen.errors,
        )

    def _best(self) -> _Round:
        """The finest round whose excess is about the smallest.

        Where runs stop, and others have errors as large as the scales, the finest that stopped.
        """
        known = [item for item in self.rounds if item.excess * self.wanted <= KNOWN]
        if known or self.too_fine == 0.0:
            candidates = known or self.rounds
            least = min(item.excess for item in candidates)
            near = [item for item in candidates if STALLED * item.excess <= least]
            return min(near, key=lambda item: item.level)
        return min(self.rounds, key=lambda item: item.level)

    def _affords(self, further: float) -> bool:
        """Whether a round with `further` evaluations leaves the search cheap enough."""
        most = MOST_COST * self._best().finest.evaluations
        short = SHORT_SEARCH / self.layout.scene.count
        return self.spent + further <= max(most, short)

    def _is_out_of_reach(self, last: _Round) -> bool:
        """Whether amplified rounding keeps finer settings from the request, or it is unknown."""
        if self.amplification is None:
            return True
        estimate = last.excess * self.wanted
        if self.too_fine > 0.0 and estimate > KNOWN:
            return False
        if self.amplification * EPSILON > self.wanted:
            return True
        rounded = rounding(self.amplification, last.finest.steps)
        return rounded > self.wanted and estimate < MOST_ROUNDED * rounded

    def _looser(self) -> float | None:
        """A level between one at which runs stop and one at which they do not; None if close."""
        level = (self.too_fine * self.reached) ** 0.5
        return level if np.isfinite(level) and level > CLOSE * self.too_fine else None

    def _expected(self, level: float) -> float:
        """Evaluations of a run at a level, by those of the last one and the order of the method."""
        before, evaluations = self.known
        return evaluations * (before / level) ** (1.0 / self.method.order)

    def _run(self, setting: Setting, times: np.ndarray, level: float) -> Integration:
        """A run of a round."""
        most = max(UNEXPECTED * self._expected(level), UNNOTICED * self.most)
        run = self._attempt(setting, times, most=min(self.most, most))
        if run.status == Status.COMPLETED:
            self.known = (level, run.evaluations)
        return run

    def _attempt(
        self,
        setting: Setting,
        times: np.ndarray,
        start: np.ndarray | None = None,
        *,
        most: float | None = None,
    ) -> Integration:
        """A run that counts as one of the search."""
        self._number += 1
        if self._announce is not None:
            self._announce(self._number, max(self._number, self._of), self._left)
            self._left = None
        run = self._attempt_run(setting, times, start, most=most)
        self.spent += run.evaluations
        return run

    def _plan(self, further: int, seconds: float | None = None) -> None:
        """How many further runs are planned, and what they should take."""
        self._of, self._left = self._number + further, seconds

    def _seconds(self, level: float) -> float:
        """What a round at a level should take, by the last run or else by the model of costs."""
        layout, method = self.layout, self.method
        rate, finer = rate_of(layout, method), fine_level(method) * level
        before, evaluations = self.known
        coarse = (before / level) ** (1.0 / rate.slope) * evaluations
        each = 1e-9 * evaluation_time(layout, method)
        if not method.adaptive:
            coarse = equal_steps(layout, method, level) * rate.step
        elif self.runs and self.runs[-1].evaluations > 0:
            each = self.runs[-1].seconds / self.runs[-1].evaluations
        fine = (level / finer) ** (1.0 / rate.slope) * coarse
        return each * (fine + COARSE_RUNS * coarse)

    def _amplification(self, setting: Setting, run: Integration) -> float | None:
        names = observables(self.accuracy)
        return measure_amplification(self.layout, self._attempt, setting, run, names)

    def _measure(self, last: _Round) -> None:
        """Measure the amplification by a coarse run, unless it is known."""
        if self.amplification is None:
            self.amplification = self._amplification(last.coarse, last.runs[0])

    def _excess(self, last: _Round) -> float:
        """The largest estimate of the fine run relative to the request."""
        *coarser, fine = last.runs
        grown = self.amplification
        bounds, scales = error_bounds(self.layout, fine, coarser, grown, self.accuracy)
        excess = excess_of_request(bounds, scales, self.accuracy)
        last.errors = Errors(fine, grown, bounds, excess)
        return excess


def _resolved(
    layout: Layout, method: Method, times: np.ndarray, attempt: Attempt
) -> tuple[Setting, Integration]:
    """A run whose tolerances resolve the energies and rates that it finds, and its setting.

    Those below the tolerances of a run are its errors, such as oscillations of a stiff pendulum
    that feels no force yet; the next run has tolerances relative to them.
    """
    scales = first_guess(layout)
    for _ in range(PILOTS):
        setting = setting_at(layout, method, scales, PILOT_LEVEL)
        run = attempt(setting, times)
        found = tolerance_scales(layout, run.samples)
        resolved = min(found.energy / scales.energy, found.rate / scales.rate) >= PILOT_LEVEL
        if run.status != Status.COMPLETED or resolved:
            break
        scales = found
    return setting, run
