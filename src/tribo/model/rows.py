"""Two rows of asperites that slide over each other: commensurate, incommensurate, periodic.

    upper, lower = commensurate_rows(5, slide=10.0, upper={"velocity": (0.5, 0.0)})
    upper, lower = incommensurate_rows(13, lower={"asperite": Asperite(kappa=4.0)})
    upper, lower, period = periodic_rows(13)  # with Scene(..., periodic={"x": period})

The first resting bobs are at x = 0, the upper row a `gap` above the lower.  `upper` and `lower`
hold any settings of :class:`tribo.Surface`, and have the last word: velocity, drive, bars,
asperite, even bob.

The golden mean is the ratio hardest to approximate by fractions, hence the usual choice:
M. Peyrard, S. Aubry, J. Phys. C 16 (1983) 1593.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from fractions import Fraction
from typing import Any

from tribo.model.surface import Surface
from tribo.validation import POSITIVE, InputError, inside, known_keys, number, whole

GOLDEN_MEAN = (1.0 + math.sqrt(5.0)) / 2.0

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
    """The upper row of n asperites and the lower row, both with the same spacing.

    The lower row is under the upper one, and under it still when it has slid by `slide` along x
    (either sign) [length]; or it has `lower_n` asperites from x = 0.
    """
    return _rows(n, spacing, 1.0, gap, slide, lower_n, upper, lower)


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
    """The upper row of n asperites `spacing` apart and the lower row, spacing / ratio apart.

    ratio = GOLDEN_MEAN makes the lower row the denser, 1 / GOLDEN_MEAN the sparser one.
    The lower row's extent is as for :func:`commensurate_rows`.
    """
    return _rows(n, spacing, ratio, gap, slide, lower_n, upper, lower)


def periodic_rows(
    n: int,
    spacing: float = 1.0,
    ratio: float = GOLDEN_MEAN,
    *,
    gap: float = 1.0,
    upper: Settings = None,
    lower: Settings = None,
) -> tuple[Surface, Surface, float]:
    """Rows of at most n upper asperites that both close over one period, and the period [length].

    As many repeats of the :func:`approximant` as n allows; ratio = 1 gives n asperites each.
    """
    upper_n, lower_n = approximant(n, ratio)
    repeats = n // upper_n
    upper_n, lower_n = repeats * upper_n, repeats * lower_n
    rows = _rows(upper_n, spacing, lower_n / upper_n, gap, 0.0, lower_n, upper, lower)
    return *rows, upper_n * spacing


def approximant(n: int, ratio: float = GOLDEN_MEAN) -> tuple[int, int]:
    """(upper_n, lower_n): lower_n / upper_n is the fraction nearest `ratio` with upper_n <= n.

    For the golden mean or its inverse both are Fibonacci numbers.
    """
    whole("n", n, 1)
    fraction = Fraction(number("ratio", ratio, POSITIVE)).limit_denominator(n)
    if fraction == 0:
        raise InputError("ratio", f"is too small for {n} upper asperites, got {ratio}")
    return fraction.denominator, fraction.numerator


def _rows(
    n: int,
    spacing: float,
    ratio: float,
    gap: float,
    slide: float,
    lower_n: int | None,
    upper: Settings,
    lower: Settings,
) -> tuple[Surface, Surface]:
    n, spacing = whole("n", n, 1), number("spacing", spacing, POSITIVE)
    below = spacing / number("ratio", ratio, POSITIVE)
    first, count = _extent((n - 1) * spacing, below, number("slide", slide), lower_n)
    return (
        _row("upper", "down", (0.0, number("gap", gap)), n, spacing, upper),
        _row("lower", "up", (first * below, 0.0), count, below, lower),
    )


def _extent(length: float, spacing: float, slide: float, count: int | None) -> tuple[int, int]:
    """Which asperite of the lower lattice is its row's first, and how many there are."""
    if count is not None:
        if slide != 0.0:
            raise InputError("slide", "cannot go with lower_n; give one or the other")
        return 0, whole("lower_n", count, 1)
    rounding = 1e-9  # what rounding adds is no reason for one more asperite
    first = math.floor(min(slide, 0.0) / spacing + rounding)
    last = math.ceil((length + max(slide, 0.0)) / spacing - rounding)
    return first, last - first + 1


def _row(
    name: str, facing: str, bob: tuple[float, float], n: int, spacing: float, settings: Settings
) -> Surface:
    row = {"name": name, "facing": facing, "bob": bob, "shape": (n, 1), "spacing": (spacing, 0.0)}
    with inside(name):
        return Surface(**row | known_keys(settings or {}, [f.name for f in fields(Surface)]))
