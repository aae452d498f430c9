"""The numbers that the paper prints, and when a computed number agrees with one.

J. David Brown, *Work Done by Sliding Friction*.
"""

import csv
from importlib.resources import files

# The labels of the figures in the source of the paper, in the order of their numbers in print.
FIGURE_LABELS = (
    "UpperBlockFig",
    "thetaelecfig",
    "Elec20thru26",
    "workpowerrepulsionfig",
    "ForcedRepulsiveFig",
    "workpowerEAB",
    "ForcedAttractiveFig",
    "WorkPowerERU",
    "FreeAttractiveFig",
    "WorkPowerEAU",
    "FreeAttractiveFigNewFrame",
)


def place(where: str) -> str:
    """Where a number is printed, with a figure by its number: "fig. 3" or "text"."""
    kind, _, label = where.partition(" ")
    return f"{kind} {FIGURE_LABELS.index(label) + 1}" if label in FIGURE_LABELS else where


def published(case: str) -> list[dict[str, str]]:
    """The numbers that the paper prints for a case: a dict for each row of the CSV file."""
    text = files("tribo.paper").joinpath("published_values.csv").read_text(encoding="utf-8")
    return [row for row in csv.DictReader(text.splitlines()) if row["case"] == case]


def unit(printed: str) -> float:
    """One unit of the last digit printed."""
    return float(10.0 ** -len(printed.partition(".")[2]))


def agrees(computed: float, printed: str) -> bool:
    """Whether the difference is at most half a unit of the last digit, rounding apart."""
    return abs(computed - float(printed)) <= 0.5 * unit(printed) * (1.0 + 1e-9)
