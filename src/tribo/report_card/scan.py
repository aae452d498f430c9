"""The distances at which a potential is checked, its values there, and the scales of errors.

Values come in two ways: from the potential's methods as Python runs them, and *compiled*, through
the kernels and the disk cache that runs use.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.ndimage import maximum_filter1d

from tribo.accuracy.scales import EPSILON
from tribo.analysis.contact_probe import ContactProbe
from tribo.model.asperite import Asperite
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.plugins.classes import parts
from tribo.plugins.sources import is_own
from tribo.potentials.potential import Potential, acting_charges
from tribo.validation import LARGEST_NUMBER, InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

# Cells around the typical distance, in each length over which the force changes.
CELLS_PER_FEATURE = 8
# Number of these cells on either side.
FINE_CELLS = 80
# Energy at which the core begins that no bob reaches [typical energy].
CORE = 1e3
# |F| r of a force that has vanished [typical energy].
VANISHED = 1e-16
# How far distances reach from the typical one at most, inward and outward [ratio].
WIDEST = 1e3
# Number of distances among which the typical one is searched.
SEARCHED = 8000
# How far these reach beyond the potential's own lengths, inward and outward [ratio].
AROUND_OWN = 1e3
# How far they reach, inward and outward, if the potential has no length [ratio, length].
WITHOUT_OWN = 1e20
# Smallest and largest |F| r among which the typical distance is searched: an energy in any unit.
# A product within the force overflows or underflows long before its result does.
IN_ANY_UNIT = (1e-100, 1e100)
# Smallest change of the energy that counts as a step [typical energy].
STEP = 1e-9
# How far the distance of two positions may be rounded below r, out of a domain that begins there.
ROUNDED = 4.0 * EPSILON
# Distance to either side of a parameter at which energies are compared, in search of a step [r].
ASIDE = 1e-6
# And once more, closer: a slope changes the energy less there, and a step as much.
CLOSER = 1e-9
# Cells beyond the distance from which the force has vanished: where it has a kink, it lies there.
BEYOND = 8
# Distances on either side of a minimum at which the force must have one sign, as round-off has not.
SAME_SIGN = 6
# Largest typical distance where there is a cutoff [cutoff].
NEAR_CUTOFF = 0.6
# Smallest scale [energy / length], so that errors of a potential that is zero can be divided by it.
SMALLEST_SCALE = 1e-280
# Smallest scale, relative to the largest at the typical distance and beyond: where the potential
# is fainter, its digits do not matter.
FAINT = 1e-30

# Of distances, energies and forces: where it holds.
Condition = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
Method = Callable[..., Any]


class PotentialScan:
    """A potential, the distances at which it is checked [length], and the scales of its errors.

    Raises InputError if the potential does not compile, raises an exception, or has an empty
    domain.
    """

    def __init__(self, potential: Potential) -> None:
        """Find the distances at which a potential is checked, and its compiled values there."""
        self.potential = potential
        self.cutoff = float(potential.range())  # from which there is no force
        self.charges = acting_charges(potential)
        one, other = (Asperite(charge=charge) for charge in self.charges)
        surfaces = Surface("one", asperite=one), Surface("other", facing="up", asperite=other)
        self._probe = ContactProbe(Scene(surfaces, (Interaction(potential),), 1.0))
        self.domain = _domain(potential)  # for which the potential is declared
        self.length = self._typical()  # that of the first minimum if there is one
        self.low, self.high = self._felt()
        self.edges = self._edges()  # (n + 1,) of cells
        self.r = np.sqrt(self.edges[:-1] * self.edges[1:])  # middles of the cells
        # Compiled U and -dU/dr at r.
        self.energy, self.force = self.compiled(self.r)
        chance = np.random.default_rng(5).uniform(size=self.r.size)
        self.random = self.edges[:-1] + chance * np.diff(self.edges)  # one in each cell
        # Where a mistake is likely: parameters, their sums and multiples, whole and half numbers,
        # the ends.
        self.special = np.array(sorted(self._special()))
        self._scale = self._running_scale()

    @property
    def everywhere(self) -> np.ndarray:
        """All distances of the scan: middles of cells, random and special ones."""
        return np.concatenate([self.r, self.random, self.special])

    @property
    def cells(self) -> tuple[np.ndarray, np.ndarray]:
        """Begins and ends of cells that are searched for jumps and kinks.

        They overlap by half, so that every distance is in the interior of one.  Those around
        parameters are short, so that two steps close to each other are seen.
        """
        x = np.array(sorted(x for x in self._parameters() if self.low < x < self.high))
        begin = np.append(self.edges[:-2], x * (1.0 - ASIDE))
        return begin, np.append(self.edges[2:], x * (1.0 + ASIDE))

    @property
    def methods(self) -> tuple[Method, Method]:
        """Energy and force of a distance and two charges, in Python."""
        return self.potential.energy_between, self.potential.force_between

    @property
    def has_derived_force(self) -> bool:
        """Whether the user's classes, if there are any, define energies and no force."""
        users = [type(part) for part in parts(self.potential) if not is_own(type(part))]
        forces = [getattr(cls, name) for cls in users for name in ("force", "force_between")]
        return bool(users) and all(map(is_own, forces))

    def one_by_one(
        self, method: Method, r: np.ndarray, charges: tuple[float, float] | None = None
    ) -> np.ndarray:
        """Values of a method of the potential at one r after another, in the precision of r.

        They are between two charges, or those of the scan, and nan where the method raises.
        """
        one, other = self.charges if charges is None else charges
        found = np.full(r.shape, np.nan, r.dtype)
        with np.errstate(all="ignore"):
            for i, x in enumerate(r.flat):
                with suppress(Exception):
                    found.flat[i] = method(x, one, other)
        return found

    def python_energies(
        self, r: np.ndarray, charges: tuple[float, float] | None = None
    ) -> np.ndarray:
        """U(r) in the precision of r: of the whole array, or one by one if it takes no arrays.

        It is between two charges, or those of the scan.
        """
        charges = charges or self.charges
        with suppress(Exception):
            energies = np.asarray(self.potential.energy_between(r, *charges))
            if energies.shape == r.shape:
                return energies
        return self.one_by_one(self.potential.energy_between, r, charges)

    def compiled(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """U and -dU/dr at each r, in the shape of r: two bobs at a distance r along x."""
        positions = np.zeros((r.size, 2, 3))
        positions[:, 0, 0] = r.ravel()
        try:
            energies, forces = self._probe(positions, np.tile(self.charges, (r.size, 1)))
        except InputError as error:
            raise InputError("potential", error.problem) from None
        except Exception as error:
            raised = f"{type(self.potential).__name__} raises {type(error).__name__}: {error}"
            problem = f"{raised}; must return nan where it has no energy"
            raise InputError("potential", problem) from None
        return energies.reshape(r.shape), forces[:, 0, 0].reshape(r.shape)

    def compiled_if_possible(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same, with nan at distances for which the potential raises an exception."""
        with suppress(InputError):
            return self.compiled(r)
        energy = np.full(r.shape, np.nan)
        force = np.full(r.shape, np.nan)
        for place in np.ndindex(r.shape):
            with suppress(InputError):
                energy[place], force[place] = self.compiled(r[place])
        return energy, force

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
        around = maximum_filter1d(here, 7, mode="nearest")  # of three cells on either side
        outer = float(np.max(here[self.r >= self.length], initial=0.0))
        return np.maximum(around, max(FAINT * outer, SMALLEST_SCALE))

    def _typical(self) -> float:
        """The first minimum, the largest |F| r, or where |F| r begins to fall faster.

        Without any force it is the largest step of the energy.  Without any of these, the largest
        length that the potential declares; else 1.
        """
        lengths = sorted({x for part in parts(self.potential) for x in _declared_lengths(part)})
        low, high = 1.0 / WITHOUT_OWN, WITHOUT_OWN
        if lengths:
            low, high = lengths[0] / AROUND_OWN, lengths[-1] * AROUND_OWN
        low = max(low, self.domain[0])
        high = min(high, self.domain[1], self.cutoff)
        if not low < high:
            raise InputError("domain", f"must not be empty, got r from {low:g} to {high:g}")
        r = np.geomspace(low, high, SEARCHED)
        turn = self._turning_point(r)
        if turn is not None:
            return turn
        found = self._knee(r) or self._step(r) or (lengths[-1] if lengths else 1.0)
        return min(max(found, low), high if math.isinf(self.cutoff) else NEAR_CUTOFF * self.cutoff)

    def _turning_point(self, r: np.ndarray) -> float | None:
        """The first distance at which repulsion turns into attraction: a minimum of the energy."""
        signs = np.sign(np.nan_to_num(self.compiled(r)[1]))
        windows = np.lib.stride_tricks.sliding_window_view(signs, 2 * SAME_SIGN)
        repulsion = windows[:, :SAME_SIGN]
        attraction = windows[:, SAME_SIGN:]
        turns = np.flatnonzero((repulsion.min(axis=1) > 0.0) & (attraction.max(axis=1) < 0.0))
        if not turns.size:
            return None
        before, after = r[turns[0] + SAME_SIGN - 1 : turns[0] + SAME_SIGN + 1]
        return self._end_of(lambda x, energy, force: force > 0.0, before, after)

    def _knee(self, r: np.ndarray) -> float | None:
        """Where |F| r is largest, or its exponent falls by 1 from that at small distances."""
        torque = r * np.abs(self.compiled(r)[1])
        valid = (torque > IN_ANY_UNIT[0]) & (torque < IN_ANY_UNIT[1])
        r = r[valid]
        torque = torque[valid]
        if r.size < 3:
            return None
        largest = int(np.argmax(torque))
        if largest > 0 and torque[largest] > 1.01 * torque[0]:  # clearly above the first
            return float(r[largest])
        exponent = np.diff(np.log(torque)) / np.diff(np.log(r))
        knee = np.flatnonzero(exponent < exponent[0] - 1.0)
        return float(r[knee[0]]) if knee.size else None

    def _step(self, r: np.ndarray) -> float | None:
        """Where an energy without any force changes most: it has steps, or is constant."""
        beside = [x * (1.0 + side) for x in self._parameters() for side in (-ASIDE, ASIDE)]
        r = np.union1d(r, [x for x in beside if r[0] < x < r[-1]])
        energy, force = self.compiled(r)
        with np.errstate(all="ignore"):
            changes = np.nan_to_num(np.abs(np.diff(energy)), posinf=0.0)
        if np.any(force) or not np.any(changes):
            return None
        return float(r[np.argmax(changes)])

    def _felt(self) -> tuple[float, float]:
        """Distances between the core, or the smallest of all, and where the force has vanished.

        Steps of the energy, at which there is no force, lie between them too.
        """
        near = self.length * np.geomspace(0.9, 1.1, 9)
        energy, force = np.abs(self.compiled(near[near < self.cutoff]))
        size = energy + force * self.length
        unit = float(np.max(size, initial=0.0, where=np.isfinite(size)))
        least, largest = self.domain
        nearest = max(self.length / WIDEST, least * (1.0 + ROUNDED))
        farthest = min(self.length * WIDEST, largest, 1.1 * self.cutoff)
        low = self._core(nearest, unit)
        if math.isfinite(self.cutoff) or math.isfinite(largest):
            return low, farthest
        last = float(self.compiled(np.array([farthest]))[0][0])

        def vanished(r: np.ndarray, energy: np.ndarray, force: np.ndarray) -> np.ndarray:
            changed = np.isfinite(last) & (np.abs(energy - last) > STEP * unit)
            return ~((np.abs(force) * r > VANISHED * unit) | changed)

        high = self._end_of(vanished, farthest, self.length)
        steps = [x * (1.0 + ASIDE) for x in self._parameters() if self._has_step(x, STEP * unit)]
        return low, max(high, 2.0 * self.length, *steps)

    def _core(self, nearest: float, unit: float) -> float:
        """The distance below which the energy exceeds CORE units, as no bob does, or the nearest.

        An energy that jumps beyond is no core: bobs reach a well, and a step is to be found.
        """

        def outside(r: np.ndarray, energy: np.ndarray, force: np.ndarray) -> np.ndarray:
            return ~((np.abs(energy) > CORE * unit) | (np.abs(force) > LARGEST_NUMBER))

        while True:
            low = self._end_of(outside, self.length, nearest)
            within = max(low * (1.0 - ASIDE), nearest)
            before, after = np.abs(self.compiled(np.array([low, within]))[0])
            if not 2.0 * max(before, unit) < after < LARGEST_NUMBER:
                return low
            unit = float(after)

    def _has_step(self, x: float, least: float) -> bool:
        """Whether the energy jumps by more than `least` at x: it changes as much close around x."""
        if not 0.0 < x < WITHOUT_OWN:
            return False
        far, near = (
            float(np.abs(np.diff(self.compiled(x * np.array([1.0 - side, 1.0 + side]))[0]))[0])
            for side in (ASIDE, CLOSER)
        )
        return least < near and far < LARGEST_NUMBER and near > 0.5 * far

    def _parameters(self) -> set[float]:
        """The sizes of the numbers among the fields: any of them may be a length."""
        fields = (x for part in parts(self.potential) for x in part)
        return {abs(x) for x in fields if isinstance(x, float)}

    def _end_of(self, wanted: Condition, start: float, stop: float) -> float:
        """The last distance on the way from `start` to `stop` up to which a condition holds."""
        for _ in range(3):  # each time, of the part that contains the end
            r = np.geomspace(start, stop, 200)
            r[[0, -1]] = start, stop
            holds = wanted(r, *self.compiled(r))
            first = int(np.argmin(holds))
            if holds[first]:
                return stop
            if first == 0:
                return start
            start = float(r[first - 1])
            stop = float(r[first])
        return start

    def _edges(self) -> np.ndarray:
        """Cells of equal ratio, and finer ones around the typical distance of a short feature.

        Short is a feature of a few percent of the distance.
        """
        edges = np.geomspace(self.low, self.high, 501)  # of 500 cells of equal ratio
        if math.isinf(self.cutoff) and math.isinf(self.domain[1]):
            more = np.geomspace(edges[-1 - BEYOND], self.high, 1 + BEYOND)[1:]
            edges = np.append(edges, more * (self.high / edges[-1 - BEYOND]))
        feature = float(self.potential.feature()[0])
        around = np.arange(-FINE_CELLS, FINE_CELLS + 1) / CELLS_PER_FEATURE * feature + self.length
        if not 0.0 < feature / CELLS_PER_FEATURE < self.length * (edges[1] / edges[0] - 1.0):
            return edges
        within = (edges > around[0]) & (edges < around[-1])
        around = around[(around > self.low) & (around < self.high)]
        return np.union1d(edges[~within], around)

    def _special(self) -> set[float]:
        """Distances where a mistake is likely, each with its two neighbours among floats."""
        values = {1.0, self.length, self.cutoff} | self._parameters()
        found = {0.5 * k for k in range(1, 41)}  # whole and half numbers
        for x in values:
            found.update((x, 0.5 * x, 2.0 * x, 3.0 * x, 1.0 / 3.0 * x))
            if x > 1e-300:
                found.add(1.0 / x)
            for y in values:
                found.update((abs(x + y), abs(x - y)))
        found = {x for x in found if math.isfinite(x)} | {self.low, self.high}
        near: set[float] = set()
        for x in found:
            near.update(map(float, (np.nextafter(x, 0.0), x, np.nextafter(x, np.inf))))
        return {x for x in near if self.low <= x <= self.high}


def _declared_lengths(part: Any) -> list[float]:
    """Distances that a potential declares: minimum, feature, range and the ends of its domain."""
    if not hasattr(part, "energy"):
        return []
    lengths: list[float] = []
    for name in ("feature", "domain", "range", "minimum"):
        if hasattr(part, name):
            declared = np.atleast_1d(getattr(part, name)()).astype(float).tolist()
            # A minimum has its depth and curvature behind its distance.
            lengths += declared[:1] if name == "minimum" else declared
    return [x for x in lengths if 0.0 < x < math.inf]


def _domain(potential: Potential) -> tuple[float, float]:
    """The distances for which the potential and all its parts are declared."""
    domains = [part.domain() for part in parts(potential) if hasattr(part, "domain")]
    least = max([0.0, *(float(low) for low, _ in domains)])
    return least, min([math.inf, *(float(high) for _, high in domains)])
