"""The search for settings that keep an accuracy.

A pilot run measures the scales from which local tolerances are made; methods with equal steps need
none.  Each round then compares a fine run with two coarse ones.  The search ends when their
difference meets the request, when finer settings gain nothing, or when the scene amplifies
round-off beyond the request.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from tribo.accuracy.estimate import distance, estimate, excess_of_request, rounding
from tribo.accuracy.scales import (
    EPSILON,
    FLOOR,
    KINDS,
    Scales,
    ToleranceScales,
    first_guess,
    kind_of,
    reported_scales,
    tolerance_scales,
    tolerances,
    unit_step,
)
from tribo.integrators.methods import Method
from tribo.kernels.status import Status
from tribo.run.integrate import Integration, Setting
from tribo.run.layout import Layout
from tribo.run.ledger import Ledger, assemble
from tribo.validation import InputError

# Level of the tolerances of the pilot run: three digits are enough for scales.
PILOT_LEVEL = 1e-3
# Level of the fine run relative to the coarse ones.  Their difference exceeds the error of the
# fine run by about the inverse of this.
FINE_LEVEL = 0.3
# The longest step of a coarse run, as a fraction of the time to the next encounter.  That of a
# fine run is shorter, so that errors which tolerances do not control fall by FINE_LEVEL too.
NEAR = 0.5
# The same for a run that is compared with no other.
NEAR_ALONE = 0.75
# Rounds of lower levels, after which a request counts as out of reach.
ROUNDS = 6
# A round stalls if its estimate exceeds this fraction of the one before.
STALLED = 0.5
# Stalled rounds in a row, after which round-off is taken for the limit.
MOST_STALLS = 2
# The next level is at most this times the last one.
LOWER = 0.1
# The next level aims at this fraction of the request.
AIM = 0.3
# Requests below this measure the amplification at once, because rounding counts in their estimate.
TIGHT = 1e-9
# Change of every initial theta that measures the amplification [radian]: small against errors,
# large against round-off.
PERTURBATION = 1e-11
# Work of a long run [force evaluations x asperites], which is refused early if its request is out
# of reach: 20 s at the 0.13 us that benchmarks/calibrate.py measures for an asperite.  The tries of
# a looser setting end after as much work.
LONG_RUN = 1.5e8
# Asperites that take as long as a call of an ASE calculator: 1 ms, as measured for EMT.
CALL = 8000
# First factor by which the level is raised for a run that is compared with no other.
LOOSER = 16.0
# Most runs that try such a level.
TRIES = 8
# Largest estimate of such a run relative to the request: its difference from the finest run is
# nearly its error, and the estimate is twice that.
LOOSE_EXCESS = 1.25
# A try with more evaluations than this times the fewest so far is no cheaper; fewer is chance.
MORE = 1.05
# Statuses of runs that were ended from outside, which other settings would not change.
ABORTED = (Status.INTERRUPTED, Status.CALCULATOR_FAILED)

# Equal parts of the duration after which a fine run stops, so that its steps differ from those of
# the coarse runs even if there are few samples.
PARTS = 32
# Most inner stops of a coarse run: samples shorten steps, and each is kept.
MOST_STOPS = 256
# Stops that differ by less than this fraction of the duration are one: steps between them would be
# as short as rounding.
SAME = 1e-9

# The largest relative error of everything, or of each quantity by name.
Accuracy = float | Mapping[str, float]


class Attempt(Protocol):
    """Runs the scene with a setting."""

    def __call__(
        self, setting: Setting, times: np.ndarray, start: np.ndarray | None = None
    ) -> Integration:
        """Record at `times`, from the state `start` or else the scene's own start."""


class StopTimes(NamedTuple):
    """Times at which a fine run and two coarse ones stop, so that no two share their steps.

    Every fourth inner time of the fine run belongs to the first coarse run, and all others to the
    second: each recorded time is compared with one of them.
    """

    few: np.ndarray
    many: np.ndarray
    fine: np.ndarray

    @classmethod
    def for_samples(cls, times: np.ndarray) -> StopTimes:
        """For a run that is recorded at `times`, and also stops after each of PARTS equal parts."""
        parts = np.linspace(times[0], times[-1], PARTS + 1)
        k = np.searchsorted(times, parts).clip(1, times.size - 1)
        off = np.minimum(np.abs(parts - times[k - 1]), np.abs(parts - times[k]))
        return cls.split(np.union1d(times, parts[off > SAME * (times[-1] - times[0])]))

    @classmethod
    def split(cls, times: np.ndarray) -> StopTimes:
        """For a fine run that stops at `times`."""
        inner = times[1:-1]
        fourth = np.arange(inner.size) % 4 == 3
        few, many = (_thinned(times, inner[mine]) for mine in (fourth, ~fourth))
        return cls(few, many, times)


def _thinned(times: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """At most MOST_STOPS of the inner times, and both ends."""
    if inner.size > MOST_STOPS:
        inner = inner[np.linspace(0, inner.size - 1, MOST_STOPS).astype(int)]
    return np.concatenate([times[:1], inner, times[-1:]])


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
    """

    coarse: Setting
    fine: Setting
    level: float
    runs: tuple[Integration, ...]
    amplification: float | None
    met: bool


def strictest(accuracy: Accuracy) -> float:
    """The smallest error in an accuracy."""
    return min(accuracy.values()) if isinstance(accuracy, Mapping) else accuracy


def observables(accuracy: Accuracy) -> tuple[str, ...]:
    """The quantities that an accuracy names; none if it is for everything."""
    return tuple(accuracy) if isinstance(accuracy, Mapping) else ()


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
    return unit_step(layout) * level ** (1.0 / method.order)


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
        if the accuracy is out of reach and its runs would be long
    """
    names = observables(accuracy)
    runs: list[Integration] = []
    scales = first_guess(layout)
    level = method.first_level * strictest(accuracy)
    if method.adaptive:
        pilot = setting_at(layout, method, scales, PILOT_LEVEL)
        runs.append(attempt(pilot, stops.few))
        _refuse_early(layout, method, accuracy, attempt, pilot, runs[0], level)
    before, amplification, stalls, excess = np.inf, None, 0, np.inf
    for _ in range(ROUNDS):
        if runs:
            scales = tolerance_scales(layout, runs[-1].samples)
        coarse, fine = _coarse_and_fine(layout, method, scales, level)
        for setting, times in zip((coarse, coarse, fine), stops, strict=True):
            if not runs or runs[-1].status not in ABORTED:
                runs.append(attempt(setting, times))
        if runs[-1].status in ABORTED:
            break
        if not method.adaptive and any(run.status == Status.ENCOUNTER_JUMPED for run in runs[-3:]):
            level *= LOWER**2
            continue
        aborted = False
        if amplification is None and strictest(accuracy) < TIGHT:
            amplification = measure_amplification(layout, attempt, coarse, runs[-3], names)
            aborted = amplification is None
        bounds, reported = error_bounds(layout, runs[-1], runs[-3:-1], amplification, names)
        excess = excess_of_request(bounds, reported, accuracy)
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
    return FoundSettings(
        coarse, fine, FINE_LEVEL * level, tuple(runs), amplification, excess <= 1.0
    )


def _coarse_and_fine(
    layout: Layout, method: Method, scales: ToleranceScales, level: float
) -> tuple[Setting, Setting]:
    """Settings of the coarse runs and of the fine run of a round."""
    coarse = setting_at(layout, method, scales, level)
    near = NEAR * FINE_LEVEL ** (1.0 / method.order)
    return coarse, setting_at(layout, method, scales, FINE_LEVEL * level, near)


def _refuse_early(
    layout: Layout,
    method: Method,
    accuracy: Accuracy,
    attempt: Attempt,
    setting: Setting,
    pilot: Integration,
    level: float,
) -> None:
    """Refuse an accuracy out of reach if its runs would be long."""
    longer = (PILOT_LEVEL / (FINE_LEVEL * level)) ** (1.0 / method.order)
    if pilot.status != Status.COMPLETED or longer * _work(layout, pilot) < LONG_RUN:
        return
    amplification = measure_amplification(layout, attempt, setting, pilot, observables(accuracy))
    if amplification is not None and amplification * EPSILON > strictest(accuracy):
        raise InputError(
            "accuracy",
            out_of_reach(strictest(accuracy), amplification).removeprefix("accuracy ")
            + "; name the observables that matter, or give a method and a step; tribo.ensemble "
            "averages over many starts",
        )


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
    names = observables(accuracy)
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
            bounds, reported = error_bounds(layout, finest, [run], found.amplification, names)
            good = excess_of_request(bounds, reported, accuracy) <= LOOSE_EXCESS
        if not good:
            level, factor = level / factor, factor**0.5
        elif run.evaluations < fewest:
            best, fewest = setting, run.evaluations
        level *= factor
    return best


def error_bounds(
    layout: Layout,
    fine: Integration,
    coarser: Sequence[Integration],
    amplification: float | None,
    names: Iterable[str] = (),
) -> tuple[dict[str, float], Scales]:
    """Bounds on the errors of a run.

    Parameters
    ----------
    layout
        the scene
    fine
        the run
    coarser
        runs that it is compared with; if one stopped early, all bounds are infinite
    amplification
        of a small change of the start; None where it was not measured
    names
        of further quantities, as "upper.W"

    Returns
    -------
    bounds : dict
        by quantity, in its own unit
    scales : Scales
        which errors are relative to

    Raises
    ------
    InputError
        if the scene does not report a quantity in `names`
    """
    names = tuple(names)
    own = assemble(layout, fine.samples)
    for name in names:
        if not own.series(name):
            raise InputError(f"accuracy.{name}", "is not a quantity that this scene reports")
    compared = (_at_shared_times(layout, own, fine, coarse) for coarse in coarser)
    scales = reported_scales(layout, own)
    rough, rounded = np.isfinite(layout.scene.smoothness), rounding(amplification, fine.steps)
    bounds = estimate(own, compared, scales, bool(rough), rounded, names)
    if any(run.status != Status.COMPLETED for run in coarser):
        bounds = dict.fromkeys(bounds, np.inf)
    return bounds, scales


def _at_shared_times(
    layout: Layout, own: Ledger, one: Integration, other: Integration
) -> tuple[Ledger, Ledger]:
    """The ledgers of two runs at the times that both recorded; `own` is that of the first."""
    shared = other.samples.at(one.samples.t)
    return own.rows(np.isin(one.samples.t, shared.t)), assemble(layout, shared)


def measure_amplification(
    layout: Layout,
    attempt: Attempt,
    setting: Setting,
    run: Integration,
    names: tuple[str, ...] = (),
) -> float | None:
    """The growth of a small change of the start.

    Parameters
    ----------
    layout
        the scene
    attempt
        runs it with a setting, through times, from a start
    setting, run
        of the scene's own start
    names
        of the quantities that matter; by default all that have a scale

    Returns
    -------
    float or None
        the largest difference of the two runs relative to the scales, over PERTURBATION; None if
        the second run was aborted
    """
    start = layout.start.copy()
    start[: layout.model.asperites.size] += PERTURBATION
    other = attempt(setting, run.samples.t, start)
    if other.status in ABORTED:
        return None
    own = assemble(layout, run.samples)
    scales = reported_scales(layout, own)
    scaled = [name for name in names or KINDS if scales.of(kind_of(name)) > 0.0]
    return distance(*_at_shared_times(layout, own, run, other), scales, scaled) / PERTURBATION


def out_of_reach(accuracy: float, amplification: float) -> str:
    """The reason why an accuracy cannot be kept."""
    reason = ""
    if amplification * EPSILON < accuracy:
        reason = "finer settings gain too little, though "
    return (
        f"accuracy {accuracy:.1e} is out of reach: {reason}a change of {PERTURBATION:.0e} in the "
        f"start grows to {amplification * PERTURBATION:.1e} of the scale, and round-off of "
        f"{EPSILON:.1e} with it to about {amplification * EPSILON:.1e}"
    )
