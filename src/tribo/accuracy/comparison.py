"""Runs compared with one another: bounds on errors, and the amplification of small changes.

The bound of every quantity is three times the largest difference of a run from two coarser ones.
One coarse run may agree with the fine run by chance; two with independent steps, compared at every
recorded time, almost never do.  The difference is never divided by 2^p - 1, and neither the
tolerance nor the closure of the ledger serves as an estimate: each of these can be wrong by orders
of magnitude.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from tribo.accuracy.extremes import Extremes, extremes
from tribo.accuracy.roundoff import WALK
from tribo.accuracy.scales import (
    COMMON,
    EPSILON,
    ROLES,
    Scales,
    Values,
    are_common,
    are_lost,
    largest,
    reported_scales,
    scale_of,
    scales_of,
)
from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.ledger.ledger import Ledger, assemble
from tribo.ledger.quantities import QUANTITIES
from tribo.ledger.reported import needs_accounts
from tribo.ledger.samples import Samples
from tribo.loops.integrate import Integration
from tribo.loops.setting import Setting
from tribo.validation import InputError

# An estimate is this times the largest difference from the coarser runs.  At 2, six of 320 random
# pairs of asperites had errors above their estimates, of which four by 1.2 to 1.5 times.
SAFETY = 3.0
# Its factor where errors fall irregularly with the step: a derivative of a potential jumps, or
# tolerances are below the rounding of forces, so that finer runs gain little.  Without it, one of
# 1000 random scenes had an error of 1.1 times its estimate there.
ROUGH = 2.0
# Fraction of the largest estimate, in scales, that each contains: one quantity may agree by chance.
POOLED = 0.02
# Largest estimate, in units of the scales, from which runs count as diverged.
DIVERGED = 0.1
# The same where a small change of the start grows by CHAOTIC or more: errors of all runs are of
# one size, and differ by less.  One of 138 random scenes had an error of 1.2 times its estimate of
# 0.08.
DIVERGED_IN_CHAOS = 0.01
# Three runs that began in a deep core shared most of their error of the first steps, 1e-7 of the
# scale.  It grew by 1e6 to half the scale, where they differed by 0.008 of it.
CHAOTIC = 1e4
# Bound in diverged runs, in units of the scales: of two values, which may be close by chance.
UNRELATED = 2.0
# Errors that all runs share, in units of the scale: rounding, first steps and iterations.
ROUNDED = 256.0 * EPSILON
# Smallest estimate, in units of the request.  A run that is far more accurate than its tolerances,
# by encounters or samples, differs from the coarser runs by chance: without this, three of 600
# random pairs of asperites had errors above their estimates, of 1e-8, 3e-5 and 2e-4 of the request.
LEAST = 1e-3
# Change of every initial theta [rad], and of omega in units of the largest rate, that measures the
# amplification: it grows linearly, and exceeds round-off, which is largest where rates are.
PERTURBATION = 1e-11
# The same where the former grows to DIVERGED, which hides how much smaller ones grow: some hundred
# roundings.  The growth of one rounding of the start, which all runs share, follows from it.
TINY_PERTURBATION = 1e-13
# A growth that is also measured by larger changes, of which the first counts that does not grow to
# DIVERGED: runs whose steps differ by chance are apart by a part of their errors, however small the
# change is.  Over 4e6 radians of a free pendulum that was 1.7e-3, taken for a growth by 1.7e8.
LARGE_GROWTH = 1e6
LARGE_PERTURBATIONS = 1e-4, 1e-7
# Energies that follow from the state, and change with any angle and rate; their rounding is known.
ENERGIES = {
    name
    for name, quantity in QUANTITIES.items()
    if quantity.kind == "energy" and not needs_accounts(name)
}
# Statuses of runs that were ended from outside, which other settings would not change.
FROM_OUTSIDE = (Status.INTERRUPTED, Status.CALCULATOR_FAILED)
# Statuses of runs after which no other is tried: finer settings would take longer still.
ABORTED = (*FROM_OUTSIDE, Status.NO_PROGRESS)
# What each note on works below the rounding of energies contains.
LOST = "below the rounding of the energies"

# The largest relative error of everything, or of each quantity by name.
Accuracy = float | Mapping[str, float]
# An Integrator, or what calls it: takes a setting, times, and a start if not the scene's own.
Attempt = Callable[..., Integration]


class Errors(NamedTuple):
    """Bounds on the errors of a run."""

    amplification: float | None  # of small changes, as far as it was known
    bounds: dict[str, float]  # by quantity, in its own unit
    scales: Scales  # which errors are relative to
    excess: float  # the largest bound in units of the accuracy


def strictest(accuracy: Accuracy) -> float:
    return accuracy if isinstance(accuracy, float) else min(accuracy.values())


def observables(accuracy: Accuracy) -> tuple[str, ...]:
    """The quantities that an accuracy names; none if it is for everything."""
    return () if isinstance(accuracy, float) else tuple(accuracy)


def check_observables(layout: Layout, names: Iterable[str], field: str = "accuracy") -> None:
    """Refuse names of quantities that the scene does not report.  Raises InputError."""
    reported = assemble(layout, Samples.at_zero(layout))
    for name in names:
        if needs_accounts(str(name).rpartition(".")[2]) and layout.model.ledger is None:
            raise InputError(
                f"{field}.{name}", 'is not kept; works need another output.ledger, as "asperites"'
            )
        if str(name).rpartition(".")[2] not in ROLES or not reported.series(str(name)):
            raise InputError(
                f"{field}.{name}",
                'is not a reported quantity; give one, as "w1", or one of a surface, as '
                f'"{next(iter(layout.parts))}.W"',
            )


def distance(one: Ledger, other: Ledger, scales: Scales, names: Iterable[str] = ()) -> float:
    """The largest difference of two runs, in units of the scales, of some quantities or of all."""
    worst = 0.0
    for name in names or COMMON:
        for mine, theirs in zip(one.series(name), other.series(name), strict=True):
            worst = max(worst, scales.relative(name, largest(mine - theirs)))
    return worst


def safety(rough: bool) -> float:
    """The factor from the difference of two runs to an estimate; larger for `rough` forces."""
    return SAFETY * ROUGH if rough else SAFETY


def rounding(amplification: float | None, steps: int) -> float:
    """The effect of rounding in units of a scale: that of each step, and its growth if measured."""
    return ROUNDED + WALK * EPSILON * (amplification or 0.0) * steps**0.5


def error_bounds(
    layout: Layout,
    fine: Integration,
    coarser: Sequence[Integration],
    amplification: float | None,
    accuracy: Accuracy,
    rough: bool = False,
) -> Errors:
    """Bounds on the errors of a run by its differences from others; infinite if one stopped.

    Errors of a `rough` run fall irregularly with the step, also if the scene's forces are smooth.
    """
    found = extremes(layout, fine, coarser, observables(accuracy))
    motion = float(found.speed), float(found.internal), float(found.path)
    scales = scales_of(layout, found.names, found.tops, *motion)
    rough = rough or bool(np.isfinite(layout.scene.smoothness))
    # The rounding of the start, which all runs share, is relative to its angles.
    grown = (amplification or 0.0) * max(1.0, largest(layout.start[: layout.asperites.size]))
    least = rounding(grown, fine.steps) + LEAST * strictest(accuracy)
    chaotic = amplification is not None and amplification >= CHAOTIC
    limit = DIVERGED_IN_CHAOS if chaotic else DIVERGED
    bounds = estimate(found, scales, rough, least, limit)
    if any(other.status != Status.COMPLETED for other in coarser):
        bounds = dict.fromkeys(bounds, np.inf)
    return Errors(amplification, bounds, scales, excess_of_request(bounds, scales, accuracy))


def estimate(
    found: Extremes, scales: Scales, rough: bool, least: float, diverged: float = DIVERGED
) -> dict[str, float]:
    """A bound on the error of each reported quantity, over asperites and recorded times.

    In units of the scales, `least` is the effect on the motion of rounding, which may be the same
    in all runs, and of chance.  From a difference of `diverged` or an estimate of DIVERGED on, runs
    count as diverged.
    """
    factor = safety(rough)
    tops = found.tops
    rounded = found.terms
    gaps = factor * found.gaps
    scale = scales.each(found.names)
    with np.errstate(invalid="ignore"):  # an infinite energy has no known error
        # The part of a difference that is no rounding; 0 if unknown.
        beyond = np.where(np.isfinite(gaps), np.maximum(gaps - factor * rounded, 0.0), 0.0)
    # A quantity with a scale of its own changes no bound of another.
    has_scale = (scale > 0.0) & are_common(found.names)
    relative = float(np.maximum.reduce(beyond[has_scale] / scale[has_scale], initial=0.0))
    apart = relative > diverged or relative + least > DIVERGED
    pooled = max(relative, UNRELATED) if apart else POOLED * relative
    bounds = gaps + 4.0 * EPSILON * tops + rounded
    # Equal bits in all runs, as of the energy of a first contact, are known to one rounding.
    same = np.where((gaps == 0.0) & (tops > 0.0), EPSILON, 0.0)
    bounds += np.where(gaps > 0.0, pooled + least, same) * scale
    return dict(zip(found.names, bounds.tolist(), strict=True))


def excess_of_request(bounds: Mapping[str, float], scales: Scales, accuracy: Accuracy) -> float:
    """The largest estimate in units of the accuracy; at most 1 where the accuracy is kept."""
    if isinstance(accuracy, Mapping):
        names = tuple(accuracy)
        unit = scales.each(names) * list(accuracy.values())
    else:
        names = tuple(bounds)
        unit = scales.each(names) * accuracy
    bound = np.array([bounds[name] for name in names])
    known = (unit > 0.0) & np.isfinite(bound)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(known, bound / unit, np.inf)
    # An estimate that is NaN is not known either.
    return float(np.maximum.reduce(np.where(bound <= 0.0, 0.0, relative), initial=0.0))


def measure_amplification(
    layout: Layout,
    attempt: Attempt,
    setting: Setting,
    run: Integration,
    names: tuple[str, ...] = (),
) -> float | None:
    """The largest growth of a small change of the start; None if a run was ended from outside."""
    own = assemble(layout, run.samples)
    scales = reported_scales(layout, own)
    chosen = names or [name for name in COMMON if name not in ENERGIES]
    scaled = [name for name in chosen if scales.of(name) > 0.0]

    def grown(change: float) -> float | None:
        """The distance of runs whose starts differ by a change, in scales; None as above."""
        start = layout.start.copy()
        asperites = layout.asperites.size
        start[:asperites] += change
        start[layout.coordinates :][:asperites] += change * scales.rate
        other = attempt(setting, run.samples.t, start)
        if other.status in FROM_OUTSIDE:
            return None
        shared = other.samples.at(run.samples.t)
        mine = own.rows(np.searchsorted(run.samples.t, shared.t))
        apart = distance(mine, assemble(layout, shared), scales, scaled)
        # One may have stopped where the other goes on.
        return apart if other.status == run.status else max(apart, 1.0)

    apart = grown(PERTURBATION)
    if apart is None:
        return None
    if apart >= DIVERGED:
        apart = grown(TINY_PERTURBATION)
        return None if apart is None else apart / TINY_PERTURBATION
    growth = apart / PERTURBATION
    for change in LARGE_PERTURBATIONS if growth >= LARGE_GROWTH else ():
        farther = grown(change)
        if farther is None:
            return None
        if farther < DIVERGED:
            return min(growth, farther / change)
    return growth


def out_of_reach(accuracy: float, amplification: float) -> str:
    """The reason why an accuracy cannot be kept."""
    is_above = amplification * EPSILON < accuracy  # round-off
    reason = "finer settings gain too little, though " if is_above else ""
    return (
        f"accuracy {accuracy:.1e} is out of reach: {reason}{growth(amplification)}, and round-off "
        f"of {EPSILON:.1e} with it to about {amplification * EPSILON:.1e}"
    )


def growth(amplification: float) -> str:
    """How much a small change of the start grows, in words."""
    chaotic = amplification * PERTURBATION >= DIVERGED
    change = TINY_PERTURBATION if chaotic else PERTURBATION
    return (
        f"a change of {change:.0e} in the start grows to {amplification * change:.1e} of the scale"
    )


def weak_notes(work: Values, energy: Values, accuracy: Accuracy) -> list[str]:
    """A note for each run whose errors of works are relative to energies of the motion; else ""."""
    work = np.array(work, ndmin=1)
    energy = np.array(energy, ndmin=1)
    asked = [scale_of(name) for name in observables(accuracy)]
    if asked and not {"energy", "total"} & set(asked):
        return [""] * work.size
    lost = (work > 0.0) & are_lost(work, energy)
    return [
        f"no work exceeds {w:.1e}, {LOST} of {e:.1e} that it changes: errors are relative to "
        "these, and works and changes of energies have no digit that is known"
        if weak
        else ""
        for w, e, weak in zip(work, energy, lost, strict=True)
    ]
