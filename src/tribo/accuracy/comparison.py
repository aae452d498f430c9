"""Runs compared with one another: bounds on errors, and the amplification of small changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from tribo.accuracy.estimate import DIVERGED, DIVERGED_IN_CHAOS, distance, estimate, rounding
from tribo.accuracy.extremes import extremes
from tribo.accuracy.scales import (
    EPSILON,
    KINDS,
    Scales,
    kind_of,
    reported_scales,
    scales_of,
)
from tribo.kernels.status import Status
from tribo.layout.layout import Layout
from tribo.ledger.ledger import assemble
from tribo.loops.integrate import Integration, Setting

# Smallest estimate, in units of the request.  Where a run happens to be far more accurate than its
# tolerances, because encounters or samples limit its steps, it differs from the coarser runs by
# chance: without this, of 600 random pairs of asperites three had errors above their estimates, of
# 1e-8, 3e-5 and 2e-4 of the request.
LEAST = 1e-3
# Change of every initial theta [radian], and of every omega in units of the largest rate, that
# measures the amplification: small enough to grow linearly, large against round-off.  Rates are
# rounded most where they are large, as in a close pass.
PERTURBATION = 1e-11
# The same where the former grows to DIVERGED, which hides how much smaller ones grow: some hundred
# roundings.  The growth of one rounding of the start, which all runs share, follows from it.
TINY_PERTURBATION = 1e-13
# Energies that follow from the state and may be far larger than all works, so that they change with
# any angle and rate; their own rounding is known.
ENERGIES = {
    *("contact_energy", "total_energy_change", "delta_E_int", "delta_K"),
    *("delta_e_int", "delta_k_trans", "swing_energy"),
}
# Statuses of runs that were ended from outside, which other settings would not change.
FROM_OUTSIDE = (Status.INTERRUPTED, Status.CALCULATOR_FAILED)
# Statuses of runs after which no other is tried: finer settings would take longer still.
ABORTED = (*FROM_OUTSIDE, Status.NO_PROGRESS)

# The largest relative error of everything, or of each quantity by name.
Accuracy = float | Mapping[str, float]


class Attempt(Protocol):
    """Runs the scene with a setting."""

    def __call__(
        self,
        setting: Setting,
        times: np.ndarray,
        start: np.ndarray | None = None,
        *,
        most: float | None = None,
        rounded: bool = False,
    ) -> Integration:
        """Record at `times`, from the state `start` or else the scene's own start.

        With `most` force evaluations, or those of the scene without it; `rounded` with other
        roundings of the bobs' places.
        """


def strictest(accuracy: Accuracy) -> float:
    """The smallest error in an accuracy."""
    return min(accuracy.values()) if isinstance(accuracy, Mapping) else accuracy


def observables(accuracy: Accuracy) -> tuple[str, ...]:
    """The quantities that an accuracy names; none if it is for everything."""
    return tuple(accuracy) if isinstance(accuracy, Mapping) else ()


def error_bounds(
    layout: Layout,
    fine: Integration,
    coarser: Sequence[Integration],
    amplification: float | None,
    accuracy: Accuracy | None = None,
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
    accuracy
        that the run was made for; it may name further quantities, as "upper.W"

    Returns
    -------
    bounds : dict
        by quantity, in its own unit
    scales : Scales
        which errors are relative to
    """
    names: tuple[str, ...] = ()
    wanted = 0.0
    if accuracy is not None:
        names, wanted = observables(accuracy), strictest(accuracy)
    found = extremes(layout, fine, coarser, names)
    tops = dict(zip(found.names, found.tops.tolist(), strict=True))
    scales = scales_of(layout, tops, found.speed, found.internal)
    rough, rounded = np.isfinite(layout.scene.smoothness), rounding(amplification, fine.steps)
    least = rounded + LEAST * wanted
    chaotic = amplification is not None and amplification * PERTURBATION >= DIVERGED
    limit = DIVERGED_IN_CHAOS if chaotic else DIVERGED
    bounds = estimate(
        found.names, found.tops, found.gaps, scales, bool(rough), least, found.terms, limit
    )
    if any(other.status != Status.COMPLETED for other in coarser):
        bounds = dict.fromkeys(bounds, np.inf)
    return bounds, scales


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
        of the quantities that matter; by default all that have a scale, but ENERGIES

    Returns
    -------
    float or None
        the largest difference of the two runs relative to the scales, over the change; None if the
        second run was ended from outside
    """
    own = assemble(layout, run.samples)
    scales = reported_scales(layout, own)
    chosen = names or [name for name in KINDS if name not in ENERGIES]
    scaled = [name for name in chosen if scales.of(kind_of(name)) > 0.0]
    grown = 0.0
    for change in (PERTURBATION, TINY_PERTURBATION):
        start, asperites = layout.start.copy(), layout.asperites.size
        start[:asperites] += change
        start[layout.coordinates :][:asperites] += change * scales.rate
        other = attempt(setting, run.samples.t, start)
        if other.status in FROM_OUTSIDE:
            return None
        shared = other.samples.at(run.samples.t)
        mine = own.rows(np.searchsorted(run.samples.t, shared.t))
        grown = distance(mine, assemble(layout, shared), scales, scaled)
        if other.status != run.status:  # one has stopped where the other goes on
            grown = max(grown, 1.0)
        if grown < DIVERGED:
            break
    return grown / change


def out_of_reach(accuracy: float, amplification: float) -> str:
    """The reason why an accuracy cannot be kept."""
    reason = ""
    if amplification * EPSILON < accuracy:
        reason = "finer settings gain too little, though "
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
