"""The search for settings that keep an accuracy.

A pilot run measures the scales from which local tolerances are made; methods with equal steps need
none.  Each round then compares a fine run with two coarse ones.  The search ends when their
difference meets the request, when finer settings gain nothing, or when the scene amplifies
round-off beyond the request.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from tribo.accuracy.comparison import (
    ABORTED,
    Accuracy,
    Attempt,
    error_bounds,
    growth,
    measure_amplification,
    observables,
    out_of_reach,
    strictest,
)
from tribo.accuracy.decision import (
    LONG_RUN,
    Limits,
    Round,
    Stop,
    best,
    decide,
    is_too_long,
    too_fine,
)
from tribo.accuracy.estimate import excess_of_request
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
# Requests below this measure the amplification at once, because rounding counts in their estimate.
# Others do so if the first round misses them: where nothing moves but by weak forces, a change of
# the start matters a thousand times more than rounding, which is relative to what it rounds.
TIGHT = 1e-9
# Level of the coarse runs for an accuracy of 1, where a small change of the start grows by 1.  Of
# two grids of 5041 asperites, where changes grew by 53,000, the error was 0.02 at a level of 6e-6.
AMPLIFIED = 5.0
# A long run is refused if growing errors make it this many times as long.
MOST_LONGER = 4.0
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
        following = search.decide()
        if isinstance(following, Stop):
            break
        level = following
    return search.found()


@dataclass
class _Round(Round):
    """A round with its runs: two coarse ones, and the fine one last."""

    coarse: Setting = 0.0
    fine: Setting = 0.0
    runs: list[Integration] = field(default_factory=list)
    errors: Errors | None = None  # of the fine run

    def add(self, layout: Layout, fine: Integration, coarse: Sequence[Integration] = ()) -> None:
        """The runs, of which the first that stopped gives the status."""
        self.runs = [*coarse, fine]
        stops = [run.status for run in self.runs if run.status != Status.COMPLETED]
        self.stopped = stops[0] if stops else None
        self.steps, self.work = fine.steps, work(layout, fine)


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
        self.reached = np.inf  # the level of a pilot that completed
        self.costly = False

    @property
    def limits(self) -> Limits:
        """What bounds the search, as far as it is known now."""
        return Limits(
            self.wanted,
            self.method.order,
            self.method.adaptive,
            finest_level(self.method),
            self.reached,
            self.count.spent > self.count.most,
            self.amplification,
        )

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
            self.rounds.append(_Round(level, coarse=setting, fine=setting, runs=[pilot]))
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
        self.count.plan_round(level, self.runs[-1] if self.runs else None)
        finest = self.count.run(fine, self.stops.fine, finer)
        self.costly = bool(self.rounds) and not self._affords(
            COARSE_RUNS * self.count.expected(level)
        )
        if self.costly:
            return False
        last = _Round(level, coarse=coarse, fine=fine)
        last.add(layout, finest)
        self.rounds.append(last)
        for times, rounded in ((self.stops.few, False), (self.stops.many, True)):
            if last.stopped is None:
                coarser = [*last.runs[:-1], self.count.run(coarse, times, level, rounded)]
                last.add(layout, finest, coarser)
        self.runs.append(finest)
        self.scales = None
        return True

    def decide(self) -> float | Stop:
        """The level of the next round, or why there is none; estimates the errors of the last."""
        last = self.rounds[-1]
        if last.stopped is None:
            if self.wanted < TIGHT:
                self._measure(last)
            last.estimate = last.excess = self._excess(last)
        if is_too_long(self.rounds, self.limits):
            self.amplification, last.estimate, last.excess = None, np.inf, np.inf
        elif last.stopped is None and last.estimate > 1.0 and self.amplification is None:
            self._measure(last)
            last.excess = self._excess(last)
        return decide(self.rounds, self.limits)

    def found(self) -> FoundSettings:
        """The settings and runs of the best round, whose fine run shares an interrupt."""
        chosen, stopped = best(self.rounds, self.limits), None
        if too_fine(self.rounds, self.limits) > 0.0:
            stopped = next(item.stopped for item in self.rounds if item.stopped is not None)
        others = [run for run in self.runs if run not in chosen.runs]
        if self.count.interrupted:
            chosen.runs[-1] = replace(chosen.runs[-1], status=Status.INTERRUPTED)
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

    def _scales(self) -> ToleranceScales:
        """Those of the last run, or without one a first guess."""
        if self.scales is None and self.runs:
            self.scales = tolerance_scales(self.layout, self.runs[-1].samples)
        return self.scales or first_guess(self.layout)

    def _affords(self, further: float) -> bool:
        """Whether a round with `further` evaluations leaves the search cheap enough."""
        most = MOST_COST * best(self.rounds, self.limits).runs[-1].evaluations
        short = SHORT_SEARCH / self.layout.scene.count
        return self.count.spent + further <= max(most, short)

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
        last.errors = Errors(fine, grown, bounds, scales, excess)
        return excess
