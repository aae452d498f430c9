"""The figure of a report card: energy, force, their disagreement, and the cutoff."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.accuracy.scales import EPSILON
from tribo.plotting.style import COLUMN, INK, NOTE_SIZE, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Colours of the curves and of the bound.
ENERGY = "#0b62a4"
FORCE = "#d55e00"
BOUND = "#a50f15"
# Largest distance whose values set the scale of a curve [typical distance].
AROUND = 5.0
# Lower end of the axis of the disagreement, which is relative.
FLOOR = 1e-17


@dataclass(frozen=True, eq=False)
class Curves:
    """The curves of a report card's figure, at n distances.

    `slope` is dU/dr by differences; |F + dU/dr| and the uncertainty of dU/dr are relative to the
    scale of the force.  The typical distance `length` is that of the minimum if there is one.
    """

    r: np.ndarray
    energy: np.ndarray
    force: np.ndarray
    slope: np.ndarray
    disagreement: np.ndarray
    uncertainty: np.ndarray
    bound: float
    cutoff: float
    length: float


def card_figure(curves: Curves, title: str, failed: Mapping[str, float] | None = None) -> Figure:
    """Energy, force and their disagreement at all distances of the card, with a title.

    The distances of checks that failed are marked, with the names of these checks.
    """
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(COLUMN, 1.35 * COLUMN), layout="constrained")
        energy, force, disagreement = figure.subplots(3, 1, sharex=True)
        _curve(energy, curves, curves.energy, ENERGY, "$U$")
        _curve(force, curves, curves.force, FORCE, "$F$")
        _disagreement(disagreement, curves)
        energy.set_title(title, fontsize=8.0, wrap=True)
        _distances(disagreement, curves)
        if math.isfinite(curves.cutoff):
            for ax in (energy, force, disagreement):
                ax.axvline(curves.cutoff, color=INK, linewidth=0.7, linestyle=(0, (4, 2)))
            top: Any = {"xytext": (-3, -4), "textcoords": "offset points", "fontsize": NOTE_SIZE}
            top |= {"xycoords": energy.get_xaxis_transform(), "ha": "right", "va": "top"}
            energy.annotate("cutoff", (curves.cutoff, 1.0), **top)
        _mark(energy, (energy, force, disagreement), failed or {})
        figure.align_ylabels([energy, force, disagreement])
    return figure


def _mark(top: Axes, axes: Sequence[Axes], failed: Mapping[str, float]) -> None:
    """Mark the distances of checks that failed, once where several have the same one."""
    low, high = top.get_xlim()
    names: dict[str, list[str]] = {}
    for name, r in failed.items():
        if low <= r <= high:  # those of limits are far away
            names.setdefault(f"{r:.6g}", []).append(name)
    for k, (place, checks) in enumerate(names.items()):
        r = float(place)
        for ax in axes:
            ax.axvline(r, color=BOUND, linewidth=0.7)
        left = math.log(r / low) > 0.5 * math.log(high / low)  # where the name has more room
        text: Any = {"xytext": (-3 if left else 3, -4 - 9 * k), "textcoords": "offset points"}
        text |= {"ha": "right" if left else "left", "va": "top", "color": BOUND}
        text |= {"xycoords": top.get_xaxis_transform(), "fontsize": NOTE_SIZE}
        top.annotate("\n".join(checks), (r, 1.0), **text)


def _distances(ax: Axes, curves: Curves) -> None:
    """Show all distances of the card, evenly in log r."""
    from matplotlib.ticker import LogLocator, NullFormatter

    ax.set_xscale("log")
    few = curves.r[-1] / curves.r[0] < 100.0
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,)))
    if few:
        ax.xaxis.set_major_formatter(lambda r, _: f"{r:g}")
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set(xlim=(curves.r[0], curves.r[-1]), xlabel="$r$")


def _curve(ax: Axes, curves: Curves, values: np.ndarray, colour: str, label: str) -> None:
    """Draw a curve on the scale of its values near the typical distance; larger ones are cut off.

    So the values of a core are, and those far away of an energy that rises with r.
    """
    near = (curves.r >= curves.length) & (curves.r <= AROUND * curves.length)
    outer = values[near & np.isfinite(values)]
    # So many typical values are shown above zero and below.
    top = 2.5 * (float(np.max(np.abs(outer), initial=0.0)) or 1.0)
    ax.axhline(0.0, color="0.6", linewidth=0.5)
    ax.plot(curves.r, np.clip(values, -2.0 * top, 2.0 * top), color=colour)
    highest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    lowest = float(np.min(values, initial=0.0, where=np.isfinite(values)))
    upper = 1.2 * highest if highest < 2.0 * top else top
    ax.set_ylim(max(1.2 * lowest, -top) - 0.1 * top, upper + 0.1 * top)
    ax.set_ylabel(label)


def _disagreement(ax: Axes, curves: Curves) -> None:
    """Draw |F + dU/dr|, relative, with the uncertainty of dU/dr in grey and the bound in red."""
    least = 0.1 * EPSILON  # smaller values are shown there
    ax.set_yscale("log")
    known = np.nan_to_num(np.maximum(curves.uncertainty, FLOOR), posinf=1.0)
    ax.fill_between(curves.r, FLOOR, known, color="0.85", linewidth=0.0)
    ax.plot(curves.r, np.maximum(curves.disagreement, least), ".", color=INK, markersize=1.6)
    ax.axhline(curves.bound, color=BOUND, linewidth=0.8)
    top = float(np.nanmax(curves.disagreement, initial=curves.bound))
    ax.set_ylim(FLOOR, 30.0 * min(top, 1e3))
    ax.set_ylabel("relative $|F + dU/dr|$")
    place: Any = {"xytext": (4, 3), "textcoords": "offset points"}
    ax.annotate("bound", (curves.r[0], curves.bound), fontsize=NOTE_SIZE, color=BOUND, **place)
