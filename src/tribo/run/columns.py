"""All series of a run side by side, which is the fastest way to compare runs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from tribo.run.accounts import Integrals
from tribo.run.layout import Layout
from tribo.run.ledger import OF_SURFACE
from tribo.run.quantities import BLOCK_QUANTITIES, QUANTITIES, SYSTEM_QUANTITIES
from tribo.run.totals import Group, Linear, System, Whole


class Columns(NamedTuple):
    """All series of a run side by side.

    Attributes
    ----------
    names : tuple of str
        Of the quantities, "w1", or "upper.w1" for that of one surface.
    starts : ndarray, (names,)
        The first column of each.
    values : ndarray, (times, columns)
        The series.
    """

    names: tuple[str, ...]
    starts: np.ndarray
    values: np.ndarray

    def rows(self, selected: slice | np.ndarray) -> Columns:
        """The same series at some of the times."""
        return self._replace(values=self.values[selected])

    def largest(self) -> np.ndarray:
        """The largest magnitude of each quantity, (names,)."""
        return np.maximum.reduceat(np.abs(self.values).max(axis=0, initial=0.0), self.starts)

    def minus(self, other: Columns) -> Columns:
        """The differences of the series from those of another run at the same times."""
        return self._replace(values=self.values - other.values)


def columns_of(layout: Layout, group: Group, names: Iterable[str] = ()) -> Columns:
    """All series of a run, and further ones by `names`, as "upper.W".

    Those that are linear in the integrals of the kernels are computed together; their last bits may
    differ from those of a series that is computed alone.

    Parameters
    ----------
    layout
        the scene
    group
        all asperites
    names
        of further quantities
    """
    samples = group.samples
    wholes = tuple(Whole(layout, samples, k) for k in range(len(layout.parts)))
    system = (System(layout, samples, wholes),)
    _, fields, reservoirs = zip(*layout.effects.values(), strict=True)
    linear, other = [], []
    for name in [*OF_SURFACE[any(fields), any(reservoirs)], *SYSTEM_QUANTITIES]:
        sources = wholes if name in BLOCK_QUANTITIES else (group,)
        sources = system if name in SYSTEM_QUANTITIES else sources
        quantity = QUANTITIES[name].of
        (linear if isinstance(quantity, Linear) else other).append((name, quantity, sources))

    def together(s: np.ndarray) -> np.ndarray:
        integrals = Integrals(s)
        series = [of.value(source, integrals) for _, of, sources in linear for source in sources]
        return np.concatenate([each.reshape(len(s), -1) for each in series], axis=1)

    with np.errstate(over="ignore", invalid="ignore"):
        first = samples.linear("columns", together)
        rest = [
            of(source).reshape(len(first), -1) for _, of, sources in other for source in sources
        ]
    values = np.concatenate([first, *rest], axis=1)
    widths = [
        len(sources) if sources[0] is not group else layout.scene.count
        for _, _, sources in [*linear, *other]
    ]
    found = tuple(name for name, _, _ in [*linear, *other])
    return _with(layout, Columns(found, np.cumsum([0, *widths[:-1]]), values), names)


def _with(layout: Layout, columns: Columns, names: Iterable[str]) -> Columns:
    """The columns with further ones, copies of those of single surfaces."""
    for full in names:
        surface, _, name = full.rpartition(".")
        if surface:
            start = int(columns.starts[columns.names.index(name)])
            index = layout.effects[surface][0]
            part = slice(index, index + 1) if name in BLOCK_QUANTITIES else layout.parts[surface]
            own = columns.values[:, start + part.start : start + part.stop]
            columns = Columns(
                (*columns.names, full),
                np.append(columns.starts, columns.values.shape[1]),
                np.concatenate([columns.values, own], axis=1),
            )
    return columns
