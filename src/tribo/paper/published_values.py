"""The numbers that the paper prints, and when a computed number agrees with one.

J. David Brown, *Work Done by Sliding Friction*.
"""

from __future__ import annotations

import csv
from decimal import Decimal
from importlib.resources import files


def published(case: str) -> list[dict[str, str]]:
    """The numbers that the paper prints for a case, one dict for each row of the CSV file."""
    text = files("tribo.paper").joinpath("published_values.csv").read_text(encoding="utf-8")
    return [row for row in csv.DictReader(text.splitlines()) if row["case"] == case]


def unit(printed: str) -> float:
    """One unit of the last digit printed."""
    exponent = Decimal(printed).as_tuple().exponent
    assert isinstance(exponent, int)
    return float(Decimal(1).scaleb(exponent))


def agrees(computed: float, printed: str) -> bool:
    """Whether the difference is at most half a unit of the last digit, rounding apart."""
    return abs(computed - float(printed)) <= 0.5 * unit(printed) * (1.0 + 1e-9)
