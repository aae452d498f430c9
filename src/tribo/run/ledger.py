"""The ledger: every reported quantity, from the raw samples of a run.

The identities that must hold, and by which the accounts are audited:

    asperite   w - w_ps = delta_e_int,  w_ps = delta_k_trans
    surface    W_ps = delta_K,  W - W_ps = delta_E_int
    system     total_energy_change = applied_work
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tribo.run.accounts import Integrals
from tribo.run.layout import Layout
from tribo.run.quantities import (
    ASPERITE_QUANTITIES,
    BLOCK_QUANTITIES,
    FIELD_QUANTITIES,
    QUANTITIES,
    RESERVOIR_QUANTITIES,
    SYSTEM_QUANTITIES,
    Quantity,
    Table,
)
from tribo.run.samples import Samples
from tribo.run.totals import Linear, System, Whole


class Computed(Mapping[str, np.ndarray]):
    """Series by name, each computed when it is first asked for.

    Parameters
    ----------
    names : iterable of str
        Of the quantities.
    compute : callable
        Computes the series of a name.
    """

    def __init__(self, names: Iterable[str], compute: Callable[[str], np.ndarray]) -> None:
        self._names = names if isinstance(names, dict) else dict.fromkeys(names)
        self._compute = compute
        self._known: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        known = self._known.get(name)
        if known is None:
            if name not in self._names:
                raise KeyError(name)
            # In a run that stopped because values were not finite, the last are infinite or NaN.
            with np.errstate(over="ignore", invalid="ignore"):
                known = self._known[name] = self._compute(name)
        return known

    def put(self, name: str, series: np.ndarray) -> None:
        """Set a series that has been computed with others."""
        self._known[name] = series

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (dict(self),)


@dataclass(eq=False)
class Ledger:
    """All quantities that a run reports, in the laboratory.

    Attributes
    ----------
    t : ndarray, (times,)
        The recorded times.
    surfaces : mapping
        Surface -> quantity -> (times, asperites).
    blocks : mapping
        Surface -> quantity of the surface as a whole -> (times,).
    system : mapping
        Quantity of the system -> (times,).
    """

    t: np.ndarray  # (times,)
    surfaces: Mapping[str, Table]  # surface -> quantity -> (times, asperites)
    blocks: Mapping[str, Table]  # surface -> quantity -> (times,)
    system: Table  # quantity -> (times,)

    def series(self, name: str) -> list[np.ndarray]:
        """All series of a quantity, "w1", or that of one surface, "upper.w1"."""
        surface, _, name = name.rpartition(".")
        tables = [self.system, *self.surfaces.values(), *self.blocks.values()]
        if surface:
            tables = [self.surfaces.get(surface, {}), self.blocks.get(surface, {})]
        return [table[name] for table in tables if name in table]

    @property
    def names(self) -> list[str]:
        """The quantities of which there are series."""
        tables = [*self.surfaces.values(), *self.blocks.values(), self.system]
        return [name for name in QUANTITIES if any(name in table for table in tables)]

    def rows(self, selected: slice | np.ndarray) -> Ledger:
        """The ledger at some of its times: a slice, indices or a mask."""

        def rows_of(table: Table) -> Table:
            return Computed(table, lambda name: table[name][selected])

        return Ledger(
            self.t[selected],
            {name: rows_of(table) for name, table in self.surfaces.items()},
            {name: rows_of(table) for name, table in self.blocks.items()},
            rows_of(self.system),
        )

    def at_end(self) -> Ledger:
        """The ledger at the last time alone."""
        return self.rows(slice(-1, None))

    def __reduce__(self) -> tuple[Any, ...]:
        return Ledger, (self.t, dict(self.surfaces), dict(self.blocks), self.system)


class Assembled(Ledger):
    """The ledger of raw samples; each series is computed when it is first asked for.

    Parameters
    ----------
    layout : Layout
        The scene.
    samples : Samples
        The raw samples of a run, the first of which is the start of the run.
    """

    def __init__(self, layout: Layout, samples: Samples) -> None:
        surfaces = layout.scene.surfaces
        super().__init__(
            samples.t,
            {s.name: self._of(k, asperite_quantities(layout, k)) for k, s in enumerate(surfaces)},
            {s.name: self._of(k, BLOCK_QUANTITIES) for k, s in enumerate(surfaces)},
            Computed(SYSTEM_QUANTITIES, lambda name: SYSTEM_QUANTITIES[name].of(self._system)),
        )
        self._layout = layout
        self._samples = samples

    def compute_linear(self) -> None:
        """Compute all that is linear in the integrals of the kernels together, which is faster.

        The last bits may differ from those of a series that is computed alone.
        """
        wanted = [
            (table, name, linear, source)
            for table, source in self._sources()
            for name in table
            if isinstance(linear := QUANTITIES[name].of, Linear)
        ]

        def together(s: np.ndarray) -> np.ndarray:
            integrals = Integrals(self._layout, s)
            values = [linear.value(source, integrals) for _, _, linear, source in wanted]
            return np.concatenate([value.reshape(len(s), -1) for value in values], axis=1)

        values, stop = self._samples.linear("all", together), 0
        for table, name, _, source in wanted:
            if name in BLOCK_QUANTITIES or name in SYSTEM_QUANTITIES:
                table.put(name, values[:, stop])
                stop += 1
            else:
                start, stop = stop, stop + source.count
                table.put(name, values[:, start:stop])

    def _sources(self) -> Iterator[tuple[Computed, Whole | System]]:
        for index, name in enumerate(self.surfaces):
            yield self.surfaces[name], self._wholes[index]
            yield self.blocks[name], self._wholes[index]
        yield self.system, self._system

    def at_end(self) -> Ledger:
        """The ledger at the last time alone, from the first and the last sample."""
        return Assembled(self._layout, self._samples.ends()).rows(slice(-1, None))

    def _of(self, index: int, quantities: Mapping[str, Quantity[Whole]]) -> Table:
        """The series of a surface or of its asperites."""
        return Computed(quantities, lambda name: quantities[name].of(self._wholes[index]))

    @cached_property
    def _wholes(self) -> tuple[Whole, ...]:
        layout, samples = self._layout, self._samples
        return tuple(Whole(layout, samples, k) for k in range(len(layout.scene.surfaces)))

    @cached_property
    def _system(self) -> System:
        return System(self._layout, self._samples, self._wholes)


def asperite_quantities(layout: Layout, index: int) -> Mapping[str, Quantity[Whole]]:
    """The quantities that are reported of a surface's asperites."""
    surface, reported = layout.scene.surfaces[index], ASPERITE_QUANTITIES
    if any(surface.name in item.on for item in layout.scene.fields):
        reported = reported | FIELD_QUANTITIES
    if surface.langevin:
        reported = reported | RESERVOIR_QUANTITIES
    return reported


def assemble(layout: Layout, samples: Samples) -> Assembled:
    """The ledger of raw samples, the first of which is the start of the run."""
    return Assembled(layout, samples)
