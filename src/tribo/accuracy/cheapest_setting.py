"""The cheapest setting for runs that are compared with no other."""

from __future__ import annotations

import numpy as np

from tribo.accuracy.comparison import error_bounds
from tribo.accuracy.decision import LONG_RUN
from tribo.accuracy.levels import setting_at, work
from tribo.accuracy.plan import Plan
from tribo.accuracy.tolerance_scales import tolerance_scales
from tribo.kernels.status import Status
from tribo.loops.integrate import Setting
from tribo.loops.select import Integrator

# The longest step of a run that is compared with no other, as a fraction of the time to the next
# encounter.
NEAR_ALONE = 0.75
# First factor by which the level is raised for a run that is compared with no other.
LOOSER = 16.0
# Most runs that try such a level.
TRIES = 8
# Largest estimate of such a run relative to the request: its difference from the finest run is
# nearly its error, and the estimate is three times that.
LOOSE_EXCESS = 1.875
# A try with more evaluations than this times the fewest so far is no cheaper; fewer is chance.
MORE = 1.05


def single_setting(plan: Plan, integrator: Integrator) -> Setting | None:
    """The cheapest setting whose run agrees with the finest one within the plan's accuracy.

    It is for runs that are compared with no other: these need not differ in their steps from any,
    and stop at samples only.  None if no try agrees, or if the finest run is long.
    """
    layout, found = integrator.layout, plan.tuned
    if plan.single is not None or found is None or not found.runs:
        return plan.single
    assert plan.accuracy is not None
    finest, grown = found.runs[-1], found.amplification
    if finest.status != Status.COMPLETED or work(layout, finest) > LONG_RUN:
        return None
    scales = tolerance_scales(layout, finest.samples)
    best, fewest, level, factor, spent = None, np.inf, found.level, LOOSER, 0.0
    for _ in range(TRIES):
        if spent > LONG_RUN:
            break
        setting = setting_at(layout, integrator.method, scales, level, NEAR_ALONE)
        run = integrator(setting, layout.times)
        spent += work(layout, run)
        if run.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        good = run.status == Status.COMPLETED and run.evaluations <= MORE * fewest
        if good:
            errors = error_bounds(layout, finest, [run], grown, plan.accuracy)
            good = errors.excess <= LOOSE_EXCESS
        if not good:
            level, factor = level / factor, factor**0.5
        elif run.evaluations < fewest:
            best, fewest = setting, run.evaluations
        level *= factor
    return best
