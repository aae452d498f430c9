"""Force against the derivative of the energy, which comes with its own uncertainty; minima."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import differentiate

from tribo.report_card.card import Check, Curves
from tribo.report_card.specimen import Specimen

BOUND = 1e-10  # of force + dU/dr, relative to the scale around
TRUSTED = 10.0  # uncertainties that a disagreement must exceed to be one
KNOWN = 0.9  # of the distances at which the derivative must be known to within the bound
REACH = 0.1  # of r or the typical distance: how far from r the energy is evaluated
LEVELS = 12  # of differences, each over half the distance of the one before
SHORTER = (1.0, 1.0 / 16.0, 1.0 / 256.0)  # of the reach, with which differences begin
AGREEMENT = 1e-13  # relative, of two successive estimates of a derivative
# Relative error of a derivative by SciPy's coefficients, which are rounded to double precision:
# up to 3.5e-15 was measured for r^-12, exp(-5 r) and the Lennard-Jones energy.
WEIGHTS = 4e-15
MINIMUM = 1e-9  # relative error of a declared minimum

Rule = Callable[[Any], Any]  # of a distance h, something whose limit at h = 0 is wanted


def derivative(function: Rule, r: Any, reach: Any) -> tuple[np.ndarray, np.ndarray]:
    """Derivative of a function of one distance, in extended precision, and its uncertainty.

    SciPy starts with differences over `reach` and halves them until its estimates agree.  A spline
    or the end of a table within that distance spoils the first differences, so shorter ones are
    tried too, and the estimate with the least uncertainty counts.

    Parameters
    ----------
    function : callable
        Takes one ``numpy.longdouble`` and returns a number.
    r : array_like
        Where the derivative is wanted.
    reach : array_like
        Largest distance from r, on either side, at which the function is evaluated.

    Returns
    -------
    derivative, uncertainty : ndarray
        In the shape of r; nan and infinity where no estimate is finite.

    See Also
    --------
    scipy.differentiate.derivative
    """
    place, length = np.broadcast_arrays(np.longdouble(r), np.longdouble(reach))
    best, uncertainty = np.full(place.shape, np.nan), np.full(place.shape, np.inf)
    for shorter in SHORTER:
        found = differentiate.derivative(
            np.vectorize(function, otypes=[np.longdouble]),
            place,
            initial_step=length * shorter,
            maxiter=LEVELS,
            tolerances={"atol": 0.0, "rtol": AGREEMENT},
        )
        doubt = np.float64(found.error + WEIGHTS * np.abs(found.df))
        better = doubt < uncertainty
        best = np.where(better, np.float64(found.df), best)
        uncertainty = np.where(better, doubt, uncertainty)
    return best, uncertainty


def curves(specimen: Specimen) -> Curves:
    """Energy, force, and how far the force is from minus the energy's derivative."""
    r, end = specimen.r, specimen.cutoff
    reach = REACH * np.minimum(r, specimen.length)
    reach = np.where(r < end, np.minimum(reach, 0.9 * np.abs(end - r)), reach)
    with np.errstate(all="ignore"):
        slope, uncertainty = derivative(specimen.written_energy, r, reach)
        scale = specimen.scale(r)
        return Curves(
            r=r,
            energy=specimen.energy,
            force=specimen.force,
            disagreement=np.abs(specimen.force + slope) / scale,
            uncertainty=uncertainty / scale,
            bound=BOUND,
            cutoff=end,
            length=specimen.length,
        )


def check_force(found: Curves) -> Check:
    """Where the derivative is known well enough, the force has to be minus that."""
    inside = found.r < found.cutoff
    known = inside & (TRUSTED * found.uncertainty <= BOUND)
    share = float(np.count_nonzero(known)) / max(1, int(np.count_nonzero(inside)))
    errors = np.where(known & np.isfinite(found.disagreement), found.disagreement, 0.0)
    worst = int(np.argmax(errors))
    best = float(np.median(found.uncertainty[known])) if known.any() else math.inf
    return Check(
        "force",
        f"with -dU/dr, known to {best:.1e}",
        float(errors[worst]),
        BOUND,
        float(found.r[worst]),
        says="" if share >= KNOWN else f"dU/dr is known at {share:.0%} of the distances only",
        failed=share < KNOWN,
    )


def check_minimum(specimen: Specimen) -> list[Check]:
    """The place, depth and curvature of the minimum, where the potential declares them."""
    if not hasattr(specimen.potential, "minimum"):
        return []
    r, depth, stiffness = (float(x) for x in specimen.potential.minimum())
    if not math.isfinite(r):
        return []
    with np.errstate(all="ignore"):
        first = float(derivative(specimen.written_energy, r, REACH * r)[0])
        second = -float(derivative(specimen.written_force, r, REACH * r)[0])
        energy = float(specimen.written_energy(np.float64(r)))
    scale = max(abs(depth), float(specimen.scale(r)) * r)
    errors = {
        "place": abs(first) * r / scale,
        "depth": abs(energy - depth) / scale,
        "curvature": abs(second - stiffness) * r * r / max(abs(second) * r * r, scale),
    }
    worst = max(errors, key=lambda name: np.nan_to_num(errors[name], nan=np.inf))
    return [
        Check(
            "minimum",
            "declared place, depth and curvature",
            errors[worst],
            MINIMUM,
            r,
            says=f"the {worst} is the worst of them" if second > 0.0 else "U has no minimum there",
            failed=not second > 0.0,
        )
    ]
