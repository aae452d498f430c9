"""What any two groups of bobs must obey, looked at through the kernels that runs use.

Third law, translation, mirror; work along a path against the energy, and round a closed loop.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tribo.report_card.card import Check
from tribo.report_card.specimen import GROUP, Specimen

ROUND_OFF = 1e-12
GROUPS = 64  # random arrangements
SPREAD = 0.15  # of the typical distance: how far bobs are from the middle of their group
SPACING = 2.0**-30  # of the typical distance: places on such a lattice are shifted without error
FARTHEST = 2**36  # lattice spacings of a shift: 64 typical distances
PANELS = 256  # of eight points each, along a path
TURN = 4096  # points round a loop
WORK = 1e-10  # relative error of a work
DOUBT = 10.0  # times what halving the panels changes

Places = np.ndarray  # (k, n, 3)
Path = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  # of s: places and d places / ds


def check_laws(specimen: Specimen) -> list[Check]:
    """Third law, translation and mirror, of groups of three against three bobs."""
    rng = np.random.default_rng(3)
    places, charges = _groups(specimen, rng)
    energy, force = specimen.probe(places, charges)
    unit = np.max(np.sum(np.abs(force), axis=(1, 2)))
    unit = max(float(unit), float(specimen.scale(specimen.length)))
    size = unit * specimen.length

    def line(name: str, looked_at: str, *errors: np.ndarray) -> Check:
        value = float(max(np.max(np.abs(error)) for error in errors))
        return Check(name, f"{looked_at}, {GROUPS} groups of {2 * GROUP} bobs", value, ROUND_OFF)

    other = _exchanged(specimen, places, charges)
    shifts = rng.integers(-FARTHEST, FARTHEST, (GROUPS, 1, 3)) * _lattice(specimen)
    moved = specimen.probe(places + shifts, charges)
    mirrored = specimen.probe(places * [-1.0, 1.0, 1.0], charges)
    return [
        line(
            "third law",
            "sums of forces, parts exchanged",
            np.sum(force, axis=1) / unit,
            (energy - other[0]) / size,
            (force - other[1]) / unit,
        ),
        line("translation", "shifted", (energy - moved[0]) / size, (force - moved[1]) / unit),
        line(
            "mirror",
            "x and -x",
            (energy - mirrored[0]) / size,
            (force - mirrored[1] * [-1.0, 1.0]) / unit,
        ),
    ]


def _exchanged(
    specimen: Specimen, places: Places, charges: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Energy and forces, in the same order, with the surfaces' bobs and charges exchanged."""
    swap = np.roll(np.arange(2 * GROUP), GROUP)
    energy, force = specimen.probe(places[:, swap], charges[:, swap])
    return energy, force[:, swap]


def _lattice(specimen: Specimen) -> float:
    """A power of two, so that places which are multiples of it can be shifted without rounding."""
    return 2.0 ** math.floor(math.log2(specimen.length * SPACING))


def _room(specimen: Specimen) -> float:
    """How far a distance may be from the typical one, relative to it, and not leave the domain."""
    end = min(specimen.high, specimen.cutoff)
    inward, outward = 1.0 - specimen.low / specimen.length, end / specimen.length - 1.0
    return 0.9 * min(inward, outward)


def _groups(specimen: Specimen, rng: np.random.Generator) -> tuple[Places, np.ndarray]:
    """Two groups of bobs that are about a typical distance apart, and their charges."""
    spread = specimen.length * min(SPREAD, 0.5 * _room(specimen)) / math.sqrt(3.0)
    places = rng.uniform(-spread, spread, (GROUPS, 2 * GROUP, 3))
    places[:, :GROUP, 1] += specimen.length
    lattice = _lattice(specimen)
    charges = rng.uniform(0.5, 1.5, (GROUPS, 2 * GROUP))
    return np.round(places / lattice) * lattice, charges * rng.choice([-1.0, 1.0], charges.shape)


def check_work(specimen: Specimen) -> list[Check]:
    """Work along an open path is what the energy loses; round a closed one it is nothing."""
    length = specimen.length
    radius = length * min(0.4, 0.5 * _room(specimen))
    start, stop = (
        np.array([-radius, length - 0.8 * radius, 0.2 * radius]),
        np.array([0.8 * radius, length + 0.6 * radius, 0.2 * radius]),
    )

    def open_path(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return start + s[:, None] * (stop - start), np.broadcast_to(stop - start, (s.size, 3))

    def loop(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        cos, sin = np.cos(2.0 * np.pi * s), np.sin(2.0 * np.pi * s)
        place = np.stack([radius * cos, length + radius * sin, 0.0 * s], axis=1)
        rate = 2.0 * np.pi * radius
        return place, rate * np.stack([-sin, cos, 0.0 * s], axis=1)

    ends, _ = specimen.probe(_beside(np.array([start, stop])), np.ones((2, 2)))
    lost = float(ends[0] - ends[1])
    return [
        _line("work", "energy lost on an open path", specimen, open_path, _gauss, lost),
        _line("closed loop", "work on the way round", specimen, loop, _trapezoid, 0.0),
    ]


def _line(
    name: str,
    looked_at: str,
    specimen: Specimen,
    path: Path,
    rule: Callable[[int], tuple[np.ndarray, np.ndarray]],
    expected: float,
) -> Check:
    """Work by a quadrature, which is done again with half the panels to see what it is worth."""
    work, effort = _work(specimen, path, *rule(2))
    coarse, _ = _work(specimen, path, *rule(1))
    unit = max(effort, specimen.typical_energy)
    doubt = DOUBT * abs(work - coarse) / unit
    return Check(name, looked_at, abs(work - expected) / unit, max(WORK, doubt))


def _work(
    specimen: Specimen, path: Path, nodes: np.ndarray, weights: np.ndarray
) -> tuple[float, float]:
    """Work of the force on a bob that is led past another, and the same with all of it positive."""
    place, along = path(nodes)
    _, force = specimen.probe(_beside(place), np.ones((nodes.size, 2)))
    power = np.sum(force[:, 0] * along[:, :2], axis=1)
    return float(weights @ power), float(weights @ np.abs(power))


def _beside(place: np.ndarray) -> Places:
    """One bob at each place (k, 3), its partner at the origin."""
    return np.stack([place, np.zeros_like(place)], axis=1)


def _gauss(times: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights on (0, 1): `times` half of PANELS, with eight points each."""
    node, weight = np.polynomial.legendre.leggauss(8)
    count = PANELS * times // 2
    nodes = (np.arange(count)[:, None] + 0.5 * (1.0 + node)) / count
    return nodes.ravel(), np.tile(0.5 * weight, count) / count


def _trapezoid(times: int) -> tuple[np.ndarray, np.ndarray]:
    """Evenly spaced points round a loop: for what is smooth there, exact to round-off."""
    count = TURN * times // 2
    return np.arange(count) / count, np.full(count, 1.0 / count)
