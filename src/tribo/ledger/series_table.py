"""All series of a run side by side, which is the fastest way to compare runs."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tribo.layout.layout import Layout, once_per_scene
from tribo.ledger.accounts import Integrals
from tribo.ledger.quantities import BLOCK_QUANTITIES, OPTIONAL_QUANTITIES
from tribo.ledger.reported import Reported, names_by_surface, needs_accounts, reported
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
# Kinds of scenes, and choices of quantities, whose columns are kept.
COLUMNS_KEPT = 64


class SeriesTable(NamedTuple):
    """All series of a run side by side."""

    names: tuple[str, ...]  # of the quantities, "w1", or "upper.w1" for that of one surface
    starts: np.ndarray  # (names,) the first column of each
    values: np.ndarray  # (times, columns)

    def largest(self, values: np.ndarray, runs: int = 1) -> np.ndarray:
        """The largest magnitude of each quantity in each of some runs, (names, runs).

        The `values` are some of those here, or their differences, (..., columns).
        """
        each = np.abs(values).reshape(-1, runs, values.shape[-1])
        highest = np.maximum.reduce(each, axis=0, initial=0.0)
        return np.maximum.reduceat(highest, self.starts, axis=1).T


def series_table(
    layout: Layout,
    group: AsperiteSeries,
    names: tuple[str, ...] = (),
    only: frozenset[str] | None = None,
) -> SeriesTable:
    """All series of a run, whose `group` is all asperites, and further ones by `names`, "upper.W".

    What is linear in the integrals is computed together: its last bits may differ from one alone.
    Quantities that are not among `only` are left out, if that is given, where this changes no bits.
    """
    samples = group.samples
    (motion,) = group.motions
    of = _columns(layout, names, only, samples.linear_alike)
    wholes = tuple([SurfaceSeries(layout, samples, k, motion) for k in range(len(layout.parts))])
    sources = (motion,), (group,), wholes, (SystemSeries(layout, samples, wholes),)

    def together(integrals: Integrals) -> np.ndarray:
        count = len(integrals.s)
        values = [value(each, integrals) for value, kind in of.linear for each in sources[kind]]
        none = np.empty((count, 0))
        return np.concatenate([none, *[value.reshape(count, -1) for value in values]], axis=1)

    columns = [samples.linear("columns", together)]
    # In a run that stopped because values were not finite, the last are infinite or NaN.
    with np.errstate(over="ignore", invalid="ignore"):
        series = [value(each) for value, kind in of.others for each in sources[kind]]
    columns += [each if each.ndim == 2 else each[:, None] for each in series]
    values = np.concatenate(columns, axis=1)
    if of.copied.size > 0:
        values = np.concatenate([values, values[:, of.copied]], axis=1)
    return SeriesTable(of.names, of.starts, values)


class Columns(NamedTuple):
    """What the columns of a layout's tables are, whichever the run: the linear quantities first."""

    names: tuple[str, ...]  # of the quantities
    widths: tuple[int, ...]  # (names,) columns of each
    starts: np.ndarray  # (names,) the first of these
    linear: tuple[tuple[Callable[..., np.ndarray], int], ...]  # formulas, and what they take
    others: tuple[tuple[Callable[..., np.ndarray], int], ...]
    copied: np.ndarray  # columns that follow once more, as those of "upper.w1" alone

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
            copied=self.copied,
        )

    def with_copies(self, names: tuple[str, ...], of_each: list[np.ndarray]) -> Columns:
        """The same with quantities of single surfaces, whose columns among all are given."""
        widths = (*self.widths, *map(len, of_each))
        return self._replace(
            names=(*self.names, *names),
            widths=widths,
            starts=_starts(widths),
            copied=np.concatenate([self.copied, *of_each]),
        )


def _starts(widths: tuple[int, ...]) -> np.ndarray:
    """The first column of each of some quantities, from their numbers of columns."""
    return np.cumsum((0, *widths[:-1]))


def names_with_accuracy(layout: Layout) -> tuple[str, ...]:
    """The quantities that runs of a scene are compared by."""
    return _columns_of(_kind_of(layout)).names


class Kind(NamedTuple):
    """What the columns of a layout depend on."""

    reported: Reported  # quantities with an accuracy
    parts: tuple[tuple[str, int, int], ...]  # surfaces: names, and places of their asperites
    sums: bool  # works are sums over surfaces


@once_per_scene
def _kind_of(layout: Layout) -> Kind:
    present = frozenset[str]().union(*names_by_surface(layout)).intersection(OPTIONAL_QUANTITIES)
    parts = tuple([(name, part.start, part.stop) for name, part in layout.parts.items()])
    found = reported(layout.scene.output.ledger, present)
    return Kind(found, parts, layout.model.sums is not None)


def _columns(
    layout: Layout, names: tuple[str, ...], only: frozenset[str] | None, linear_alike: bool
) -> Columns:
    """The columns of the quantities that a scene reports, or of `only` some, and further ones."""
    kind = _kind_of(layout)
    if not names and only is None:
        return _columns_of(kind)
    return _columns_with(kind, names, only, linear_alike)


@lru_cache(COLUMNS_KEPT)
def _columns_with(
    kind: Kind, names: tuple[str, ...], only: frozenset[str] | None, linear_alike: bool
) -> Columns:
    """The same for scenes of one kind."""
    found = _columns_of(kind)
    if only is not None:
        found = found.of_some(only, linear_alike)
    places = {name: (k, start, stop) for k, (name, start, stop) in enumerate(kind.parts)}
    chosen: list[str] = []
    copied: list[np.ndarray] = []
    for full in names:
        surface, _, name = full.rpartition(".")
        if surface:
            index, start, stop = places[surface]
            if name in BLOCK_QUANTITIES or (needs_accounts(name) and kind.sums):
                start = index
                stop = index + 1
            chosen.append(full)
            copied.append(found.starts[found.names.index(name)] + np.arange(start, stop))
    return found.with_copies(tuple(chosen), copied)


@lru_cache(COLUMNS_KEPT)
def _columns_of(kind: Kind) -> Columns:
    """The columns of all quantities of scenes of one kind."""
    found = kind.reported
    tables = {ASPERITES: found.asperites, SURFACES: found.blocks, SYSTEM: found.system}
    widths = {ASPERITES: kind.parts[-1][2], SURFACES: len(kind.parts), SYSTEM: 1}
    each = [(name, one.of, taken) for taken, table in tables.items() for name, one in table.items()]
    each.sort(key=lambda item: not isinstance(item[1], Linear))
    linear = []
    others = []
    for _, of, taken in each:
        if isinstance(of, Linear):
            linear.append((of.value, taken))
        elif isinstance(of, Moving):
            others.append((of.value, MOTION))
        else:
            others.append((of.value if isinstance(of, Summed) else of, taken))
    columns = tuple([widths[taken] for _, _, taken in each])
    return Columns(
        names=tuple([name for name, _, _ in each]),
        widths=columns,
        starts=_starts(columns),
        linear=tuple(linear),
        others=tuple(others),
        copied=np.empty(0, int),
    )
