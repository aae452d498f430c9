"""Samples of a pair as those of a scene, of one run or of several."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.kernels.samples import STORED
from tribo.layout.layout import Layout
from tribo.ledger.accounts import Integrals
from tribo.ledger.lazy import lazy_property
from tribo.ledger.motion import add_reactions
from tribo.ledger.row_products import row_product
from tribo.ledger.samples import Samples, interleaved
from tribo.pair.loop import COLUMNS, ENERGY
from tribo.pair.step_rows import Q1, Q2


@dataclass(frozen=True, eq=False)
class Factors:
    """The factors from a row of the loop's record, with its arcs, to the scene's layout."""

    state: np.ndarray  # (2 coordinates, columns) those of y
    accounts: np.ndarray  # (accounts, columns) those of s
    # Those of linear functions of s by their keys, and the shapes of the functions' values: one
    # vector for one value, with or without an axis, or a table; without the arcs where they have
    # no part.
    linear: dict[Hashable, tuple[np.ndarray, tuple[int, ...]]]
    driven: Layout | None  # the layout of driven bars, on which the reactions are not linear

    def find(self, key: Hashable, function: Callable[[Integrals], np.ndarray]) -> None:
        """Compute the factors of a linear function of s once, and keep them under `key`."""
        factors = function(self.integrals)
        shape = factors.shape[1:]
        if not factors[ENERGY:].any():  # the arcs, which take longer, have no part
            factors = factors[:ENERGY]
        width = factors.size // len(factors)
        factors = factors.reshape((-1, width) if width > 1 else -1)
        self.linear[key] = factors, shape

    @lazy_property
    def integrals(self) -> Integrals:
        """The integrals s of a sample for each column, of which those of a run are combinations."""
        return Integrals(self.accounts.T)

    @lazy_property
    def columns(self) -> np.ndarray:
        """The column of which each coordinate or rate is a multiple, (2 coordinates,)."""
        return np.argmax(np.abs(self.state), axis=1)

    @lazy_property
    def multiples(self) -> np.ndarray:
        """The multiples, (2 coordinates,)."""
        return self.state[np.arange(len(self.state)), self.columns]


class PairSamples(Samples):
    """The samples of a pair, which stay in the loop's record until they are asked for.

    `record` (times x runs, COLUMNS) has rows of the loop's record, and `first` (runs, COLUMNS) the
    first row of each run; `factors` are those of the scene's layout.
    """

    def __init__(
        self, t: np.ndarray, record: np.ndarray, first: np.ndarray, factors: Factors
    ) -> None:
        self.t = t
        self.runs = first.shape[0]
        self._record = record
        self._first = first
        self._factors = factors

    @property
    def linear_alike(self) -> bool:  # type: ignore[override]
        return self._factors.driven is not None

    @lazy_property
    def contact(self) -> np.ndarray:  # type: ignore[override]
        return self._record[:, ENERGY]

    @lazy_property
    def field(self) -> np.ndarray:  # type: ignore[override]
        return np.zeros(self.t.size)

    @lazy_property
    def stored(self) -> np.ndarray:  # type: ignore[override]
        return np.zeros((self.t.size, 2, STORED))

    @lazy_property
    def baths(self) -> np.ndarray:  # type: ignore[override]
        return np.empty((self.t.size, 0, 0))

    @lazy_property
    def y(self) -> np.ndarray:  # type: ignore[override]
        """Coordinates and their rates, (times, 2 coordinates).

        Each is a multiple of one column: a product of matrices takes as long as half of the runs.
        """
        columns: np.ndarray = self._record[:, self._factors.columns]
        return columns * self._factors.multiples

    @lazy_property
    def s(self) -> np.ndarray:  # type: ignore[override]
        s = self._columns @ self._factors.accounts.T
        if self._factors.driven is not None:
            start = self._first[:, self._factors.columns] * self._factors.multiples
            starts = np.tile(start, (self.t.size // self.runs, 1))
            add_reactions(self._factors.driven, self.y, s, starts)
        return s

    def linear(self, key: Hashable, function: Callable[[Integrals], np.ndarray]) -> np.ndarray:
        """The value of a linear function of `s`, from the record's columns that it depends on."""
        if self._factors.driven is not None:
            return function(Integrals(self.s))
        if key not in self._factors.linear:
            self._factors.find(key, function)
        factors, shape = self._factors.linear[key]
        height = factors.shape[0]
        columns = self._record[:, :ENERGY] if height == ENERGY else self._columns
        if factors.ndim > 1:
            return row_product(columns, factors).reshape(-1, *shape)
        # Sums row by row, unlike products of matrices, have the same bits for any number of times.
        values = np.vecdot(columns, factors)
        return values[:, None] if shape else values

    def of_members(self, selected: np.ndarray) -> PairSamples:
        shape = self.t.size // self.runs, self.runs, COLUMNS
        record = self._record.reshape(shape)[:, selected].reshape(-1, COLUMNS)
        first = self._first[selected]
        return PairSamples(self.t[:: self.runs].repeat(len(first)), record, first, self._factors)

    def beside(self, *others: Samples) -> Samples:
        """These samples and those of others, still as a record where all are of pairs."""
        parts = [each for each in (self, *others) if isinstance(each, PairSamples)]
        if not others or len(parts) <= len(others):
            return super().beside(*others)
        runs = [each.runs for each in parts]
        t = interleaved([each.t for each in parts], runs)
        record = interleaved([each._record for each in parts], runs)
        first = np.concatenate([each._first for each in parts])
        return PairSamples(t, record, first, self._factors)

    def with_factors(self, state: np.ndarray, accounts: np.ndarray) -> Samples:
        """The samples where each run has factors of its own, (runs, ..., columns)."""
        columns = self._columns.reshape(-1, self.runs, state.shape[2]).swapaxes(0, 1)
        y, s = (
            (columns @ factors.swapaxes(1, 2)).swapaxes(0, 1).reshape(-1, factors.shape[1])
            for factors in (state, accounts)
        )
        others = self.contact, self.field, self.stored, self.baths
        return Samples.of_runs(self.runs, self.t, y, s, *others)

    def then(self, *later: Samples) -> Samples:
        parts = [each for each in (self, *later) if isinstance(each, PairSamples)]
        if len(parts) <= len(later):
            return super().then(*later)
        t = np.concatenate([each.t for each in parts])
        record = np.concatenate([each._record for each in parts])
        return PairSamples(t, record, self._first, self._factors)

    def rows(self, selected: np.ndarray | slice) -> PairSamples:
        return PairSamples(self.t[selected], self._record[selected], self._first, self._factors)

    def __reduce__(self) -> tuple[Any, ...]:
        return Samples, self.columns

    @lazy_property
    def _columns(self) -> np.ndarray:
        """The record's columns before the energy, and the arcs.

        Those are integrals of q omega sin q: the powers of the end forces are multiples of them.
        """
        q = self._record[:, [Q1, Q2]].reshape(-1, self.runs, 2)
        first = self._first[:, [Q1, Q2]]
        arcs = (np.sin(q) - q * np.cos(q)) - (np.sin(first) - first * np.cos(first))
        return np.concatenate([self._record[:, :ENERGY], arcs.reshape(-1, 2)], axis=1)
