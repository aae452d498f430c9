"""The largest values of a run, and its largest differences from others.

Samples are taken portion by portion, so that the series of large scenes need little memory.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tribo.accuracy.roundoff import rounding_of_terms
from tribo.accuracy.scales import largest, mean_velocity
from tribo.layout.layout import Layout
from tribo.ledger.samples import Samples
from tribo.ledger.series_table import series_table
from tribo.ledger.totals import AsperiteSeries
from tribo.loops.integrate import Integration

# Bytes of the series of a portion; four times as many take a half longer, since caches hold less.
PORTION = 2**25
# Bytes of the series of one asperite at one time, in all runs that are compared: measured on rows
# and grids.
BYTES = 2500


@dataclass(frozen=True)
class Extremes:
    """The largest magnitudes in a run.

    Attributes
    ----------
    names : tuple of str
        Of the quantities, "w1", or "upper.w1" for that of one surface.
    tops : ndarray, (names,)
        The largest magnitude of each.
    gaps : ndarray, (names,)
        The largest difference of each from the other runs.
    speed : float
        The largest of a bob relative to the mean of the surfaces' initial velocities.
    internal : float
        The largest internal energy of an asperite.
    terms : mapping
        The rounding of the terms of each quantity; see
        :func:`tribo.accuracy.roundoff.rounding_of_terms`.
    """

    names: tuple[str, ...]
    tops: np.ndarray
    gaps: np.ndarray
    speed: float
    internal: float
    terms: Mapping[str, float]

    def join(self, other: Extremes) -> Extremes:
        """Those of two portions."""
        return Extremes(
            self.names,
            np.maximum(self.tops, other.tops),
            np.maximum(self.gaps, other.gaps),
            max(self.speed, other.speed),
            max(self.internal, other.internal),
            {name: max(term, other.terms[name]) for name, term in self.terms.items()},
        )


def extremes(
    layout: Layout, fine: Integration, coarser: Sequence[Integration], names: tuple[str, ...]
) -> Extremes:
    """The largest values of a run, and its largest differences from coarser ones.

    Parameters
    ----------
    layout
        the scene
    fine
        the run
    coarser
        runs that it is compared with where their times are its own
    names
        of further quantities, as "upper.W"
    """
    found: Extremes | None = None
    for own, shared in _portions(layout, fine.samples, [run.samples for run in coarser]):
        portion = _extremes(layout, own, shared, names, fine.steps)
        found = portion if found is None else found.join(portion)
    assert found is not None
    return found


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
    """Those of one portion."""
    count, samples = fine.t.size, fine.then(*shared)
    group = AsperiteSeries(layout.view, samples, (layout.view.together,))
    columns, (motion,) = series_table(layout, group, names), group.motions
    run, coarse = columns.rows(slice(count)), columns.rows(slice(count, None))
    at_shared = run.rows(np.searchsorted(fine.t, samples.t[count:]))
    speed = largest(motion.bob_speed(mean_velocity(layout))[:count])
    internal = largest(motion.energy[:count])
    terms = rounding_of_terms(layout, motion, steps)
    gaps = at_shared.minus(coarse).largest()
    return Extremes(run.names, run.largest(), gaps, speed, internal, terms)
