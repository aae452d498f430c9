"""The search for settings that keep an accuracy.

A pilot run measures the scales from which tolerances are made; equal steps need none.  Each round
then compares a fine run with two coarse ones.  The search ends when their difference meets the
request, when finer settings gain nothing, or when the scene amplifies round-off beyond the request.
"""

import time
from dataclasses import dataclass, replace

import numpy as np

from tribo.accuracy import comparison, decision, levels
from tribo.accuracy.decision import LONG_RUN, Limits, Round, Stop
from tribo.accuracy.levels import first_guess, tolerance_scales
from tribo.accuracy.scales import EPSILON
from tribo.accuracy.search_runs import COARSE_RUNS, PILOT_LEVEL, Announce, SearchRuns, StopTimes
from tribo.kernels.status import Status
from tribo.loops.integrate import Integration
from tribo.loops.select import Integrator
from tribo.loops.setting import Setting
from tribo.validation import InputError

# First level, in units of that of the method, which is for estimates of two differences, not three.
FIRST = 2.0 / 3.0
# Rounds of lower levels, after which a request counts as out of reach.
ROUNDS = 6
# Requests below this measure the amplification at once, for rounding counts in their estimate;
# others if the first round misses.  With weak forces alone, a change of the start matters a
# thousand times more than rounding, which is relative to what it rounds.
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


@dataclass(frozen=True)
class FoundSettings:
    coarse: Setting  # of the runs that estimate the error
    fine: Setting  # of the run that is delivered
    level: float  # of the fine setting, relative to the scales
    # All of the search, the one to deliver last, after two that it was compared with, if it was.
    runs: tuple[Integration, ...]
    amplification: float | None  # of a small change of the start, if it was measured
    met: bool  # whether the fine run kept the accuracy
    evaluations: int  # of all forces, in all runs of the search
    seconds: float  # wall time of the search
    costly: bool  # whether a further round would have cost too much
    stopped: Status | None  # of runs with finer settings, if these stopped
    errors: comparison.Errors | None  # of the run to deliver; None if it was compared with no other
    rough: bool  # whether its tolerances are below the rounding of forces


def missed_note(found: FoundSettings, accuracy: comparison.Accuracy, excess: float) -> str:
    """By how much a run missed its request, in units of it, and why."""
    wanted = comparison.strictest(accuracy)
    if found.met:
        why = "the settings were found from the scene's own start, which kept it"
    elif found.stopped is not None:
        why = f"with tolerances that could keep it, runs stop as {found.stopped}"
    elif found.amplification is None:
        why = "the search for settings was interrupted"
    elif found.costly:
        why = f"finer settings would take more than {MOST_COST:g} times the evaluations of the "
        why += "run that is delivered"
    else:
        why = comparison.out_of_reach(wanted, found.amplification)
    if excess * wanted > 1.0:
        return f"errors may exceed the scales of their quantities; {why}"
    return f"errors are estimated at {excess:.1e} of the request; {why}"


def find_settings(
    integrator: Integrator,
    accuracy: comparison.Accuracy,
    stops: StopTimes,
    announce: Announce | None = None,
) -> FoundSettings:
    """Settings of which a fine run keeps `accuracy`, or misses it least.  Raises InputError."""
    search = _Search(SearchRuns(integrator, announce), accuracy, stops)
    method = integrator.method
    level = max(FIRST * method.first_level * search.wanted, search.limits.finest)
    level = min(level, levels.coarsest_level(integrator.layout, method))
    following: float | Stop | None = search.run_pilot(level)
    for _ in range(ROUNDS):
        if not isinstance(following, float) or not search.allows(following):
            break
        following = search.run_round(following)
    return search.found()


class _Search:
    """The runs of a search, in order, and what they show."""

    def __init__(self, runner: SearchRuns, accuracy: comparison.Accuracy, stops: StopTimes) -> None:
        """Begin without runs, and with a guess of the scales."""
        self.layout = runner.layout
        self.method = runner.method
        self.runner = runner
        self.stops = stops
        self.accuracy = accuracy
        self.wanted = comparison.strictest(accuracy)
        self.runs: list[Integration] = []
        self.scales = first_guess(self.layout)
        self.rounds: list[Round] = []
        method = self.method
        finest = levels.FLOOR / levels.fine_level(self.method)
        self.limits = Limits(self.wanted, method.order, method.adaptive, finest)
        self.costly = False

    def run_pilot(self, level: float) -> float | None:
        """Run the pilot of an adaptive method; the level of the first round, None if no run helps.

        It is below `level` where the fine run would be long and small errors grow.  Raises
        InputError if the accuracy is out of reach of such a run.
        """
        if not self.method.adaptive:
            return level
        setting, pilot, self.scales = self.runner.pilot(self.stops.few)
        self.runs.append(pilot)
        if pilot.status in comparison.ABORTED:
            self.rounds.append(Round(level, coarse=setting, fine=setting, runs=[pilot]))
            return None
        if pilot.status != Status.COMPLETED:
            return level
        self.runner.plan(1 + COARSE_RUNS)
        self.limits.reached = PILOT_LEVEL
        self.runner.known = (PILOT_LEVEL, pilot.evaluations)
        longer = self.runner.expected(levels.fine_level(self.method) * level) / pilot.evaluations
        if longer * levels.work(self.layout, pilot) < LONG_RUN:
            return level
        self._measure(setting, pilot)
        grown = self.limits.amplification
        if grown is None:
            return level
        amplified = min(level, AMPLIFIED * self.wanted / max(grown, 1.0))
        longer = self.runner.expected(amplified) / self.runner.expected(level)
        if grown * EPSILON > self.wanted or longer > MOST_LONGER:
            raise InputError("accuracy", self._too_far(grown, longer))
        return max(amplified, self.limits.finest)

    def _too_far(self, amplification: float, longer: float) -> str:
        """Why a long run is refused, and what to do."""
        why = comparison.out_of_reach(self.wanted, amplification).removeprefix("accuracy ")
        if amplification * EPSILON <= self.wanted:
            why = (
                f"{self.wanted:.1e} would take about {longer:.0f} times the evaluations of a run "
                f"without growing errors: {comparison.growth(amplification)}"
            )
        return (
            f"{why}; name the observables that matter, or give a method and a step; tribo.ensemble "
            "averages over many starts"
        )

    def allows(self, level: float) -> bool:
        """Whether a round is short enough; refuses the accuracy if the first has too many steps."""
        finer = levels.fine_level(self.method) * level
        steps = 0.0
        if not self.method.adaptive:
            steps = self.layout.run_time / levels.equal_step(self.layout, self.method, finer)
        if steps > self.runner.most:
            if self.runs:
                return False
            raise InputError(
                "accuracy",
                f"would take {self.method.name} {steps:.0e} steps, "
                f"more than {self.runner.most:.0e}; "
                "give a larger accuracy, a method that chooses its steps, or max_evaluations",
            )
        coarse = self.runner.expected(level)
        fine = self.runner.expected(finer)
        self.costly = bool(self.rounds) and not self._affords(COARSE_RUNS * coarse + fine)
        return not self.costly

    def run_round(self, level: float) -> float | Stop | None:
        """A fine run, and two coarse ones at `level`: what follows; None if it was too costly."""
        layout = self.layout
        method = self.method
        if self.rounds:
            self.scales = tolerance_scales(layout, self.runs[-1].samples)
        finer = levels.fine_level(method) * level
        near = levels.NEAR * levels.fine_level(method) ** (1.0 / method.order)
        coarse = levels.setting_at(layout, method, self.scales, level)
        fine = levels.setting_at(layout, method, self.scales, finer, near)
        self.runner.plan_round(level, self.runs[-1] if self.runs else None)
        run = self.runner.run(fine, self.stops.fine, finer)
        self.costly = bool(self.rounds) and not self._affords(
            COARSE_RUNS * self.runner.expected(level)
        )
        if self.costly:
            return None
        last = Round(level, _stop_of(run), steps=run.steps, work=levels.work(layout, run))
        last.coarse = coarse
        last.fine = fine
        last.runs = [run]
        self.rounds.append(last)
        self.runs.append(run)
        for times, rounded in ((self.stops.few, False), (self.stops.many, True)):
            if last.stopped is None:
                run = self.runner.run(coarse, times, level, rounded)
                last.runs.insert(-1, run)  # the fine run stays the last one
                last.stopped = _stop_of(run)
        return self.decide()

    def decide(self) -> float | Stop:
        """The level of the next round, or why there is none; estimates the errors of the last."""
        last = self.rounds[-1]
        if last.stopped is None:
            if self.wanted < TIGHT:
                self._measure(last.coarse, last.runs[0])
            last.estimate = last.excess = self._excess(last)
            if last.estimate <= 1.0 and last.estimate * self.wanted > comparison.DIVERGED_IN_CHAOS:
                # The errors of all three runs may be of one size, where they do not fall with the
                # level: those of the start grew by 1e6 in a scene that starts in a deep core.
                self._measure(last.coarse, last.runs[0])
                last.estimate = last.excess = self._excess(last)
        if decision.is_too_long(self.rounds, self.limits):
            self.limits.amplification = None
            last.estimate = np.inf
            last.excess = np.inf
        elif last.stopped is None and last.estimate > 1.0 and self.limits.amplification is None:
            self._measure(last.coarse, last.runs[0])
            last.excess = self._excess(last)
        self.limits.exhausted = self.runner.spent > self.runner.most
        return decision.decide(self.rounds, self.limits)

    def found(self) -> FoundSettings:
        """The settings and runs of the best round, whose fine run shares an interrupt."""
        chosen = decision.best(self.rounds, self.limits)
        stopped = None
        if decision.too_fine(self.rounds, self.limits) > 0.0:
            stopped = next(item.stopped for item in self.rounds if item.stopped is not None)
        others = [run for run in self.runs if run not in chosen.runs]
        if self.runner.interrupted:
            chosen.runs[-1] = replace(chosen.runs[-1], status=Status.INTERRUPTED)
        return FoundSettings(
            coarse=chosen.coarse,
            fine=chosen.fine,
            level=levels.fine_level(self.method) * chosen.level,
            runs=(*others, *chosen.runs),
            amplification=self.limits.amplification,
            met=chosen.excess <= 1.0,
            evaluations=self.runner.spent,
            seconds=time.perf_counter() - self.runner.began,
            costly=self.costly,
            stopped=stopped,
            errors=chosen.errors,
            rough=chosen.rough,
        )

    def _affords(self, further: float) -> bool:
        """Whether a round with `further` evaluations leaves the search cheap enough."""
        most = MOST_COST * decision.best(self.rounds, self.limits).runs[-1].evaluations
        short = SHORT_SEARCH / self.layout.scene.count
        return self.runner.spent + further <= max(most, short)

    def _measure(self, setting: Setting, run: Integration) -> None:
        """Measure the amplification by a run, unless it is known."""
        if self.limits.amplification is None:
            names = comparison.observables(self.accuracy)
            self.limits.amplification = comparison.measure_amplification(
                self.layout, self.runner.attempt, setting, run, names
            )

    def _excess(self, last: Round) -> float:
        """The largest estimate of the fine run relative to the request."""
        *coarser, fine = last.runs
        grown = self.limits.amplification
        finer = levels.fine_level(self.method) * last.level
        last.rough = self.method.adaptive and self.scales.below_rounding(finer)
        last.errors = comparison.error_bounds(
            self.layout, fine, coarser, grown, self.accuracy, last.rough
        )
        return last.errors.excess


def _stop_of(run: Integration) -> Status | None:
    return None if run.status == Status.COMPLETED else run.status
