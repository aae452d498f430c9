"""All cases in one picture: the works over time, and the numbers that the paper prints at the end.

J. David Brown, *Work Done by Sliding Friction*.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tribo import plotting
from tribo.paper.cases import CASES, END, Run
from tribo.paper.comparison import Row
from tribo.plotting.marks import frame, point_length
from tribo.plotting.picture import Picture
from tribo.plotting.pose import pose
from tribo.plotting.style import INK, PAGE
from tribo.plotting.works import WORKS, symbol

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Height of a row of panels [inch].
ROW_HEIGHT = 1.9
# Time of the drawing of case A: the bobs pass.
PASSING = 23.2
# What the paper prints at the end of a run, and the curve that ends there.
CURVES = {"w1": "w1", "w2": "w2", "w": "w", "delta e_int": "delta_e_int"}


def draw_overview(tables: Mapping[str, Sequence[Row]], path: str | Path) -> Path:
    """Draw the works of the cases, with dots at the printed numbers, and write the picture.

    Parameters
    ----------
    tables : mapping of str to list of Row
        The rows of each case, from `compare`.
    path : str or Path
        Name of the file, which ends in .png, .pdf or .svg.

    Raises
    ------
    InputError
        If the name ends otherwise, or the file cannot be written.
    """
    from tribo.plotting.shown import ShownFigure

    rows = -(-(1 + len(tables)) // 3)  # of three panels, the drawing first
    with plotting.style():
        figure = ShownFigure(figsize=(PAGE, ROW_HEIGHT * rows), layout="constrained")
        panels = figure.subplots(rows, 3, squeeze=False).ravel()
        for ax in panels:
            ax.set_axis_off()
        for ax, (case, table) in zip(panels[1:], tables.items(), strict=False):
            ax.set_axis_on()
            _works(ax, case, table)
        handles = panels[1].get_legend_handles_labels()
        figure.legend(*handles, loc="outside lower center", ncols=len(handles[0]))
        figure.draw_without_rendering()  # lays out the Axes, whose sizes the drawing needs
        _drawing(panels[0], next(iter(tables)))
    return plotting.save(figure, path)


def _drawing(ax: Axes, case: str) -> None:
    """Both asperites near their closest approach."""
    now = pose(Run.extended(case).result, PASSING)
    Picture(ax, now, point_length(ax, now.box.left, now.box.right))
    frame(ax, now.box)
    ax.set_title(f"{case} at $t = {PASSING}$", fontsize="medium")


def _works(ax: Axes, case: str, table: Sequence[Row]) -> None:
    """Works and internal energy of the upper asperite; a dot at each number printed for the end."""
    result = Run.extended(case).result
    series = result["upper"]
    shown = result.t <= END[case]
    for name in CURVES.values():
        energy = name == "delta_e_int"
        colour = INK if energy else WORKS[name].colour
        ax.plot(
            result.t[shown],
            series[name][shown, 0],
            color="0.55" if name == "w" else colour,
            linestyle=(0, (4, 2)) if energy else "-",
            linewidth=1.8 if name == "w" else 1.0,
            label=r"$\Delta e_{\rm int}$" if energy else symbol(name),
        )
    ends = [float(row.printed) for row in table if row.t == "end" and row.quantity in CURVES]
    if ends:  # case E has a sign alone
        t = np.full(len(ends), END[case])
        ax.plot(t, ends, "o", ms=3.5, mfc="none", color=INK, clip_on=False, label="printed")
    ax.set(xlim=(10.0, END[case]), xlabel="$t$")
    ax.set_title(f"{case}: {CASES[case].removesuffix(' on a moving table')}", fontsize="medium")
