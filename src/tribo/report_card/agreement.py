"""One potential computed in three ways: one distance at a time, arrays, and compiled code."""

from __future__ import annotations

import numpy as np

from tribo.report_card.card import Check
from tribo.report_card.scan import PotentialScan

# Largest acceptable difference, relative to the scale of the potential at that distance.
ROUND_OFF = 1e-12


def check_agreement(scan: PotentialScan) -> list[Check]:
    """Compare arrays and compiled code with the potential's methods, one distance at a time."""
    r = scan.everywhere
    r = r[r < scan.cutoff]
    with np.errstate(all="ignore"):
        energy = np.array([float(scan.python_energy(np.float64(x))) for x in r])
        force = np.array([float(scan.python_force(np.float64(x))) for x in r])
        note = ""
        try:
            arrays = [np.broadcast_to(np.asarray(x, float), r.shape) for x in scan.in_python(r)]
        except Exception as error:
            note = f"takes no arrays ({type(error).__name__}); np.where and np.maximum do"
            arrays = [energy, force]
    return [
        _compared("arrays", scan, r, (energy, force), (arrays[0], arrays[1]), note),
        _compared("compiled", scan, r, (energy, force), scan.compiled(r)),
    ]


def _compared(
    name: str,
    scan: PotentialScan,
    r: np.ndarray,
    one: tuple[np.ndarray, np.ndarray],
    other: tuple[np.ndarray, np.ndarray],
    note: str = "",
) -> Check:
    """The largest difference; none where neither value is finite, infinite where one is."""
    scale = scan.scale(r)
    errors = np.zeros(r.size)
    for k, unit in enumerate((scale * r, scale)):
        both = np.isfinite(one[k]) & np.isfinite(other[k])
        same_kind = np.isfinite(one[k]) == np.isfinite(other[k])
        gap = np.abs(np.subtract(one[k], other[k], where=both, out=np.zeros(r.size))) / unit
        errors = np.maximum(errors, np.where(same_kind, gap, np.inf))
    worst = int(np.argmax(errors))
    return Check(
        name,
        f"values for one r at a time, at {r.size} distances",
        float(errors[worst]),
        ROUND_OFF,
        float(r[worst]),
        note=note,
    )
