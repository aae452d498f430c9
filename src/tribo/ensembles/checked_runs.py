"""Members that are run by one compiled loop with one setting, checked, and refined.

docs/developers/ensembles.md has the rules and reasons.  What is delivered of a member depends on
the plan of all and on the member alone, not on the members that are run beside it.

The plan is the method, its setting, and whom to check.  The cheapest setting with which a sample
agrees with finer runs is tried on a pilot, and made finer until its largest error leaves room for
larger ones.  Members with numbers of their own, of which evaluations do not show the errors, are
run at a level below the cheapest one, and compared with rougher runs.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import NamedTuple, Self

import numpy as np

from tribo.accuracy.comparison import strictest, weak_notes
from tribo.accuracy.levels import FLOOR, ToleranceScales, setting_at, tolerance_scales
from tribo.accuracy.member_comparison import FineRuns
from tribo.accuracy.plan import NEAR_ALONE
from tribo.accuracy.scales import EPSILON, ROLES
from tribo.ensembles.batches import (
    MOST_NUMBERS,
    Policy,
    chunk_of,
    complete_members,
    delivered,
    kept_series,
)
from tribo.ensembles.engines import in_threads
from tribo.ensembles.kept_values import ERROR, UNKNOWN, Kept, KeptValues, set_notes
from tribo.ensembles.members import Members, Variation
from tribo.integrators.tableaux import RKN8, RKN12
from tribo.kernels.status import CODE, COMPLETED, EVALUATIONS, STEPS
from tribo.ledger.series_table import names_with_accuracy
from tribo.loops.batch import Batch, MemberRuns, MemberStarts
from tribo.loops.batch_pair import PairLanes, has_lanes
from tribo.loops.setting import Setting
from tribo.prepared import Simulation

# The first members, by which the setting is chosen; all are checked: few of a million.
SAMPLE = 64
# Members of the pilot: 2 % of the runs of 200,000 members of a pair, and fewer of larger scenes.
PILOT = 4096
PILOT_OF_LARGE = 512
# Finest level that is tried in larger scenes, relative to the accuracy.  Pairs can afford FLOOR.
FINEST_OF_LARGE = 1e-4
# One member in so many is checked beside them, whatever its evaluations: 2 % of the time.
CHECKED = 256
# Level of a run that checks another, relative to that or to the accuracy: two digits better.
FINER = 1e-2
# Its longest step to an encounter, relative to that of single runs.  Where accuracies are rough,
# encounters alone limit the steps: with the same limit, both runs have nearly the same error.
FINER_NEAR = 0.5
# Largest difference of a run from a finer one, in units of the accuracy: the rest is the latter's.
KEPT = 0.9
# Longest step of members in lanes, as a fraction of the time to the next encounter.
NEAR_IN_LANES = 1.25
# Time of an evaluation in lanes over that of the collocation: 6 and 13 ns on cases A and C.
COST_IN_LANES = 0.47
# Level of a rougher run, relative to that of the plan.
ROUGHER = 4.0
# Its longest step to an encounter, relative to the plan's: tolerances do not control its error.
ROUGHER_NEAR = 1.5
# Largest difference of a run from a rougher one, in units of the accuracy, with which it is not
# checked: most of the difference is the error of the rougher one, some three times as large.
AGREED = 0.5
# Times that a member is refined before it gets a run of its own.
REFINEMENTS = 3
# Levels that are tried, from the loosest, in units of the accuracy.
LEVELS = 2.0 ** np.arange(14.0, -24.0, -0.5)
# Largest difference of the sample from finer runs, in units of the accuracy: others may be larger.
CHOSEN = 0.5
# A search ends at a level that takes at most so many times the evaluations of one too loose.
CLOSE = 1.1
# Trials in a row that leave more than half of the levels, after which the middle one is tried.
MOST_SLOW = 2
# Places of LEVELS by which an error that is proportional to the level halves.
LEVELS_TO_HALF = 2.0
# Members of the pilot that are run in one call, so that threads share them.
PIECE = 1024
# Members of the first batch: where they suffice, 1 % are checked, in 4 % of the time.
BATCH = 32
# One in so many of the others is checked.
OTHERS = 4
# Their largest difference from finer runs, in units of the accuracy.  In 20,000 members of case A
# the share above x fell as x^-4: of a million, ten miss if one in a thousand is above this.
ROOM = 0.3
# Exponent with which the largest error of some members grows with their number: that of 1024 others
# of 20,000 members of the paper's cases is 1.4 times that of the sample, in the middle of 24.
GROWTH = 0.125
# Settings that are kept: all members have a few, in many calls.
SETTINGS_KEPT = 8
# Part of a level to which it is lowered at most, since errors need not be proportional to it.
LOWERED = 0.1
# And at most: smaller changes approach the room without ever reaching it.
TIGHTENED = 0.7


class Stepper(NamedTuple):
    """A loop that runs members, and its cost."""

    batch: Batch
    near: float  # longest step, as a fraction of the time to the next encounter
    cost: float  # time of an evaluation, relative to that of the collocation


class CheckedPlan(NamedTuple):
    """How all members are run: by which method and tolerances, and which members are checked."""

    method: str
    level: float
    most_evaluations: int  # members that take more are checked; -1 with numbers of their own
    scales: ToleranceScales

    @property
    def attributes(self) -> dict[str, str | float]:
        return self._asdict() | {"scales": json.dumps([*vars(self.scales).values()])}

    @classmethod
    def from_attributes(cls, attributes: Mapping[str, str | float]) -> Self:
        method, level, evaluations, scales = (attributes[name] for name in cls._fields)
        found = ToleranceScales(*json.loads(str(scales)))
        return cls(str(method), float(level), int(evaluations), found)


class CheckedRuns(Policy):
    """Runs members in batches by an adaptive method, with a `plan` that has to be set."""

    plan: CheckedPlan

    def __init__(self, simulation: Simulation, kept: Kept, own_numbers: Sequence[str]) -> None:
        """Compile the ways to run members that this scene has, and the loop for checks."""
        super().__init__(simulation, kept, own_numbers)
        assert simulation.accuracy is not None
        asked = simulation.accuracy
        if not isinstance(asked, Mapping):
            # Quantities without an accuracy follow from others; alone, from any of them.
            compared = [name for name in kept.names if name.rpartition(".")[2] in ROLES]
            asked = dict.fromkeys(compared or names_with_accuracy(simulation.layout), asked)
        self._accuracy = asked
        self.strictest = strictest(self._accuracy)
        self.exact = simulation.method.name  # that of single runs, and of the first stepper
        self.steppers = _steppers(simulation, bool(own_numbers))
        self._checks = simulation.integrator.batch(bool(own_numbers), rounded=True)
        find = partial(setting_at, simulation.layout, simulation.method)
        self._setting_at = lru_cache(SETTINGS_KEPT)(find)
        pair = simulation.integrator.pair is not None
        self.pilot = PILOT if pair else PILOT_OF_LARGE  # members that tell whom to check
        self.finest = FLOOR if pair else max(FLOOR, FINEST_OF_LARGE * self.strictest)  # level
        # The numbers of the pilot's members and their runs by the last plan, if these are kept.
        self._of_pilot: tuple[np.ndarray, MemberRuns] | None = None

    @cached_property
    def chunk(self) -> int:  # type: ignore[override]
        pair = self.simulation.integrator.pair is not None
        return chunk_of(self.simulation, None if pair else self.simulation.finest.evaluations)

    def compute(self, members: Members) -> KeptValues:
        """Run members, check and refine them; those that need a search of their own are UNKNOWN."""
        starts = self.begin(members)
        runs = self._by_plan(members.numbers, starts)
        found = delivered(self.kept, runs, self.plan.level, complete_members(runs))
        complete = found["status"] != UNKNOWN
        some = (members.numbers < SAMPLE) | (members.numbers % CHECKED == 0)
        checked = complete & (self.kept.with_errors or self._doubtful(runs, starts) | some)
        if checked.any():
            self._refine(found, np.flatnonzero(checked), runs, starts)
        return found

    def run_pilot(
        self, plan: CheckedPlan, numbers: np.ndarray, starts: MemberStarts, threads: int
    ) -> np.ndarray:
        """The counts of the pilot's runs by a plan; the runs are kept unless they are large."""
        layout = self.simulation.layout
        parts = in_threads(partial(self.run, plan), starts.pieces(self.piece(threads)), threads)
        if numbers.size * layout.times.size * (2 * layout.core + layout.accounts) > MOST_NUMBERS:
            return np.concatenate([part.counts for part in parts])
        first, *others = parts
        runs = first.beside(*others) if others else first
        self._of_pilot = numbers, runs
        return runs.counts

    def piece(self, threads: int) -> int:
        """Members of the pilot that are run in one call."""
        return self.chunk if threads == 1 else min(PIECE, self.chunk)

    def _by_plan(self, numbers: np.ndarray, starts: MemberStarts) -> MemberRuns:
        """The runs of members by the plan; the pilot's are known."""
        if self._of_pilot is None:
            return self.run(self.plan, starts)
        of_pilot, runs = self._of_pilot
        places = np.minimum(np.searchsorted(of_pilot, numbers), of_pilot.size - 1)
        is_known = of_pilot[places] == numbers
        if not is_known.any():
            return self.run(self.plan, starts)
        known = runs.of_members(places[is_known])
        if is_known.all():
            return known
        every = known.beside(self.run(self.plan, starts.of_members(~is_known)))
        if is_known[: len(known.counts)].all():
            return every
        order = np.argsort(~is_known, kind="stable")  # the known ones first
        return every.of_members(np.argsort(order))

    def _doubtful(self, runs: MemberRuns, starts: MemberStarts) -> np.ndarray:
        """Whether runs by the plan may miss their accuracy, (members,)."""
        plan = self.plan
        if starts.numbers is None:
            return np.asarray(runs.counts[:, EVALUATIONS] > plan.most_evaluations)
        near = ROUGHER_NEAR * self.steppers[plan.method].near
        rough = self.run(plan._replace(level=ROUGHER * plan.level), starts, near)
        return np.asarray(self.fine(runs).compare(rough)[1][0] > AGREED)

    def run(self, plan: CheckedPlan, starts: MemberStarts, near: float | None = None) -> MemberRuns:
        """Run members by the method and tolerances of a plan; `near` in place of the method's."""
        stepper = self.steppers[plan.method]
        near = stepper.near if near is None else near
        return stepper.batch.run(self._setting(plan, near), starts)

    def _check(self, level: float, starts: MemberStarts) -> MemberRuns:
        """Run members by the method of single runs, in finer steps.

        The bobs' places are rounded in another way.
        """
        if starts.numbers is not None:
            places = starts.numbers.displaced(*self.simulation.layout.shifts)
            starts = starts._replace(numbers=places)
        setting = self._setting(self.plan._replace(level=level), FINER_NEAR * NEAR_ALONE)
        return self._checks.run(setting, starts)

    def _setting(self, plan: CheckedPlan, near: float) -> Setting:
        return self._setting_at(plan.scales, plan.level, near)

    def fine(self, runs: MemberRuns) -> FineRuns:
        """Runs of members, with which others of the same members are compared."""
        return FineRuns(runs, self._accuracy)

    def finer(self, level: float) -> float:
        """The level of runs that check those of another level."""
        return max(FLOOR, FINER * min(level, self.strictest))

    def _refine(
        self, found: KeptValues, now: np.ndarray, runs: MemberRuns, starts: MemberStarts
    ) -> None:
        """Check members with some places, and deliver those that miss from finer runs."""
        coarse = runs.of_members(now)
        level = self.plan.level
        for _ in range(REFINEMENTS + 1):
            level = self.finer(level)
            fine = self.fine(self._check(level, starts.of_members(now)))
            scales, (excess,) = fine.compare(coarse)
            known = np.isfinite(excess)
            set_notes(found, now, weak_notes(scales.work, scales.energy, self._accuracy))
            for name in self.kept.names if self.kept.with_errors else ():
                worst = np.maximum(excess / KEPT, EPSILON / self.strictest)  # of any quantity
                asked = self._accuracy.get(name)
                if asked is None:
                    found[f"{name}{ERROR}"][now] = np.nan
                else:
                    found[f"{name}{ERROR}"][now] = worst * asked * scales.of(name)
            found["error"][now] = np.where(known, excess * self.strictest, np.nan)
            bad = ~(excess <= KEPT)
            now = now[bad]
            if not now.size:
                return
            finer = self.plan._replace(method=self.exact, level=level)
            coarse = self.run(finer, starts.of_members(now))
            for name, values in kept_series(self.kept, coarse).items():
                found[name][now] = values
            found["level"][now] = level
            found["steps"][now] = coarse.counts[:, STEPS]
            found["force_evaluations"][now] = coarse.counts[:, EVALUATIONS]
        found["status"][now] = UNKNOWN


def _steppers(simulation: Simulation, own_numbers: bool) -> dict[str, Stepper]:
    """The ways to run members, by method."""
    pair = simulation.integrator.pair
    method = simulation.method
    layout = simulation.layout
    batch = simulation.integrator.batch(own_numbers)
    steppers = {method.name: Stepper(batch, NEAR_ALONE, 1.0)}
    if pair is not None and has_lanes(pair) and layout.times.size == 2:
        for name, explicit in (("rkn8", RKN8), ("rkn12", RKN12)):
            lanes = Batch(partial(PairLanes, pair, explicit, own_numbers))
            steppers[name] = Stepper(lanes, NEAR_IN_LANES, COST_IN_LANES)
    return steppers


def checked_plan(runs: CheckedRuns, variation: Variation, count: int, threads: int) -> CheckedPlan:
    """The plan of an ensemble of `count` members; the own plan of `runs` is not used."""
    simulation = runs.simulation
    pilot = simulation.plan.pilot
    if pilot is not None:
        scales = pilot.scales
    else:
        scales = tolerance_scales(simulation.layout, simulation.finest.samples)
    plan, error = _cheapest(runs, variation, count, scales)
    if runs.own_numbers:  # each member is compared with a run at the level that is chosen
        return plan._replace(level=max(FLOOR, plan.level / ROUGHER))
    members = variation.sample(count, runs.pilot)
    starts = runs.begin(members)
    # The largest error to expect of the pilot's others, so that one round may suffice.
    expected = error * max(1.0, (len(starts.y) / (OTHERS * SAMPLE)) ** GROWTH)
    plan = _with_room(runs, plan, expected, 1.0)
    counts = runs.run_pilot(plan, members.numbers, starts, threads)
    plan, error = _with_most_evaluations(runs, plan, starts, counts, threads)
    while error > ROOM and plan.level > runs.finest:
        plan = _with_room(runs, plan, error, TIGHTENED)
        counts = runs.run_pilot(plan, members.numbers, starts, threads)
        plan, error = _with_most_evaluations(runs, plan, starts, counts, threads)
    return plan


def _with_room(runs: CheckedRuns, plan: CheckedPlan, error: float, most: float) -> CheckedPlan:
    """The plan at a level that leaves room, at most so much of its own, if errors grow with it."""
    if error <= ROOM:
        return plan
    level = plan.level * max(LOWERED, min(most, ROOM / error))
    return plan._replace(level=max(runs.finest, level))


def _cheapest(
    runs: CheckedRuns, variation: Variation, count: int, scales: ToleranceScales
) -> tuple[CheckedPlan, float]:
    """The cheapest setting that keeps the accuracy of the sample, and the sample's error with it.

    The error is in units of the accuracy; 0 with a setting that was not tried.
    """
    starts = runs.begin(variation.sample(count, SAMPLE))
    levels = np.maximum(LEVELS * runs.strictest, runs.finest)
    exact = CheckedPlan(runs.exact, float(levels[-1]), -1, scales)
    fine = runs.run(exact, starts)
    reference = runs.fine(fine)
    complete = fine.complete
    searches = [_Search(name, stepper, levels.size - 1) for name, stepper in runs.steppers.items()]
    while tried := _worth_trying(searches):
        found = [
            runs.run(exact._replace(method=each.method, level=float(levels[each.next])), starts)
            for each in tried
        ]
        errors = reference.compare(*found)[1][:, complete].max(axis=1, initial=0.0)
        for each, own, error in zip(tried, found, errors.tolist(), strict=True):
            each.narrow(error, float(own.counts[:, EVALUATIONS].sum()))
    best = min(searches, key=lambda each: each.cost)  # the first of equal ones
    if best.cost == np.inf:
        return exact._replace(level=max(FLOOR, FINER * runs.strictest)), 0.0
    return exact._replace(method=best.method, level=float(levels[best.good])), best.error


@dataclass
class _Search:
    """The search for the loosest of some levels with which a method keeps the accuracy.

    It tries the loosest level first, which many scenes allow.  The logarithm of the error, taken to
    be linear, tells the next one; where that leaves most of the range, the middle is next.
    """

    method: str
    stepper: Stepper
    good: int  # place of the loosest level that keeps it; the finest, if none that was tried does
    too_loose: int = -1
    cost: float = np.inf  # of the runs at the good level, if that was tried
    least: float = 0.0  # cost of those at the level that is too loose
    error: float = 0.0  # at the good level, in units of the accuracy; 0 if that was not tried
    largest: float = np.inf  # error at the level that is too loose
    slow: int = 0  # trials in a row that left more than half of the range

    @property
    def is_open(self) -> bool:
        return self.good - self.too_loose > 1 and self.cost > CLOSE * self.least

    @property
    def next(self) -> int:
        """The place of the level to try."""
        if self.too_loose < 0:
            return 0
        if self.slow > MOST_SLOW or self.largest == np.inf:
            return (self.good + self.too_loose) // 2
        ahead = LEVELS_TO_HALF * np.log2(self.largest / CHOSEN)
        if self.error > 0.0:
            part = np.log(self.largest / CHOSEN) / np.log(self.largest / self.error)
            ahead = part * (self.good - self.too_loose)
        return min(max(self.too_loose + round(float(ahead)), self.too_loose + 1), self.good - 1)

    def narrow(self, error: float, evaluations: float) -> None:
        """Take in the error of the level that was tried, and what its runs took."""
        tried = self.next
        before = self.good - self.too_loose
        if error <= CHOSEN:
            self.good = tried
            self.error = error
            self.cost = self.stepper.cost * evaluations
        else:
            self.too_loose = tried
            self.largest = error
            self.least = self.stepper.cost * evaluations
        halved = 2 * (self.good - self.too_loose) <= before
        self.slow = 0 if halved else self.slow + 1


def _worth_trying(searches: list[_Search]) -> list[_Search]:
    """The searches that go on: finer levels are dearer, and one may be too dear already."""
    cheapest = min(each.cost for each in searches)
    return [each for each in searches if each.is_open and each.least < cheapest]


def _with_most_evaluations(
    runs: CheckedRuns, plan: CheckedPlan, starts: MemberStarts, counts: np.ndarray, threads: int
) -> tuple[CheckedPlan, float]:
    """The plan with the evaluations above which to check, and the largest error of others.

    Both are of a pilot, members with the `starts`, whose runs by the plan have the `counts`.
    """

    def errors(members: np.ndarray, method: str) -> np.ndarray:
        """Differences from finer runs by a method, in units of the accuracy, (members,)."""
        finer = plan._replace(method=method, level=runs.finer(plan.level))

        def excess(some: MemberStarts) -> np.ndarray:
            found = runs.fine(runs.run(finer, some)).compare(runs.run(plan, some))
            return np.asarray(found[1][0])

        pieces = starts.of_members(members).pieces(runs.piece(threads))
        return np.concatenate([np.empty(0), *in_threads(excess, pieces, threads)])

    evaluations = counts[:, EVALUATIONS]
    complete = np.flatnonzero(counts[:, CODE] == COMPLETED)
    order = complete[np.argsort(-evaluations[complete], kind="stable")]
    stop = 0
    size = BATCH
    missed = np.array([], int)
    while stop < order.size:
        batch = order[stop : stop + size]
        stop += size
        bad = batch[~(errors(batch, runs.exact) <= KEPT)]
        if not bad.size:
            break
        size = 2 * size
        missed = np.append(missed, bad)
    most = int(evaluations[order[stop]]) if stop < order.size else -1
    if missed.size:
        most = min(most, int(evaluations[missed].min()) - 1)
    others = np.sort(complete[evaluations[complete] <= most])[::OTHERS]
    # Finer runs in lanes are quicker, and other members are compared with the exact method.
    error = errors(others, plan.method).max(initial=0.0)
    return plan._replace(most_evaluations=most), float(error)
