"""Force and minimum compared with derivatives of the energy, whose uncertainty is estimated."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from tribo.report_card.card import Check, Curves
from tribo.report_card.scan import PotentialScan

# Largest acceptable |F + dU/dr|, relative to the scale of the force.
BOUND = 1e-10

# Factor by which the bound must exceed the uncertainty of dU/dr where the two are compared.
TRUSTED = 10.0

# Least fraction of the distances at which they must be compared.
KNOWN = 0.9

REACH = 0.1  # of r or the typical distance: the first difference is taken over twice that
LEVELS = 12  # of differences, each over half the distance of the one before

# Largest acceptable relative error of a declared minimum.
MINIMUM = 1e-9

Rule = Callable[[Any], Any]  # of a distance h, something whose limit at h = 0 is wanted


def limit(rule: Rule, h: Any, ratio: float) -> tuple[float, float]:
    """The limit of rule(h) at h = 0, and its uncertainty, from h, h/2, h/4 ...

    `ratio` is that of successive terms of the error when h is halved: 4 if the error is a series
    in h^2, 2 in h.  Of all extrapolations the one is taken that changes least from those it was
    made of, and the change is the uncertainty.

    C. J. F. Ridders, Adv. Eng. Softw. 4 (1982) 75.
    """
    best, uncertainty = math.nan, math.inf
    above: list[Any] = []
    for _ in range(LEVELS):
        row = [rule(h)]
        for k, before in enumerate(above):
            row.append(row[k] + (row[k] - before) / (ratio ** (k + 1) - 1.0))
            change = float(max(abs(row[k + 1] - row[k]), abs(row[k + 1] - before)))
            if change < uncertainty:
                best, uncertainty = float(row[k + 1]), change
        above, h = row, 0.5 * h
    return best, uncertainty


def slope(function: Rule, r: float, reach: float) -> tuple[float, float]:
    """f'(r) and its uncertainty, by central differences in extended precision."""
    x = np.longdouble(r)

    def rule(h: Any) -> Any:
        return (function(x + h) - function(x - h)) / ((x + h) - (x - h))

    return limit(rule, np.longdouble(reach), 4.0)


def curvature(function: Rule, r: float, reach: float) -> tuple[float, float]:
    """f''(r) and its uncertainty, likewise."""
    x = np.longdouble(r)
    middle = function(x)
    return limit(
        lambda h: ((function(x + h) - middle) - (middle - function(x - h))) / (h * h),
        np.longdouble(reach),
        4.0,
    )


def curves(scan: PotentialScan) -> Curves:
    """Energy, force, and |F + dU/dr| with the uncertainty of dU/dr."""
    r, end = scan.r, scan.cutoff
    reach = REACH * np.minimum(r, scan.length)
    reach = np.where(r < end, np.minimum(reach, 0.9 * np.abs(end - r)), reach)
    with np.errstate(all="ignore"):
        found = [slope(scan.python_energy, *both) for both in zip(r, reach, strict=True)]
        derivative, uncertainty = np.array(found).T
        scale = scan.scale(r)
        return Curves(
            r=r,
            energy=scan.energy,
            force=scan.force,
            disagreement=np.abs(scan.force + derivative) / scale,
            uncertainty=uncertainty / scale,
            bound=BOUND,
            cutoff=end,
            length=scan.length,
        )


def check_force(found: Curves) -> Check:
    """Check that the force is -dU/dr where the uncertainty of dU/dr permits it."""
    inside = found.r < found.cutoff
    known = inside & (TRUSTED * found.uncertainty <= BOUND)
    share = float(np.count_nonzero(known)) / max(1, int(np.count_nonzero(inside)))
    errors = np.where(known & np.isfinite(found.disagreement), found.disagreement, 0.0)
    worst = int(np.argmax(errors))
    best = float(np.median(found.uncertainty[known])) if known.any() else math.inf
    return Check(
        "force",
        f"force and -dU/dr, whose uncertainty is {best:.1e}",
        float(errors[worst]),
        BOUND,
        float(found.r[worst]),
        note="" if share >= KNOWN else f"dU/dr is known at only {share:.0%} of the distances",
        failed=share < KNOWN,
    )


def check_minimum(scan: PotentialScan) -> list[Check]:
    """Check distance, depth and curvature of the minimum, if the potential declares them."""
    if not hasattr(scan.potential, "minimum"):
        return []
    r, depth, stiffness = (float(x) for x in scan.potential.minimum())
    if not math.isfinite(r):
        return []
    with np.errstate(all="ignore"):
        first, _ = slope(scan.python_energy, r, REACH * r)
        second, _ = curvature(scan.python_energy, r, REACH * r)
        energy = float(scan.python_energy(np.float64(r)))
    scale = max(abs(depth), float(scan.scale(r)) * r)
    errors = {
        "distance": abs(first) * r / scale,
        "depth": abs(energy - depth) / scale,
        "curvature": abs(second - stiffness) * r * r / max(abs(second) * r * r, scale),
    }
    worst = max(errors, key=lambda name: np.nan_to_num(errors[name], nan=np.inf))
    return [
        Check(
            "minimum",
            "declared distance, depth and curvature",
            errors[worst],
            MINIMUM,
            r,
            note=f"the {worst} has the largest error"
            if second > 0.0
            else "U has no minimum at this distance",
            failed=not second > 0.0,
        )
    ]
