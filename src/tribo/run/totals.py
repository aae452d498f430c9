"""Surfaces and the system, from sums over asperites.  Every array is (times,) unless it is said."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import cached_property

import numpy as np

from tribo.kernels.samples import BATH, MOMENTUM_X, MOMENTUM_Y, SPRINGS, TORSIONAL, WITHIN
from tribo.run.accounts import APPLIED, EXTERNAL, FORCES, Account, accounted
from tribo.run.entry import Entry
from tribo.run.layout import Layout
from tribo.run.motion import batches
from tribo.run.samples import Samples


class Whole:
    """A surface: its asperites, and sums over them; V is the velocity of its centre of all masses.

    Parameters
    ----------
    layout : Layout
        The scene.
    samples : Samples
        The raw samples of a run, the first of which is the start of the run.
    index : int
        Of the surface.

    """

    def __init__(self, layout: Layout, samples: Samples, index: int) -> None:
        self._layout = layout
        self._samples = samples
        self._index = index

    def each(self, value: Callable[[Entry], np.ndarray]) -> np.ndarray:
        """A quantity of all asperites, (times, asperites)."""
        return _side_by_side([value(entry) for entry in self._entries])

    def accounted(self, name: str) -> np.ndarray:
        """A work, a pseudowork or the heat of all asperites, (times, asperites)."""
        return self._linear(
            name,
            lambda s: _side_by_side([accounted(e.batch, s, name) for e in self._entries]),
        )

    def work(self) -> np.ndarray:
        """The work of external forces."""
        return self._linear("W", lambda s: _sum(f.work(self._velocity) for f in self._forces(s, EXTERNAL)))

    def pseudowork(self) -> np.ndarray:
        """The pseudowork of external forces."""

        def value(s: np.ndarray) -> np.ndarray:
            slot = self._record.acc_block
            boost = _sum(force.boost(self._velocity) for force in self._forces(s, EXTERNAL))
            return boost + s[:, slot] if slot >= 0 else boost

        return self._linear("W_ps", value)

    def change_of_kinetic(self) -> np.ndarray:
        """The change of the bulk kinetic energy."""
        vx, vy = self._velocity
        lag_x, lag_y = self._lag
        moving = self._record.total_mass * (vx * lag_x + vy * lag_y) + self._bulk
        return np.asarray(moving - moving[0])

    def change_of_internal(self) -> np.ndarray:
        """The change of the internal energy: of all energy that is not bulk kinetic."""
        within = self._total(lambda e: e.moving + e.internal) - self._bulk
        for store in (SPRINGS, BATH, TORSIONAL, WITHIN):
            within = within + self._stored[:, store]
        return np.asarray(within - within[0])

    def applied(self) -> np.ndarray:
        """The work of outside agents."""
        return self._linear(
            "applied",
            lambda s: _sum(f.work(self._velocity) for f in self._forces(s, APPLIED)),
        )

    @cached_property
    def _entries(self) -> tuple[Entry, ...]:
        layout = self._layout
        return tuple(Entry(layout, b, self._samples) for b in batches(layout, self._index))

    @cached_property
    def _record(self) -> np.record:
        return self._layout.model.surfaces[self._index]

    @property
    def _velocity(self) -> np.ndarray:
        return self._entries[0].batch.velocity

    @property
    def _stored(self) -> np.ndarray:
        return self._samples.stored[:, self._index]

    @cached_property
    def _lag(self) -> tuple[np.ndarray, np.ndarray]:
        """The velocity V in the surface's first frame."""
        mass, stored = self._record.total_mass, self._stored
        px = self._total(lambda e: e.vx * e.batch.asperites.mass) + stored[:, MOMENTUM_X]
        py = self._total(lambda e: e.vy * e.batch.asperites.mass) + stored[:, MOMENTUM_Y]
        return px / mass, py / mass

    @cached_property
    def _bulk(self) -> np.ndarray:
        """The kinetic energy of the motion with V, in the surface's first frame."""
        lag_x, lag_y = self._lag
        return np.asarray(0.5 * self._record.total_mass * (lag_x**2 + lag_y**2))

    def _forces(self, s: np.ndarray, names: tuple[str, ...]) -> Iterator[Account]:
        return (FORCES[name](entry.batch, s) for entry in self._entries for name in names)

    def _total(self, value: Callable[[Entry], np.ndarray]) -> np.ndarray:
        return _sum(map(value, self._entries))

    def _linear(self, name: str, function: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        return self._samples.linear((self._index, name), function)


class System:
    """The whole system.

    Parameters
    ----------
    layout : Layout
        The scene.
    samples : Samples
        The raw samples of a run, the first of which is the start of the run.
    wholes : tuple of Whole
        Its surfaces.
    """

    def __init__(self, layout: Layout, samples: Samples, wholes: tuple[Whole, ...]) -> None:
        self._layout = layout
        self._samples = samples
        self._wholes = wholes

    def contact_energy(self) -> np.ndarray:
        """The potential energy of contacts between surfaces."""
        return self._samples.contact

    def change_of_energy(self) -> np.ndarray:
        """The change of the total energy; that of bobs at one place is infinite."""
        potential = self._samples.contact + self._samples.field
        changes = (w.change_of_kinetic() + w.change_of_internal() for w in self._wholes)
        return np.asarray(sum(changes) + (potential - potential[0]))

    def applied(self) -> np.ndarray:
        """The work of drives, ends, reservoirs and moving fields."""
        slots = [f.account for f in self._layout.model.fields or () if f.account >= 0]
        moving = (self._samples.s[:, slot] for slot in slots)
        return np.asarray(sum(moving, start=sum(whole.applied() for whole in self._wholes)))


def _side_by_side(series: list[np.ndarray]) -> np.ndarray:
    """The series of all asperites, from those of the batches."""
    return series[0] if len(series) == 1 else np.concatenate(series, axis=1)


def _sum(values: Iterable[np.ndarray]) -> np.ndarray:
    """The sum of all, over their asperites.

    Sums, unlike products of matrices, have the same bits for any number of times.
    """
    return np.asarray(sum(np.sum(value, axis=1) for value in values))
