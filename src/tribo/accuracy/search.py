"""The search for settings that keep an accuracy.

A pilot run measures the scales from which local tolerances are made; methods with equal steps need
none.  Each round then compares a fine run with two coarse ones.  The search ends when their
difference meets the request, when finer settings gain nothing, or when the scene amplifies
round-off beyond the request.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tribo.accuracy.comparison import (
    ABORTED,
    Accuracy,
    Attempt,
    error_bounds,
    measure_amplification,
    observables,
    out_of_reach,
    strictest,
)
from tribo.accuracy.estimate import excess_of_request
from tribo.accuracy.scales import (
    EPSILON,
    FLOOR,
    ToleranceScales,
    first_guess,
    tolerance_scales,
    tolerances,
    unit_step,
)
from tribo.accuracy.stop_times import StopTimes
from tribo.integrators.methods import Method
from tribo.kernels.status import Status
from tribo.run.integrate import Integration, Setting
from tribo.run.layout import Layout
from tribo.run.progress_guard import MOST_EVALUATIONS
from tribo.run.resolution import spring_frequency
from tribo.validation import InputError

# Level of the tolerances of the pilot run: three digits are enough for scales.
PILOT_LEVEL = 1e-3
# Most pilot runs.  Each finds smaller scales until they are those of the motion; where these are
# tiny, 1e-60 of the first guess, four are enough.
PILOTS = 8
# Level of the fine run relative to the coarse ones.  Their difference exceeds the error of the
# fine run by about the inverse of this.  Errors of adaptive steps differ by chance, so that two
# runs may agree: of 600 random pairs of asperites 2.3 % had errors beyond their bars at 0.3, and
# 0.3 % at 0.1.  Errors of equal steps fall smoothly.
FINE_LEVEL = 0.1
FINE_LEVEL_OF_EQUAL_STEPS = 0.3
# The longest step of a coarse run, as a fraction of the time to the next encounter.  That of a
# fine run is shorter, so that errors which tolerances do not control fall as much.
NEAR = 0.5
# The same for a run that is compared with no other.
NEAR_ALONE = 0.75
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
# a looser setting end after as much work.
LONG_RUN = 1.5e8
# The next round takes this fraction of equal steps that are too long.
SHORTER = 0.25
# Statuses of runs whose equal steps are too long.
TOO_LONG = (Status.ENCOUNTER_JUMPED, Status.NOT_FINITE, Status.NOT_CONVERGED)
# Asperites that take as long as a call of an ASE calculator: 1 ms, as measured for EMT.
CALL = 8000
# First factor by which the level is raised for a run that is compared with no other.
LOOSER = 16.0
# Most runs that try such a level.
TRIES = 8
# Largest estimate of such a run relative to the request: its difference from the finest run is
# nearly its error, and the estimate is three times that.
LOOSE_EXCESS = 1.875
# A try with more evaluations than this times the fewest so far is no cheaper; fewer is chance.
MORE = 1.05


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
    errors
        the last ones that were estimated; None if no run was compared
    """

    coarse: Setting
    fine: Setting
    level: float
    runs: tuple[Integration, ...]
    amplification: float | None
    met: bool
    errors: Errors | None = None


def fine_level(method: Method) -> float:
    """Level of a fine run relative to that of the coarse runs that it is compared with."""
    return FINE_LEVEL if method.adaptive else FINE_LEVEL_OF_EQUAL_STEPS


def setting_at(
    layout: Layout, method: Method, scales: ToleranceScales, level: float, near: float = NEAR
) -> Setting:
    """The setting whose errors are about `level` of the scales.

    Parameters
    ----------
    layout
        the scene
    method
        with tolerances if it is adaptive, else with equal steps
    scales
        of a run of the scene, or a first guess
    level
        relative error; equal steps have errors in proportion to it
    near
        the longest step of an adaptive method, as a fraction of the time to the next encounter
    """
    if method.adaptive:
        return tolerances(layout, scales, level, near)
    springs = spring_frequency(layout)
    unit = min(unit_step(layout), 1.0 / springs if springs > 0.0 else np.inf)
    return unit * level ** (1.0 / method.order)


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
    names = observables(accuracy)
    level = min(FIRST * method.first_level * strictest(accuracy), 1.0)
    runs = _run_pilot(layout, method, accuracy, level, stops, attempt)
    before, amplification, stalls, excess = np.inf, None, 0, np.inf
    errors: Errors | None = None
    for _ in range(ROUNDS):
        if _equal_steps(layout, method, fine_level(method) * level) > MOST_EVALUATIONS:
            if runs:
                break
            raise InputError(
                "accuracy",
                f"would take {method.name} more than {MOST_EVALUATIONS:.0e} steps; give a larger "
                "one, or a method that chooses its steps",
            )
        coarse, fine = _run_round(layout, method, level, stops, attempt, runs)
        if runs[-1].status in ABORTED:
            break
        can_be_too_long = not method.adaptive and _work(layout, runs[-1]) < SHORTER * LONG_RUN
        if can_be_too_long and any(run.status in TOO_LONG for run in runs[-3:]):
            level *= SHORTER**method.order
            continue
        aborted = False
        if amplification is None and strictest(accuracy) < TIGHT:
            amplification = measure_amplification(layout, attempt, coarse, runs[-3], names)
            aborted = amplification is None
        bounds, scales = error_bounds(layout, runs[-1], runs[-3:-1], amplification, accuracy)
        excess = excess_of_request(bounds, scales, accuracy)
        errors = Errors(runs[-1], amplification, bounds, excess)
        if can_be_too_long and len(runs) == 3 and excess * strictest(accuracy) > 1.0:
            level, amplification = level * SHORTER**method.order, None
            continue
        stalls = stalls + 1 if excess > STALLED * before else 0
        if excess <= 1.0 or level <= FLOOR or stalls == MOST_STALLS or aborted:
            break
        if amplification is None:
            amplification = measure_amplification(layout, attempt, coarse, runs[-3], names)
        if amplification is None or amplification * EPSILON > strictest(accuracy):
            break
        before = excess
        lower = AIM / excess if np.isfinite(excess) else LOWER**2
        level = max(level * min(LOWER, lower), FLOOR)
    found, met = fine_level(method) * level, excess <= 1.0
    return FoundSettings(coarse, fine, found, tuple(runs), amplification, met, errors)


def _equal_steps(layout: Layout, method: Method, level: float) -> float:
    """Number of equal steps of a run; 0 for a method that chooses its steps."""
    if method.adaptive:
        return 0.0
    return layout.scene.duration / (unit_step(layout) * level ** (1.0 / method.order))


def _run_pilot(
    layout: Layout,
    method: Method,
    accuracy: Accuracy,
    level: float,
    stops: StopTimes,
    attempt: Attempt,
) -> list[Integration]:
    """The pilot run of an adaptive method; none with equal steps.

    Refuses an accuracy out of reach if the fine run of the first round, at `level`, would be long.
    """
    if not method.adaptive:
        return []
    setting, pilot = _resolved(layout, method, stops.few, attempt)
    longer = (PILOT_LEVEL / (fine_level(method) * level)) ** (1.0 / method.order)
    if pilot.status != Status.COMPLETED or longer * _work(layout, pilot) < LONG_RUN:
        return [pilot]
    amplification = measure_amplification(layout, attempt, setting, pilot, observables(accuracy))
    if amplification is not None and amplification * EPSILON > strictest(accuracy):
        raise InputError(
            "accuracy",
            out_of_reach(strictest(accuracy), amplification).removeprefix("accuracy ")
            + "; name the observables that matter, or give a method and a step; tribo.ensemble "
            "averages over many starts",
        )
    return [pilot]


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


def _run_round(
    layout: Layout,
    method: Method,
    level: float,
    stops: StopTimes,
    attempt: Attempt,
    runs: list[Integration],
) -> tuple[Setting, Setting]:
    """Append two coarse runs at `level` and a fine one to `runs`; their settings."""
    scales = tolerance_scales(layout, runs[-1].samples) if runs else first_guess(layout)
    coarse = setting_at(layout, method, scales, level)
    ratio = fine_level(method)
    near = NEAR * ratio ** (1.0 / method.order)
    fine = setting_at(layout, method, scales, ratio * level, near)
    for setting, times in zip((coarse, coarse, fine), stops, strict=True):
        if not runs or runs[-1].status not in ABORTED:
            runs.append(attempt(setting, times))
    return coarse, fine


def _work(layout: Layout, run: Integration) -> float:
    """Force evaluations times asperites: a measure of cost that is the same on every machine."""
    return run.evaluations * float(
        layout.model.asperites.size + CALL * len(layout.calculator_calls)
    )


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
    if finest.status != Status.COMPLETED or _work(layout, finest) > LONG_RUN:
        return None
    scales = tolerance_scales(layout, finest.samples)
    best, fewest, level, factor, work = None, np.inf, found.level, LOOSER, 0.0
    for _ in range(TRIES):
        if work > LONG_RUN:
            break
        setting = setting_at(layout, method, scales, level, NEAR_ALONE)
        run = attempt(setting)
        work += _work(layout, run)
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
