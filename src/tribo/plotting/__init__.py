"""Figures of results: asperites, snapshots, sequences of snapshots, angles and works over time.

Functions that draw a figure take ``ax=None`` and return the Axes: those given, or those of a new
figure in tribo's style.  `save` writes a figure to a path and returns the path::

    ax = plotting.work_curves(result, span=(10.0, 40.0))
    plotting.save(ax, "works.pdf")

`overview` draws a whole result in one figure, `animate` writes a moving picture, and `compare`
draws the same plot of several results; `Plots` is the type of ``result.plot``.  `style` and `axes`
give figures of your own the same look.  Lengths in drawings are in the scene's units, sizes of
letters, gaps and margins in points.
"""

from tribo.plotting.animation import animate
from tribo.plotting.comparison import compare
from tribo.plotting.histogram import reflected_histogram
from tribo.plotting.overview import overview
from tribo.plotting.plots import Plots
from tribo.plotting.series import angle_curve, work_curves
from tribo.plotting.snapshots import sequence, snapshot
from tribo.plotting.style import COLUMN, INK, PAGE, WIDE, axes, save, style

__all__ = [
    "COLUMN",
    "INK",
    "PAGE",
    "WIDE",
    "Plots",
    "angle_curve",
    "animate",
    "axes",
    "compare",
    "overview",
    "reflected_histogram",
    "save",
    "sequence",
    "snapshot",
    "style",
    "work_curves",
]
