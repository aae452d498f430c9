"""Figures in tribo's style.

``result.plot`` draws a result: :class:`Plots` has its methods.  `compare` draws several results in
one figure, and `reflected_histogram` the works of an ensemble.  For figures of your own, `axes` and
`style` give the fonts, lines and sizes, and `save` writes a figure to a file::

    ax = result.plot.work("upper", span=(10.0, 40.0))
    plotting.save(ax, "works.pdf")
"""

from tribo.plotting.histogram import histogram, reflected_histogram
from tribo.plotting.plots import Plots, compare
from tribo.plotting.style import COLUMN, INK, PAGE, WIDE, axes, save, style

__all__ = [
    "COLUMN",
    "INK",
    "PAGE",
    "WIDE",
    "Plots",
    "axes",
    "compare",
    "histogram",
    "reflected_histogram",
    "save",
    "style",
]
