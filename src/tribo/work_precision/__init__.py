"""Work-precision diagrams: the error of every method on a scene against its cost."""

from tribo.work_precision.measure import TIMES, work_precision
from tribo.work_precision.rows import (
    ACCURACIES,
    Automatic,
    Cheapest,
    Reference,
    Row,
    WorkPrecision,
    with_front,
)

__all__ = [
    "ACCURACIES",
    "TIMES",
    "Automatic",
    "Cheapest",
    "Reference",
    "Row",
    "WorkPrecision",
    "with_front",
    "work_precision",
]
