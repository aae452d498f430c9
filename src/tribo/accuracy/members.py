"""Differences of many runs of one scene from finer runs, in units of the accuracy of each."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tribo.accuracy.comparison import Accuracy, observables, weak_notes
from tribo.accuracy.scales import kind_of, mean_velocity, scales_by_kind
from tribo.layout.layout import Layout
from tribo.ledger.motion import Motion
from tribo.ledger.samples import Samples
from tribo.ledger.series_table import SeriesTable, series_table
from tribo.ledger.totals import AsperiteSeries


class FineMembers:
    """Members that others are compared with.

    Errors are relative to the scales of the member, as those of a single run.
    """

    def __init__(self, layout: Layout, fine: Samples, accuracy: Accuracy) -> None:
        self._layout = layout
        self._accuracy = accuracy
        self._names = observables(accuracy)
        self._members = fine.runs
        self._columns, motion = self._series(fine)
        self._scales = scales_by_kind(
            layout,
            _by_name(self._columns, fine.runs),
            _largest(motion.bob_speed(mean_velocity(layout)), fine.runs),
            _largest(motion.energy, fine.runs),
        )

    @property
    def notes(self) -> list[str]:
        """A note on each member whose works are lost in rounding, else ""."""
        return weak_notes(self._scales["work"], self._scales["energy"], self._accuracy)

    def scale_of(self, name: str) -> np.ndarray:
        """What the errors of a quantity are relative to, (members,)."""
        return self._scales[kind_of(name)]

    def excess(self, other: Samples) -> np.ndarray:
        """The largest differences of members from those of another run at the same times.

        In units of the accuracy, (members,); NaN where a value is not finite.
        """
        accuracy, (theirs, _) = self._accuracy, self._series(other)
        gaps = _by_name(self._columns.minus(theirs), self._members)
        worst = np.zeros(self._members)
        for name in self._names or self._columns.names:
            relative = accuracy[name] if isinstance(accuracy, Mapping) else accuracy
            scale = relative * self.scale_of(name)
            with np.errstate(divide="ignore", invalid="ignore"):
                worst = np.maximum(worst, np.where(gaps[name] == 0.0, 0.0, gaps[name] / scale))
        return worst

    def _series(self, samples: Samples) -> tuple[SeriesTable, Motion]:
        group = AsperiteSeries(self._layout, samples, (self._layout.together,))
        return series_table(self._layout, group, self._names), group.motions[0]


def _by_name(columns: SeriesTable, members: int) -> dict[str, np.ndarray]:
    """The largest magnitude of each quantity in each member, over times and asperites."""
    each = np.maximum.reduceat(np.abs(columns.values), columns.starts, axis=1)
    tops = each.reshape(-1, members, each.shape[1]).max(axis=0)
    return dict(zip(columns.names, tops.T, strict=True))


def _largest(series: np.ndarray, members: int) -> np.ndarray:
    """The largest magnitude of a series in each member, over times and asperites."""
    each = np.abs(series).reshape(-1, members, series.shape[1])
    return np.asarray(each.max(axis=(0, 2)))
