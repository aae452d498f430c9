"""Pictures of results: asperites, snapshots, sequences of them, angles and works over time.

Everything is drawn into matplotlib Axes that the caller owns::

    with plotting.style():
        ax = plotting.axes(plotting.COLUMN)
        plotting.sequence(ax, result, times=(15.0, 23.2, 26.0))
        plotting.trim(ax)
        plotting.save(ax, folder / "sequence")

Lengths of drawings are in the scene's own units, so that a bob is where the run had it; sizes of
letters, gaps and margins are in points.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.checks import as_path
from tribo.errors import InputError
from tribo.pose import Pose, Poses, contact_force, poses, separation
from tribo.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN, WIDE = 3.375, 5.1  # one and one-and-a-half columns of a journal [inch]
FILES = (".png", ".pdf", ".svg")  # kinds that a figure can be written as
POINTS_PER_INCH = 72.0
LINE = 14.0  # from one line of labels to the next [points]
EDGE = 4.0  # of paper around a drawing [points]
MARGIN = 42.0  # for labels left of a sequence [points]
SIDES = ("left", "right", "bottom", "top")

INK = "#1a1a1a"
STEEL = {"down": "#c9d9ee", "up": "#d9dde3"}  # of bars and bobs, by where the surface faces
ROD, MASS_CENTRE = "#fbf3d0", "#d7301f"
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
GUIDES = {"bar": ":", "cm": (0, (6, 1.5, 1, 1.5)), "bob": (0, (4, 2))}  # line styles
SUBSCRIPTS = {"bar": "2", "cm": r"{\rm cm}", "bob": "1"}

STYLE: Any = {
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


def write(figure: Figure, path: Any) -> Path:
    """Write a figure into a file whose name ends on .png, .pdf or .svg.  Raises InputError."""
    place = as_path(path)
    if place.suffix.lower() not in FILES:
        raise InputError("--figure", f"must end on {', '.join(FILES)}, got {str(path)!r}")
    try:
        figure.savefig(place)
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError("--figure", f"{place} cannot be written ({why})") from None
    return place


def style() -> AbstractContextManager[None]:
    """Fonts and lines of a journal, for as long as the context lasts."""
    from matplotlib import rc_context

    return rc_context(STYLE)


def axes(width: float, height: float | None = None) -> Axes:
    """Axes of a new figure [inch]: with a height for a graph, without one for a drawing.

    A drawing fills its figure and has no frame; `trim` gives it the height that it needs.
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
        stamp: Any = {"CreationDate": None} if path.suffix == ".pdf" else {}
        _figure(ax).savefig(path, metadata=stamp)
    return paths


def _figure(ax: Axes) -> Figure:
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure


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


def arrow(ax: Axes, start: Any, tip: Any, **properties: Any) -> None:
    """A straight arrow between two places."""
    drawn = {"arrowstyle": "-|>,head_length=0.5,head_width=0.2", "linewidth": 0.9, "color": INK}
    ax.annotate(
        "",
        xy=tuple(tip),
        xytext=tuple(start),
        arrowprops=drawn | {"shrinkA": 0, "shrinkB": 0, "mutation_scale": 8} | properties,
        zorder=1000,
    )


def note(
    ax: Axes, place: Any, text: str, away: tuple[float, float] = (0.0, 0.0), **properties: Any
) -> None:
    """A text beside a place, `away` from it [points]."""
    where: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 1001}
    ax.annotate(
        text, xy=tuple(place), xytext=away, textcoords="offset points", **(where | properties)
    )


def clock(times: Sequence[float]) -> list[str]:
    """Times with as many decimals as the longest of them needs."""
    decimals = max(len(f"{t:.6g}".partition(".")[2]) for t in times)
    return [f"$t = {t:.{decimals}f}$" for t in times]


def unit(ax: Axes, box: tuple[float, float, float, float], **margins: float) -> float:
    """The length that a point is, if a box is to fill the width of `ax` up to its margins."""
    width = ax.bbox.width / ax.figure.dpi * POINTS_PER_INCH
    return (box[1] - box[0]) / (width - margins.get("left", EDGE) - margins.get("right", EDGE))


def frame(ax: Axes, box: tuple[float, float, float, float], **margins: float) -> None:
    """Show a box (left, right, bottom, top) with margins of the same names [points]."""
    point = unit(ax, box, **margins)
    left, right, bottom, top = (point * margins.get(side, EDGE) for side in SIDES)
    ax.set_xlim(box[0] - left, box[1] + right)
    ax.set_ylim(box[2] - bottom, box[3] + top)
    ax.set_aspect("equal")


def trim(ax: Axes) -> None:
    """Give the figure that a drawing fills the height that the drawing needs."""
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    figure = _figure(ax)
    figure.set_figheight(figure.get_figwidth() * (top - bottom) / (right - left))


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
