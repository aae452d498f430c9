"""The search for settings that keep an accuracy.

A pilot run measures the scales from which local tolerances are made; methods with equal steps need
none.  Each round then compares a fine run with two coarse ones.  The search ends when their
difference meets the request, when finer settings gain nothing, or when the scene amplifies
round-off beyond the request.
"""

from __future__ import annotations

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
from tribo.accuracy.estimate import excess_of_request
from tribo.accuracy.levels import (
    NEAR,
    coarsest_level,
    equal_steps,
    fine_level,
    finest_level,
    setting_at,
    work,
)
from tribo.accuracy.scales import (
    EPSILON,
    first_guess,
    tolerance_scales,
)
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
        of the search, in order; the last is the one to deliver
    amplification
        of a small change of the start; None where it was not measured
    met
        whether the fine run kept the accuracy
    stopped
        the status of runs with finer settings, if these stopped
    errors
        the last ones that were estimated; None if no run was compared
    """

    coarse: Setting
    fine: Setting
    level: float
    runs: tuple[Integration, ...]
    amplification: float | None
    met: bool
    stopped: Status | None = None
    errors: Errors | None = None


def find_settings(
    layout: Layout, method: Method, accuracy: Accuracy, stops: StopTimes, attempt: Attempt
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

    Returns
    -------
    FoundSettings
        the last ones tried, whether they keep the accuracy or not

    Raises
    ------
    InputError
        if the accuracy is out of reach and its runs would be long, or if equal steps would be too
        many
    """
    search = _Search(layout, method, accuracy, stops, attempt)
    level = FIRST * method.first_level * strictest(accuracy)
    level = min(max(level, finest_level(method)), coarsest_level(layout, method))
    if not search.run_pilot(level):
        return search.found()
    for _ in range(ROUNDS):
        if not search.allows(level):
            break
        search.run_round(level)
        lower = search.next_level(level)
        if lower is None:
            break
        level = lower
    return search.found()


@dataclass
class _Round:
    """Two coarse runs and a fine one."""

    level: float  # of the coarse runs
    coarse: Setting
    fine: Setting
    runs: list[Integration] = field(default_factory=list)
    excess: float = np.inf  # the largest estimate of the fine run relative to the request
    errors: Errors | None = None  # of the fine run

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
    ) -> None:
        self.layout, self.method, self.stops, self.attempt = layout, method, stops, attempt
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

    def run_pilot(self, level: float) -> bool:
        """Run the pilot of an adaptive method; none with equal steps.

        Returns whether another run can come farther.  Refuses an accuracy out of reach if the fine
        run of the first round, at `level`, would be long.
        """
        if not self.method.adaptive:
            return True
        setting, pilot = _resolved(self.layout, self.method, self.stops.few, self.attempt)
        self.runs.append(pilot)
        if pilot.status in ABORTED:
            self.rounds.append(_Round(level, setting, setting, [pilot]))
            return False
        if pilot.status != Status.COMPLETED:
            return True
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
        """Whether a round has few enough equal steps; refuses the accuracy if the first has not."""
        few = equal_steps(self.layout, self.method, fine_level(self.method) * level)
        if few <= self.most:
            return True
        if self.runs:
            return False
        raise InputError(
            "accuracy",
            f"would take {self.method.name} {few:.0e} steps, more than {self.most:.0e}; give a "
            "larger accuracy, a method that chooses its steps, or max_evaluations",
        )

    def run_round(self, level: float) -> None:
        """Two coarse runs at `level`, and a fine one."""
        layout, method = self.layout, self.method
        scales = (
            tolerance_scales(layout, self.runs[-1].samples) if self.runs else first_guess(layout)
        )
        finer = fine_level(method) * level
        near = NEAR * fine_level(method) ** (1.0 / method.order)
        coarse = setting_at(layout, method, scales, level)
        fine = setting_at(layout, method, scales, finer, near)
        last = _Round(level, coarse, fine)
        self.rounds.append(last)
        each = ((coarse, level), (coarse, level), (fine, finer))
        for (setting, its_level), times in zip(each, self.stops, strict=True):
            most = max(UNEXPECTED * self._expected(its_level), UNNOTICED * self.most)
            run = self.attempt(setting, times, most=min(self.most, most))
            last.runs.append(run)
            self.runs.append(run)
            if run.status in ABORTED:
                return
            if run.status == Status.COMPLETED:
                self.known = (its_level, run.evaluations)
        if last.stopped is None:
            self.reached = level

    def next_level(self, level: float) -> float | None:
        """The level of the round after one at `level`; None if the search ends."""
        last = self.rounds[-1]
        fine = last.runs[-1]
        if fine.status in FROM_OUTSIDE or sum(run.evaluations for run in self.runs) > self.most:
            return None
        if self.method.adaptive and last.stopped is not None:
            self.too_fine = max(self.too_fine, level)
            return self._looser()
        finest = finest_level(self.method)
        shorter = level * SHORTER**self.method.order
        can_be_too_long = not self.method.adaptive and work(self.layout, fine) < SHORTER * LONG_RUN
        if can_be_too_long and any(run.status in TOO_LONG for run in last.runs):
            return shorter
        known = self.wanted >= TIGHT or self._measure() is not None
        before = self.rounds[-2].excess if len(self.rounds) > 1 else np.inf
        last.excess = self._excess(last)
        if can_be_too_long and len(self.runs) == 3 and last.excess * self.wanted > 1.0:
            self.amplification, last.excess = None, np.inf
            return shorter
        self.stalls = self.stalls + 1 if last.excess > STALLED * before else 0
        if last.excess <= 1.0 or level <= finest or self.stalls == MOST_STALLS or not known:
            return None
        amplification = self._measure()
        unknown = self.too_fine > 0.0 and last.excess * self.wanted > KNOWN
        if amplification is None or (amplification * EPSILON > self.wanted and not unknown):
            return None
        lower = AIM / last.excess if np.isfinite(last.excess) else LOWER**2
        lower = max(level * min(LOWER, lower), finest)
        return lower if lower > self.too_fine else self._looser()

    def found(self) -> FoundSettings:
        """What the search found: the last round, or the best one if finer runs stopped."""
        chosen, stopped = self.rounds[-1], None
        if self.too_fine > 0.0:
            known = [item for item in self.rounds if item.excess * self.wanted <= KNOWN]
            chosen = min(known or self.rounds, key=lambda item: item.level)
            stopped = next(item.stopped for item in self.rounds if item.stopped is not None)
        others = [run for run in self.runs if run not in chosen.runs]
        return FoundSettings(
            chosen.coarse,
            chosen.fine,
            fine_level(self.method) * chosen.level,
            (*others, *chosen.runs),
            self.amplification,
            chosen.excess <= 1.0,
            stopped,
            chosen.errors,
        )

    def _looser(self) -> float | None:
        """A level between one at which runs stop and one at which they do not; None if close."""
        level = (self.too_fine * self.reached) ** 0.5
        return level if np.isfinite(level) and level > CLOSE * self.too_fine else None

    def _expected(self, level: float) -> float:
        """Evaluations of a run at a level, by those of the last one and the order of the method."""
        before, evaluations = self.known
        return evaluations * (before / level) ** (1.0 / self.method.order)

    def _amplification(self, setting: Setting, run: Integration) -> float | None:
        names = observables(self.accuracy)
        return measure_amplification(self.layout, self.attempt, setting, run, names)

    def _measure(self) -> float | None:
        """The amplification, measured by a coarse run unless it is known."""
        if self.amplification is None:
            last = self.rounds[-1]
            self.amplification = self._amplification(last.coarse, last.runs[0])
        return self.amplification

    def _excess(self, last: _Round) -> float:
        """The largest estimate of the fine run relative to the request."""
        bounds, scales = error_bounds(
            self.layout, last.runs[-1], last.runs[:-1], self.amplification, self.accuracy
        )
        excess = excess_of_request(bounds, scales, self.accuracy)
        last.errors = Errors(last.runs[-1], self.amplification, bounds, excess)
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
