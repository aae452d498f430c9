"""Figures of results: asperites, snapshots, sequences of snapshots, angles and works over time.

Functions that draw a figure take ``ax=None`` and return the Axes: those given, or those of a new
figure in tribo's style.  `save` writes a figure to a path and returns the path::

    ax = plotting.work_curves(result, span=(10.0, 40.0))
    plotting.save(ax, "works.pdf")

`overview` draws a whole result in one figure, `animate` a moving picture, and `compare` the same
plot of several results; `Plots` is what ``result.plot`` is.

Functions that add a mark to a figure (`note`, `arrow`, `draw_asperite`) take its Axes first.
Lengths in drawings are in the scene's units.  Sizes of letters, gaps and margins are in points.
"""

from tribo.plotting.animation import animate
from tribo.plotting.comparison import compare
from tribo.plotting.geometry import AsperiteGeometry, SceneGeometry, scene_geometry, shifted
from tribo.plotting.histogram import reflected_histogram
from tribo.plotting.overview import overview
from tribo.plotting.plots import Plots
from tribo.plotting.series import WORKS, angle_curve, spread, work_curves
from tribo.plotting.snapshots import draw_asperite, draw_asperites, extent, sequence, snapshot
from tribo.plotting.style import (
    COLUMN,
    EDGE,
    FILES,
    INK,
    PAGE,
    STYLE,
    WIDE,
    arrow,
    axes,
    drawing_axes,
    drawing_on,
    figure_path,
    frame,
    note,
    save,
    style,
    time_labels,
    trim,
)

__all__ = [
    "COLUMN",
    "EDGE",
    "FILES",
    "INK",
    "PAGE",
    "STYLE",
    "WIDE",
    "WORKS",
    "AsperiteGeometry",
    "Plots",
    "SceneGeometry",
    "angle_curve",
    "animate",
    "arrow",
    "axes",
    "compare",
    "draw_asperite",
    "draw_asperites",
    "drawing_axes",
    "drawing_on",
    "extent",
    "figure_path",
    "frame",
    "note",
    "overview",
    "reflected_histogram",
    "save",
    "scene_geometry",
    "sequence",
    "shifted",
    "snapshot",
    "spread",
    "style",
    "time_labels",
    "trim",
    "work_curves",
]
