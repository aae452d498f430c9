"""All series of a run side by side, which is the fastest way to compare runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from tribo.layout.layout import Layout
from tribo.ledger.accounts import Integrals
from tribo.ledger.quantities import (
    BLOCK_QUANTITIES,
    OPTIONAL_QUANTITIES,
    needs_accounts,
    present_names,
    reported,
)
from tribo.ledger.totals import AsperiteSeries, Linear, SurfaceSeries, SystemSeries


class SeriesTable(NamedTuple):
    """All series of a run side by side."""

    names: tuple[str, ...]  # of the quantities, "w1", or "upper.w1" for that of one surface
    starts: np.ndarray  # (names,) the first column of each
    values: np.ndarray  # (times, columns)

    def rows(self, selected: slice | np.ndarray) -> SeriesTable:
        return self._replace(values=self.values[selected])

    def largest(self, runs: int = 1) -> np.ndarray:
        """The largest magnitude of each quantity in each of some runs, (names, runs)."""
        each = np.abs(self.values).reshape(-1, runs, self.values.shape[1])
        return np.maximum.reduceat(each.max(axis=0, initial=0.0), self.starts, axis=1).T

    def minus(self, other: SeriesTable) -> SeriesTable:
        """The differences of the series from those of another run at the same times."""
        with np.errstate(invalid="ignore"):  # of two infinite energies
            return self._replace(values=self.values - other.values)


def series_table(layout: Layout, group: AsperiteSeries, names: Iterable[str] = ()) -> SeriesTable:
    """All series of a run, whose `group` is all asperites, and further ones by `names`, "upper.W".

    What is linear in the integrals is computed together: its last bits may differ from one alone.
    """
    items = sorted(_items(layout, group), key=lambda item: not isinstance(item.of, Linear))

    def together(integrals: Integrals) -> np.ndarray:
        count = len(integrals.s)
        linear = ((item, item.of) for item in items if isinstance(item.of, Linear))
        values = [of.value(each, integrals) for item, of in linear for each in item.sources]
        none = np.empty((count, 0))
        return np.concatenate([none, *(value.reshape(count, -1) for value in values)], axis=1)

    values = [group.samples.linear("columns", together)]
    rest = (item for item in items if not isinstance(item.of, Linear))
    series = (item.of(each) for item in rest for each in item.sources)
    values += [each.reshape(len(values[0]), -1) for each in series]
    starts = np.cumsum([0, *(item.width for item in items[:-1])])
    columns = SeriesTable(tuple(i.name for i in items), starts, np.concatenate(values, axis=1))
    return _with(layout, columns, names)


class ReportedSeries(NamedTuple):
    """A reported quantity, and what it is computed from."""

    name: str
    of: Callable[..., np.ndarray]
    sources: Sequence[Any]  # series of asperites, of surfaces, or of the system
    width: int


def _items(layout: Layout, group: AsperiteSeries) -> list[ReportedSeries]:
    samples, scene = group.samples, layout.scene
    (motion,) = group.motions
    wholes = tuple(SurfaceSeries(layout, samples, k, motion) for k in range(len(layout.parts)))
    system = SystemSeries(layout, samples, wholes)
    present = frozenset[str]().union(*(present_names(scene, each) for each in scene.surfaces))
    found = reported(scene.output.ledger, present.intersection(OPTIONAL_QUANTITIES))
    sources = (group,), wholes, (system,)
    widths = scene.count, len(wholes), 1
    tables = found.asperites, found.blocks, found.system
    return [
        ReportedSeries(name, quantity.of, own, width)
        for table, own, width in zip(tables, sources, widths, strict=True)
        for name, quantity in table.items()
    ]


def _with(layout: Layout, columns: SeriesTable, names: Iterable[str]) -> SeriesTable:
    """The columns with further ones, copies of those of single surfaces."""
    for full in names:
        surface, _, name = full.rpartition(".")
        if surface:
            start = int(columns.starts[columns.names.index(name)])
            index = list(layout.parts).index(surface)
            sums = needs_accounts(name) and layout.model.sums is not None
            whole = name in BLOCK_QUANTITIES or sums
            part = slice(index, index + 1) if whole else layout.parts[surface]
            own = columns.values[:, start + part.start : start + part.stop]
            columns = SeriesTable(
                (*columns.names, full),
                np.append(columns.starts, columns.values.shape[1]),
                np.concatenate([columns.values, own], axis=1),
            )
    return columns
