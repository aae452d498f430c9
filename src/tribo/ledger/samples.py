"""The raw samples of one run, or of several runs of a scene, as the time loops record them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from tribo.kernels.samples import STORED
from tribo.layout.layout import Layout
from tribo.ledger.accounts import Integrals
from tribo.ledger.lazy import lazy_property


@dataclass(eq=False)
class Samples:
    """The raw samples of runs of one scene: a row for each time and run, those of a time together.

    The columns are explained in `tribo.layout.layout` and `tribo.kernels.samples`.
    """

    t: np.ndarray  # (times,)
    y: np.ndarray  # (times, 2 core coordinates)
    s: np.ndarray  # (times, accounts)
    contact: np.ndarray  # (times,) energy of contacts between surfaces
    field: np.ndarray  # (times,) energy in external fields
    stored: np.ndarray  # (times, surfaces, STORED)
    baths: np.ndarray  # (times, rows, columns), or (times, 0, 0) where no series needs it

    runs = 1  # how many there are; all have the same times
    # Whether values of linear functions have the same bits beside others as alone.
    linear_alike = True

    @lazy_property
    def contacts(self) -> dict[tuple[Layout, bool], dict[tuple[int, int], np.ndarray]]:
        """Where :func:`tribo.ledger.separation.touching` keeps what it has found of these."""
        return {}

    @classmethod
    def of_runs(cls, runs: int, *columns: np.ndarray) -> Samples:
        """The samples of so many runs, (times x runs, ...) each; the first time is their start."""
        samples = Samples(*columns)
        samples.runs = runs
        return samples

    @classmethod
    def at_zero(cls, layout: Layout) -> Samples:
        """One sample at t = 0, of which all values are zero."""
        columns = sample_columns(layout, 1)
        for column in columns:
            column[...] = 0.0
        return cls(np.zeros(1), *columns)

    def arrays(self) -> dict[str, np.ndarray]:
        """All arrays by the names of the fields."""
        return {name: getattr(self, name) for name in NAMES}

    @property
    def columns(self) -> tuple[np.ndarray, ...]:
        return tuple([getattr(self, name) for name in NAMES])

    def at(self, times: np.ndarray) -> Samples:
        """The samples whose times are among `times`, which ascend."""
        found = are_among(self.t, times)
        return self if np.logical_and.reduce(found) else self.rows(found)

    def rows(self, selected: np.ndarray | slice) -> Samples:
        """The samples of one run at some places: indices, a mask, or a slice, of views."""
        return Samples(*(each[selected] for each in self.columns))

    def first(self) -> Samples:
        return self.rows(np.array([0]))

    def last(self) -> Samples:
        return self.rows(np.array([-1]))

    def last_interval(self, beginning: float = 0.0) -> Samples:
        """The first sample, the first one from `beginning` on, and the last two."""
        last = self.t.size - 1
        return self.rows(np.unique([0, self.index_from(beginning), max(last - 1, 0), last]))

    def index_from(self, time: float) -> int:
        """The index of the first sample from a time on, or else of the last."""
        return min(int(np.searchsorted(self.t, time)), self.t.size - 1)

    def ends(self) -> Samples:
        """The first and the last sample."""
        return self.rows(np.array([0, self.t.size - 1] if self.t.size > 1 else [0]))

    def then(self, *later: Samples) -> Samples:
        """These samples, followed by `later` ones of runs with the same start."""
        columns = zip(*(each.columns for each in (self, *later)), strict=True)
        return Samples(*map(_joined, columns))

    def beside(self, *others: Samples) -> Samples:
        """The samples of these runs and of others at the same times, those of a time together."""
        if not others:
            return self
        runs = [each.runs for each in (self, *others)]
        columns = zip(*(each.columns for each in (self, *others)), strict=True)
        return Samples.of_runs(sum(runs), *(interleaved(each, runs) for each in columns))

    def linear(self, key: Hashable, function: Callable[[Integrals], np.ndarray]) -> np.ndarray:
        """The value of a linear function of the integrals, which `key` tells from others."""
        # In a run that stopped because values were not finite, the last are infinite or NaN.
        with np.errstate(over="ignore", invalid="ignore"):
            return function(Integrals(self.s))

    def of_members(self, selected: np.ndarray) -> Samples:
        """The samples of some of the runs, by their indices or a mask."""
        rows = np.arange(self.t.size).reshape(-1, self.runs)[:, selected]
        samples = self.rows(rows.ravel())
        samples.runs = rows.shape[1]
        return samples

    def at_start(self, series: np.ndarray) -> np.ndarray:
        """A series at the start of each run: a row for each sample, or one for a single run."""
        if self.runs == 1:
            return series[:1]
        return np.concatenate([series[: self.runs]] * (self.t.size // self.runs))

    def change(self, series: np.ndarray) -> np.ndarray:
        """A series of these samples less its value at the start of the run."""
        change: np.ndarray = series - self.at_start(series)
        return change


def are_among(t: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Which of some times `t` are among `times`, which ascend."""
    nearest = np.minimum(times.searchsorted(t), times.size - 1)
    return np.asarray(times[nearest] == t)


# The names of the arrays of samples.
NAMES = tuple(each.name for each in fields(Samples))


def sample_columns(layout: Layout, *shape: int) -> tuple[np.ndarray, ...]:
    """Arrays for the samples of a time loop, whose first axes have a shape; all but the times."""
    return (
        np.empty((*shape, 2 * layout.core)),
        np.empty((*shape, layout.accounts)),
        np.empty(shape),
        np.empty(shape),
        np.zeros((*shape, len(layout.parts), STORED)),
        np.empty((*shape, *layout.sampled_baths)),
    )


def _joined(parts: tuple[np.ndarray, ...]) -> np.ndarray:
    """Arrays one after another; NaN where the first ones do not have what the last has."""
    shape = parts[-1].shape[1:]
    return np.concatenate(
        [p if p.shape[1:] == shape else np.full((len(p), *shape), np.nan) for p in parts]
    )


def interleaved(parts: Sequence[np.ndarray], runs: Sequence[int]) -> np.ndarray:
    """Arrays (times x runs, ...) of several sets of runs as one, the rows of a time together."""
    times = len(parts[0]) // runs[0]
    sets = zip(parts, runs, strict=True)
    together = np.concatenate([each.reshape(times, own, *each.shape[1:]) for each, own in sets], 1)
    return together.reshape(times * sum(runs), *together.shape[2:])
