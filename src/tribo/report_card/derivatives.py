"""Force and minimum compared with derivatives of the energy, whose uncertainty is estimated."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from scipy import differentiate

from tribo.accuracy.scales import EPSILON
from tribo.report_card.card import Check
from tribo.report_card.figure import Curves
from tribo.report_card.scan import PotentialScan

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# Largest acceptable |F + dU/dr|, relative to the scale of the force.
BOUND = 1e-10
# Factor by which the bound must exceed the uncertainty of dU/dr where the two are compared.
TRUSTED = 10.0
# Least fraction of the distances at which force and derivative must be compared.
KNOWN = 0.9
# Relative difference up to which ratios of force and derivative are one factor.
PROPORTIONAL = 1e-8
# Advice where no class defines a force.
DERIVED = (
    "the force is derived from energy(), which loses digits or has jumps there: write energy() "
    "in another form, or define force()"
)
# Largest distance from r at which the energy is evaluated [r].
REACH = 0.1
# Largest distance from r at which the energy is evaluated, if r is long [typical distance].
LONGEST = 0.8
# Distances at which differences begin [reach].
SHORTER = (1.0, 1.0 / 16.0, 1.0 / 256.0, 1.0 / 4096.0)
# Relative error of a derivative by SciPy's coefficients, which are rounded to double precision:
# up to 3.5e-15 was measured for r^-12, exp(-5 r) and the Lennard-Jones energy.
WEIGHTS = 4e-15
# Largest acceptable relative error of a declared minimum.
MINIMUM = 1e-9

Function = Callable[[np.ndarray], np.ndarray]  # of distances


def derivative(function: Function, r: ArrayLike, reach: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Derivative of a function of one distance, in extended precision, and its uncertainty.

    SciPy starts with differences over `reach` and halves them until its estimates agree.  A spline
    or the end of a table within that distance spoils the first differences, so shorter ones are
    tried too, and the estimate with the least uncertainty counts.  The uncertainty includes the
    round-off of energies in double precision, as functions of ``math`` have it.
    """
    place, length = np.broadcast_arrays(
        np.asarray(r, np.longdouble), np.asarray(reach, np.longdouble)
    )
    best = np.full(place.shape, np.nan)
    uncertainty = np.full(place.shape, np.inf)
    for shorter in SHORTER:
        found = differentiate.derivative(
            function,
            place,
            initial_step=length * shorter,
            maxiter=12,  # differences, each over half the distance of the one before
            tolerances={"atol": 0.0, "rtol": 1e-13},  # of two successive estimates
        )
        shortest = length * shorter * 0.5 ** (found.nit - 1.0)
        round_off = EPSILON * np.abs(function(place)) / shortest
        doubt = np.float64(found.error + WEIGHTS * np.abs(found.df) + round_off)
        better = doubt < uncertainty
        best = np.where(better, np.float64(found.df), best)
        uncertainty = np.where(better, doubt, uncertainty)
    return best, uncertainty


def reach_of(scan: PotentialScan, r: np.ndarray) -> np.ndarray:
    """How far from r energies are evaluated for a derivative: not beyond the cutoff [length]."""
    end = scan.cutoff
    reach = np.minimum(REACH * r, LONGEST * scan.length)
    return np.where(r < end, np.minimum(reach, 0.9 * np.abs(end - r)), reach)


def curves(scan: PotentialScan) -> Curves:
    """Energy, force, and |F + dU/dr| with the uncertainty of dU/dr."""
    r = np.sort(np.concatenate([scan.r, scan.random]))
    energy, force = scan.compiled(r)
    reach = reach_of(scan, r)
    with np.errstate(all="ignore"):
        slope, uncertainty = derivative(scan.python_energies, r, reach)
        scale = scan.scale(r)
        return Curves(
            r=r,
            energy=energy,
            force=force,
            slope=slope,
            disagreement=np.abs(force + slope) / scale,
            uncertainty=uncertainty / scale,
            bound=BOUND,
            cutoff=scan.cutoff,
            length=scan.length,
        )


def check_force(found: Curves, derived: bool = False) -> Check:
    """Check that the force is -dU/dr where the uncertainty of dU/dr permits it.

    If the force is `derived` from the energy, a failure is no mistake in a class's own force().
    """
    inside = found.r < found.cutoff
    known = inside & (TRUSTED * found.uncertainty <= BOUND)
    share = float(np.count_nonzero(known)) / max(1, int(np.count_nonzero(inside)))
    errors = np.where(known & np.isfinite(found.disagreement), found.disagreement, 0.0)
    best = float(np.median(found.uncertainty[known])) if known.any() else math.inf
    text = f"force and -dU/dr, whose uncertainty is {best:.1e}, at {found.r.size} distances"
    note = "" if share >= KNOWN else f"dU/dr is known at only {share:.0%} of the distances"
    line = replace(
        Check.of_worst("force", text, errors, BOUND, found.r),
        note=note,
        failed=bool(note),
        remedy=DERIVED if derived else "",
    )
    return line if line.passed or note else replace(line, note=_proportion(found, known))


def _proportion(found: Curves, known: np.ndarray) -> str:
    """What to say of a force that is a multiple of -dU/dr at all distances; empty if it is not."""
    known = known & (np.abs(found.slope) > 0.0) & np.isfinite(found.force)
    with np.errstate(all="ignore"):
        ratios = -found.force[known] / found.slope[known]
    factor = float(np.median(ratios)) if ratios.size else math.nan
    alike = np.count_nonzero(np.abs(ratios - factor) <= PROPORTIONAL * abs(factor))
    if not alike >= KNOWN * ratios.size > 0:
        return ""
    if abs(factor - 1.0) <= PROPORTIONAL:  # it fails at few distances, or by little
        return ""
    if abs(factor + 1.0) <= PROPORTIONAL:
        return "the force has the wrong sign: it is dU/dr instead of -dU/dr"
    return f"the force is {factor:.9g} times -dU/dr"


def check_minimum(scan: PotentialScan) -> list[Check]:
    """Check distance, depth and curvature of the minimum, if the potential declares them."""
    if not hasattr(scan.potential, "minimum"):
        return []
    r, depth, stiffness = (float(x) for x in scan.potential.minimum())
    if not math.isfinite(r):
        return []
    with np.errstate(all="ignore"):
        forces = partial(scan.one_by_one, scan.methods[1])
        first = float(derivative(scan.python_energies, r, REACH * r)[0])
        second = -float(derivative(forces, r, REACH * r)[0])
        energy = float(scan.python_energies(np.array([r]))[0])
    scale = max(abs(depth), float(scan.scale(r)) * r)
    errors = {
        "distance": abs(first) * r / scale,
        "depth": abs(energy - depth) / scale,
        "curvature": abs(second - stiffness) * r * r / max(abs(second) * r * r, scale),
    }
    worst = max(errors, key=lambda name: np.nan_to_num(errors[name], nan=np.inf))
    text = "declared distance, depth and curvature"
    failed = not second > 0.0
    note = "U has no minimum at this distance" if failed else f"the {worst} has the largest error"
    return [Check("minimum", text, errors[worst], MINIMUM, r, note, failed)]
