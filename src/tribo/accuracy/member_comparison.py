"""Finer runs of members, with which any number of other runs of the same members are compared."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from tribo.accuracy.comparison import Accuracy, observables
from tribo.accuracy.scales import Scales, largest_of_runs, scales_of
from tribo.layout.layout import Layout
from tribo.ledger.motion import mean_velocity
from tribo.ledger.samples import Samples
from tribo.ledger.series_table import SeriesTable, series_table
from tribo.ledger.totals import AsperiteSeries
from tribo.loops.batch import MemberRuns

# Times at which members are compared, at most: comparisons at 401 took longer than the runs.
MOST_COMPARED = 65


class FineRuns:
    """Fine runs of some members: their series, and the scales of errors.

    Both are computed once, and serve all comparisons.
    """

    def __init__(self, runs: MemberRuns, accuracy: Accuracy) -> None:
        layout, samples = _at_few_times(runs)
        self._complete, self._members = runs.complete, samples.runs
        self._names = observables(accuracy)
        group = self._group(layout, samples)
        columns = series_table(layout, group, self._names)
        names = columns.names
        tops = dict(zip(names, columns.largest(samples.runs), strict=True))
        (motion,), mean = group.motions, mean_velocity(layout)
        speed, internal, path = (
            largest_of_runs(each, samples.runs)
            for each in (motion.bob_speed(mean), motion.energy, motion.bob_path(mean))
        )
        self.scales: Scales = scales_of(layout, tops, speed, internal, path)
        asked = accuracy if isinstance(accuracy, Mapping) else dict.fromkeys(names, accuracy)
        self._compared = [name in asked for name in names]
        units = [asked[name] * self.scales.of(name) for name in names if name in asked]
        once = layout, columns, np.stack(np.broadcast_arrays(*units, speed)[:-1])
        # The layout, the series and the units (names, members) of all members so many times.
        self._repeated: dict[int, tuple[Layout, SeriesTable, np.ndarray]] = {1: once}

    def excess(self, *others: MemberRuns) -> np.ndarray:
        """The largest differences of other runs in units of the accuracy, (others, members).

        They are infinite if a run stopped, or a difference is not finite.
        """
        number = len(others)
        first, *rest = (_at_few_times(runs)[1] for runs in others)
        samples = first.beside(*rest)
        if number not in self._repeated:
            self._repeated[number] = self._repeat(number)
        layout, mine, units = self._repeated[number]
        theirs = series_table(layout, self._group(layout, samples), self._names)
        gaps = mine.minus(theirs).largest(samples.runs)[self._compared]
        with np.errstate(divide="ignore", invalid="ignore"):
            relative = np.where(gaps == 0.0, 0.0, gaps / units)
        worst = relative.max(axis=0, initial=0.0).reshape(number, self._members)
        complete = self._complete & [runs.complete for runs in others]
        return np.where(complete & np.isfinite(worst), worst, np.inf)

    @staticmethod
    def _group(layout: Layout, samples: Samples) -> AsperiteSeries:
        return AsperiteSeries(layout, samples, (layout.together,))

    def _repeat(self, number: int) -> tuple[Layout, SeriesTable, np.ndarray]:
        """All members so many times, as in samples of runs side by side."""
        layout, columns, units = self._repeated[1]
        if layout.numbers is not None:
            members = np.tile(np.arange(self._members), number)
            layout = replace(layout, numbers=layout.numbers.of_members(members))
        each = columns.values.reshape(-1, self._members, columns.values.shape[1])
        values = np.tile(each, (1, number, 1)).reshape(-1, each.shape[2])
        return layout, columns._replace(values=values), np.tile(units, number)


def _at_few_times(runs: MemberRuns) -> tuple[Layout, Samples]:
    """The samples by which members are compared, as single runs are where they have many."""
    layout, samples, members = runs.layout, runs.samples, runs.samples.runs
    times = samples.t.size // members
    if times <= MOST_COMPARED:
        return layout, samples
    chosen = np.unique(np.linspace(0, times - 1, MOST_COMPARED).astype(int))
    rows = np.arange(samples.t.size).reshape(times, members)[chosen].ravel()
    few = Samples.of_runs(members, *samples.rows(rows).columns)
    return replace(layout, member_times=chosen.size), few
