"""Error estimates: a bound for every quantity, from a run and two coarser ones.

The bound is three times the largest difference of the run from two coarser ones.  One coarse run
may agree with the fine run by chance; two with independent steps, compared at every recorded time,
almost never do.  The difference is never divided by 2^p - 1, and neither the tolerance nor the
closure of the ledger serves as an estimate: each of these can be wrong by orders of magnitude.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from tribo.accuracy.scales import EPSILON, KINDS, Scales, kind_of, largest
from tribo.run.layout import Layout
from tribo.run.ledger import Ledger, assemble
from tribo.run.samples import Samples
from tribo.validation import InputError

# An estimate is this times the largest difference from the coarser runs.  At 2, six of 320 random
# pairs of asperites had errors beyond their bars, of which four by 1.2 to 1.5 times.
SAFETY = 3.0
# It is also multiplied by this where a derivative of a potential jumps, because errors then fall
# irregularly with the step.
ROUGH = 2.0
# Fraction of the largest estimate of all, in units of the scales, that is added to each: runs may
# agree by chance in one quantity.
POOLED = 0.02
# Largest estimate, in units of the scales, from which runs count as diverged: then each quantity
# may be off by as much as the largest.
DIVERGED = 0.1
# Errors that all runs share, in units of the scale: rounding, first steps and iterations.
ROUNDED = 256.0 * EPSILON
# Effect of the rounding of a run, in units of sqrt(steps) roundings times the amplification.
WALK = 1.0


def check_observables(layout: Layout, names: Iterable[str], field: str = "accuracy") -> None:
    """Refuse names of quantities that the scene does not report.  Raises InputError."""
    sample = Samples.at_zero(layout.core, layout.accounts, len(layout.parts))
    reported = assemble(layout, sample)
    for name in names:
        if not reported.series(str(name)):
            raise InputError(
                f"{field}.{name}",
                'is not a reported quantity; give one, as "w1", or one of a surface, as '
                f'"{next(iter(layout.parts))}.W"',
            )


def distance(one: Ledger, other: Ledger, scales: Scales, names: Iterable[str] = ()) -> float:
    """The largest difference of two runs at the same times, in units of the scales.

    Of the quantities in `names`, or of all.
    """
    worst = 0.0
    for name in names or KINDS:
        for mine, theirs in zip(one.series(name), other.series(name), strict=True):
            gap, scale = largest(mine - theirs), scales.of(kind_of(name))
            if gap > 0.0:
                worst = max(worst, gap / scale if scale > 0.0 else np.inf)
    return worst


def safety(rough: bool) -> float:
    """The factor from the difference of two runs to an estimate; larger for `rough` forces."""
    return SAFETY * ROUGH if rough else SAFETY


def rounding(amplification: float | None, steps: int) -> float:
    """The effect of rounding on a quantity, in units of its scale.

    Each step makes one rounding, which grows by the `amplification` of a small change of the start;
    None where that was not measured.
    """
    return ROUNDED + WALK * EPSILON * (amplification or 0.0) * steps**0.5


class Columns(NamedTuple):
    """Series of a run side by side.

    Attributes
    ----------
    names : tuple of str
        Of the quantities, "w1", or "upper.w1" for that of one surface.
    starts : ndarray, (names,)
        The first column of each.
    values : ndarray, (times, columns)
        All series.
    """

    names: tuple[str, ...]
    starts: np.ndarray
    values: np.ndarray

    @classmethod
    def of(cls, ledger: Ledger, names: Iterable[str] = ()) -> Columns:
        """All quantities of a ledger, and further `names`, as "upper.W"."""
        series = {name: ledger.series(name) for name in dict.fromkeys([*ledger.names, *names])}
        arrays = [a.reshape(len(a), -1) for found in series.values() for a in found]
        widths = [sum(a[0].size for a in found) for found in series.values()]
        return cls(tuple(series), np.cumsum([0, *widths[:-1]]), np.concatenate(arrays, axis=1))

    def rows(self, selected: slice | np.ndarray) -> Columns:
        """The same series at some of the times."""
        return self._replace(values=self.values[selected])

    def largest(self, values: np.ndarray) -> np.ndarray:
        """The largest magnitudes of values of these columns, by name (names,)."""
        return np.maximum.reduceat(np.abs(values).max(axis=0, initial=0.0), self.starts)


def estimate(
    run: Columns,
    fine: Columns,
    coarse: Columns,
    scales: Scales,
    rough: bool,
    least: float,
    own: Mapping[str, float],
) -> dict[str, float]:
    """A bound on the error of each reported quantity, over asperites and recorded times.

    Parameters
    ----------
    run
        the run at all of its times
    fine, coarse
        the run and coarser ones, at the times that both recorded
    scales
        which errors are relative to
    rough
        whether a derivative of a potential jumps
    least
        added to the estimates, in units of the scales: the effect of rounding on the motion, which
        may be the same in all runs, and of chance
    own
        the rounding of the terms of each quantity, in its own unit: see
        :func:`tribo.accuracy.roundoff.rounding_of_terms`

    Returns
    -------
    dict
        bounds by quantity, in its own unit
    """
    times, names = safety(rough), run.names
    with np.errstate(invalid="ignore"):  # an infinite energy has no known error
        gaps = times * run.largest(fine.values - coarse.values)
    tops = run.largest(run.values)
    scale = np.array([scales.of(kind_of(name)) for name in names])
    rounded = np.array([own.get(name.rpartition(".")[2], 0.0) for name in names])
    # The part of a difference that is no rounding; 0 if unknown.
    beyond = np.where(np.isfinite(gaps), np.maximum(gaps - times * rounded, 0.0), 0.0)
    relative = float(np.max(beyond[scale > 0.0] / scale[scale > 0.0], initial=0.0))
    pooled = relative * (1.0 if relative > DIVERGED else POOLED)
    bounds = gaps + 4.0 * EPSILON * tops + rounded
    bounds += np.where(gaps > 0.0, (pooled + least) * scale, 0.0)
    # Equal bits in all runs, as of the energy of a first contact.
    bounds += np.where((gaps == 0.0) & (tops > 0.0), EPSILON * scale, 0.0)
    return dict(zip(names, bounds.tolist(), strict=True))


def excess_of_request(
    bounds: Mapping[str, float], scales: Scales, accuracy: float | Mapping[str, float]
) -> float:
    """The largest estimate in units of the accuracy; at most 1 where the accuracy is kept."""
    worst = 0.0
    for name in accuracy if isinstance(accuracy, Mapping) else bounds:
        bound, scale = bounds[name], scales.of(kind_of(name))
        relative = accuracy[name] if isinstance(accuracy, Mapping) else accuracy
        if not bound <= 0.0:  # nor where it is NaN
            known = scale > 0.0 and np.isfinite(bound)
            worst = max(worst, bound / (relative * scale) if known else np.inf)
    return worst
