"""The distances at which a potential is checked, its values there, and the scales of errors.

Values come in two ways: from the potential's methods as Python runs them, and *compiled*, through
the kernels and the disk cache that runs use.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.potentials.mixins import Potential
from tribo.run.contact_probe import ContactProbe
from tribo.validation import LARGEST_NUMBER, InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# Cells of equal ratio between the smallest and the largest distance.
CELLS = 400

# Finer cells around the typical distance: in each length over which the force changes, and on
# either side.
CELLS_PER_FEATURE, FINE_CELLS = 8, 80

# How far distances reach beyond the potential's own lengths, inward and outward [ratio].
INWARD, OUTWARD = 3.0, 6.0

# How far distances reach from the typical one at most, whatever the lengths are [ratio].
WIDEST = 1e3

# Cells on either side over which a scale is the largest value.
AROUND = 3

# Largest typical distance where there is a cutoff [cutoff].
NEAR_CUTOFF = 0.6

# Smallest scale [energy / length], so that errors of a potential that is zero can be divided by it.
SMALLEST_SCALE = 1e-280

# Smallest scale, relative to the largest at the typical distance and beyond: where the potential
# is fainter, its digits do not matter.
FAINT = 1e-30

# Bobs of each surface in checks of groups.
GROUP = 3


class PotentialScan:
    """A potential, the distances at which it is checked, and the scales of its errors.

    Parameters
    ----------
    potential : NamedTuple
        A potential, as :func:`tribo.potentials.as_potential` returns it.

    Attributes
    ----------
    low, high : float
        Smallest and largest distance [length].
    edges : ndarray, (n + 1,)
        They divide the distances into cells [length].
    r : ndarray, (n,)
        Middles of the cells [length].
    energy, force : ndarray, (n,)
        Compiled U and -dU/dr at `r`, for charges of 1.
    special : ndarray
        Distances where a mistake is likely: parameters, their sums and multiples, whole and half
        numbers, the ends [length].
    length : float
        Typical distance: that of the first minimum if there is one [length].
    cutoff : float
        Distance from which there is no force; infinite without one [length].
    domain : tuple of float
        Distances for which the potential is declared [length].

    Raises
    ------
    InputError
        If the potential does not compile, raises an exception, or has an empty domain.
    """

    def __init__(self, potential: Potential) -> None:
        self.potential = potential
        self.cutoff = float(potential.range())
        self._probes = {count: _contact_probe(potential, count) for count in (1, GROUP)}
        lengths = self._own_lengths()
        low, high = lengths[0] / INWARD, lengths[-1] * OUTWARD
        if math.isfinite(self.cutoff):
            high = 1.1 * self.cutoff
        self.domain = _domain(potential)
        low, high = self._within(low, high)
        self.length = self._typical(low, high)
        self.low = self._without_overflow(max(low, self.length / WIDEST))
        self.high = min(high, self.length * WIDEST)
        self.edges = self._edges()
        self.r = np.sqrt(self.edges[:-1] * self.edges[1:])
        self.energy, self.force = self.compiled(self.r)
        self.special = np.array(sorted(self._special()))
        self._scale = self._running_scale()

    # --- values ----------------------------------------------------------------------------------

    def in_python(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """U and -dU/dr between charges of 1 by the potential's methods, on an array."""
        return (
            self.potential.energy_between(r, 1.0, 1.0),
            self.potential.force_between(r, 1.0, 1.0),
        )

    def python_energy(self, r: np.floating) -> float | np.floating:
        """U(r) by the potential's methods, in the precision of r; nan where they raise."""
        try:
            return self.potential.energy_between(r, 1.0, 1.0)
        except Exception:
            return np.nan

    def python_force(self, r: np.floating) -> float | np.floating:
        """-dU/dr by the potential's methods, in the precision of r; nan where they raise."""
        try:
            return self.potential.force_between(r, 1.0, 1.0)
        except Exception:
            return np.nan

    def compiled(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """U and -dU/dr at each r, in the shape of r: two bobs at a distance r along x."""
        positions = np.zeros((r.size, 2, 3))
        positions[:, 0, 0] = r.ravel()
        energies, forces = self.probe(positions, np.ones((r.size, 2)))
        return energies.reshape(r.shape), forces[:, 0, 0].reshape(r.shape)

    def probe(self, positions: np.ndarray, charges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Contact energy (k,) and forces (k, n, 2) on bobs at `positions` (k, n, 3).

        The first half of the bobs belong to one surface, the others to another.
        """
        try:
            return self._probes[positions.shape[1] // 2](positions, charges)
        except InputError as error:
            raise InputError("potential", error.problem) from None
        except Exception as error:
            name = type(self.potential).__name__
            raise InputError(
                "potential",
                f"{name} raises {type(error).__name__}: {error}; "
                "must return nan where it has no energy",
            ) from None

    # --- scales ----------------------------------------------------------------------------------

    def scale(self, r: ArrayLike) -> np.ndarray:
        """Scale of errors of the force at r: the largest |F| + |U| / r in the cells around."""
        cell = np.clip(np.searchsorted(self.edges, r) - 1, 0, self.r.size - 1)
        return np.asarray(self._scale[cell])

    @property
    def typical_energy(self) -> float:
        """The scale of the energy at the typical distance."""
        return float(self.scale(self.length)) * self.length

    def _running_scale(self) -> np.ndarray:
        with np.errstate(all="ignore"):
            here = np.abs(self.force) + np.abs(self.energy) / self.r
        here = np.where(np.isfinite(here), here, 0.0)
        padded = np.pad(here, AROUND, mode="edge")
        windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * AROUND + 1)
        outer = float(np.max(here[self.r >= self.length], initial=0.0))
        return np.maximum(windows.max(axis=1), max(FAINT * outer, SMALLEST_SCALE))

    # --- distances -------------------------------------------------------------------------------

    def _own_lengths(self) -> list[float]:
        """Lengths that the potential declares, else its minima, else 1; in ascending order."""
        declared = sorted({x for part in _parts(self.potential) for x in _declared_lengths(part)})
        if declared:
            return declared
        return self._turning_points(np.geomspace(1e-20, 1e20, 20 * CELLS)) or [1.0]

    def _turning_points(self, r: np.ndarray) -> list[float]:
        """Distances at which repulsion turns into attraction: minima of the energy."""
        _, force = self.compiled(r)
        turns = np.flatnonzero((force[:-1] > 0.0) & (force[1:] < 0.0))
        return [float(x) for x in r[turns]]

    def _within(self, low: float, high: float) -> tuple[float, float]:
        """The ends of the declared domain where it has any, else `low` and `high`."""
        least, largest = self.domain
        low = least if least > 0.0 else min(low, 0.5 * high)
        high = largest if math.isfinite(largest) else max(high, 2.0 * low)
        if math.isfinite(self.cutoff):
            high = min(high, 1.1 * self.cutoff)
        if not low < high:
            raise InputError("domain", f"must not be empty, got r from {low:g} to {high:g}")
        return low, high

    def _typical(self, low: float, high: float) -> float:
        """The first minimum; without one the middle, in ratio."""
        turns = self._turning_points(np.geomspace(low, high, CELLS))
        middle = math.sqrt(low * high)
        if math.isfinite(self.cutoff):
            middle = min(middle, max(NEAR_CUTOFF * self.cutoff, low))
        return turns[0] if turns else middle

    def _without_overflow(self, low: float) -> float:
        """The smallest distance from which on energy and force do not overflow."""
        if self.domain[0] > 0.0:
            return low
        r = np.geomspace(low, self.length, CELLS)
        huge = np.any(np.abs(self.compiled(r)) > LARGEST_NUMBER, axis=0)
        return float(r[min(int(np.flatnonzero(huge)[-1]) + 1, CELLS - 1)]) if huge.any() else low

    def _edges(self) -> np.ndarray:
        """Cells of equal ratio, and finer ones around the typical distance of a short feature.

        Short is a feature of a few percent of the distance.
        """
        edges = np.geomspace(self.low, self.high, CELLS + 1)
        feature = float(self.potential.feature()[0])
        around = np.arange(-FINE_CELLS, FINE_CELLS + 1) / CELLS_PER_FEATURE * feature + self.length
        if not 0.0 < feature / CELLS_PER_FEATURE < self.length * (edges[1] / edges[0] - 1.0):
            return edges
        within = (edges > around[0]) & (edges < around[-1])
        around = around[(around > self.low) & (around < self.high)]
        return np.union1d(edges[~within], around)

    def _special(self) -> set[float]:
        """Distances where a mistake is likely, each with its two neighbours among floats."""
        values = {abs(x) for part in _parts(self.potential) for x in part if isinstance(x, float)}
        values |= {1.0, self.length, self.cutoff}
        pairs = {abs(x + sign * y) for x in values for y in values for sign in (1.0, -1.0)}
        multiples = {m * x for x in values for m in (0.5, 2.0, 3.0, 1.0 / 3.0)}
        inverse = {1.0 / x for x in values if x > 1e-300}
        halves = {0.5 * k for k in range(1, 41)}
        found = {x for x in values | pairs | multiples | inverse | halves if math.isfinite(x)}
        found |= {self.low, self.high}
        near = {y for x in found for y in (np.nextafter(x, 0.0), x, np.nextafter(x, np.inf))}
        return {float(x) for x in near if self.low <= x <= self.high}


def _contact_probe(potential: Potential, count: int) -> ContactProbe:
    """Two surfaces of `count` bobs each, with the potential between them."""
    one = Surface("one", shape=(count, 1), spacing=(1.0, 0.0))
    other = Surface("other", facing="up", shape=(count, 1), spacing=(1.0, 0.0))
    return ContactProbe(Scene((one, other), (Interaction(potential),), 1.0))


def _parts(potential: Any) -> Iterator[Any]:
    """The potential, and every potential that it is made of."""
    yield potential
    for item in potential:
        if isinstance(item, tuple):
            yield from _parts(item)


def _declared_lengths(part: Any) -> list[float]:
    """The distance of a potential's minimum and the lengths over which its force changes."""
    if not hasattr(part, "energy"):
        return []
    lengths = list(part.feature()) if hasattr(part, "feature") else []
    if hasattr(part, "minimum"):
        lengths.append(part.minimum()[0])
    return [float(x) for x in lengths if 0.0 < x < math.inf]


def _domain(potential: Potential) -> tuple[float, float]:
    """The distances for which the potential and all its parts are declared."""
    domains = [part.domain() for part in _parts(potential) if hasattr(part, "domain")]
    least = max([0.0, *(float(low) for low, _ in domains)])
    return least, min([math.inf, *(float(high) for _, high in domains)])
