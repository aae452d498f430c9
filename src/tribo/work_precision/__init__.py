"""Error against cost: the runs of every method on a scene, and the lowest cost of an accuracy.

With thermal noise single runs do not converge; there it is the half-width of means against the
number of members.
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
