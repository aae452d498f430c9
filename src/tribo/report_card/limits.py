"""Numbers where they are wanted, and a clean refusal beyond: r -> 0, far away, and in between."""

from __future__ import annotations

import math

import numpy as np

from tribo.report_card.card import Check
from tribo.report_card.specimen import NOTHING, Specimen

FAR = 1e6  # of the largest distance looked at: bobs may be that far apart, if no domain forbids it
FROZEN = 1e-9  # of the energy: what a force may do over a stretch where U does not change
OCTAVES = 996  # from r = 1 either way: 1e-300 to 1e300


def check_finite(specimen: Specimen) -> Check:
    """Energy and force are numbers at every distance of the domain, special ones too."""
    r = np.concatenate([specimen.edges, specimen.r, specimen.special])
    energy, force = specimen.compiled(r)
    bad = ~(np.isfinite(energy) & np.isfinite(force))
    worst = r[int(np.argmax(bad))] if bad.any() else None
    return Check(
        "finite",
        f"energy and force at {r.size} distances",
        float(np.count_nonzero(bad)),
        0.0,
        None if worst is None else float(worst),
        says="" if worst is None else "a run that comes there ends as NotFinite",
    )


def check_limits(specimen: Specimen) -> Check:
    """From 1e-300 to 1e300: numbers from some small distance on, and as far as bobs may be apart.

    Nearer and farther a run may end as NotFinite.  And where the energy does not change any more,
    lost to round-off or underflow, the force may do no work.
    """
    r = 2.0 ** np.arange(-OCTAVES, OCTAVES + 1)
    energy, force = specimen.compiled(r)
    finite = np.isfinite(energy) & np.isfinite(force)
    says, where = _said(specimen, r, finite)
    value, place = _work_of_nothing(specimen, r, energy, force)
    return Check(
        "limits",
        "force where U is constant, 1e-300 < r < 1e300",
        value,
        FROZEN,
        place if where is None else where,
        says=says,
        failed=where is not None,
    )


def _said(specimen: Specimen, r: np.ndarray, finite: np.ndarray) -> tuple[str, float | None]:
    """What there is to say of a ladder of distances, and where it fails if it does."""
    domain_ends = math.isfinite(specimen.declared[1])
    needed = specimen.high if domain_ends else min(FAR * specimen.high, float(r[-1]))
    if not finite.any():
        return "there are no numbers at all", float(r[0])
    first = int(np.argmax(finite))
    bad = np.flatnonzero(~finite[first:]) + first
    last = float(r[bad[0]]) if bad.size else math.inf
    if last <= needed:
        return "not finite there, though nearer it is", last
    inward = "r -> 0" if first == 0 else f"r = {r[first]:.1e} (NotFinite below)"
    outward = f"{last:.1e} (NotFinite from there)" if bad.size else "infinity"
    return f"finite from {inward} to {outward}", None


def _work_of_nothing(
    specimen: Specimen, r: np.ndarray, energy: np.ndarray, force: np.ndarray
) -> tuple[float, float | None]:
    """The largest |F| r, relative to the energy, where U is the same over two octaves."""
    with np.errstate(all="ignore"):
        same = (energy[:-2] == energy[1:-1]) & (energy[1:-1] == energy[2:])
        unit = np.abs(energy[1:-1]) + max(specimen.typical_energy, NOTHING)
        work = np.abs(force[1:-1]) * r[1:-1] / unit
    work = np.where(same & np.isfinite(work), work, 0.0)
    worst = int(np.argmax(work))
    return float(work[worst]), float(r[1 + worst]) if work[worst] > 0.0 else None
