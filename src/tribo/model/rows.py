"""Two rows of asperites that slide over each other: commensurate, incommensurate, periodic.

    upper, lower = commensurate_rows(5, slide=10.0, upper={"velocity": (0.5, 0.0)})
    upper, lower = incommensurate_rows(13, lower={"asperite": Asperite(kappa=4.0)})
    upper, lower, period = periodic_rows(13)  # with Scene(..., periodic={"x": period})

The first resting bobs are at x = 0, the upper row a `gap` above the lower.  `upper` and `lower`
hold any settings of :class:`tribo.Surface` (velocity, drive, bars, asperite) and override those of
the row.

The golden mean is the ratio that fractions approximate worst, and so the usual choice:
M. Peyrard, S. Aubry, J. Phys. C 16 (1983) 1593.
"""

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from tribo.model.surface import Surface
from tribo.model.tables import field_names
from tribo.validation import POSITIVE, InputError, inside, integer, known_keys, must_be, number

# Ratio of the spacings of incommensurate rows.
GOLDEN_MEAN = (1.0 + math.sqrt(5.0)) / 2.0

# Settings of a Surface that replace those of a row.
Settings = Mapping[str, Any] | None


def commensurate_rows(
    n: int,
    spacing: float = 1.0,
    *,
    gap: float = 1.0,
    slide: float = 0.0,
    lower_n: int | None = None,
    upper: Settings = None,
    lower: Settings = None,
) -> tuple[Surface, Surface]:
    """Two rows with the same spacing.

    Parameters
    ----------
    n : int
        Number of upper asperites.
    spacing : float
        Distance between neighbours [length].
    gap : float
        Height of the resting upper bobs above the resting lower bobs [length].
    slide : float
        Distance along x, of either sign, by which the upper row will slide [length].  The lower
        row extends below the upper one from start to end.
    lower_n : int, optional
        Number of lower asperites from x = 0 on, instead of `slide`.
    upper, lower : dict, optional
        Settings of :class:`tribo.Surface` that replace those of the row.

    Raises
    ------
    InputError
        If a value is out of range, or both `slide` and `lower_n` are given.
    """
    return incommensurate_rows(
        n, spacing, 1.0, gap=gap, slide=slide, lower_n=lower_n, upper=upper, lower=lower
    )


def incommensurate_rows(
    n: int,
    spacing: float = 1.0,
    ratio: float = GOLDEN_MEAN,
    *,
    gap: float = 1.0,
    slide: float = 0.0,
    lower_n: int | None = None,
    upper: Settings = None,
    lower: Settings = None,
) -> tuple[Surface, Surface]:
    """Two rows with different spacings.

    Parameters
    ----------
    n, spacing, gap, slide, lower_n, upper, lower
        As for :func:`commensurate_rows`; `spacing` is that of the upper row.
    ratio : float
        Upper spacing over lower spacing, by default the golden mean: the lower row is denser.
    """
    n = integer("n", n, 1)
    spacing = number("spacing", spacing, POSITIVE, "length")
    below = spacing / number("ratio", ratio, POSITIVE)
    first, count = _extent((n - 1) * spacing, below, number("slide", slide, unit="length"), lower_n)
    return (
        _row("upper", "down", (0.0, number("gap", gap, unit="length")), n, spacing, upper),
        _row("lower", "up", (first * below, 0.0), count, below, lower),
    )


def periodic_rows(
    n: int,
    spacing: float = 1.0,
    ratio: float = GOLDEN_MEAN,
    *,
    gap: float = 1.0,
    upper: Settings = None,
    lower: Settings = None,
) -> tuple[Surface, Surface, float]:
    """Two rows that both fit one period, for a scene that is periodic along x.

    The rows are as many repeats of the :func:`approximant` as n allows.

    Parameters
    ----------
    n : int
        Largest number of upper asperites.
    ratio : float
        Upper spacing over lower spacing, approximated by a fraction; 1 gives n asperites each.
    spacing, gap, upper, lower
        As for :func:`incommensurate_rows`.

    Returns
    -------
    upper, lower : Surface
    period : float
        Length of both rows [length].

    Raises
    ------
    InputError
        If a value is out of range, or `ratio` is too small for n.
    """
    upper_n, lower_n = approximant(n, ratio)
    repeats = n // upper_n
    ratio = lower_n / upper_n  # of whole numbers, where the given one need not be
    upper_n *= repeats
    lower_n *= repeats
    rows = incommensurate_rows(
        upper_n, spacing, ratio, gap=gap, lower_n=lower_n, upper=upper, lower=lower
    )
    return *rows, upper_n * spacing


def approximant(n: int, ratio: float = GOLDEN_MEAN) -> tuple[int, int]:
    """(upper_n, lower_n): lower_n / upper_n is the fraction nearest `ratio` with upper_n <= n.

    For the golden mean or its inverse both are Fibonacci numbers.
    """
    integer("n", n, 1)
    fraction = Fraction(number("ratio", ratio, POSITIVE)).limit_denominator(n)
    if fraction == 0:
        raise must_be("ratio", f"above {0.5 / n:g} for {n} upper asperites", ratio)
    return fraction.denominator, fraction.numerator


def _extent(length: float, spacing: float, slide: float, count: int | None) -> tuple[int, int]:
    """Index of the row's first asperite on the lower lattice, and the number of asperites."""
    if count is not None:
        if slide != 0.0:
            raise InputError("slide", "cannot go with lower_n; give one or the other")
        return 0, integer("lower_n", count, 1)
    rounding = 1e-9  # of a spacing: an end that rounding moves adds no asperite
    first = math.floor(min(slide, 0.0) / spacing + rounding)
    last = math.ceil((length + max(slide, 0.0)) / spacing - rounding)
    return first, last - first + 1


def _row(
    name: str, facing: str, bob: tuple[float, float], n: int, spacing: float, settings: Settings
) -> Surface:
    row = {"name": name, "facing": facing, "bob": bob, "shape": (n, 1), "spacing": (spacing, 0.0)}
    with inside(name):
        return Surface(**row | known_keys(settings or {}, field_names(Surface)))
