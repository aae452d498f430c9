"""Asperites as they stand: snapshots, and sequences of them with what moved in between.

Lengths of drawings are in the scene's own units, so that a bob is where the run had it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.plotting.geometry import Pose, Poses, contact_force, poses, separation
from tribo.plotting.style import EDGE, INK, arrow, clock, frame, note, unit
from tribo.run.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LINE = 14.0  # from one line of labels to the next [points]
MARGIN = 42.0  # for labels left of a sequence [points]
STEEL = {"down": "#c9d9ee", "up": "#d9dde3"}  # of bars and bobs, by where the surface faces
ROD, MASS_CENTRE = "#fbf3d0", "#d7301f"
GUIDES = {"bar": ":", "cm": (0, (6, 1.5, 1, 1.5)), "bob": (0, (4, 2))}  # line styles
SUBSCRIPTS = {"bar": "2", "cm": r"{\rm cm}", "bob": "1"}


def draw_asperite(ax: Axes, pose: Pose, zorder: float = 2.0) -> dict[str, Any]:
    """Bar, rod, bob, torsion spring and centre of mass; returns the artists by these names."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Circle, Rectangle

    size = pose.length
    edge: dict[str, Any] = {"edgecolor": INK, "linewidth": 0.5}
    steel = STEEL[pose.facing]

    def beam(start: np.ndarray, angle: float, length: float, width: float, colour: str) -> Any:
        corner = start + 0.5 * width * np.array([np.sin(angle), -np.cos(angle)])
        return Rectangle(
            tuple(corner), length, width, angle=np.degrees(angle), facecolor=colour, **edge
        )

    def dot(place: np.ndarray, radius: float, colour: str) -> Any:
        return Circle(tuple(place), radius * size, facecolor=colour, **edge)

    parts: dict[str, Any] = {
        "spring": Line2D(*_spring(pose), color=INK, linewidth=0.4),
        "bar": beam(pose.ends[0], pose.phi, pose.bar_length, 0.1 * size, steel),
        "rod": beam(pose.bar, pose.theta - 0.5 * np.pi, size, 0.06 * size, ROD),
        "bob": dot(pose.bob, 0.09, steel),
        "pivot": dot(pose.bar, 0.022, INK),
        "cm": dot(pose.cm, 0.045, MASS_CENTRE),
    }
    for k, part in enumerate(parts.values()):
        part.set_zorder(zorder + 0.1 * k)
        ax.add_artist(part)
    return parts


def _spring(pose: Pose) -> np.ndarray:
    """(2, points) the torsion spring, from the bar's one half by way of the rod to the other.

    Each side has a fixed number of windings, so that the swing is seen to press and to stretch.
    """
    radius, swell, windings = 0.17 * pose.length, 0.024 * pose.length, 5
    across = pose.phi - 0.5 * np.pi * pose.up  # from the bar, where the rod is at rest
    at_bar = np.arcsin(0.05 * pose.length / radius)
    s = np.linspace(0.0, 1.0, 40 * windings)
    turn = 2.0 * np.pi * windings * s
    wave = radius + swell * np.sin(turn)
    rod = pose.theta - 0.5 * np.pi
    paths = []
    for side in (-1.0, 1.0):
        start = across + side * (0.5 * np.pi - at_bar)
        angle = start + (rod - start) * (s - 0.05 * (1.0 - np.cos(turn)))
        paths.append(pose.bar[:, None] + wave * np.array([np.cos(angle), np.sin(angle)]))
    return np.concatenate([paths[0], paths[1][:, ::-1]], axis=1)


def snapshot(
    ax: Axes,
    result: Result,
    t: float,
    forces: tuple[str, int] | None = None,
    shift: tuple[float, float] = (0.0, 0.0),
) -> Poses:
    """All asperites at a time, the farthest in z first; returns where they were drawn.

    `forces` names a surface and an asperite whose contact force is shown, and the opposite one
    beside it; arrows have the forces' direction, not their size.
    """
    there = {
        name: [replace(pose, cm=pose.cm + shift) for pose in group]
        for name, group in poses(result, t).items()
    }
    depths = sorted({pose.depth for group in there.values() for pose in group})
    for group in there.values():
        for pose in group:
            draw_asperite(ax, pose, zorder=2.0 + depths.index(pose.depth))
    if forces is not None:
        _force_arrows(ax, result, there, *forces)
    frame(ax, extent(there))
    return there


def extent(*groups: Poses) -> tuple[float, float, float, float]:
    """Left, right, bottom and top of asperites with room for arrows at their bobs."""
    everything = [pose for there in groups for group in there.values() for pose in group]
    ends = np.concatenate([pose.ends for pose in everything])
    bobs = np.array([pose.bob for pose in everything])
    size = max(pose.length for pose in everything)
    room = np.array([0.56, 0.1]) * size
    low = np.minimum(ends.min(0) - 0.06 * size, bobs.min(0) - room)
    high = np.maximum(ends.max(0) + 0.06 * size, bobs.max(0) + room)
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])


def _force_arrows(ax: Axes, result: Result, there: Poses, surface: str, asperite: int) -> None:
    """f1 on an asperite, and what its nearest partner feels; none where nothing acts."""
    pose = there[surface][asperite]
    others = [(name, k) for name in there if name != surface for k in range(len(there[name]))]
    distances = [
        float(np.linalg.norm(separation(result.scene, pose, there[name][k]))) for name, k in others
    ]
    chosen = [(surface, asperite)] + [others[k] for k in np.argsort(distances)[:1]]
    for name, k in chosen:
        force = contact_force(result, there, name, k)
        if np.any(force):
            _force_arrow(ax, there[name][k], force / np.hypot(*force), min(distances))


def _force_arrow(ax: Axes, pose: Pose, direction: np.ndarray, distance: float) -> None:
    """Shorter than half the way to another bob, so that two that pull do not collide."""
    edge = 0.09 * pose.length
    reach = min(0.55 * pose.length, max(0.43 * distance, 2.0 * edge))
    start, tip = pose.bob + edge * direction, pose.bob + reach * direction
    arrow(ax, start, tip)
    letter = "f" if pose.facing == "down" else "F"
    aside = np.array([-direction[1], direction[0]])
    aside *= 10.0 * np.copysign(1.0, aside[1] * pose.up)
    note(ax, 0.5 * (start + tip), rf"$\vec{{{letter}}}_1$", tuple(aside))


def sequence(
    ax: Axes,
    result: Result,
    times: Sequence[float],
    surface: str = "upper",
    asperite: int = 0,
    points: Sequence[str] = ("bar", "cm", "bob"),
    phases: Sequence[str] = (),
) -> None:
    """Snapshots below one another, and between them how far points of one asperite moved along x.

    `phases` are words beside the gaps.  Forces are shown in the first and the last snapshot.
    """
    boxes = np.array([extent(poses(result, t)) for t in times])
    left, right = boxes[:, 0].min(), boxes[:, 1].max()
    point = unit(ax, (left, right, 0.0, 0.0), left=MARGIN)
    gap = (len(points) + 1.2) * LINE * point
    beside: dict[str, Any] = {"away": (EDGE - MARGIN, 0.0), "ha": "left"}

    floor, before = 0.0, None
    for k, (t, label) in enumerate(zip(times, clock(times), strict=True)):
        top = floor - gap if k else 0.0
        forces = (surface, asperite) if k in (0, len(times) - 1) else None
        row = snapshot(ax, result, t, forces, shift=(0.0, top - boxes[k, 3]))
        after = row[surface][asperite]
        note(ax, (left, after.bob[1]), label, **beside)
        if before is not None:
            _displacements(ax, before, after, points, floor, point)
            if phases:
                note(ax, (left, floor - 0.5 * gap), phases[k - 1], style="italic", **beside)
        floor, before = extent(row)[2], after
    frame(ax, (left, right, floor, 0.0), left=MARGIN)


def _displacements(
    ax: Axes, before: Pose, after: Pose, points: Sequence[str], ceiling: float, point: float
) -> None:
    """An arrow for each point, one below the other, between guides to the two asperites.

    `point` is the length that a point of the paper is.
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
    ax: Axes, looks: Sequence[Any], places: np.ndarray, ends: np.ndarray, near: float
) -> None:
    """Upright lines from places (n, 2) to their ends, the nearest end first.

    Where two would lie on one another the second begins at the end of the first.
    """
    drawn: list[tuple[float, float]] = []
    for look, (x, y), end in zip(looks, places, ends, strict=True):
        begin = next((stop for other, stop in drawn[::-1] if abs(other - x) < near), y)
        ax.plot([x, x], [begin, end], color=INK, linewidth=0.7, linestyle=look, zorder=1)
        drawn.append((x, end))


def _free_side(starts: np.ndarray, tips: np.ndarray, width: float) -> float:
    """-1 if labels left of all arrows are clear of the guides beside them, else +1.

    Beside an arrow pass the guides from above to it and to lower ones, and those from below to it
    and to higher ones.
    """
    for j, (start, tip) in enumerate(zip(starts, tips, strict=True)):
        end = min(start, tip)
        passing = [*starts[j:], *tips[: j + 1]]
        if any(end - width < x < end - 0.06 * width for x in passing):
            return 1.0
    return -1.0
