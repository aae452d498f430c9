"""One potential, four ways to compute it: scalar, array, and what runs have compiled."""

from __future__ import annotations

import numpy as np

from tribo.report_card.card import Check
from tribo.report_card.specimen import Specimen

ROUND_OFF = 1e-12  # relative to the scale around


def check_agreement(specimen: Specimen) -> list[Check]:
    """Arrays and compiled code say what the methods say of one distance after another."""
    r = np.concatenate([specimen.r, specimen.special])
    r = r[r < specimen.cutoff]
    with np.errstate(all="ignore"):
        energy = np.array([float(specimen.written_energy(np.float64(x))) for x in r])
        force = np.array([float(specimen.written_force(np.float64(x))) for x in r])
        says = ""
        try:
            arrays = [np.broadcast_to(np.asarray(x, float), r.shape) for x in specimen.written(r)]
        except Exception as error:
            says = f"no arrays ({type(error).__name__}); numpy's functions and np.where take them"
            arrays = [energy, force]
    return [
        _line("arrays", specimen, r, (energy, force), (arrays[0], arrays[1]), says),
        _line("compiled", specimen, r, (energy, force), specimen.compiled(r)),
    ]


def _line(
    name: str,
    specimen: Specimen,
    r: np.ndarray,
    one: tuple[np.ndarray, np.ndarray],
    other: tuple[np.ndarray, np.ndarray],
    says: str = "",
) -> Check:
    """The largest difference; where neither is a number there is none."""
    scale = specimen.scale(r)
    errors = np.zeros(r.size)
    for k, unit in enumerate((scale * r, scale)):
        numbers = np.isfinite(one[k]) & np.isfinite(other[k])
        alike = np.isfinite(one[k]) == np.isfinite(other[k])
        gap = np.abs(np.subtract(one[k], other[k], where=numbers, out=np.zeros(r.size))) / unit
        errors = np.maximum(errors, np.where(alike, gap, np.inf))
    worst = int(np.argmax(errors))
    return Check(
        name,
        f"with one r at a time, at {r.size} distances",
        float(errors[worst]),
        ROUND_OFF,
        float(r[worst]),
        says=says,
        failed=bool(says),
    )
