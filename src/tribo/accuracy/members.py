"""Differences of many runs of one scene from finer runs, in units of the accuracy of each."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tribo.accuracy.comparison import Accuracy, observables
from tribo.accuracy.scales import KINDS, mean_velocity, motion_scales
from tribo.accuracy.weak_works import weak_notes
from tribo.layout.layout import Layout
from tribo.ledger.samples import Samples
from tribo.ledger.series_table import SeriesTable, series_table
from tribo.ledger.totals import AsperiteSeries


class FineMembers:
    """Members that others are compared with.

    Errors are relative to the scales of the member, as those of a single run.

    Parameters
    ----------
    layout : Layout
        The scene.
    fine : Samples
        Their samples.
    accuracy : float or mapping
        The relative error of everything, or of each observable named.
    """

    def __init__(self, layout: Layout, fine: Samples, accuracy: Accuracy) -> None:
        self._layout = layout
        self._accuracy = accuracy
        self._names = observables(accuracy)
        self._members = fine.runs
        group = AsperiteSeries(layout.view, fine, (layout.view.together,))
        self._columns = series_table(layout, group, self._names)
        self._scales = _scales(layout, group, _largest(self._columns, fine.runs), fine.runs)

    @property
    def notes(self) -> list[str]:
        """A note on each member whose works are lost in rounding, else ""."""
        return weak_notes(self._scales["work"], self._scales["energy"], self._accuracy)

    def scale_of(self, name: str) -> float | np.ndarray:
        """What the errors of a quantity are relative to, (members,)."""
        return self._scales[KINDS[name.rpartition(".")[2]]]

    def excess(self, other: Samples) -> np.ndarray:
        """The largest difference of each member in another run, in units of the accuracy.

        Parameters
        ----------
        other : Samples
            The same members at the same times.

        Returns
        -------
        ndarray, (members,)
            NaN where a value is not finite.
        """
        accuracy, group = (
            self._accuracy,
            AsperiteSeries(self._layout.view, other, (self._layout.view.together,)),
        )
        theirs = series_table(self._layout, group, self._names)
        gaps = _largest(self._columns.minus(theirs), self._members)
        worst = np.zeros(self._members)
        for name in self._names or self._columns.names:
            relative = accuracy[name] if isinstance(accuracy, Mapping) else accuracy
            scale = relative * self._scales[KINDS[name.rpartition(".")[2]]]
            with np.errstate(divide="ignore", invalid="ignore"):
                worst = np.maximum(worst, np.where(gaps[name] == 0.0, 0.0, gaps[name] / scale))
        return worst


def _largest(columns: SeriesTable, members: int) -> dict[str, np.ndarray]:
    """The largest magnitude of each quantity in each member, over times and asperites."""
    each = np.maximum.reduceat(np.abs(columns.values), columns.starts, axis=1)
    tops = each.reshape(-1, members, each.shape[1]).max(axis=0)
    return dict(zip(columns.names, tops.T, strict=True))


def _scales(
    layout: Layout, group: AsperiteSeries, tops: dict[str, np.ndarray], members: int
) -> dict[str, np.ndarray | float]:
    """The scales of each member, as :class:`tribo.accuracy.scales.Scales` for a single run."""
    (motion,) = group.motions

    def largest(series: np.ndarray) -> np.ndarray:
        each = np.abs(series).reshape(-1, members, series.shape[1])
        return np.asarray(each.max(axis=(0, 2)))

    internal, a = largest(motion.energy), layout.view.together.asperites
    speed = largest(motion.bob_speed(mean_velocity(layout)))
    inertia, mass, length = (
        np.max(np.atleast_2d(each), axis=1)[:members] for each in (a.inertia, a.mass, a.l1 + a.l2)
    )
    moving = motion_scales(tops, speed, internal, inertia, mass, layout.scene.count)
    return moving | {"length": length, "angle": 1.0}
