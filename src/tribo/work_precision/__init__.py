"""Error against cost: the runs of every method on a scene, and what an accuracy costs at least.

With thermal noise, where no run is near another: the half-width of means against members.
"""

from tribo.work_precision.diagram import Cheapest, Reference, Row, WorkPrecision
from tribo.work_precision.means import MeanRow, MeansPrecision, means_precision
from tribo.work_precision.measure import work_precision

__all__ = [
    "Cheapest",
    "MeanRow",
    "MeansPrecision",
    "Reference",
    "Row",
    "WorkPrecision",
    "means_precision",
    "work_precision",
]
