"""The card's figure: energy, force, how far they disagree, and where the potential ends."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo import plotting
from tribo.plotting.style import COLUMN, INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tribo.report_card.card import Curves, Report

EPSILON = float(np.finfo(float).eps)
ENERGY, FORCE, BOUND = "#0b62a4", "#d55e00", "#a50f15"
DEPTHS = 2.5  # typical values shown above zero and below
FAINT = 0.01  # of them is where a curve has come to its end
WIDEST = 12.0  # typical distances shown at most
FLOOR = 1e-17  # of the disagreement: what is less is shown at a tenth of round-off


def save(report: Report, path: Any) -> Path:
    """Draw the figure into a file whose name ends on .png, .pdf or .svg; returns its path."""
    with plotting.style():
        return plotting.write(draw(report), path)


def draw(report: Report) -> Figure:
    """Energy and force where they are of typical size, and below them the disagreement everywhere.

    The axes are those of the energy, the force, and the disagreement.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(COLUMN, 1.35 * COLUMN), layout="constrained")
    energy, force, disagreement = figure.subplots(3, 1)
    found = report.curves
    _curve(energy, found, found.energy, ENERGY, "$U$")
    _curve(force, found, found.force, FORCE, "$F$")
    _disagreement(disagreement, found)
    energy.set_title(report.potential, fontsize=8.0, wrap=True)
    energy.tick_params(labelbottom=False)
    ends = _interesting(found)
    for ax in (energy, force):
        ax.set_xlim(*ends)
    for ax in (force, disagreement):
        ax.set_xlabel("$r$")
    for ax in (energy, force, disagreement):
        if math.isfinite(found.cutoff):
            ax.axvline(found.cutoff, color=INK, linewidth=0.7, linestyle=(0, (4, 2)))
    if ends[0] < found.cutoff < ends[1]:
        place: Any = {"xytext": (-3, -4), "textcoords": "offset points", "ha": "right", "va": "top"}
        edge = energy.get_xaxis_transform()
        energy.annotate("cutoff", (found.cutoff, 1.0), xycoords=edge, fontsize=7.5, **place)
    figure.align_ylabels([energy, force, disagreement])
    return figure


def _unit(found: Curves, values: np.ndarray) -> float:
    """The largest magnitude at the typical distance and beyond."""
    outer = values[(found.r >= found.length) & np.isfinite(values)]
    return float(np.max(np.abs(outer), initial=0.0)) or 1.0


def _interesting(found: Curves) -> tuple[float, float]:
    """Distances between which the energy is neither off the scale nor next to nothing."""
    size = np.abs(np.nan_to_num(found.energy)) / _unit(found, found.energy)
    seen = (size > FAINT) & (size < DEPTHS)
    low = float(np.min(found.r[seen & (found.r <= found.length)], initial=found.length))
    high = float(np.max(found.r[seen], initial=1.2 * found.length))
    if math.isfinite(found.cutoff):
        high = max(high, 1.05 * found.cutoff)
    return low - 0.05 * (high - low), min(high, WIDEST * found.length)


def _curve(ax: Axes, found: Curves, values: np.ndarray, colour: str, label: str) -> None:
    """A curve that leaves the picture where it leaves the scale of the typical distance."""
    top = DEPTHS * _unit(found, values)
    ax.axhline(0.0, color="0.6", linewidth=0.5)
    ax.plot(found.r, np.clip(values, -2.0 * top, 2.0 * top), color=colour)
    highest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    lowest = float(np.min(values, initial=0.0, where=np.isfinite(values)))
    ax.set_ylim(max(1.2 * lowest, -top) - 0.1 * top, min(1.2 * highest, top) + 0.1 * top)
    ax.set_ylabel(label)


def _disagreement(ax: Axes, found: Curves) -> None:
    """|F + dU/dr| relative to the scale around, above what is known of it, below its bound."""
    from matplotlib.ticker import LogLocator, NullFormatter

    least = 0.1 * EPSILON
    ax.set_xscale("log")
    ax.set_yscale("log")
    few = found.r[-1] / found.r[0] < 100.0
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,)))
    if few:
        ax.xaxis.set_major_formatter(lambda r, _: f"{r:g}")
    ax.xaxis.set_minor_formatter(NullFormatter())
    known = np.nan_to_num(np.maximum(found.uncertainty, FLOOR), posinf=1.0)
    ax.fill_between(found.r, FLOOR, known, color="0.85", linewidth=0.0)
    ax.plot(found.r, np.maximum(found.disagreement, least), ".", color=INK, markersize=1.6)
    ax.axhline(found.bound, color=BOUND, linewidth=0.8)
    top = float(np.nanmax(found.disagreement, initial=found.bound))
    ax.set_xlim(found.r[0], found.r[-1])
    ax.set_ylim(FLOOR, 30.0 * min(top, 1e3))
    ax.set_ylabel("$|F + dU/dr|$")
    style: Any = {"xytext": (4, 3), "textcoords": "offset points", "fontsize": 7.5, "color": BOUND}
    ax.annotate("bound", (found.r[0], found.bound), **style)
