"""The cheapest setting for runs that are compared with no other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tribo.accuracy.comparison import Accuracy, error_bounds
from tribo.accuracy.decision import LONG_RUN
from tribo.accuracy.estimate import excess_of_request
from tribo.accuracy.found_settings import FoundSettings
from tribo.accuracy.levels import setting_at, work
from tribo.accuracy.tolerance_scales import tolerance_scales
from tribo.integrators.methods import Method
from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.loops.integrate import Integration, Setting

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


def cheapest_setting(
    layout: Layout,
    method: Method,
    found: FoundSettings,
    accuracy: Accuracy,
    attempt: Callable[[Setting], Integration],
) -> Setting | None:
    """The cheapest setting whose run agrees with the finest one within `accuracy`.

    It is for runs that are compared with no other: these need not differ in their steps from any,
    and stop at samples only.

    Parameters
    ----------
    layout, method, accuracy
        as for `find_settings`
    found
        by `find_settings`
    attempt
        runs the scene with a setting, recorded at the scene's times

    Returns
    -------
    Setting or None
        None if no try agrees, or if the finest run is long
    """
    finest = found.runs[-1]
    if finest.status != Status.COMPLETED or work(layout, finest) > LONG_RUN:
        return None
    scales = tolerance_scales(layout, finest.samples)
    best, fewest, level, factor, spent = None, np.inf, found.level, LOOSER, 0.0
    for _ in range(TRIES):
        if spent > LONG_RUN:
            break
        setting = setting_at(layout, method, scales, level, NEAR_ALONE)
        run = attempt(setting)
        spent += work(layout, run)
        if run.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        good = run.status == Status.COMPLETED and run.evaluations <= MORE * fewest
        if good:
            bounds, reported = error_bounds(layout, finest, [run], found.amplification, accuracy)
            good = excess_of_request(bounds, reported, accuracy) <= LOOSE_EXCESS
        if not good:
            level, factor = level / factor, factor**0.5
        elif run.evaluations < fewest:
            best, fewest = setting, run.evaluations
        level *= factor
    return best
