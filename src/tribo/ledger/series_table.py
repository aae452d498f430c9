"""All series of a run side by side, which is the fastest way to compare runs."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from typing import NamedTuple

import numpy as np

from tribo.layout.layout import Layout, once_per_layout
from tribo.ledger.accounts import Integrals
from tribo.ledger.quantities import BLOCK_QUANTITIES, OPTIONAL_QUANTITIES
from tribo.ledger.reported import needs_accounts, present_names, reported
from tribo.ledger.totals import (
    AsperiteSeries,
    Linear,
    Moving,
    Summed,
    SurfaceSeries,
    SystemSeries,
)

# What the formula of a column takes: the motion of all asperites, these, each surface, the system.
MOTION, ASPERITES, SURFACES, SYSTEM = range(4)


class SeriesTable(NamedTuple):
    """All series of a run side by side."""

    names: tuple[str, ...]  # of the quantities, "w1", or "upper.w1" for that of one surface
    starts: np.ndarray  # (names,) the first column of each
    values: np.ndarray  # (times, columns)

    def rows(self, selected: slice | np.ndarray) -> SeriesTable:
        return SeriesTable(self.names, self.starts, self.values[selected])

    def largest(self, runs: int = 1) -> np.ndarray:
        """The largest magnitude of each quantity in each of some runs, (names, runs)."""
        each = np.abs(self.values).reshape(-1, runs, self.values.shape[1])
        highest = np.maximum.reduce(each, axis=0, initial=0.0)
        return np.maximum.reduceat(highest, self.starts, axis=1).T

    def minus(self, other: SeriesTable) -> SeriesTable:
        """The differences of the series from those of another run at the same times."""
        with np.errstate(invalid="ignore"):  # of two infinite energies
            return SeriesTable(self.names, self.starts, self.values - other.values)


def series_table(
    layout: Layout,
    group: AsperiteSeries,
    names: Iterable[str] = (),
    only: Collection[str] | None = None,
) -> SeriesTable:
    """All series of a run, whose `group` is all asperites, and further ones by `names`, "upper.W".

    What is linear in the integrals is computed together: its last bits may differ from one alone.
    Quantities that are not among `only` are left out, if that is given, where this changes no bits.
    """
    of = _columns(layout)
    samples = group.samples
    (motion,) = group.motions
    if only is not None:
        of = of.of_some(only, samples.linear_alike)
    wholes = tuple([SurfaceSeries(layout, samples, k, motion) for k in range(len(layout.parts))])
    sources = (motion,), (group,), wholes, (SystemSeries(layout, samples, wholes),)

    def together(integrals: Integrals) -> np.ndarray:
        count = len(integrals.s)
        values = [value(each, integrals) for value, kind in of.linear for each in sources[kind]]
        none = np.empty((count, 0))
        return np.concatenate([none, *(value.reshape(count, -1) for value in values)], axis=1)

    columns = [samples.linear("columns", together)]
    # In a run that stopped because values were not finite, the last are infinite or NaN.
    with np.errstate(over="ignore", invalid="ignore"):
        series = [value(each) for value, kind in of.others for each in sources[kind]]
    columns += [each if each.ndim == 2 else each[:, None] for each in series]
    table = SeriesTable(of.names, of.starts, np.concatenate(columns, axis=1))
    return _with(layout, table, names)


class Columns(NamedTuple):
    """What the columns of a layout's tables are, whichever the run: the linear quantities first."""

    names: tuple[str, ...]  # of the quantities
    widths: tuple[int, ...]  # (names,) columns of each
    starts: np.ndarray  # (names,) the first of these
    linear: tuple[tuple[Callable[..., np.ndarray], int], ...]  # formulas, and what they take
    others: tuple[tuple[Callable[..., np.ndarray], int], ...]

    def of_some(self, names: Collection[str], of_linear: bool) -> Columns:
        """Those of the quantities that are named, and all linear ones unless some `of_linear`."""
        count = 0 if of_linear else len(self.linear)
        chosen = [k for k, name in enumerate(self.names) if k < count or name in names]
        linear = [k for k in chosen if k < len(self.linear)]
        others = chosen[len(linear) :]
        widths = tuple([self.widths[k] for k in chosen])
        return Columns(
            names=tuple([self.names[k] for k in chosen]),
            widths=widths,
            starts=_starts(widths),
            linear=tuple([self.linear[k] for k in linear]),
            others=tuple([self.others[k - len(self.linear)] for k in others]),
        )


def _starts(widths: tuple[int, ...]) -> np.ndarray:
    """The first column of each of some quantities, from their numbers of columns."""
    return np.cumsum((0, *widths[:-1]))


def names_with_accuracy(layout: Layout) -> tuple[str, ...]:
    """The quantities that runs of a scene are compared by."""
    return _columns(layout).names


@once_per_layout
def _columns(layout: Layout) -> Columns:
    """The columns of the quantities that a scene reports."""
    scene = layout.scene
    present = frozenset[str]().union(*(present_names(scene, each) for each in scene.surfaces))
    found = reported(scene.output.ledger, present.intersection(OPTIONAL_QUANTITIES))
    tables = {ASPERITES: found.asperites, SURFACES: found.blocks, SYSTEM: found.system}
    widths = {ASPERITES: scene.count, SURFACES: len(layout.parts), SYSTEM: 1}
    each = [(name, one.of, kind) for kind, table in tables.items() for name, one in table.items()]
    each.sort(key=lambda item: not isinstance(item[1], Linear))
    linear = []
    others = []
    for _, of, kind in each:
        if isinstance(of, Linear):
            linear.append((of.value, kind))
        elif isinstance(of, Moving):
            others.append((of.value, MOTION))
        else:
            others.append((of.value if isinstance(of, Summed) else of, kind))
    columns = tuple([widths[kind] for _, _, kind in each])
    return Columns(
        names=tuple([name for name, _, _ in each]),
        widths=columns,
        starts=_starts(columns),
        linear=tuple(linear),
        others=tuple(others),
    )


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
