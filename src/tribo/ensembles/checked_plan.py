"""How the members of an ensemble are run: the method, its setting, and whom to check.

The cheapest setting with which a sample agrees with finer runs is tried on a pilot.  Few members
have errors far above those of the others, and not all of them take more evaluations: the setting is
made finer until the largest error found leaves room for larger ones among all members.
Members with numbers of their own have scales of their own, which their evaluations do not show.
They are run at a level below the cheapest one, and compared with rougher runs at that.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tribo.accuracy.levels import FLOOR, tolerance_scales
from tribo.ensembles.checked_runs import FINER, KEPT, ROUGHER, SAMPLE, CheckedPlan, CheckedRuns
from tribo.ensembles.engines import in_threads
from tribo.ensembles.members import Variation
from tribo.kernels.status import CODE, COMPLETED, EVALUATIONS
from tribo.loops.batch import MemberStarts

# Levels that are tried, from the loosest, in units of the accuracy.
LEVELS = 2.0 ** np.arange(14.0, -24.0, -0.5)
# Largest difference of the sample from finer runs, in units of the accuracy: other members may have
# larger ones.
CHOSEN = 0.5
# Members of the pilot that are run in one call, so that threads share them.
PIECE = 512
# Members of the first batch: where they keep the accuracy, 1 % of all members are checked, which
# takes 4 % of the time.
BATCH = 32
# One in so many of the others is checked.
OTHERS = 4
# Their largest difference from finer runs, in units of the accuracy.  In 20,000 members of case A
# the share of differences above x fell as x^-4: of a million members, some ten are above the
# accuracy if one in a thousand is above this.
ROOM = 0.3
# Part of a level to which it is lowered at most, since errors need not be proportional to it.
LOWERED = 0.1


def checked_plan(runs: CheckedRuns, variation: Variation, count: int, threads: int) -> CheckedPlan:
    """The plan of an ensemble of `count` members; the own plan of `runs` is not used."""
    simulation = runs.simulation
    scales = tolerance_scales(simulation.layout, simulation.finest.samples)
    chosen = _cheapest(runs, variation, count, tuple(vars(scales).values()))
    if runs.own_numbers:  # each member is compared with a run at the level that is chosen
        return chosen._replace(level=max(FLOOR, chosen.level / ROUGHER))
    pilot = Pilot(runs, runs.begin(variation.sample(count, runs.pilot)), threads)
    plan, error = pilot.with_most_evaluations(chosen)
    while error > ROOM and plan.level > runs.finest:
        level = plan.level * max(LOWERED, ROOM / error)
        plan, error = pilot.with_most_evaluations(plan._replace(level=max(runs.finest, level)))
    return plan


def _cheapest(
    runs: CheckedRuns, variation: Variation, count: int, scales: tuple[float, ...]
) -> CheckedPlan:
    """The cheapest setting that keeps the accuracy of the sample."""
    starts = runs.begin(variation.sample(count, SAMPLE))
    levels = np.maximum(LEVELS * runs.strictest, runs.finest)
    exact = CheckedPlan(runs.exact, float(levels[-1]), -1, scales)
    fine = runs.run(exact, starts)
    best, least = exact._replace(level=max(FLOOR, FINER * runs.strictest)), np.inf
    for method, stepper in runs.steppers.items():
        too_loose, good = -1, levels.size - 1
        while good - too_loose > 1:
            k = (good + too_loose) // 2
            found = runs.run(exact._replace(method=method, level=float(levels[k])), starts)
            if np.all(runs.compared(fine, found)[1][fine.complete] <= CHOSEN):
                good, cost = k, stepper.cost * float(found.counts[:, EVALUATIONS].sum())
            else:
                too_loose = k
        if good < levels.size - 1 and cost < least:
            best, least = exact._replace(method=method, level=float(levels[good])), cost
    return best


class Pilot:
    """Members by which it is found whom to check."""

    def __init__(self, runs: CheckedRuns, starts: MemberStarts, threads: int) -> None:
        self._runs, self._starts, self._threads = runs, starts, threads
        self._piece = min(PIECE, runs.chunk)

    def with_most_evaluations(self, plan: CheckedPlan) -> tuple[CheckedPlan, float]:
        """The plan with the evaluations above which members are checked; -1 for all.

        Also returns the largest difference of others from finer runs, in units of the accuracy.
        """
        runs = self._runs
        counts = np.concatenate(self._each(lambda some: runs.run(plan, some).counts, self._starts))
        evaluations = counts[:, EVALUATIONS]
        complete = np.flatnonzero(counts[:, CODE] == COMPLETED)
        order = complete[np.argsort(-evaluations[complete], kind="stable")]
        stop, size, missed = 0, BATCH, np.array([], int)
        while stop < order.size:
            batch, stop = order[stop : stop + size], stop + size
            bad = batch[~(self._errors(plan, batch, runs.exact) <= KEPT)]
            if not bad.size:
                break
            size, missed = 2 * size, np.append(missed, bad)
        most = int(evaluations[order[stop]]) if stop < order.size else -1
        if missed.size:
            most = min(most, int(evaluations[missed].min()) - 1)
        others = np.sort(complete[evaluations[complete] <= most])[::OTHERS]
        # Finer runs in lanes are quicker, and other members are compared with the exact method.
        error = self._errors(plan, others, plan.method).max(initial=0.0)
        return plan._replace(most_evaluations=most), float(error)

    def _errors(self, plan: CheckedPlan, members: np.ndarray, method: str) -> np.ndarray:
        """Differences from finer runs by a method, in units of the accuracy, (members,)."""
        runs = self._runs
        finer = plan._replace(method=method, level=runs.finer(plan.level))

        def errors(some: MemberStarts) -> np.ndarray:
            return runs.compared(runs.run(finer, some), runs.run(plan, some))[1]

        return np.concatenate([np.empty(0), *self._each(errors, self._starts.of_members(members))])

    def _each(
        self, task: Callable[[MemberStarts], np.ndarray], starts: MemberStarts
    ) -> list[np.ndarray]:
        """The results for pieces of some members, in threads."""
        return list(in_threads(task, starts.pieces(self._piece), self._threads))
