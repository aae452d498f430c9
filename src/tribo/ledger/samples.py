"""The raw samples of a run, as the time loops record them."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, fields

import numpy as np

from tribo.kernels.samples import STORED
from tribo.layout.layout import Layout


@dataclass(eq=False)
class Samples:
    """The raw samples of a run, one row for each time.

    The columns are explained in `tribo.layout.layout` and `tribo.kernels.samples`.
    """

    t: np.ndarray  # (times,)
    y: np.ndarray  # (times, 2 core coordinates)
    s: np.ndarray  # (times, accounts)
    contact: np.ndarray  # (times,) energy of contacts between surfaces
    field: np.ndarray  # (times,) energy in external fields
    stored: np.ndarray  # (times, surfaces, STORED)
    baths: np.ndarray  # (times, rows, columns), or (times, 0, 0) where no series needs it

    @classmethod
    def at_zero(cls, layout: Layout) -> Samples:
        """One sample at t = 0, of which all values are zero."""
        one = np.zeros(1)
        y, s = np.zeros((1, 2 * layout.core)), np.zeros((1, layout.accounts))
        stored = np.zeros((1, len(layout.parts), STORED))
        return cls(one, y, s, one, one, stored, np.zeros((1, *layout.sampled_baths)))

    def at(self, times: np.ndarray) -> Samples:
        """The samples whose times are among `times`, which ascend."""
        found = times[np.searchsorted(times, self.t).clip(max=times.size - 1)] == self.t
        return self if found.all() else self._rows(found)

    def rows(self, selected: slice) -> Samples:
        """The samples at some places."""
        return self._rows(np.arange(self.t.size)[selected])

    def first(self) -> Samples:
        """The first sample alone."""
        return self._rows(np.array([0]))

    def last(self) -> Samples:
        """The last sample alone."""
        return self._rows(np.array([-1]))

    def last_interval(self) -> Samples:
        """The first sample and the last two."""
        return self._rows(np.unique([0, max(self.t.size - 2, 0), self.t.size - 1]))

    def ends(self) -> Samples:
        """The first and the last sample."""
        return self._rows(np.unique([0, self.t.size - 1]))

    def then(self, *later: Samples) -> Samples:
        """These samples, followed by `later` ones of runs with the same start."""
        values = ([getattr(each, f.name) for each in (self, *later)] for f in fields(Samples))
        return Samples(*map(_joined, values))

    def linear(self, key: Hashable, function: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """The value of a linear function of `s`, which `key` tells from others of the layout."""
        # In a run that stopped because values were not finite, the last are infinite or NaN.
        with np.errstate(over="ignore", invalid="ignore"):
            return function(self.s)

    def at_start(self, series: np.ndarray) -> np.ndarray:
        """The value of a series of these samples at the start of the run."""
        return np.asarray(series[0])

    def change(self, series: np.ndarray) -> np.ndarray:
        """A series of these samples less its value at the start of the run."""
        return np.asarray(series - self.at_start(series))

    def _rows(self, selected: np.ndarray) -> Samples:
        return Samples(*(getattr(self, f.name)[selected] for f in fields(Samples)))


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    """Arrays one after another; NaN where the first ones do not have what the last has."""
    shape = parts[-1].shape[1:]
    return np.concatenate(
        [p if p.shape[1:] == shape else np.full((len(p), *shape), np.nan) for p in parts]
    )
