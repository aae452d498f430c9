"""Pictures of results: asperites, snapshots, sequences of them, angles and works over time.

Everything is drawn into matplotlib Axes that the caller owns::

    with plotting.style():
        ax = plotting.axes(plotting.COLUMN)
        plotting.snapshot(ax, result, t=20.0)
        plotting.save(ax, folder / "snapshot")

Lengths of drawings are in the scene's own units, so that a bob is where the run had it; sizes of
letters, gaps and margins are in points.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.errors import InputError
from tribo.result import Result
from tribo.surface import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLUMN, WIDE = 3.375, 5.1  # one and one-and-a-half columns of a journal [inch]
GOLDEN = 0.62  # height of a graph over its width
POINTS_PER_INCH = 72.0
LINE = 14.0  # from one line of labels to the next [points]

INK = "#1a1a1a"
STEEL = {"down": "#c9d9ee", "up": "#d9dde3"}  # of bars and bobs, by where the surface faces
ROD, MASS_CENTRE = "#fbf3d0", "#d7301f"
COLOURS = {"w1": "#0b62a4", "w2": "#d55e00", "wL": "#00916e", "wR": "#b65d9b", "w": INK}
GUIDES = {"bar": ":", "cm": (0, (6, 1.5, 1, 1.5)), "bob": (0, (4, 2))}  # line styles
SUBSCRIPTS = {"bar": "2", "cm": r"{\rm cm}", "bob": "1"}

STYLE: dict[str, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.minor.visible": True,
    "ytick.minor.visible": True,
    "lines.linewidth": 1.1,
    "savefig.dpi": 300,
    "pdf.fonttype": 42,  # letters stay letters, as journals ask for
}


def style() -> AbstractContextManager[None]:
    """Fonts and lines of a journal, for as long as the context lasts."""
    from matplotlib import rc_context

    return rc_context(STYLE)


def axes(width: float, height: float | None = None) -> Axes:
    """Axes of a new figure [inch]: with a height for a graph, without one for a drawing.

    A drawing fills its figure and has no frame; it takes the height that it needs.
    """
    from matplotlib.figure import Figure

    if height is not None:
        return Figure(figsize=(width, height), layout="constrained").add_subplot()
    ax = Figure(figsize=(width, width)).add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set_axis_off()
    return ax


def save(ax: Axes, stem: Path) -> list[Path]:
    """Write the figure that `ax` is in as ``stem.pdf`` and ``stem.png``."""
    paths = [stem.with_name(stem.name + suffix) for suffix in (".pdf", ".png")]
    for path in paths:
        # Without a date the same picture is the same file.
        stamp = {"CreationDate": None} if path.suffix == ".pdf" else {}
        ax.figure.savefig(path, metadata=stamp)
    return paths


@dataclass(frozen=True)
class Pose:
    """Where an asperite is and what it measures [length, rad]."""

    x: float  # of the centre of mass
    y: float
    theta: float  # of the rod, from straight down
    phi: float  # of the bar
    l1: float  # from the centre of mass to the bob
    l2: float  # from the centre of mass to the bar
    bar_length: float
    facing: str = "down"
    depth: float = 0.0  # z

    @property
    def length(self) -> float:
        """Of the rod, which everything else is drawn in proportion to."""
        return self.l1 + self.l2

    @property
    def along(self) -> np.ndarray:
        """(2,) unit vector from bar to bob."""
        return np.array([np.sin(self.theta), -np.cos(self.theta)])

    @property
    def cm(self) -> np.ndarray:
        """(2,) place of the centre of mass."""
        return np.array([self.x, self.y])

    @property
    def bob(self) -> np.ndarray:
        """(2,) place of the bob."""
        return self.cm + self.l1 * self.along

    @property
    def bar(self) -> np.ndarray:
        """(2,) place of the bar's centre."""
        return self.cm - self.l2 * self.along

    @property
    def ends(self) -> np.ndarray:
        """(2, 2) places of the bar's left and right end."""
        half = 0.5 * self.bar_length * np.array([np.cos(self.phi), np.sin(self.phi)])
        return np.array([self.bar - half, self.bar + half])

    @property
    def up(self) -> float:
        """+1 if the bar is above the bob, -1 if it is below."""
        return 1.0 if self.facing == "down" else -1.0

    def shifted(self, dx: float, dy: float) -> Pose:
        """The same asperite elsewhere."""
        return replace(self, x=self.x + dx, y=self.y + dy)


Poses = dict[str, list[Pose]]  # the asperites of each surface


def poses(result: Result, t: float) -> Poses:
    """All asperites at a time; between samples by the rates that were recorded with them."""
    if not result.t[0] <= t <= result.t[-1]:
        raise InputError("t", f"must be from {result.t[0]:g} to {result.t[-1]:g}, got {t}")
    return {surface.name: _surface_poses(result, surface, t) for surface in result.scene.surfaces}


def _surface_poses(result: Result, surface: Surface, t: float) -> list[Pose]:
    from scipy.interpolate import CubicHermiteSpline

    series = result[surface.name]
    rates = {"x_cm": "vx_cm", "y_cm": "vy_cm", "theta": "omega", "phi": "nu"}
    now = [
        CubicHermiteSpline(result.t, series[name], series[rate])(t) for name, rate in rates.items()
    ]
    each = surface.asperite.for_each(surface.count)
    columns = [*now, each["l1"], each["l2"], each["bar_length"]]
    depths = surface.resting_bobs()[:, 2]
    return [
        Pose(*map(float, row), facing=surface.facing, depth=float(z))
        for row, z in zip(np.transpose(columns), depths, strict=True)
    ]


def draw_asperite(ax: Axes, pose: Pose, zorder: float = 2.0) -> dict[str, Any]:
    """Bar, rod, bob, torsion spring and centre of mass; returns the artists by these names."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Circle, Rectangle

    size = pose.length
    edge = {"edgecolor": INK, "linewidth": 0.7}
    steel = STEEL[pose.facing]

    def beam(start: np.ndarray, angle: float, length: float, width: float, colour: str) -> Any:
        corner = start + 0.5 * width * np.array([np.sin(angle), -np.cos(angle)])
        return Rectangle(
            (float(corner[0]), float(corner[1])),
            length,
            width,
            angle=float(np.degrees(angle)),
            facecolor=colour,
            **edge,
        )

    def dot(place: np.ndarray, radius: float, colour: str) -> Any:
        return Circle((float(place[0]), float(place[1])), radius * size, facecolor=colour, **edge)

    parts: dict[str, Any] = {
        "spring": Line2D(*_spring(pose), color=INK, linewidth=0.5),
        "bar": beam(pose.ends[0], pose.phi, pose.bar_length, 0.1 * size, steel),
        "rod": beam(pose.bar, pose.theta - 0.5 * np.pi, size, 0.05 * size, ROD),
        "bob": dot(pose.bob, 0.09, steel),
        "pivot": dot(pose.bar, 0.022, INK),
        "cm": dot(pose.cm, 0.036, MASS_CENTRE),
    }
    for k, part in enumerate(parts.values()):
        part.set_zorder(zorder + 0.1 * k)
        ax.add_artist(part)
    return parts


def _spring(pose: Pose) -> np.ndarray:
    """(2, points) the torsion spring, from the bar's one half by way of the rod to the other.

    Each side has a fixed number of windings, so that the swing is seen to press and to stretch.
    """
    radius, swell, windings = 0.17 * pose.length, 0.022 * pose.length, 6
    across = pose.phi - 0.5 * np.pi * pose.up  # from the bar, where the rod is at rest
    at_bar = np.arcsin(0.05 * pose.length / radius)
    s = np.linspace(0.0, 1.0, 40 * windings)
    wave = radius + swell * np.sin(2.0 * np.pi * windings * s)
    rod = pose.theta - 0.5 * np.pi
    paths = []
    for side in (-1.0, 1.0):
        start = across + side * (0.5 * np.pi - at_bar)
        angle = start + (rod - start) * s
        paths.append(pose.bar[:, None] + wave * np.array([np.cos(angle), np.sin(angle)]))
    return np.concatenate([paths[0], paths[1][:, ::-1]], axis=1)
