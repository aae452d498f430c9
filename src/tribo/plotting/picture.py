"""All asperites at one sample, few in detail and many as points, in a drawing that can move."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo.model.surface import Surface
from tribo.plotting.geometry import joined_bars
from tribo.plotting.oscillators import oscillator_dots
from tribo.plotting.style import INK
from tribo.results.run_result import RunResult
from tribo.validation import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection

# Above this number of asperites, bobs alone are drawn: bars and rods would cover one another.
MOST_DETAILED = 120

# Displacement in the drawing for a depth of 1, to the right and upward (oblique projection).
OBLIQUE = np.array([0.35, 0.2])

# Colours of bars, by where the surface faces; of rods, bobs and bath oscillators.
COLOURS = {"down": "#3f74b5", "up": "#6b7280"}
ROD_COLOUR, BOB_COLOUR, BATH_COLOUR = "#b98a2f", "#f3c969", "#9a5fb5"

# Colours of the swing of many bobs, from the most negative to the most positive.
SWING_COLOURS = "coolwarm"

# Diameters of a bob and of a bath oscillator, widths of a bar and of a rod [rod length].
BOB, DOT, BAR, ROD = 0.2, 0.06, 0.1, 0.05

# Windings of a lattice spring, and half its width [distance of the bars].
WINDINGS, SPRING = 8, 0.03


class Pose(NamedTuple):
    """Places of all asperites at one sample, those of one surface after those of another.

    Attributes
    ----------
    bars, bobs : ndarray, (n, 2)
        Centres in the drawing [length].
    dots : ndarray, (m, 2)
        Bath oscillators; none unless they are asked for [length].
    ends : ndarray, (n, 2, 2)
        Left and right end of each bar [length].
    swing : ndarray, (n,)
        Angle of the pendulum from its rest [rad].
    """

    bars: np.ndarray
    bobs: np.ndarray
    ends: np.ndarray
    swing: np.ndarray
    dots: np.ndarray

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of all bars, bobs and dots."""
        points = np.concatenate([self.ends.reshape(-1, 2), self.bobs, self.dots])
        (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
        return float(left), float(right), float(bottom), float(top)


def pose(result: RunResult, sample: int, bath: bool = False) -> Pose:
    """The asperites at a sample, those at a depth shifted to the right and upward.

    Parameters
    ----------
    result : RunResult
    sample : int
    bath : bool
        Whether bath oscillators are drawn.

    Returns
    -------
    Pose

    Raises
    ------
    InputError
        The run was too large to keep the places of single asperites, or those of the bath's
        oscillators are not recorded.
    """
    parts = [_pose(result, surface, sample) for surface in result.scene.surfaces]
    dots = oscillator_dots(result, np.array([sample])) if bath else {}
    surfaces = {surface.name: surface for surface in result.scene.surfaces}
    places = [
        (group[0] + _shift(surfaces[name])[:, None]).reshape(-1, 2) for name, group in dots.items()
    ]
    bars, bobs, ends, swing = map(np.concatenate, zip(*parts, strict=True))
    return Pose(bars, bobs, ends, swing, np.concatenate([np.empty((0, 2)), *places]))


def _shift(surface: Surface) -> np.ndarray:
    """(n, 2) displacement in the drawing of each asperite, for its depth."""
    return np.asarray(surface.resting_bobs()[:, 2:] * OBLIQUE)


def _pose(result: RunResult, surface: Surface, sample: int) -> tuple[np.ndarray, ...]:
    series = result[surface.name]
    if len(series["theta"]) != len(result.t):
        raise InputError("output.samples", "must be fewer, to keep the places of single asperites")
    shift = _shift(surface)
    bars, bobs = (
        np.stack([series[f"{axis}_{point}"][sample] for axis in "xy"], axis=1) + shift
        for point in ("bar", "bob")
    )
    phi = series["phi"][sample]
    half = 0.5 * surface.each["bar_length"][:, None]
    half = half * np.stack([np.cos(phi), np.sin(phi)], axis=1)
    ends = np.stack([bars - half, bars + half], axis=1)
    return bars, bobs, ends, series["theta"][sample] - surface.rest - phi


def _zigzag(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(n, 2) the line of a lattice spring between two bars."""
    along = np.linspace(0.0, 1.0, 2 * WINDINGS + 2)[:, None]
    aside = np.array([start[1] - end[1], end[0] - start[0]]) * SPRING
    signs = np.array([0.0, *([1.0, -1.0] * WINDINGS), 0.0])[:, None]
    return np.asarray(start + along * (end - start) + signs * aside)


class Picture:
    """A drawing of all asperites of a result, which can be moved from sample to sample.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        The axes to draw on.  Their limits stay as they are.
    result : RunResult
    scale : float
        Size of one unit of length in the drawing [points].
    swing : float
        The least swing that has the strongest colour where asperites are many [rad].
    bath : bool
        Whether bath oscillators are drawn.
    """

    def __init__(
        self, ax: Axes, result: RunResult, scale: float, swing: float, bath: bool = False
    ) -> None:
        from matplotlib.collections import LineCollection

        self._result = result
        self._bath = bath
        surfaces = result.scene.surfaces
        facing = np.concatenate([[s.facing] * s.count for s in surfaces])
        rods = np.concatenate([s.each["length"] for s in surfaces])
        starts = np.cumsum([0, *(s.count for s in surfaces)])
        parts = [joined_bars(s) + start for s, start in zip(surfaces, starts, strict=False)]
        self._joined = np.concatenate(parts)
        self._is_detailed = facing.size <= MOST_DETAILED
        size = float(np.median(rods)) * scale
        marks: dict[str, Any] = {"linewidth": 0.5, "edgecolors": INK, "color": BOB_COLOUR}
        if self._is_detailed:
            empty: list[np.ndarray] = []
            self._rods = LineCollection(empty, linewidths=max(0.6, ROD * size), colors=ROD_COLOUR)
            colours = [COLOURS[each] for each in facing]
            self._bars = LineCollection(empty, linewidths=max(1.0, BAR * size), colors=colours)
            self._springs = LineCollection(empty, linewidths=0.7, colors=INK)
            ordered = ((self._springs, 1.9), (self._rods, 2.1), (self._bars, 2.2))
            for lines, order in ordered:
                ax.add_collection(lines, autolim=False)
                lines.set_zorder(order)
        else:
            marks = {
                "linewidth": 0.2,
                "edgecolors": "0.5",
                "cmap": SWING_COLOURS,
                "vmin": -swing,
                "vmax": swing,
            }
            marks["c"] = np.zeros(facing.size)
        nothing = np.zeros(facing.size)
        diameter = max(1.5 if not self._is_detailed else 2.5, BOB * size)
        self._bobs = ax.scatter(nothing, nothing, s=diameter**2, zorder=2.3, **marks)

        self._dots = ax.scatter([], [], s=(DOT * size) ** 2, zorder=2.0, color=BATH_COLOUR)

    @property
    def colours(self) -> PathCollection | None:
        """What a colour bar of the swing needs; None where bobs have no colours."""
        return None if self._is_detailed else self._bobs

    @property
    def artists(self) -> list[Any]:
        """What `show` moves, from the back to the front."""
        detail = [self._springs, self._rods, self._bars] if self._is_detailed else []
        return [self._dots, *detail, self._bobs]

    def show(self, sample: int, shift: tuple[float, float] = (0.0, 0.0)) -> None:
        """Move all asperites to their places at a sample, displaced by `shift` [length]."""
        now = pose(self._result, sample, self._bath)
        self._bobs.set_offsets(now.bobs + shift)
        self._dots.set_offsets(now.dots + shift)
        if self._is_detailed:
            self._bars.set_segments(list(now.ends + shift))
            self._springs.set_segments([_zigzag(*now.bars[pair]) + shift for pair in self._joined])
            self._rods.set_segments(list(np.stack([now.bars, now.bobs], axis=1) + shift))
        else:
            self._bobs.set_array(now.swing)
