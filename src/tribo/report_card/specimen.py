"""A potential on the bench: where it is looked at, on what scales, and its values there.

Values come in two ways: *written*, from the methods as Python runs them, and *compiled*, through
the kernels and the disk cache that runs use, bob against bob.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from tribo.kernels.compiled import time_loop
from tribo.kernels.probe import contact_probe
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.plugins import sources
from tribo.plugins.compile_errors import COMPILE_ERRORS, compile_error
from tribo.run.layout import lay_out
from tribo.validation import LARGEST, InputError

CELLS = 400  # of equal ratio, from the least distance looked at to the largest
PER_FEATURE, FINE = 8, 80  # finer cells in each length on which the force changes, each way
INWARD, OUTWARD = 3.0, 6.0  # how far past a potential's own lengths to look
WIDEST = 1e3  # and how far from the typical one at most, whatever the domain
AROUND = 3  # cells on either side, over which a scale is the largest value
NEAR_END = 0.6  # of the range: typical distances are at most that
NOTHING = 1e-280  # the least that a scale can be
FAINT = 1e-30  # of the largest scale at the typical distance and beyond: less counts as that


class Specimen:
    """A potential, the distances from `low` to `high` at which it is looked at, and its scales.

    `edges` (n + 1,) divide them into cells, `r` (n,) lie within the cells, and `special` are those
    at which a slip is likely: parameters, their sums and multiples, whole and half numbers, the
    ends.  `length` is a typical distance, that of a minimum if there is one.
    """

    def __init__(self, potential: Any) -> None:
        self.potential = potential
        self.cutoff = float(potential.range())
        self._bench = {n: _Bench(potential, n) for n in (1, GROUP)}
        lengths = self._own_lengths()
        low, high = lengths[0] / INWARD, lengths[-1] * OUTWARD
        if math.isfinite(self.cutoff):
            high = 1.1 * self.cutoff
        self.declared = _domain(potential)
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

    def written(self, r: Any) -> tuple[Any, Any]:
        """U and -dU/dr between charges of 1, as Python computes them at one r or an array."""
        return (
            self.potential.energy_between(r, 1.0, 1.0),
            self.potential.force_between(r, 1.0, 1.0),
        )

    def written_energy(self, r: Any) -> Any:
        """U(r) as Python computes it, in whatever precision r has; nan where it raises."""
        try:
            return self.potential.energy_between(r, 1.0, 1.0)
        except Exception:
            return np.nan

    def written_force(self, r: Any) -> Any:
        """-dU/dr as Python computes it, in whatever precision r has; nan where it raises."""
        try:
            return self.potential.force_between(r, 1.0, 1.0)
        except Exception:
            return np.nan

    def compiled(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """U and -dU/dr at each r, in the shape of r: two bobs that are r apart along x."""
        places = np.zeros((r.size, 2, 3))
        places[:, 0, 0] = r.ravel()
        energies, forces = self.probe(places, np.ones((r.size, 2)))
        return energies.reshape(r.shape), forces[:, 0, 0].reshape(r.shape)

    def probe(self, places: np.ndarray, charges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Contact energy (k,) and forces (k, n, 2) on bobs at `places` (k, n, 3).

        The first half of the bobs belong to one surface, the others to another.
        """
        return self._bench[places.shape[1] // 2](places, charges)

    # --- scales ----------------------------------------------------------------------------------

    def scale(self, r: Any) -> np.ndarray:
        """What errors of the force at r are relative to: the largest |F| + |U| / r around."""
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
        return np.maximum(windows.max(axis=1), max(FAINT * outer, NOTHING))

    # --- where to look ---------------------------------------------------------------------------

    def _own_lengths(self) -> list[float]:
        """Lengths that the potential knows of, in ascending order; 1 if there is none.

        Those that it declares; otherwise the distances of its minima.
        """
        declared = sorted({x for part in _parts(self.potential) for x in _declared_lengths(part)})
        if declared:
            return declared
        return self._turning_points(np.geomspace(1e-20, 1e20, 20 * CELLS)) or [1.0]

    def _turning_points(self, r: np.ndarray) -> list[float]:
        """Where a push turns into a pull: minima of the energy."""
        _, force = self.compiled(r)
        turns = np.flatnonzero((force[:-1] > 0.0) & (force[1:] < 0.0))
        return [float(x) for x in r[turns]]

    def _within(self, low: float, high: float) -> tuple[float, float]:
        """Distances to look at: as far as the declared domain has ends, those."""
        least, largest = self.declared
        low = least if least > 0.0 else min(low, 0.5 * high)
        high = largest if math.isfinite(largest) else max(high, 2.0 * low)
        if math.isfinite(self.cutoff):
            high = min(high, 1.1 * self.cutoff)
        if not low < high:
            raise InputError("domain", f"has nothing between r = {low:g} and {high:g}")
        return low, high

    def _typical(self, low: float, high: float) -> float:
        """The first distance at which push turns into pull; else the middle."""
        turns = self._turning_points(np.geomspace(low, high, CELLS))
        middle = math.sqrt(low * high)
        if math.isfinite(self.cutoff):
            middle = min(middle, max(NEAR_END * self.cutoff, low))
        return turns[0] if turns else middle

    def _without_overflow(self, low: float) -> float:
        """The least distance to look at, farther out than where energy or force grow too large."""
        if self.declared[0] > 0.0:
            return low
        r = np.geomspace(low, self.length, CELLS)
        huge = np.any(np.abs(self.compiled(r)) > LARGEST, axis=0)
        return float(r[min(int(np.flatnonzero(huge)[-1]) + 1, CELLS - 1)]) if huge.any() else low

    def _edges(self) -> np.ndarray:
        """Cells of equal ratio, and finer ones about the typical distance if the force asks for it.

        That is where it changes within a few percent of the distance.
        """
        edges = np.geomspace(self.low, self.high, CELLS + 1)
        feature = float(self.potential.feature()[0])
        around = np.arange(-FINE, FINE + 1) / PER_FEATURE * feature + self.length
        if not 0.0 < feature / PER_FEATURE < self.length * (edges[1] / edges[0] - 1.0):
            return edges
        within = (edges > around[0]) & (edges < around[-1])
        around = around[(around > self.low) & (around < self.high)]
        return np.union1d(edges[~within], around)

    def _special(self) -> set[float]:
        """Distances at which a slip is likely, each with its two neighbours among floats."""
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


GROUP = 3  # bobs a surface, where one pair is not enough


class _Bench:
    """Two surfaces of `count` bobs each, to be put where one likes."""

    def __init__(self, potential: Any, count: int) -> None:
        row = {"shape": (count, 1), "spacing": (1.0, 0.0)}
        surfaces = (Surface("one", **row), Surface("other", facing="up", **row))  # type: ignore
        self._layout = lay_out(Scene(surfaces, potential, 1.0))
        stamp = sources.source_stamp(self._layout.plugins)
        self._name = type(potential).__name__
        self._probe: Callable[..., None] = time_loop(contact_probe, stamp)

    def __call__(self, places: np.ndarray, charges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        energies, forces = np.empty(len(places)), np.empty((*places.shape[:2], 2))
        try:
            self._probe(self._layout.model, places, charges, energies, forces)
        except COMPILE_ERRORS as error:
            raise InputError(
                "potential", compile_error(self._layout.named_plugins, error).problem
            ) from None
        except Exception as error:
            reason = f"{self._name} raises {type(error).__name__}: {error}"
            raise InputError("potential", f"{reason}; give nan where there is no energy") from None
        return energies, forces


def _parts(potential: Any) -> Iterator[Any]:
    """The potential, and every other that it is made of."""
    yield potential
    for item in potential:
        if isinstance(item, tuple):
            yield from _parts(item)


def _declared_lengths(part: Any) -> list[float]:
    """Where a potential says that its minimum is, and on what lengths its force changes."""
    if not hasattr(part, "energy"):
        return []
    lengths = list(part.feature()) if hasattr(part, "feature") else []
    if hasattr(part, "minimum"):
        lengths.append(part.minimum()[0])
    return [float(x) for x in lengths if 0.0 < x < math.inf]


def _domain(potential: Any) -> tuple[float, float]:
    """The distances for which the potential, and all that it is made of, are meant."""
    domains = [part.domain() for part in _parts(potential) if hasattr(part, "domain")]
    least = max([0.0, *(float(low) for low, _ in domains)])
    return least, min([math.inf, *(float(high) for _, high in domains)])
