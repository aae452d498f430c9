"""Energy and force are finite where runs need them: as r -> 0, far away, and in between."""

import math

import numpy as np

from tribo.report_card.card import Check
from tribo.report_card.scan import SMALLEST_SCALE, PotentialScan

# Distance to which energy and force must be finite if no domain ends before
# [largest distance of the scan].
FAR = 1e6
# Largest acceptable work of the force between distances where U is constant [energy].
FROZEN = 1e-9
# Depth of an energy that falls without end inside a barrier [typical energy].
DEEP = 100.0
# Octaves below and above r = 1 at which the potential is evaluated: from 1e-300 to 1e300.
OCTAVES = 996


def check_finite(scan: PotentialScan) -> Check:
    """Check that energy and force are finite at all distances of the scan."""
    r = np.concatenate([scan.edges, scan.everywhere])
    energy, force = scan.compiled(r)
    bad = ~(np.isfinite(energy) & np.isfinite(force))
    text = f"energy and force at {r.size} distances"
    number = float(np.count_nonzero(bad))
    where = float(r[np.argmax(bad)]) if number else None
    note = "a run that reaches this distance ends as NotFinite" if number else ""
    return Check("finite", text, number, 0.0, where, note)


def check_limits(scan: PotentialScan) -> Check:
    """Check that energy and force are finite from a small distance to a very large one.

    At smaller and larger distances a run may end as NotFinite, or with the potential's exception.
    Where U is constant, by round-off or underflow, the force must do no work.
    """
    r = 2.0 ** np.arange(-OCTAVES, OCTAVES + 1)
    energy, force = scan.compiled_if_possible(r)
    finite = np.isfinite(energy) & np.isfinite(force)
    note, where = _finite_range(scan, r, finite)
    value, worst = _work_at_constant_energy(scan, r, energy, force)
    text = "force where U is constant, 1e-300 < r < 1e300"
    failed = where is not None
    collapse = _collapse(scan)
    note = f"{note}; {collapse}" if collapse else note
    return Check("limits", text, value, FROZEN, where if failed else worst, note, failed)


def _collapse(scan: PotentialScan) -> str:
    """What to say of an energy that falls without end inside a barrier; empty if it does not.

    That of an attraction at all distances has no barrier, and is meant.
    """
    inner = scan.r < scan.length
    inward = scan.force[inner][::-1]  # from the typical distance
    repulsion = np.flatnonzero(inward > 0.0)
    if not repulsion.size or not scan.energy[0] < -DEEP * scan.typical_energy:
        return ""
    attraction = np.flatnonzero(inward[repulsion[0] :] < 0.0) + repulsion[0]
    if not attraction.size or not np.all(inward[attraction[-1] :] < 0.0):
        return ""
    barrier = scan.r[inner][::-1][attraction[0]]
    fall = f"U falls below {scan.energy[0]:.1e} inside its barrier at r = {barrier:.3g}"
    return f"{fall}; domain() can exclude these distances"


def _finite_range(
    scan: PotentialScan, r: np.ndarray, finite: np.ndarray
) -> tuple[str, float | None]:
    """The range of finite values, as text, and the distance of the first failure if any."""
    domain_ends = math.isfinite(scan.domain[1])
    needed = scan.high if domain_ends else min(FAR * scan.high, float(r[-1]))
    if not finite.any():
        return "not finite at any distance", float(r[0])
    first = int(np.argmax(finite))
    bad = np.flatnonzero(~finite[first:]) + first
    last = float(r[bad[0]]) if bad.size else math.inf
    if last <= needed:
        return "not finite at this distance, but finite at smaller ones", last
    inward = "r -> 0" if first == 0 else f"r = {r[first]:.1e} (NotFinite below)"
    outward = f"{last:.1e} (NotFinite beyond)" if bad.size else "infinity"
    return f"finite from {inward} to {outward}", None


def _work_at_constant_energy(
    scan: PotentialScan, r: np.ndarray, energy: np.ndarray, force: np.ndarray
) -> tuple[float, float | None]:
    """The largest |F| r, relative to the energy, where U is the same over two octaves."""
    with np.errstate(all="ignore"):
        same = (energy[:-2] == energy[1:-1]) & (energy[1:-1] == energy[2:])
        unit = np.abs(energy[1:-1]) + max(scan.typical_energy, SMALLEST_SCALE)
        work = np.abs(force[1:-1]) * r[1:-1] / unit
    work = np.where(same & np.isfinite(work), work, 0.0)
    worst = int(np.argmax(work))
    return float(work[worst]), float(r[1 + worst]) if work[worst] > 0.0 else None
