"""The card's figure: energy, force, how far they disagree, and where the potential ends."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo import plotting
from tribo.checks import as_path
from tribo.errors import InputError
from tribo.plotting import COLUMN, INK
from tribo.report_card.card import EPSILON, Curves, Report

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ENERGY, FORCE, BOUND = "#0b62a4", "#d55e00", "#a50f15"
KINDS = (".png", ".pdf", ".svg")
DEPTHS = 2.5  # typical values shown above zero and below


def save(report: Report, path: Any) -> Path:
    """Draw the figure into a file whose name ends on .png, .pdf or .svg; returns its path."""
    place = as_path(path)
    if place.suffix.lower() not in KINDS:
        raise InputError("--figure", f"must end on {', '.join(KINDS)}, got {str(path)!r}")
    with plotting.style():
        figure = draw(report)
        try:
            figure.savefig(place)
        except OSError as error:
            why = error.strerror or str(error)
            raise InputError("--figure", f"{place} cannot be written ({why})") from None
    return place


def draw(report: Report) -> Figure:
    """Energy, force and disagreement one below the other, over one axis of distances."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(COLUMN, 1.35 * COLUMN), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True, height_ratios=(1.0, 1.0, 1.0))
    found = report.curves
    _curve(axes[0], found, found.energy, ENERGY, "$U$")
    _curve(axes[1], found, found.force, FORCE, "$F$")
    _disagreement(axes[2], found)
    axes[0].set_title(report.potential, fontsize=8.0, wrap=True)
    axes[2].set_xlabel("$r$")
    axes[2].set_xscale("log")
    axes[2].set_xlim(found.r[0], found.r[-1])
    for ax in axes:
        if np.isfinite(found.cutoff):
            ax.axvline(found.cutoff, color=INK, linewidth=0.7, linestyle=(0, (4, 2)))
    if np.isfinite(found.cutoff):
        label: Any = {"xytext": (-3, -4), "textcoords": "offset points", "ha": "right", "va": "top"}
        edge = axes[0].get_xaxis_transform()
        axes[0].annotate("cutoff", (found.cutoff, 1.0), xycoords=edge, fontsize=7.5, **label)
    figure.align_ylabels(axes)
    return figure


def _curve(ax: Axes, found: Curves, values: np.ndarray, colour: str, label: str) -> None:
    """A curve over all distances, cut where it leaves the scale of the typical distance."""
    outer = values[(found.r >= found.length) & np.isfinite(values)]
    top = DEPTHS * float(np.max(np.abs(outer), initial=0.0)) or 1.0
    ax.axhline(0.0, color="0.6", linewidth=0.5)
    ax.plot(found.r, np.clip(values, -2.0 * top, 2.0 * top), color=colour)
    ax.set_ylim(-top, top)
    ax.set_ylabel(label)


def _disagreement(ax: Axes, found: Curves) -> None:
    """|F + dU/dr| relative to the scale around, above what is known of it, below its bound."""
    least = 0.1 * EPSILON
    ax.set_yscale("log")
    known = np.maximum(found.uncertainty, least**2)
    ax.fill_between(found.r, least**2, known, color="0.85", linewidth=0.0)
    ax.plot(found.r, np.maximum(found.disagreement, least), ".", color=INK, markersize=1.6)
    ax.axhline(found.bound, color=BOUND, linewidth=0.8)
    top = float(np.nanmax(found.disagreement, initial=found.bound))
    ax.set_ylim(min(1e-17, 0.5 * least), 30.0 * min(top, 1e3))
    ax.set_ylabel("$|F + dU/dr|$")
    style: Any = {"xytext": (4, 3), "textcoords": "offset points", "fontsize": 7.5, "color": BOUND}
    ax.annotate("bound", (found.r[0], found.bound), **style)
