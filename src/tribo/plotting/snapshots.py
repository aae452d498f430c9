"""Drawings of asperites: snapshots, and sequences of them with the displacements in between.

Lengths are in the scene's units, so that a bob is drawn where the run had it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting.geometry import (
    AsperiteGeometry,
    Contacts,
    SceneGeometry,
    scene_geometry,
    shifted,
)
from tribo.plotting.style import (
    COLUMN,
    EDGE,
    INK,
    arrow,
    drawing_on,
    frame,
    note,
    point_length,
    time_labels,
)
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.patches import Circle, Rectangle

# Distance between lines of labels [points].
LINE = 14.0

# Margin for labels left of a sequence [points].
MARGIN = 42.0

# Radius of a bob [rod length].
BOB_RADIUS = 0.09

# Colours of bars and bobs, by where the surface faces; of rods; of centres of mass.
STEEL = {"down": "#c9d9ee", "up": "#d9dde3"}
ROD_COLOUR = "#fbf3d0"
CM_COLOUR = "#d7301f"

# Line styles, and subscripts in labels, of the points of an asperite.
GUIDES = {"bar": ":", "cm": (0, (6, 1.5, 1, 1.5)), "bob": (0, (4, 2))}
SUBSCRIPTS = {"bar": "2", "cm": r"{\rm cm}", "bob": "1"}


def draw_asperite(ax: Axes, asperite: AsperiteGeometry, zorder: float = 2.0) -> dict[str, Artist]:
    """Draw bar, rod, bob, torsion spring and centre of mass.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
    asperite : AsperiteGeometry
    zorder : float
        matplotlib's order of the first part; those of the others follow within 1.

    Returns
    -------
    dict of str to matplotlib.artist.Artist
        "spring", "bar", "rod", "bob", "pivot" and "cm".
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Circle, Rectangle

    size = asperite.length
    edge: dict[str, Any] = {"edgecolor": INK, "linewidth": 0.5}
    steel = STEEL[asperite.facing]

    def beam(
        start: np.ndarray, angle: float, length: float, width: float, colour: str
    ) -> Rectangle:
        x, y = start + 0.5 * width * np.array([np.sin(angle), -np.cos(angle)])
        return Rectangle((x, y), length, width, angle=np.degrees(angle), facecolor=colour, **edge)

    def dot(centre: np.ndarray, radius: float, colour: str) -> Circle:
        x, y = centre
        return Circle((x, y), radius * size, facecolor=colour, **edge)

    parts: dict[str, Artist] = {
        "spring": Line2D(*_spring(asperite), color=INK, linewidth=0.4),
        "bar": beam(asperite.ends[0], asperite.phi, asperite.bar_length, 0.1 * size, steel),
        "rod": beam(asperite.bar, asperite.theta - 0.5 * np.pi, size, 0.06 * size, ROD_COLOUR),
        "bob": dot(asperite.bob, BOB_RADIUS, steel),
        "pivot": dot(asperite.bar, 0.022, INK),
        "cm": dot(asperite.cm, 0.045, CM_COLOUR),
    }
    for k, part in enumerate(parts.values()):
        part.set_zorder(zorder + 0.1 * k)
        ax.add_artist(part)
    return parts


def _spring(asperite: AsperiteGeometry) -> np.ndarray:
    """(2, points) the torsion spring, from one half of the bar to the rod and to the other half.

    Each side has a fixed number of windings, which a swing compresses or stretches.
    """
    radius, swell, windings = 0.17 * asperite.length, 0.024 * asperite.length, 5
    across = asperite.phi - 0.5 * np.pi * asperite.up  # direction of the rod at rest
    at_bar = np.arcsin(0.05 * asperite.length / radius)
    s = np.linspace(0.0, 1.0, 40 * windings)
    turn = 2.0 * np.pi * windings * s
    wave = radius + swell * np.sin(turn)
    rod = asperite.theta - 0.5 * np.pi
    paths = []
    for side in (-1.0, 1.0):
        start = across + side * (0.5 * np.pi - at_bar)
        angle = start + (rod - start) * (s - 0.05 * (1.0 - np.cos(turn)))
        paths.append(asperite.bar[:, None] + wave * np.array([np.cos(angle), np.sin(angle)]))
    return np.concatenate([paths[0], paths[1][:, ::-1]], axis=1)


def draw_asperites(ax: Axes, geometry: SceneGeometry) -> None:
    """Draw all asperites, the farthest in z first.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        Axes to draw in.
    geometry : SceneGeometry
        The asperites, as of :func:`scene_geometry`.
    """
    everything = [each for group in geometry.values() for each in group]
    depths = sorted({each.depth for each in everything})
    for each in everything:
        draw_asperite(ax, each, zorder=2.0 + depths.index(each.depth))


def snapshot(
    result: RunResult, t: float, forces: tuple[str, int] | None = None, ax: Axes | None = None
) -> Axes:
    """Draw all asperites at a time, and the contact force on one of them.

    Parameters
    ----------
    result : RunResult
    t : float
        Time, from the first sample to the last [time].
    forces : tuple of str and int, optional
        Surface and asperite whose contact force f1 is shown, and that on the nearest bob of
        another surface.  Arrows have the directions of the forces, not their sizes.  There is no
        arrow where no force acts.
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    InputError
        If `t` is outside the run, or a calculator of the scene fails.
    """
    geometry = scene_geometry(result, t)
    with drawing_on(ax, COLUMN) as ax:
        draw_asperites(ax, geometry)
        if forces is not None:
            _force_arrows(ax, Contacts(result.scene, geometry), geometry, *forces)
        frame(ax, extent(geometry))
    return ax


def extent(*geometries: SceneGeometry) -> tuple[float, float, float, float]:
    """The box around asperites with room for arrows at their bobs.

    Parameters
    ----------
    *geometries : SceneGeometry
        The asperites at one or several times.

    Returns
    -------
    tuple of float
        Left, right, bottom and top [length].
    """
    everything = [each for one in geometries for group in one.values() for each in group]
    ends = np.concatenate([each.ends for each in everything])
    bobs = np.array([each.bob for each in everything])
    size = max(each.length for each in everything)
    room = np.array([0.56, 0.1]) * size
    low = np.minimum(ends.min(0) - 0.06 * size, bobs.min(0) - room)
    high = np.maximum(ends.max(0) + 0.06 * size, bobs.max(0) + room)
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])


def _force_arrows(
    ax: Axes, contacts: Contacts, geometry: SceneGeometry, surface: str, asperite: int
) -> None:
    """Arrows at an asperite and at its nearest neighbour, where a force acts.

    `geometry` says where the arrows start; it may be shifted.
    """
    nearest = contacts.nearest(surface, asperite)
    if nearest is None:
        return
    other_surface, other, distance = nearest
    for name, k in ((surface, asperite), (other_surface, other)):
        force = contacts.force(name, k)
        if np.any(force) and np.all(np.isfinite(force)):
            _force_arrow(ax, geometry[name][k], force / np.hypot(*force), distance)


def _force_arrow(
    ax: Axes, asperite: AsperiteGeometry, direction: np.ndarray, distance: float
) -> None:
    """Draw a force; two forces that point at each other over `distance` do not touch."""
    edge = BOB_RADIUS * asperite.length
    reach = min(0.55 * asperite.length, max(0.43 * distance, 2.0 * edge))
    start, tip = asperite.bob + edge * direction, asperite.bob + reach * direction
    arrow(ax, start, tip)
    letter = "f" if asperite.facing == "down" else "F"
    aside = np.array([-direction[1], direction[0]])
    aside *= 10.0 * np.copysign(1.0, aside[1] * asperite.up)
    note(ax, 0.5 * (start + tip), rf"$\vec{{{letter}}}_1$", tuple(aside))


def sequence(
    result: RunResult,
    times: Sequence[float],
    surface: str = "upper",
    asperite: int = 0,
    points: Sequence[str] = ("bar", "cm", "bob"),
    phases: Sequence[str] = (),
    ax: Axes | None = None,
) -> Axes:
    """Draw snapshots below one another, and the displacements of one asperite between them.

    Contact forces are shown in the first and the last snapshot.

    Parameters
    ----------
    result : RunResult
    times : sequence of float
        Times of the snapshots [time].
    surface, asperite : str, int
        The asperite whose displacements along x and contact force are shown.
    points : sequence of str
        Its points, of "bar", "cm" and "bob".
    phases : sequence of str
        Words beside the gaps, one fewer than the times.
    ax : matplotlib.axes.Axes, optional
        The axes to draw on; by default a new figure.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    InputError
        If a time is outside the run, or a calculator of the scene fails.
    """
    geometries = [scene_geometry(result, t) for t in times]
    boxes = np.array([extent(geometry) for geometry in geometries])
    left, right = boxes[:, 0].min(), boxes[:, 1].max()
    beside: dict[str, Any] = {"offset": (EDGE - MARGIN, 0.0), "ha": "left"}
    with drawing_on(ax, COLUMN) as ax:
        point = point_length(ax, (left, right, 0.0, 0.0), left=MARGIN)
        gap = (len(points) + 1.2) * LINE * point
        floor, before = 0.0, None
        for k, (geometry, label) in enumerate(zip(geometries, time_labels(times), strict=True)):
            top = floor - gap if k else 0.0
            row = shifted(geometry, (0.0, top - boxes[k, 3]))
            after = row[surface][asperite]
            draw_asperites(ax, row)
            if k in (0, len(times) - 1):
                _force_arrows(ax, Contacts(result.scene, geometry), row, surface, asperite)
            note(ax, (left, after.bob[1]), label, **beside)
            if before is not None:
                _displacements(ax, before, after, points, floor, point)
                if phases:
                    note(ax, (left, floor - 0.5 * gap), phases[k - 1], style="italic", **beside)
            floor, before = extent(row)[2], after
        frame(ax, (left, right, floor, 0.0), left=MARGIN)
    return ax


def _displacements(
    ax: Axes,
    before: AsperiteGeometry,
    after: AsperiteGeometry,
    points: Sequence[str],
    ceiling: float,
    point: float,
) -> None:
    """Draw an arrow for each point, one below the other, between guides to the two asperites.

    `point` is the length of a typographic point.
    """
    levels = ceiling - LINE * point * np.arange(1, len(points) + 1)
    begins = np.array([getattr(before, name) for name in points])
    ends = np.array([getattr(after, name) for name in points])
    looks = [GUIDES[name] for name in points]
    _guides(ax, looks, begins, levels - 5.0 * point, 2.5 * point)
    _guides(ax, looks[::-1], ends[::-1], (levels + 5.0 * point)[::-1], 2.5 * point)
    side = _free_side(begins[:, 0], ends[:, 0], 32.0 * point)
    letter = "x" if before.facing == "down" else "X"
    where = {"ha": "left" if side > 0.0 else "right", "bbox": {"fc": "w", "ec": "none", "pad": 0.5}}
    for name, y, start, tip in zip(points, levels, begins[:, 0], ends[:, 0], strict=True):
        head = min(8.0, 1.2 * abs(tip - start) / point)  # a short arrow has a small head
        if head > 0.5:
            arrow(ax, (start, y), (tip, y), mutation_scale=head)
        text = rf"$\Delta {letter}_{{{SUBSCRIPTS[name]}}}$"
        note(ax, (side * max(side * start, side * tip), y), text, (4.0 * side, 0.5), **where)


def _guides(
    ax: Axes, looks: Sequence[Any], starts: np.ndarray, ends: np.ndarray, near: float
) -> None:
    """Draw vertical lines from points (n, 2) to heights (n,), the nearest height first.

    Where two lines would overlap, within `near`, the second begins at the end of the first.
    """
    drawn: list[tuple[float, float]] = []
    for look, (x, y), end in zip(looks, starts, ends, strict=True):
        begin = next((stop for other, stop in drawn[::-1] if abs(other - x) < near), y)
        ax.plot([x, x], [begin, end], color=INK, linewidth=0.7, linestyle=look, zorder=1)
        drawn.append((x, end))


def _free_side(starts: np.ndarray, tips: np.ndarray, width: float) -> float:
    """-1 if labels of that width fit left of all arrows without crossing a guide, else +1.

    The guides beside an arrow are those from above to it and to lower arrows, and those from below
    to it and to higher arrows.
    """
    for j, (start, tip) in enumerate(zip(starts, tips, strict=True)):
        end = min(start, tip)
        passing = [*starts[j:], *tips[: j + 1]]
        if any(end - width < x < end - 0.06 * width for x in passing):
            return 1.0
    return -1.0
