"""Error estimates: a bound for every quantity, from a run and two coarser ones.

The bound is three times the largest difference of the run from two coarser ones.  One coarse run
may agree with the fine run by chance; two with independent steps, compared at every recorded time,
almost never do.  The difference is never divided by 2^p - 1, and neither the tolerance nor the
closure of the ledger serves as an estimate: each of these can be wrong by orders of magnitude.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from tribo.accuracy.roundoff import WALK
from tribo.accuracy.scales import EPSILON, KINDS, Scales, kind_of, largest
from tribo.layout.layout import Layout
from tribo.ledger.ledger import Ledger, assemble
from tribo.ledger.quantities import needs_accounts
from tribo.ledger.samples import Samples
from tribo.validation import InputError

# An estimate is this times the largest difference from the coarser runs.  At 2, six of 320 random
# pairs of asperites had errors above their estimates, of which four by 1.2 to 1.5 times.
SAFETY = 3.0
# It is also multiplied by this where a derivative of a potential jumps, because errors then fall
# irregularly with the step.
ROUGH = 2.0
# Fraction of the largest estimate of all, in units of the scales, that is added to each: runs may
# agree by chance in one quantity.
POOLED = 0.02
# Largest estimate, in units of the scales, from which runs count as diverged.
DIVERGED = 0.1
# The same where a small change of the start grew to DIVERGED, so that its growth is known no more
# than round-off's: errors of all runs are then of one size, and differ by less than they are.  One
# of 138 random scenes had an error of 1.2 times its estimate of 0.08.
DIVERGED_IN_CHAOS = 0.01
# Bound of each quantity in diverged runs, in units of its scale: two values of at most the scale.
# Runs that have nothing more in common may be close in all quantities by chance.
UNRELATED = 2.0
# Errors that all runs share, in units of the scale: rounding, first steps and iterations.
ROUNDED = 256.0 * EPSILON


def check_observables(layout: Layout, names: Iterable[str], field: str = "accuracy") -> None:
    """Refuse names of quantities that the scene does not report.  Raises InputError."""
    reported = assemble(layout, Samples.at_zero(layout))
    for name in names:
        if needs_accounts(str(name).rpartition(".")[2]) and layout.model.ledger is None:
            raise InputError(
                f"{field}.{name}", 'is not kept; works need another output.ledger, as "asperites"'
            )
        if str(name).rpartition(".")[2] not in KINDS or not reported.series(str(name)):
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


def estimate(
    names: Sequence[str],
    tops: np.ndarray,
    gaps: np.ndarray,
    scales: Scales,
    rough: bool,
    least: float,
    own: Mapping[str, float],
    diverged: float = DIVERGED,
) -> dict[str, float]:
    """A bound on the error of each reported quantity, over asperites and recorded times.

    Parameters
    ----------
    names
        of the quantities, "w1", or "upper.w1" for that of one surface
    tops
        the largest magnitude of each in the run, (names,)
    gaps
        the largest difference of each from the coarser runs, (names,)
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
    diverged
        largest estimate, in units of the scales, from which the runs count as diverged

    Returns
    -------
    dict
        bounds by quantity, in its own unit
    """
    times, short = safety(rough), [name.rpartition(".")[2] for name in names]
    gaps = times * gaps
    scale = np.array([scales.of(KINDS[name]) for name in short])
    rounded = np.array([own.get(name, 0.0) for name in short])
    with np.errstate(invalid="ignore"):  # an infinite energy has no known error
        # The part of a difference that is no rounding; 0 if unknown.
        beyond = np.where(np.isfinite(gaps), np.maximum(gaps - times * rounded, 0.0), 0.0)
    has_scale = scale > 0.0
    relative = float((beyond[has_scale] / scale[has_scale]).max(initial=0.0))
    pooled = max(relative, UNRELATED) if relative + least > diverged else POOLED * relative
    bounds = gaps + 4.0 * EPSILON * tops + rounded
    # Equal bits in all runs, as of the energy of a first contact, are known to one rounding.
    same = np.where((gaps == 0.0) & (tops > 0.0), EPSILON, 0.0)
    bounds += np.where(gaps > 0.0, pooled + least, same) * scale
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
