"""How the members of an ensemble are run: the method, its setting, and whom to check.

The method and its setting are the cheapest of those with which the members of a sample agree with
finer runs, in the quantities that are kept.  Methods are that of single runs and, of a pair whose
ledger follows from the motion by conservation of energy, explicit ones with members in lanes.

Members of a pilot are then checked in the order of their evaluations, from the most on, batch by
batch, until a batch has none that misses its accuracy.  Members that take more evaluations than the
rest of the pilot are checked in the whole ensemble.

Members with numbers of their own have scales of their own, which their evaluations do not show.
They are run at a level below the cheapest one, and compared with rougher runs at that.
"""

from __future__ import annotations

import numpy as np

from tribo.accuracy.tolerance_scales import FLOOR, tolerance_scales
from tribo.ensembles.checked_runs import (
    FINER,
    KEPT,
    ROUGHER,
    SAMPLE,
    Begun,
    CheckedPlan,
    CheckedRuns,
)
from tribo.ensembles.engines import in_threads
from tribo.ensembles.members import Variation
from tribo.kernels.status import COMPLETED
from tribo.pair.members import CODE, EVALUATIONS

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


def checked_plan(runs: CheckedRuns, variation: Variation, count: int, threads: int) -> CheckedPlan:
    """The plan of an ensemble of `count` members.

    Parameters
    ----------
    runs : CheckedRuns
        Runs members; its own plan is not used.
    variation : Variation
        The differences between members.
    count : int
        Of members.
    threads : int
        That run members of the pilot.
    """
    simulation = runs.simulation
    scales = tolerance_scales(simulation.layout, simulation.finest.samples)
    chosen = _cheapest(runs, variation, count, tuple(vars(scales).values()))
    if runs.own_numbers:  # each member is compared with a run at the level that is chosen
        return chosen._replace(level=max(FLOOR, chosen.level / ROUGHER))
    return chosen._replace(most_evaluations=_most(runs, variation, count, threads, chosen))


def _cheapest(
    runs: CheckedRuns, variation: Variation, count: int, scales: tuple[float, ...]
) -> CheckedPlan:
    """The cheapest setting that keeps the accuracy of the sample."""
    begun = runs.begin(variation.sample(count, SAMPLE))
    levels = np.maximum(LEVELS * runs.strictest, runs.finest)
    fine = runs.run(runs.exact, levels[-1], scales, begun)
    known = fine.counts[:, CODE] == COMPLETED
    best, least = CheckedPlan(runs.exact, max(FLOOR, FINER * runs.strictest), -1, scales), np.inf
    for method, way in runs.ways.items():
        too_loose, good = -1, levels.size - 1
        while good - too_loose > 1:
            k = (good + too_loose) // 2
            found = runs.run(method, levels[k], scales, begun)
            if np.all(runs.excess(fine, found)[known] <= CHOSEN):
                good, cost = k, way.cost * float(found.counts[:, EVALUATIONS].sum())
            else:
                too_loose = k
        if good < levels.size - 1 and cost < least:
            best, least = CheckedPlan(method, float(levels[good]), -1, scales), cost
    return best


def _most(
    runs: CheckedRuns, variation: Variation, count: int, threads: int, plan: CheckedPlan
) -> int:
    """The evaluations above which members are checked; -1 for all."""
    begun, piece = runs.begin(variation.sample(count, runs.pilot)), min(PIECE, runs.chunk)

    def counts_from(some: Begun) -> np.ndarray:
        return runs.run(plan.method, plan.level, plan.scales, some).counts

    counts = np.concatenate(list(in_threads(counts_from, begun.pieces(piece), threads)))
    evaluations = counts[:, EVALUATIONS]
    complete = np.flatnonzero(counts[:, CODE] == COMPLETED)
    order = complete[np.argsort(-evaluations[complete], kind="stable")]
    stop, size, missed = 0, BATCH, np.array([], int)
    while stop < order.size:
        batch, stop = order[stop : stop + size], stop + size
        bad = batch[_misses(runs, plan, begun.of_members(batch), piece)]
        if not bad.size:
            break
        size, missed = 2 * size, np.append(missed, bad)
    rest = int(evaluations[order[stop]]) if stop < order.size else -1
    return min(rest, int(evaluations[missed].min()) - 1) if missed.size else rest


def _misses(runs: CheckedRuns, plan: CheckedPlan, begun: Begun, piece: int) -> np.ndarray:
    """Which members miss the accuracy by the plan, (members,)."""
    found = []
    for some in begun.pieces(piece):
        coarse = runs.run(plan.method, plan.level, plan.scales, some)
        fine = runs.run(runs.exact, runs.finer(plan.level), plan.scales, some)
        found.append(~(runs.excess(fine, coarse) <= KEPT))
    return np.concatenate(found)
