"""The search for settings that keep an accuracy.

A pilot run measures the scales from which local tolerances are made; methods with equal steps need
none.  Each round then compares a fine run with two coarse ones.  The search ends when their
difference meets the request, when finer settings gain nothing, or when the scene amplifies
round-off beyond the request.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tribo.accuracy.comparison import (
    ABORTED,
    FROM_OUTSIDE,
    Accuracy,
    Attempt,
    error_bounds,
    growth,
    measure_amplification,
    observables,
    out_of_reach,
    strictest,
)
from tribo.accuracy.estimate import excess_of_request, rounding
from tribo.accuracy.found_settings import Errors, FoundSettings
from tribo.accuracy.levels import (
    NEAR,
    coarsest_level,
    equal_steps,
    fine_level,
    finest_level,
    setting_at,
    work,
)
from tribo.accuracy.scales import EPSILON
from tribo.accuracy.search_runs import COARSE_RUNS, PILOT_LEVEL, Announce, SearchRuns
from tribo.accuracy.stop_times import StopTimes
from tribo.accuracy.tolerance_scales import ToleranceScales, first_guess, tolerance_scales
from tribo.integrators.methods import Method
from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.loops.integrate import Integration, Setting
from tribo.validation import InputError

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
# of reach: 5 to 10 s at the 0.03 to 0.06 us that benchmarks/calibrate.py measures for an asperite.
# The tries of `cheapest_setting` end after as much work.
LONG_RUN = 1.5e8
# Level of the coarse runs for an accuracy of 1, where a small change of the start grows by 1.  Of
# two grids of 5041 asperites, where changes grew by 53,000, the error was 0.02 at a level of 6e-6.
AMPLIFIED = 5.0
# A long run is refused if growing errors make it this many times as long.
MOST_LONGER = 4.0
# The next round takes this fraction of equal steps that are too long.
SHORTER = 0.25
# Statuses of runs whose equal steps are too long.
TOO_LONG = (Status.ENCOUNTER_JUMPED, Status.NOT_FINITE, Status.NOT_CONVERGED)
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
    first = search.run_pilot(level)
    if first is None:
        return search.found()
    level = first
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
        self.count = SearchRuns(layout, method, attempt, announce)
        self.runs: list[Integration] = []
        self.scales: ToleranceScales | None = None  # of the last of them, once they are measured
        self.rounds: list[_Round] = []
        self.amplification: float | None = None
        self.reached = np.inf  # the last level of a round that completed, or of the pilot
        self.too_fine = 0.0  # the loosest level at which runs stopped
        self.stalls = 0
        self.costly = False

    def run_pilot(self, level: float) -> float | None:
        """Run the pilot of an adaptive method; none with equal steps.

        Returns the level of the first round: `level`, or less where the fine run would be long and
        small errors grow; None if no other run can come farther.  Refuses an accuracy that is out
        of reach of such a run.
        """
        if not self.method.adaptive:
            return level
        setting, pilot, self.scales = self.count.pilot(self.stops.few)
        self.runs.append(pilot)
        if pilot.status in ABORTED:
            self.rounds.append(_Round(level, setting, setting, [pilot]))
            return None
        if pilot.status != Status.COMPLETED:
            return level
        self.count.plan(1 + COARSE_RUNS)
        self.reached, self.count.known = PILOT_LEVEL, (PILOT_LEVEL, pilot.evaluations)
        longer = self.count.expected(fine_level(self.method) * level) / pilot.evaluations
        if longer * work(self.layout, pilot) < LONG_RUN:
            return level
        self.amplification = amplification = self._amplification(setting, pilot)
        if amplification is None:
            return level
        amplified = min(level, AMPLIFIED * self.wanted / max(amplification, 1.0))
        longer = self.count.expected(amplified) / self.count.expected(level)
        if amplification * EPSILON > self.wanted or longer > MOST_LONGER:
            raise InputError("accuracy", self._too_far(amplification, longer))
        return max(amplified, finest_level(self.method))

    def _too_far(self, amplification: float, longer: float) -> str:
        """Why a long run is refused, and what to do."""
        why = out_of_reach(self.wanted, amplification).removeprefix("accuracy ")
        if amplification * EPSILON <= self.wanted:
            why = (
                f"{self.wanted:.1e} would take about {longer:.0f} times the evaluations of a run "
                f"without growing errors: {growth(amplification)}"
            )
        return (
            f"{why}; name the observables that matter, or give a method and a step; tribo.ensemble "
            "averages over many starts"
        )

    def allows(self, level: float) -> bool:
        """Whether a round is short enough; refuses the accuracy if the first has too many steps."""
        few = equal_steps(self.layout, self.method, fine_level(self.method) * level)
        if few > self.count.most:
            if self.runs:
                return False
            raise InputError(
                "accuracy",
                f"would take {self.method.name} {few:.0e} steps, more than {self.count.most:.0e}; "
                "give a larger accuracy, a method that chooses its steps, or max_evaluations",
            )
        coarse = self.count.expected(level)
        fine = self.count.expected(fine_level(self.method) * level)
        self.costly = bool(self.rounds) and not self._affords(COARSE_RUNS * coarse + fine)
        return not self.costly

    def run_round(self, level: float) -> bool:
        """A fine run, and two coarse ones at `level`; whether it was not too costly."""
        layout, method, scales = self.layout, self.method, self._scales()
        finer = fine_level(method) * level
        near = NEAR * fine_level(method) ** (1.0 / method.order)
        coarse = setting_at(layout, method, scales, level)
        fine = setting_at(layout, method, scales, finer, near)
        self.count.plan(
            1 + COARSE_RUNS, self.count.seconds(level, self.runs[-1] if self.runs else None)
        )
        finest = self.count.run(fine, self.stops.fine, finer)
        last = _Round(level, coarse, fine, [finest])
        self.costly = bool(self.rounds) and not self._affords(
            COARSE_RUNS * self.count.expected(level)
        )
        if self.costly:
            return False
        self.rounds.append(last)
        for times in (self.stops.few, self.stops.many):
            if last.stopped is None:
                last.runs.insert(-1, self.count.run(coarse, times, level))
        self.runs.append(finest)
        self.scales = None
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
            return None if self.count.spent > self.count.most else self._looser()
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
        if (
            self.count.spent > self.count.most
            or excess <= 1.0
            or level <= finest
            or self.stalls == MOST_STALLS
        ):
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
            self.count.spent,
            self.count.elapsed,
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

    def _scales(self) -> ToleranceScales:
        """Those of the last run, or without one a first guess."""
        if self.scales is None and self.runs:
            self.scales = tolerance_scales(self.layout, self.runs[-1].samples)
        return self.scales or first_guess(self.layout)

    def _affords(self, further: float) -> bool:
        """Whether a round with `further` evaluations leaves the search cheap enough."""
        most = MOST_COST * self._best().finest.evaluations
        short = SHORT_SEARCH / self.layout.scene.count
        return self.count.spent + further <= max(most, short)

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

    def _amplification(self, setting: Setting, run: Integration) -> float | None:
        names = observables(self.accuracy)
        return measure_amplification(self.layout, self.count.attempt, setting, run, names)

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
