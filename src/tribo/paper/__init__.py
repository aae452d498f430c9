"""The paper's five cases, its published values beside computed ones, and its figures.

J. David Brown, *Work Done by Sliding Friction*.
"""

from tribo.paper.cases import CASES, END, Row, Run, boost_gap, compare, published, report, scene

__all__ = ["CASES", "END", "Row", "Run", "boost_gap", "compare", "published", "report", "scene"]
