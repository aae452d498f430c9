"""One potential computed in several ways: arrays, compiled code, and two charges exchanged."""

from __future__ import annotations

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
        _compared("arrays", scan, r, (energy, force), (arrays[0], arrays[1]), note=note),
        _compared("compiled", scan, r, (energy, force), scan.compiled(r)),
    ]


def check_third_law(scan: PotentialScan) -> Check:
    """Check that energy and force stay the same if two charges are exchanged."""
    r = scan.r[:: max(1, scan.r.size // DISTANCES)]
    with np.errstate(all="ignore"):
        one, other = (_of_charges(scan, r, pair) for pair in (CHARGES, CHARGES[::-1]))
    name, compared = "third law", f"charges exchanged, at {r.size} distances"
    return _compared(name, scan, r, one, other, compared)


def _of_charges(
    scan: PotentialScan, r: np.ndarray, pair: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Energies and forces of two charges, one distance at a time."""
    potential = scan.potential
    methods = (potential.energy_between, potential.force_between)
    energy, force = (np.array([float(method(x, *pair)) for x in r]) for method in methods)
    return energy, force


def _compared(
    name: str,
    scan: PotentialScan,
    r: np.ndarray,
    one: tuple[np.ndarray, np.ndarray],
    other: tuple[np.ndarray, np.ndarray],
    compared: str = "",
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
        compared or f"values for one r at a time, at {r.size} distances",
        float(errors[worst]),
        ROUND_OFF,
        float(r[worst]),
        note=note,
    )
