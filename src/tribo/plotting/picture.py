"""The drawing of all asperites, few in detail and many as points, which can be moved."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting.pose import Pose
from tribo.plotting.style import INK, figure_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection

# Above this number of asperites, bobs alone are drawn: bars and rods would cover one another.
MOST_DETAILED = 120
# Colours of bars whose bobs are below and above them.
DOWN_COLOUR = "#3f74b5"
UP_COLOUR = "#6b7280"
# Colours of rods, bobs, centres of mass and bath oscillators.
ROD_COLOUR = "#b98a2f"
BOB_COLOUR = "#f3c969"
CM_COLOUR = "#d7301f"
BATH_COLOUR = "#9a5fb5"
# Widths of bars, rods and the dots of oscillators [rod length].
BAR = 0.1
ROD = 0.06
DOT = 0.06
# Radii of bobs, pivots and centres of mass [rod length].
BOB = 0.09
PIVOT = 0.022
CM = 0.045
# Least widths of bars and rods, and least radius of bobs [points].
LEAST_BAR = 1.0
LEAST_ROD = 0.6
LEAST_BOB = 1.25
# Largest width of edges [points], and their usual one [rod length].
EDGE_WIDTH = 0.5
EDGE_PART = 0.015
# Radius of torsion springs, and half their width [rod length].
RADIUS = 0.17
SWELL = 0.024
# Windings on each side of a torsion spring, and points of each winding.
WINDINGS = 5
TURN = 24
# Windings of a lattice spring.
ZIGZAGS = 8
# Half the width of a lattice spring [distance of the bars].
SPRING = 0.03
# Angles of the points of a circle, and its points.
AROUND = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
RING = np.stack([np.cos(AROUND), np.sin(AROUND)], axis=1)


class Picture:
    """A drawing of a pose, which can be moved to others of the same asperites; limits stay.

    `point` is the length of a typographic point in the drawing, and `swing` the least one that has
    the strongest colour where asperites are many [rad].
    """

    def __init__(self, ax: Axes, now: Pose, point: float, swing: float = 1.0) -> None:
        """Add the parts of asperites to the axes.

        `point` is the length of a typographic point in the axes.  The colours of many asperites
        range over swings from `-swing` to `swing` [rad].
        """
        from matplotlib.collections import LineCollection, PolyCollection

        self._point = point
        self.swings: PathCollection | None = None
        """What a colour bar of the swings needs; None where asperites are drawn in detail."""
        size = float(np.median(now.rods)) / point
        self._dots = ax.scatter([], [], s=(DOT * size) ** 2, zorder=2.0, color=BATH_COLOUR)
        self._parts: dict[str, Any] = {}
        self._has_springs = size > 12.0  # they cannot be seen beside shorter rods
        if len(now.bars) > MOST_DETAILED:
            marks: Any = {"s": max(1.5, 2.0 * BOB * size) ** 2, "linewidth": 0.2, "zorder": 2.6}
            marks |= {"vmin": -swing, "vmax": swing, "cmap": "coolwarm", "edgecolors": "0.5"}
            self.swings = ax.scatter(now.bobs[:, 0], now.bobs[:, 1], c=now.swing, **marks)
        else:
            edge: Any = {"edgecolors": INK, "linewidths": min(EDGE_WIDTH, EDGE_PART * size)}
            bars = [DOWN_COLOUR if up > 0.0 else UP_COLOUR for up in now.up]
            line: Any = {"colors": INK, "linewidths": 0.7}
            self._parts["bonds"] = LineCollection([], **line)
            self._parts["springs"] = LineCollection([], **line | {"linewidths": 0.4})
            colours: dict[str, Any] = {"bars": bars, "rods": ROD_COLOUR, "bobs": BOB_COLOUR}
            colours |= {"pivots": INK, "cms": CM_COLOUR}
            for name, colour in colours.items():
                self._parts[name] = PolyCollection([], facecolors=colour, **edge)
            for k, part in enumerate(self._parts.values()):
                part.set_zorder(2.1 + 0.1 * k)
                ax.add_collection(part, autolim=False)
        self.show(now)

    @property
    def artists(self) -> list[Any]:
        """What `show` moves, from the back to the front."""
        return [self._dots, *self._parts.values(), *([self.swings] if self.swings else [])]

    def show(self, now: Pose) -> None:
        """Move all parts to a pose."""
        self._dots.set_offsets(now.dots)
        if self.swings is not None:
            self.swings.set_offsets(now.bobs)
            self.swings.set_array(now.swing)
            return
        rods = now.rods
        parts = self._parts
        parts["bonds"].set_segments([_zigzag(*now.bars[pair]) for pair in now.joined])
        twisted = np.flatnonzero(now.is_twisted) if self._has_springs else ()
        parts["springs"].set_segments([_torsion_spring(now, k) for k in twisted])
        left, right = now.ends.swapaxes(0, 1)
        parts["bars"].set_verts(_beams(left, right, self._least(BAR * rods, LEAST_BAR)))
        parts["rods"].set_verts(_beams(now.bars, now.bobs, self._least(ROD * rods, LEAST_ROD)))
        parts["bobs"].set_verts(_discs(now.bobs, self._least(BOB * rods, LEAST_BOB)))
        parts["pivots"].set_verts(_discs(now.bars, PIVOT * rods))
        parts["cms"].set_verts(_discs(now.cms, CM * rods))

    def _least(self, sizes: np.ndarray, points: float) -> np.ndarray:
        """Sizes (n,) [length] that are at least so many points."""
        return np.maximum(sizes, points * self._point)


def _beams(starts: np.ndarray, ends: np.ndarray, widths: np.ndarray) -> np.ndarray:
    """(n, 4, 2) corners of rectangles around lines."""
    along = ends - starts
    lengths = np.maximum(np.hypot(*along.T), np.finfo(float).tiny)
    aside = np.stack([-along[:, 1], along[:, 0]], axis=1) * (0.5 * widths / lengths)[:, None]
    return np.stack([starts + aside, ends + aside, ends - aside, starts - aside], axis=1)


def _discs(centres: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """(n, points, 2) of circles."""
    return np.asarray(centres[:, None] + radii[:, None, None] * RING)


def _torsion_spring(now: Pose, k: int | np.intp) -> np.ndarray:
    """(points, 2) a line from one half of a bar to the rod and to the other half.

    Each side has a fixed number of windings, which a swing compresses or stretches.
    """
    length = now.rods[k]
    across = now.phi[k] - 0.5 * np.pi * now.up[k]  # direction of the rod at rest
    at_bar = np.arcsin(0.5 * BAR / RADIUS)
    s = np.linspace(0.0, 1.0, TURN * WINDINGS)
    turn = 2.0 * np.pi * WINDINGS * s
    wave = length * (RADIUS + SWELL * np.sin(turn))
    paths = []
    for side in (-1.0, 1.0):
        start = across + side * (0.5 * np.pi - at_bar)
        angle = start + (across + now.swing[k] - start) * (s - 0.05 * (1.0 - np.cos(turn)))
        paths.append(now.bars[k] + wave[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    return np.concatenate([paths[0], paths[1][::-1]])


def _zigzag(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(points, 2) the line of a lattice spring between two bars."""
    along = np.linspace(0.0, 1.0, 2 * ZIGZAGS + 2)[:, None]
    aside = np.array([start[1] - end[1], end[0] - start[0]]) * SPRING
    signs = np.array([0.0, *([1.0, -1.0] * ZIGZAGS), 0.0])[:, None]
    return np.asarray(start + along * (end - start) + signs * aside)


def colour_bar(
    ax: Axes, colours: PathCollection, place: tuple[float, float], width: float, height: float
) -> None:
    """Draw the scale of the swings in a box, whose place and size are in the units of `ax`."""
    inset = ax.inset_axes((*place, width, height), transform=ax.transData)
    bar = figure_of(ax).colorbar(colours, cax=inset, orientation="horizontal", extend="both")
    bar.set_label("swing (rad)", fontsize=7.0, labelpad=0.0)
    bar.ax.tick_params(labelsize=6.0, top=False, pad=1.0)
    bar.ax.minorticks_off()
