"""The largest values of a run and of its differences from others, by portions of its samples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np

from tribo.accuracy.roundoff import rounding_of_terms
from tribo.accuracy.scales import largest, without_surfaces
from tribo.layout.layout import Layout
from tribo.ledger.motion import mean_velocity
from tribo.ledger.samples import Samples
from tribo.ledger.series_table import series_table
from tribo.ledger.totals import AsperiteSeries
from tribo.loops.integrate import Integration

# Bytes of the series of a portion; four times as many take a half longer, since caches hold less.
PORTION = 2**25
# Bytes of the series of one asperite at one time, in all runs compared: measured on rows and grids.
BYTES = 2500


class Extremes(NamedTuple):
    """The largest magnitudes in a run; arrays are (names,)."""

    names: tuple[str, ...]  # of the quantities, "w1", or "upper.w1" for that of one surface
    tops: np.ndarray  # the largest magnitudes
    gaps: np.ndarray  # the largest differences from the other runs
    terms: np.ndarray  # the rounding of terms: see tribo.accuracy.roundoff.rounding_of_terms
    speed: float | np.ndarray  # the largest of a bob relative to the mean of initial velocities
    internal: float | np.ndarray  # the largest internal energy of an asperite
    path: float | np.ndarray  # the largest displacement of a bob, in the frame of that mean

    def join(self, other: Extremes) -> Extremes:
        return Extremes(self.names, *map(np.maximum, self[1:], other[1:]))


def extremes(
    layout: Layout, fine: Integration, coarser: Sequence[Integration], names: tuple[str, ...]
) -> Extremes:
    """The largest values of a run, and its differences from coarser ones at shared times."""
    portions = _portions(layout, fine.samples, [run.samples for run in coarser])
    found = (_extremes(layout, own, shared, names, fine.steps) for own, shared in portions)
    return reduce(Extremes.join, found)


def _portions(
    layout: Layout, fine: Samples, coarser: Sequence[Samples]
) -> Iterator[tuple[Samples, list[Samples]]]:
    """Portions of the samples of all runs, each behind the first sample of the run."""
    every = max(1, PORTION // (BYTES * layout.scene.count))
    if fine.t.size <= every:
        yield fine, [run.at(fine.t) for run in coarser]
        return
    for begin in range(0, fine.t.size, every):
        own = fine.rows(slice(begin, begin + every))
        yield own if begin == 0 else fine.first().then(own), [run.at(own.t) for run in coarser]


def _extremes(
    layout: Layout, fine: Samples, shared: list[Samples], names: tuple[str, ...], steps: int
) -> Extremes:
    """The extremes of samples of a run; `shared` are those of coarser runs at the same times."""
    count = fine.t.size
    samples = fine.then(*shared)
    group = AsperiteSeries(layout, samples, (layout.together,))
    columns = series_table(layout, group, names)
    (motion,) = group.motions
    run = columns.values[:count]
    at_shared = run[fine.t.searchsorted(samples.t[count:])]
    with np.errstate(invalid="ignore"):  # of two infinite energies
        apart = at_shared - columns.values[count:]
    names = without_surfaces(columns.names)
    rounding = dict.fromkeys(names, 0.0) | rounding_of_terms(layout, motion, steps)
    mean = mean_velocity(layout)
    return Extremes(
        columns.names,
        tops=columns.largest(run)[:, 0],
        gaps=columns.largest(apart)[:, 0],
        terms=np.array([rounding[name] for name in names]),
        speed=largest(motion.bob_speed(mean)[:count]),
        internal=largest(motion.energy[:count]),
        path=largest(motion.bob_path(mean)[:count]),
    )
