"""One potential computed in several ways: arrays, compiled code, and two charges exchanged."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tribo.report_card.card import Check
from tribo.report_card.scan import PotentialScan

# Largest acceptable difference, relative to the scale of the potential at that distance.
ROUND_OFF = 1e-12
# Distances at which charges are exchanged, and two charges.
DISTANCES = 40
CHARGES = (0.7, -1.3)


def check_agreement(scan: PotentialScan) -> list[Check]:
    """Compare arrays and compiled code with the potential's methods, one distance at a time."""
    r = scan.everywhere
    r = r[r < scan.cutoff]
    single, note = [scan.one_by_one(method, r) for method in scan.methods], ""
    try:
        with np.errstate(all="ignore"):
            found = (np.asarray(method(r, 1.0, 1.0), float) for method in scan.methods)
            arrays = [np.broadcast_to(values, r.shape) for values in found]
    except Exception as error:
        note = f"takes no arrays ({type(error).__name__}); np.where and np.maximum do"
        arrays = single
    text = f"values for one r at a time, at {r.size} distances"
    compared = replace(check_same("arrays", text, scan, r, single, arrays), note=note)
    return [compared, check_same("compiled", text, scan, r, single, scan.compiled(r))]


def check_third_law(scan: PotentialScan) -> Check:
    """Check that energy and force stay the same if two charges are exchanged."""
    r = scan.r[:: max(1, scan.r.size // DISTANCES)]
    one, other = (
        [scan.one_by_one(method, r, *charges) for method in scan.methods]
        for charges in (CHARGES, CHARGES[::-1])
    )
    text = f"charges exchanged, at {r.size} distances"
    return check_same("third law", text, scan, r, one, other)


def check_same(
    name: str,
    text: str,
    scan: PotentialScan,
    r: np.ndarray,
    one: Sequence[np.ndarray],
    other: Sequence[np.ndarray],
) -> Check:
    """The largest difference of energies and forces that are computed in two ways.

    None where neither value is finite, infinite where one is.
    """
    scale = scan.scale(r)
    errors = np.zeros(r.size)
    for k, unit in enumerate((scale * r, scale)):
        both = np.isfinite(one[k]) & np.isfinite(other[k])
        same_kind = np.isfinite(one[k]) == np.isfinite(other[k])
        gap = np.abs(np.subtract(one[k], other[k], where=both, out=np.zeros(r.size))) / unit
        errors = np.maximum(errors, np.where(same_kind, gap, np.inf))
    return Check.of_worst(name, text, errors, ROUND_OFF, r)
