"""The ledger: every reported quantity, from the raw samples of a run.

The identities that must hold, and by which the accounts are audited:

    asperite   w - w_ps = delta_e_int,  w_ps = delta_k_trans
    surface    W_ps = delta_K,  W - W_ps = delta_E_int
    system     total_energy_change = applied_work
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
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
from tribo.run.totals import Linear, Source, System, Whole


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
        self._layout = layout
        self._samples = samples
        # The tables do not refer to the ledger, so that it is released without a collection.
        names = [surface.name for surface in layout.scene.surfaces]
        wholes = tuple(Whole(layout, samples, k) for k in range(len(names)))
        system = System(layout, samples, wholes)
        asperites = [_table(asperite_quantities(layout, w.index), w) for w in wholes]
        blocks = [_table(BLOCK_QUANTITIES, whole) for whole in wholes]
        total = _table(SYSTEM_QUANTITIES, system)
        super().__init__(samples.t, dict(zip(names, asperites)), dict(zip(names, blocks)), total)
        self._sources = (*zip(asperites, wholes), *zip(blocks, wholes), (total, system))

    def compute_linear(self) -> None:
        """Compute all that is linear in the integrals of the kernels together, which is faster.

        The last bits may differ from those of a series that is computed alone.
        """
        wanted = [
            (table, name, linear, source)
            for table, source in self._sources
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

    def at_end(self) -> Ledger:
        """The ledger at the last time alone, from the first and the last sample."""
        return Assembled(self._layout, self._samples.ends()).rows(slice(-1, None))


def _table(quantities: Mapping[str, Quantity[Source]], source: Source) -> Computed:
    """The series of a surface or of the system."""
    return Computed(quantities, lambda name: quantities[name].of(source))


def asperite_quantities(layout: Layout, index: int) -> Mapping[str, Quantity[Whole]]:
    """The quantities that are reported of a surface's asperites."""
    scene, reported = layout.scene, ASPERITE_QUANTITIES
    surface = scene.surfaces[index]
    if scene.fields and any(surface.name in item.on for item in scene.fields):
        reported = reported | FIELD_QUANTITIES
    if surface.langevin:
        reported = reported | RESERVOIR_QUANTITIES
    return reported


def assemble(layout: Layout, samples: Samples) -> Assembled:
    """The ledger of raw samples, the first of which is the start of the run."""
    return Assembled(layout, samples)
