"""The paper's five cases, its printed numbers beside computed ones, and its figures.

J. David Brown, *Work Done by Sliding Friction*.
"""

from tribo.paper.cases import CASES, END, Run, scene
from tribo.paper.comparison import Row, boost_error, compare
from tribo.paper.picture import draw_overview
from tribo.paper.published_values import published
from tribo.paper.report import report, short_report

__all__ = [
    "CASES",
    "END",
    "Row",
    "Run",
    "boost_error",
    "compare",
    "draw_overview",
    "published",
    "report",
    "scene",
    "short_report",
]
