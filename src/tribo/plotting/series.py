"""Angles and works over time, each line with its name at its end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting.style import INK, POINTS_PER_INCH
from tribo.run.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WORKS = {  # subscript and colour of each; a pseudowork has its work's
    "w1": ("1", "#0b62a4"),
    "w2": ("2", "#d55e00"),
    "wL": ("L", "#2fae8c"),
    "wR": ("R", "#7d2f86"),
    "w_int": (r"{\rm int}", "#8a6f00"),
    "w_field": (r"{\rm field}", "#c2185b"),
    "w_T": ("T", "#607d8b"),
    "w": ("", INK),
}


def angle_curve(
    ax: Axes, result: Result, surface: str = "upper", asperite: int = 0, **properties: Any
) -> Any:
    """theta(t) of an asperite [rad]; returns the line."""
    theta = result[surface].theta[:, asperite]
    facing = {s.name: s.facing for s in result.scene.surfaces}[surface]
    (line,) = ax.plot(result.t, theta, **({"color": WORKS["w1"][1]} | properties))
    ax.set_xlabel("$t$")
    ax.set_ylabel(r"$\theta$ (rad)" if facing == "down" else r"$\Theta$ (rad)")
    ax.set_xlim(result.t[0], result.t[-1])
    return line


def work_curves(
    ax: Axes,
    result: Result,
    surface: str = "upper",
    asperite: int = 0,
    span: tuple[float, float] | None = None,
) -> dict[str, Any]:
    """Works on an asperite over time, pseudoworks dashed; returns the lines by their names.

    What is nothing throughout is left out.  Labels stand at the end of the `span` of time.
    """
    from matplotlib.ticker import MaxNLocator

    series = result[surface]
    span = span or (float(result.t[0]), float(result.t[-1]))
    lines, labels = {}, []
    for suffix, ending in (("", ""), ("_ps", r"{,}{\rm ps}")):
        for work, (subscript, colour) in WORKS.items():
            name = work + suffix
            if name == "w_ps" or name not in series or not np.any(series[name][:, asperite]):
                continue
            look: dict[str, Any] = {"linestyle": (0, (4, 2))} if suffix else {}
            look |= {"linewidth": 1.6, "zorder": 3} if name == "w" else {}
            values = series[name][:, asperite]
            (lines[name],) = ax.plot(result.t, values, color=colour, **look)
            labels.append(f"$w_{{{subscript}{ending}}}$")
    ax.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    ax.set_xlabel("$t$")
    ax.set_ylabel("work")
    ax.set_xlim(*span)
    ax.xaxis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10]))
    if lines:
        _label_ends(ax, dict(zip(labels, lines.values(), strict=True)), span[1])
    return lines


def _label_ends(ax: Axes, lines: dict[str, Any], t: float) -> None:
    """Labels right of the frame, each beside its line's end and clear of its neighbours."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high)
    values = np.array([np.interp(t, *line.get_data()) for line in lines.values()])
    height = ax.bbox.height / ax.figure.dpi * POINTS_PER_INCH
    places = spread((values - low) / (high - low), 11.0 / height)
    for (label, line), value, place in zip(lines.items(), values, places, strict=True):
        colour = line.get_color()
        ax.annotate(
            label,
            xy=(1.0, (value - low) / (high - low)),
            xytext=(1.06, place),
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


def spread(places: np.ndarray, gap: float) -> np.ndarray:
    """The nearest places from 0 to 1 in the same order that are at least `gap` apart."""
    order = np.argsort(places, kind="stable")
    groups: list[list[float]] = []  # of places less their turn's share, which only may not fall
    for turn, place in enumerate(places[order]):
        groups.append([float(place) - turn * gap])
        while len(groups) > 1 and np.mean(groups[-2]) > np.mean(groups[-1]):
            last = groups.pop()
            groups[-1] += last
    level = np.concatenate([np.full(len(group), np.mean(group)) for group in groups])
    turns = np.arange(len(places))
    apart = np.empty(len(places))
    apart[order] = np.clip(level, 0.0, 1.0 - gap * turns[-1]) + gap * turns
    return apart
