"""Angles and works over time, each line labelled at its end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting.style import COLUMN, INK, POINTS_PER_INCH, drawing_on
from tribo.results.run_result import RunResult
from tribo.validation import must_be

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

# Subscript and colour of each work; a pseudowork has those of its work.
WORKS = {
    "w1": ("1", "#0b62a4"),
    "w2": ("2", "#d55e00"),
    "wL": ("L", "#2fae8c"),
    "wR": ("R", "#7d2f86"),
    "w_int": (r"{\rm int}", "#8a6f00"),
    "w_field": (r"{\rm field}", "#c2185b"),
    "w_T": ("T", "#607d8b"),
    "w": ("", INK),
}

# What each work is of, in words.
MEANINGS = {
    "w1": "friction (contact)",
    "w2": "drive",
    "wL": "left end of the bar",
    "wR": "right end of the bar",
    "w_int": "inside the surface",
    "w_field": "fields",
    "w_T": "reservoir",
    "w": "all forces",
}

# Distance between labels at the ends of lines [points].
LABEL_GAP = 11.0


def angle_curve(
    result: RunResult, surface: str = "upper", asperite: int = 0, ax: Axes | None = None
) -> Axes:
    """Draw theta over time [rad].

    Parameters
    ----------
    result : RunResult
    surface, asperite : str, int
        The asperite.
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        Its last line is the angle, with the label "theta".
    """
    theta = result[surface].theta[:, asperite]
    facing = {s.name: s.facing for s in result.scene.surfaces}[surface]
    with drawing_on(ax, COLUMN, 0.62 * COLUMN) as ax:
        ax.plot(result.t, theta, color=WORKS["w1"][1], label="theta")
        ax.set_xlabel("$t$")
        ax.set_ylabel(r"$\theta$ (rad)" if facing == "down" else r"$\Theta$ (rad)")
        ax.set_xlim(result.t[0], result.t[-1])
    return ax


def work_curves(
    result: RunResult,
    surface: str = "upper",
    asperite: int | None = 0,
    span: tuple[float, float] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the works on an asperite or on a surface over time, pseudoworks dashed.

    Works that are zero throughout are left out, and so is the total pseudowork.

    Parameters
    ----------
    result : RunResult
    surface : str
    asperite : int or None
        None for the sums over all asperites of the surface.
    span : tuple of float, optional
        Times between which curves are shown; labels stand at the later one [time].  All without it.
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The label of each line is the name of the work in the ledger, as "w1_ps".

    Raises
    ------
    InputError
        The result has no works, or none of single asperites.
    """
    from matplotlib.ticker import MaxNLocator

    ledger = result.scene.output.ledger
    if ledger == "none" or (asperite is not None and ledger != "asperites"):
        raise must_be("output.ledger", '"asperites" for works of single asperites', ledger)
    series = works_of(result, surface, asperite)
    span = span or (float(result.t[0]), float(result.t[-1]))
    lines: dict[str, Line2D] = {}
    with drawing_on(ax, COLUMN, 0.72 * COLUMN) as ax:
        for suffix, ending in (("", ""), ("_ps", r"{,}{\rm ps}")):
            for work, (subscript, colour) in WORKS.items():
                name = work + suffix
                if name == "w_ps" or name not in series or not np.any(series[name]):
                    continue
                look: dict[str, Any] = {"linestyle": (0, (4, 2))} if suffix else {}
                look |= {"linewidth": 1.6, "zorder": 3} if name == "w" else {}
                (line,) = ax.plot(result.t, series[name], color=colour, label=name, **look)
                lines[f"$w_{{{subscript}{ending}}}$"] = line
        ax.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
        ax.set_xlabel("$t$")
        ax.set_ylabel("work")
        ax.set_xlim(*span)
        ax.xaxis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10]))
        if lines:
            _label_ends(ax, lines, span[1])
    return ax


def works_of(result: RunResult, surface: str, asperite: int | None) -> dict[str, np.ndarray]:
    """Works and pseudoworks by name, (times,): of one asperite, or summed over the surface."""
    series = result[surface]
    names = [work + suffix for work in WORKS for suffix in ("", "_ps")]
    found = {name: series[name] for name in names if name in series}
    if asperite is not None:
        return {name: values[:, asperite] for name, values in found.items()}
    return {name: values.reshape(len(result.t), -1).sum(axis=1) for name, values in found.items()}


def _label_ends(ax: Axes, lines: dict[str, Line2D], t: float) -> None:
    """Write labels right of the frame, each beside the end of its line and clear of the others."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high)
    values = np.array([np.interp(t, *np.asarray(line.get_data())) for line in lines.values()])
    height = ax.bbox.height / ax.figure.dpi * POINTS_PER_INCH
    levels = spread((values - low) / (high - low), LABEL_GAP / height)
    for (label, line), value, level in zip(lines.items(), values, levels, strict=True):
        colour = line.get_color()
        ax.annotate(
            label,
            xy=(1.0, (value - low) / (high - low)),
            xytext=(1.06, level),
            xycoords="axes fraction",
            va="center",
            color=colour,
            arrowprops={
                "arrowstyle": "-",
                "color": colour,
                "linewidth": 0.5,
                "shrinkA": 0,
                "relpos": (0.0, 0.5),
            },
        )


def spread(levels: np.ndarray, gap: float) -> np.ndarray:
    """Move levels apart, as little as possible in least squares, and keep their order.

    Parameters
    ----------
    levels : ndarray, (n,)
        From 0 to 1.
    gap : float
        Least distance between two levels of the result.

    Returns
    -------
    ndarray, (n,)
        From 0 to 1, as far as there is room.
    """
    order = np.argsort(levels, kind="stable")
    # Levels less `gap` for each level below must not decrease: pool those that do.
    groups: list[list[float]] = []
    for rank, level in enumerate(levels[order]):
        groups.append([float(level) - rank * gap])
        while len(groups) > 1 and np.mean(groups[-2]) > np.mean(groups[-1]):
            last = groups.pop()
            groups[-1] += last
    pooled = np.concatenate([np.full(len(group), np.mean(group)) for group in groups])
    ranks = np.arange(len(levels))
    apart = np.empty(len(levels))
    apart[order] = np.clip(pooled, 0.0, 1.0 - gap * ranks[-1]) + gap * ranks
    return apart
