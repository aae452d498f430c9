"""Laws that every contact obeys, checked through the kernels that runs use.

Newton's third law, translation, reflection; work along a path and around a loop.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tribo.report_card.card import Check
from tribo.report_card.scan import GROUP, PotentialScan

# Largest acceptable violation of a law, relative to the largest force or energy.
ROUND_OFF = 1e-12

# Number of random arrangements of bobs.
GROUPS = 64

# Distance of bobs from the middle of their group [typical distance].
SPREAD = 0.15

# Spacing of the lattice on which bobs are placed, so that shifts have no rounding error
# [typical distance].
SPACING = 2.0**-30

# Largest shift, 64 typical distances [spacings of the lattice].
FARTHEST = 2**36

# Intervals along a path, each with eight Gauss points.
PANELS = 256

# Points around a loop.
LOOP_POINTS = 4096

# Largest acceptable error of a work, relative to the integral of |F . dr|.
WORK = 1e-10

# Factor by which an error must exceed the change of the work when the panels are halved.
DOUBT = 10.0

Path = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  # of s: positions and their derivative
Rule = Callable[[int], tuple[np.ndarray, np.ndarray]]  # of a refinement: nodes and weights


def check_laws(scan: PotentialScan) -> list[Check]:
    """Check third law, translation and reflection on groups of three bobs against three."""
    rng = np.random.default_rng(3)
    positions, charges = _groups(scan, rng)
    energy, force = scan.probe(positions, charges)
    unit = np.max(np.sum(np.abs(force), axis=(1, 2)))
    unit = max(float(unit), float(scan.scale(scan.length)))
    size = unit * scan.length

    def law(name: str, compared: str, *errors: np.ndarray) -> Check:
        value = float(max(np.max(np.abs(error)) for error in errors))
        return Check(name, f"{compared}, {GROUPS} groups of {2 * GROUP} bobs", value, ROUND_OFF)

    other = _exchanged(scan, positions, charges)
    shifts = rng.integers(-FARTHEST, FARTHEST, (GROUPS, 1, 3)) * _lattice(scan)
    moved = scan.probe(positions + shifts, charges)
    mirrored = scan.probe(positions * [-1.0, 1.0, 1.0], charges)
    return [
        law(
            "third law",
            "sum of forces, surfaces exchanged",
            np.sum(force, axis=1) / unit,
            (energy - other[0]) / size,
            (force - other[1]) / unit,
        ),
        law(
            "translation", "all bobs shifted", (energy - moved[0]) / size, (force - moved[1]) / unit
        ),
        law(
            "mirror",
            "x and -x",
            (energy - mirrored[0]) / size,
            (force - mirrored[1] * [-1.0, 1.0]) / unit,
        ),
    ]


def _exchanged(
    scan: PotentialScan, positions: np.ndarray, charges: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Energy and forces, in the order of the bobs, with the two surfaces exchanged."""
    swap = np.roll(np.arange(2 * GROUP), GROUP)
    energy, force = scan.probe(positions[:, swap], charges[:, swap])
    return energy, force[:, swap]


def _lattice(scan: PotentialScan) -> float:
    """Spacing of the lattice: a power of two, so that shifts are exact."""
    return 2.0 ** math.floor(math.log2(scan.length * SPACING))


def _room(scan: PotentialScan) -> float:
    """Largest deviation from the typical distance within the domain, relative to it."""
    end = min(scan.high, scan.cutoff)
    inward, outward = 1.0 - scan.low / scan.length, end / scan.length - 1.0
    return 0.9 * min(inward, outward)


def _groups(scan: PotentialScan, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Two groups of bobs about a typical distance apart, and their charges."""
    spread = scan.length * min(SPREAD, 0.5 * _room(scan)) / math.sqrt(3.0)
    positions = rng.uniform(-spread, spread, (GROUPS, 2 * GROUP, 3))
    positions[:, :GROUP, 1] += scan.length
    lattice = _lattice(scan)
    charges = rng.uniform(0.5, 1.5, (GROUPS, 2 * GROUP))
    return np.round(positions / lattice) * lattice, charges * rng.choice([-1.0, 1.0], charges.shape)


def check_work(scan: PotentialScan) -> list[Check]:
    """Compare the work along a path with the energy lost, and around a loop with zero."""
    length = scan.length
    radius = length * min(0.4, 0.5 * _room(scan))
    start, stop = (
        np.array([-radius, length - 0.8 * radius, 0.2 * radius]),
        np.array([0.8 * radius, length + 0.6 * radius, 0.2 * radius]),
    )

    def open_path(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return start + s[:, None] * (stop - start), np.broadcast_to(stop - start, (s.size, 3))

    def loop(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        cos, sin = np.cos(2.0 * np.pi * s), np.sin(2.0 * np.pi * s)
        position = np.stack([radius * cos, length + radius * sin, 0.0 * s], axis=1)
        rate = 2.0 * np.pi * radius
        return position, rate * np.stack([-sin, cos, 0.0 * s], axis=1)

    ends, _ = scan.probe(_beside(np.array([start, stop])), np.ones((2, 2)))
    lost = float(ends[0] - ends[1])
    return [
        _work_check("work", "energy lost on an open path", scan, open_path, _gauss, lost),
        _work_check("closed loop", "work around a circle", scan, loop, _trapezoid, 0.0),
    ]


def _work_check(
    name: str,
    compared: str,
    scan: PotentialScan,
    path: Path,
    rule: Rule,
    expected: float,
) -> Check:
    """Compare a work with its expected value; half the panels give the quadrature's error."""
    work, size = _work(scan, path, *rule(2))
    coarse, _ = _work(scan, path, *rule(1))
    unit = max(size, scan.typical_energy)
    doubt = DOUBT * abs(work - coarse) / unit
    value = abs(work - expected) / unit
    if scan.potential.smoothness_within() < 0.0:  # no force accounts for a jump of the energy
        return Check(name, f"{compared}; smoothness() lets it jump", value, None)
    return Check(name, compared, value, max(WORK, doubt))


def _work(
    scan: PotentialScan, path: Path, nodes: np.ndarray, weights: np.ndarray
) -> tuple[float, float]:
    """Integrals of F . dr and |F . dr| for a bob that is moved past another."""
    position, along = path(nodes)
    _, force = scan.probe(_beside(position), np.ones((nodes.size, 2)))
    power = np.sum(force[:, 0] * along[:, :2], axis=1)
    return float(weights @ power), float(weights @ np.abs(power))


def _beside(position: np.ndarray) -> np.ndarray:
    """Positions (k, 2, 3) of one bob at `position` (k, 3) and another at the origin."""
    return np.stack([position, np.zeros_like(position)], axis=1)


def _gauss(times: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights on (0, 1): `times` half of PANELS, with eight Gauss points each."""
    node, weight = np.polynomial.legendre.leggauss(8)
    count = PANELS * times // 2
    nodes = (np.arange(count)[:, None] + 0.5 * (1.0 + node)) / count
    return nodes.ravel(), np.tile(0.5 * weight, count) / count


def _trapezoid(times: int) -> tuple[np.ndarray, np.ndarray]:
    """Equal weights at equal spacing on [0, 1), exact for smooth periodic functions."""
    count = LOOP_POINTS * times // 2
    return np.arange(count) / count, np.full(count, 1.0 / count)
