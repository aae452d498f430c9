"""Pictures of results: asperites, snapshots, sequences of them, angles and works over time.

Everything is drawn into matplotlib Axes that the caller owns::

    with plotting.style():
        ax = plotting.axes(plotting.COLUMN)
        plotting.sequence(ax, result, times=(15.0, 23.2, 26.0))
        plotting.trim(ax)
        plotting.save(ax, folder / "sequence")

Lengths of drawings are in the scene's own units, so that a bob is where the run had it; sizes of
letters, gaps and margins are in points.
"""

from tribo.plotting.series import WORKS, angle_curve, spread, work_curves
from tribo.plotting.snapshots import draw_asperite, extent, sequence, snapshot
from tribo.plotting.style import (
    COLUMN,
    EDGE,
    FILES,
    INK,
    STYLE,
    WIDE,
    arrow,
    axes,
    clock,
    frame,
    note,
    save,
    style,
    trim,
    unit,
    write,
)

__all__ = [
    "COLUMN",
    "EDGE",
    "FILES",
    "INK",
    "STYLE",
    "WIDE",
    "WORKS",
    "angle_curve",
    "arrow",
    "axes",
    "clock",
    "draw_asperite",
    "extent",
    "frame",
    "note",
    "save",
    "sequence",
    "snapshot",
    "spread",
    "style",
    "trim",
    "unit",
    "work_curves",
    "write",
]
