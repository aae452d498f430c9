"""Error estimates: from a run and two coarser ones to an honest bound for every quantity.

An estimate is the largest raw difference of a run from two coarser ones, times two: one coarse
run may agree with the fine run by chance.  It is never the difference divided by 2^p - 1, never
the tolerance, and never how well the ledger closes: each of those can be wrong by orders of
magnitude.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from tribo.accuracy.scales import EPSILON, KINDS, Scales, kind_of, largest
from tribo.run.layout import Layout
from tribo.run.ledger import Ledger
from tribo.validation import InputError

SAFETY = 2.0  # the estimate is this times the largest difference from the coarser runs
ROUGH = 2.0  # times that where derivatives of a potential jump, and errors fall irregularly
POOLED = 0.02  # of the largest estimate of all, in units of scales, that is added to every other
ROUNDED = 256.0 * EPSILON  # of its scale: what rounding, first steps, iterations do to runs alike
WALK = 1.0  # of sqrt(steps) roundings, magnified as the scene does: what they may come to


def check_observables(layout: Layout, names: Iterable[str], field: str = "accuracy") -> None:
    """Complain about names of nothing that is reported."""
    for name in names:
        surface, _, quantity = name.rpartition(".")
        if quantity not in KINDS or (surface and surface not in layout.parts):
            raise InputError(
                f"{field}.{name}",
                'names nothing that is reported; give a quantity, as "w1", or a surface\'s, as '
                f'"{next(iter(layout.parts))}.W"',
            )


def distance(one: Ledger, other: Ledger, scales: Scales, names: Iterable[str] = ()) -> float:
    """The largest difference of two runs at the same times, each in units of its scale.

    Of the quantities named, or of everything.
    """
    worst = 0.0
    for name in names or KINDS:
        for mine, theirs in zip(one.series(name), other.series(name), strict=True):
            gap, scale = largest(mine - theirs), scales.of(kind_of(name))
            if gap > 0.0:
                worst = max(worst, gap / scale if scale > 0.0 else np.inf)
    return worst


def safety(rough: bool) -> float:
    """What a difference of two runs is multiplied by, where forces are `rough` or not."""
    return SAFETY * ROUGH if rough else SAFETY


def rounding(grown: float | None, steps: int) -> float:
    """What rounding may do to a quantity, in units of its scale.

    `grown` is what becomes of a small change of the start, where it was looked at: each step
    makes one as small as can be.
    """
    return ROUNDED + WALK * EPSILON * (grown or 0.0) * steps**0.5


def estimate(
    books: Ledger,
    compared: Iterable[tuple[Ledger, Ledger]],
    scales: Scales,
    rough: bool,
    rounded: float,
    names: Iterable[str],
) -> dict[str, float]:
    """A bound on the error of each reported quantity, over asperites and recorded times.

    `books` has a run at all of its times; `compared` are pairs, of this run and of a coarser one,
    each at the times that both recorded.  To SAFETY times the largest difference, and ROUGH times
    that where forces are `rough`, comes what rounding costs, which runs may share: of forces and
    of sums, `rounded` in units of the scale, and of the number written down.  And a small part of
    the largest estimate of all: runs may come close by chance in one quantity.  `names` are
    further ones, as "upper.W".
    """
    wanted = [name for name in dict.fromkeys([*KINDS, *names]) if books.series(name)]
    times = safety(rough)
    apart = dict.fromkeys(wanted, 0.0)
    for fine, coarse in compared:
        for name in wanted:
            pairs = zip(fine.series(name), coarse.series(name), strict=True)
            with np.errstate(invalid="ignore"):  # an infinite energy has no known error
                gaps = [times * largest(one - other) for one, other in pairs]
            apart[name] = float(np.max([apart[name], *gaps]))
    relative = (
        gap / scales.of(kind_of(name)) for name, gap in apart.items() if scales.of(kind_of(name))
    )
    pooled = POOLED * max((x for x in relative if np.isfinite(x)), default=0.0)
    bounds = {}
    for name, gap in apart.items():
        bounds[name] = gap + 4.0 * EPSILON * max(map(largest, books.series(name)))
        if gap > 0.0:
            bounds[name] += (pooled + rounded) * scales.of(kind_of(name))
    return bounds


def excess_of_request(
    bounds: Mapping[str, float], scales: Scales, wanted: float | Mapping[str, float]
) -> float:
    """The largest estimate in units of what was asked for; at most 1 where the request is met."""
    worst = 0.0
    for name in wanted if isinstance(wanted, Mapping) else bounds:
        bound, scale = bounds[name], scales.of(kind_of(name))
        accuracy = wanted[name] if isinstance(wanted, Mapping) else wanted
        if not bound <= 0.0:  # nor where it is no number
            known = scale > 0.0 and np.isfinite(bound)
            worst = max(worst, bound / (accuracy * scale) if known else np.inf)
    return worst
