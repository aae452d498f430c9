"""Runs of members compared with finer ones of the same members."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from tribo.accuracy.scales import (
    MEASURES,
    Scales,
    largest_of_runs,
    scales_of,
    without_surfaces,
)
from tribo.layout.layout import Layout
from tribo.ledger.motion import mean_velocity
from tribo.ledger.samples import Samples
from tribo.ledger.series_table import SeriesTable, series_table
from tribo.ledger.totals import AsperiteSeries
from tribo.loops.batch import MemberRuns

# Times at which members are compared, at most: comparisons at 401 took longer than the runs.
MOST_COMPARED = 65


class FineRuns:
    """Fine runs of some members, with which any number of other runs of these are compared.

    `accuracy` has that of each quantity by which they are.
    """

    def __init__(self, runs: MemberRuns, accuracy: Mapping[str, float]) -> None:
        self._accuracy = accuracy
        self._asked = tuple(accuracy)
        self._kinds = frozenset(without_surfaces(self._asked))
        self._complete = runs.complete
        layout, self._samples = _at_few_times(runs)
        self._layouts = {1: layout}  # for all members so many times
        self._scales: Scales | None = None

    def compare(self, *others: MemberRuns) -> tuple[Scales, np.ndarray]:
        """The scales of errors, (members,), and the largest differences, (others, members).

        Differences are in units of the accuracy; they are infinite if a run stopped, or if one is
        not finite.  One table has the series of all runs side by side: to make it takes longer than
        to fill it.
        """
        members = self._samples.runs
        runs = 1 + len(others)
        samples = self._samples.beside(*(_at_few_times(each)[1] for each in others))
        layout = self._layout_of(runs)
        group = AsperiteSeries(layout, samples, (layout.together,))
        only = self._kinds if self._scales else self._kinds | MEASURES
        table = series_table(layout, group, self._asked, only)
        values = table.values.reshape(-1, runs, members, table.values.shape[1])
        if self._scales is None:
            self._scales = _scales(layout, group, table, values[:, 0])
        with np.errstate(divide="ignore", invalid="ignore"):  # of infinite energies, by no scale
            gaps = table.largest(values[:, :1] - values[:, 1:], members * len(others))
            worst = _in_units(self._accuracy, self._scales, table.names, gaps, members)
        complete = self._complete & [each.complete for each in others]
        return self._scales, np.where(complete & np.isfinite(worst), worst, np.inf)

    def _layout_of(self, runs: int) -> Layout:
        """The layout for all members so many times, as in samples of runs side by side."""
        if runs not in self._layouts:
            layout = self._layouts[1]
            if layout.numbers is not None:
                members = np.tile(np.arange(self._samples.runs), runs)
                layout = replace(layout, numbers=layout.numbers.of_members(members))
            self._layouts[runs] = layout
        return self._layouts[runs]


def _scales(
    layout: Layout, group: AsperiteSeries, table: SeriesTable, values: np.ndarray
) -> Scales:
    """The scales of the first runs of a group, whose `values` are (times, members, columns)."""
    members = values.shape[1]
    tops = table.largest(values, members)
    (motion,) = group.motions
    mean = mean_velocity(layout)
    runs = group.samples.runs
    speed, internal, path = (
        largest_of_runs(each, runs)[:members]
        for each in (motion.bob_speed(mean), motion.energy, motion.bob_path(mean))
    )
    return scales_of(layout, table.names, tops, speed, internal, path)


def _in_units(
    accuracy: Mapping[str, float],
    scales: Scales,
    names: tuple[str, ...],
    gaps: np.ndarray,
    members: int,
) -> np.ndarray:
    """The largest of differences (names, runs x members) in their units, (runs, members)."""
    places = [place for place, name in enumerate(names) if name in accuracy]
    units = np.empty((len(places), members))
    for unit, place in zip(units, places, strict=True):
        unit[:] = accuracy[names[place]] * scales.of(names[place])
    chosen = gaps[places].reshape(len(places), -1, members)
    relative = np.where(chosen == 0.0, 0.0, chosen / units[:, None])
    worst: np.ndarray = np.maximum.reduce(relative, axis=0, initial=0.0)
    return worst


def _at_few_times(runs: MemberRuns) -> tuple[Layout, Samples]:
    """The samples by which members are compared, as single runs are where they have many."""
    layout = runs.layout
    samples = runs.samples
    members = runs.samples.runs
    times = samples.t.size // members
    if times <= MOST_COMPARED:
        return layout, samples
    chosen = np.unique(np.linspace(0, times - 1, MOST_COMPARED).astype(int))
    rows = np.arange(samples.t.size).reshape(times, members)[chosen].ravel()
    few = Samples.of_runs(members, *samples.rows(rows).columns)
    return replace(layout, member_times=chosen.size), few
