"""Snapshots of all asperites, and the displacements of one of them in between."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo.plotting import marks
from tribo.plotting.contacts import force_arrows
from tribo.plotting.corrugations import corrugation_line
from tribo.plotting.curves import swing_of
from tribo.plotting.picture import Picture, colour_bar
from tribo.plotting.pose import Pose, nearest_sample, pose
from tribo.plotting.style import COLUMN, INK, WIDE, drawing_on
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Distance between two snapshots [points].
GAP = 9.0
# Distance between lines of labels [points].
LINE = 14.0
# Margin for times and phases left of snapshots [points].
MARGIN = 50.0
# Height that the colours of many asperites take below snapshots [points].
BAR_ROOM = 30.0
# Room at the sides for the arrows of forces [rod length].
ARROW_ROOM = 0.4
# Most times that a stretch of a corrugation in all snapshots is as wide as one of them alone.
MOST_WIDER = 6.0
# Of all changes of the contact energy, the parts before the first and after the last time that is
# chosen: most of an encounter lies between these times, and the asperites are near each other.
BEFORE = 0.15
# Line styles of the points of an asperite, and their subscripts.
GUIDES: dict[str, Any] = {"bar": ":", "cm": (0, (6, 1.5, 1, 1.5)), "bob": (0, (4, 2))}
SUBSCRIPTS = {"bar": "2", "cm": r"{\rm cm}", "bob": "1"}


def encounter_times(result: RunResult, number: int) -> list[float]:
    """Times of samples between which the contact energy changes by equal amounts.

    A single encounter is thus shown on its way in, at its closest, and on its way out.

    They are fewer than `number` where samples are few, and evenly spaced from start to end where no
    contact energy is recorded, or it does not change.
    """
    parts = np.linspace(BEFORE, 1.0 - BEFORE, number)
    energy = np.asarray(result.system.get("contact_energy", 0))
    changes = np.abs(np.diff(energy)) if energy.size == result.t.size else np.zeros(1)
    total = np.nansum(changes)
    if not (np.isfinite(total) and total > 0.0):
        return np.linspace(result.t[0], result.t[-1], number).tolist()
    reached = np.concatenate([[0.0], np.cumsum(np.nan_to_num(changes))]) / total
    return result.t[np.unique(np.searchsorted(reached, parts))].tolist()


def typical_swing(result: RunResult) -> float:
    """The swing that 99 % of all swings in the run do not exceed, at least 1e-9 [rad]."""
    swings = [np.abs(swing_of(result, surface)).ravel() for surface in result.scene.surfaces]
    return max(1e-9, float(np.nanpercentile(np.concatenate(swings), 99.0)))


def snapshots(
    result: RunResult,
    times: Sequence[float] | None,
    forces: tuple[str, int] | None,
    bath: bool,
    ax: Axes | None,
) -> Axes:
    """Draw all asperites at the samples nearest to some times."""
    if forces is not None:
        result.scene.index_of(forces[0])
    times = encounter_times(result, 4) if times is None else times
    samples = [nearest_sample(result, t) for t in times]
    poses = [pose(result, float(result.t[k]), bath, wrap=True) for k in samples]
    room = 0.0 if forces is None else ARROW_ROOM * float(poses[0].rods.max())
    boxes = np.array([now.box for now in poses]) + np.array([-room, room, 0.0, 0.0])
    line = corrugation_line(result, poses)
    if line is not None:
        boxes = _on_one_stretch(np.array([line.in_box(marks.Box(*box)) for box in boxes]))
    widths = boxes[:, 1] - boxes[:, 0]
    heights = boxes[:, 3] - boxes[:, 2]
    # In a row, pictures are small if it is much wider than high.
    arranged = [_in_a_row if widths.sum() < 6.0 * heights.max() else _in_a_column]
    room_above = np.inf
    is_given = ax is not None
    if is_given:
        arranged = [_in_a_row, _in_two_columns, _in_a_column]
    with drawing_on(ax, WIDE) as ax:
        width, height = np.array(ax.bbox.size) / ax.figure.dpi * marks.POINTS_PER_INCH
        if is_given:
            room_above = height - BAR_ROOM
        layouts = [arrange(boxes, width, room_above) for arrange in arranged]
        layout = min(layouts, key=lambda each: each.point)  # the largest pictures
        point = layout.point
        left, right, bottom, top = layout.view
        swing = typical_swing(result)
        labels = marks.time_labels(result.t[samples].tolist())
        for k, now, box, shift, place, label in zip(
            samples, poses, boxes, layout.shifts, layout.labels, labels, strict=True
        ):
            shown = now.shifted(shift)
            if line is not None:
                line.draw(ax, float(result.t[k]), marks.Box(*box), shift, point)
            picture = Picture(ax, shown, point, swing)
            marks.note(ax, place, label, ha=layout.align)
            if forces is not None:
                force_arrows(ax, result.scene, now, shown, *forces)
        rigid = all(surface.asperite.is_rigid for surface in result.scene.surfaces)
        if picture.swings is not None and not rigid:
            bottom -= BAR_ROOM * point
            place = (left + 0.6 * (right - left), bottom + 16.0 * point)
            colour_bar(ax, picture.swings, place, 0.38 * (right - left), 4.0 * point)
        ax.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    return ax


def _on_one_stretch(boxes: np.ndarray) -> np.ndarray:
    """Boxes (n, 4) that all reach from the leftmost to the rightmost, so that motion is seen.

    They stay as they are where each would be too small in such a picture.
    """
    left = boxes[:, 0].min()
    right = boxes[:, 1].max()
    if right - left > MOST_WIDER * np.max(boxes[:, 1] - boxes[:, 0]):
        return boxes
    common = boxes.copy()
    common[:, 0] = left
    common[:, 1] = right
    return common


class _Layout(NamedTuple):
    """Where snapshots and their labels are."""

    point: float  # length of a typographic point
    shifts: np.ndarray  # (n, 2) of the snapshots
    labels: np.ndarray  # (n, 2) of the times
    align: str  # of the times, along x
    view: marks.Box


def _in_a_row(boxes: np.ndarray, width: float, height: float) -> _Layout:
    """Snapshots side by side in boxes (n, 4), in so many points; times below them."""
    widths = boxes[:, 1] - boxes[:, 0]
    low = boxes[:, 2].min()
    high = boxes[:, 3].max()
    point = widths.sum() / (width - GAP * (len(boxes) - 1) - 2.0 * marks.EDGE)
    point = float(max(point, (high - low) / max(1.0, height - LINE - marks.EDGE)))
    begins = boxes[0, 0] + np.cumsum([0.0, *(widths[:-1] + GAP * point)])
    end = float(begins[-1] + widths[-1])
    shifts = np.stack([begins - boxes[:, 0], np.zeros(len(boxes))], axis=1)
    below = np.full(len(boxes), low - 0.5 * LINE * point)
    edge = marks.EDGE * point
    labels = np.stack([begins + 0.5 * widths, below], axis=1)
    view = marks.Box(boxes[0, 0] - edge, end + edge, low - LINE * point, high + edge)
    return _Layout(point, shifts, labels, "center", view)


def _in_two_columns(boxes: np.ndarray, width: float, height: float) -> _Layout:
    """Snapshots two and two in cells of one size, in so many points; times below them."""
    wide = float(np.max(boxes[:, 1] - boxes[:, 0]))
    high = float(np.max(boxes[:, 3] - boxes[:, 2]))
    rows = (len(boxes) + 1) // 2
    point = 2.0 * wide / (width - GAP - 2.0 * marks.EDGE)
    point = max(point, rows * high / max(1.0, height - rows * LINE - marks.EDGE))
    place = np.arange(len(boxes))
    left = (place % 2) * (wide + GAP * point)
    top = -(place // 2) * (high + LINE * point)
    shifts = np.stack([left - boxes[:, 0], top - boxes[:, 3]], axis=1)
    labels = np.stack([left + 0.5 * wide, top - high - 0.5 * LINE * point], axis=1)
    edge = marks.EDGE * point
    lowest = -rows * (high + LINE * point)
    view = marks.Box(-edge, 2.0 * wide + GAP * point + edge, lowest, edge)
    return _Layout(point, shifts, labels, "center", view)


def _in_a_column(boxes: np.ndarray, width: float, height: float) -> _Layout:
    """Snapshots below one another, at the places along x of the run; times left of them."""
    left = boxes[:, 0].min()
    right = boxes[:, 1].max()
    heights = boxes[:, 3] - boxes[:, 2]
    point = (right - left) / (width - MARGIN - marks.EDGE)
    point = float(max(point, heights.sum() / max(1.0, height - GAP * len(boxes))))
    tops = boxes[0, 3] - np.cumsum([0.0, *(heights + GAP * point)])
    shifts = np.stack([np.zeros(len(boxes)), tops[:-1] - boxes[:, 3]], axis=1)
    start = np.full(len(boxes), left - (MARGIN - marks.EDGE) * point)
    labels = np.stack([start, tops[:-1] - 0.5 * heights], axis=1)
    edge = marks.EDGE * point
    highest, *_, lowest = tops.tolist()
    view = marks.Box(left - MARGIN * point, right + edge, lowest, highest + edge)
    return _Layout(point, shifts, labels, "left", view)


def sequence(
    result: RunResult,
    times: Sequence[float] | None,
    asperite: tuple[str, int],
    points: Sequence[str],
    phases: Sequence[str],
    ax: Axes | None,
) -> Axes:
    """Draw snapshots, and the displacements of one asperite between them."""
    times = encounter_times(result, 3) if times is None else times
    poses = [pose(result, t) for t in times]
    boxes = np.array([now.box for now in poses])
    room = ARROW_ROOM * float(poses[0].rods.max())
    left = boxes[:, 0].min() - room
    right = boxes[:, 1].max() + room
    beside: dict[str, Any] = {"offset": (marks.EDGE - MARGIN, 0.0), "ha": "left"}
    with drawing_on(ax, COLUMN) as ax:
        point = marks.point_length(ax, left, right, left=MARGIN)
        gap = (len(points) + 1.2) * LINE * point
        floor = 0.0
        before = None
        for k, (now, label) in enumerate(zip(poses, marks.time_labels(times), strict=True)):
            top = floor - gap if k else 0.0
            row = now.shifted((0.0, top - boxes[k, 3]))
            index = row.index(*asperite)
            Picture(ax, row, point)
            if k in (0, len(times) - 1):
                force_arrows(ax, result.scene, now, row, *asperite)
            marks.note(ax, (left, row.bobs[index, 1]), label, **beside)
            if before is not None:
                _displacements(ax, before, row, index, points, floor, point)
                if phases:
                    marks.note(
                        ax, (left, floor - 0.5 * gap), phases[k - 1], style="italic", **beside
                    )
            floor = row.box.bottom
            before = row
        marks.frame(ax, marks.Box(left, right, floor, 0.0), left=MARGIN)
    return ax


def _displacements(
    ax: Axes,
    before: Pose,
    after: Pose,
    index: int,
    points: Sequence[str],
    ceiling: float,
    point: float,  # length of a typographic point
) -> None:
    """Draw an arrow for each point of an asperite, one below the other, between guides to it."""
    levels = ceiling - LINE * point * np.arange(1, len(points) + 1)
    begins = np.array([getattr(before, f"{name}s")[index] for name in points])
    ends = np.array([getattr(after, f"{name}s")[index] for name in points])
    looks = [GUIDES[name] for name in points]
    _guides(ax, looks, begins, levels - 5.0 * point, 2.5 * point)
    _guides(ax, looks[::-1], ends[::-1], (levels + 5.0 * point)[::-1], 2.5 * point)
    side = _free_side(begins[:, 0], ends[:, 0], 32.0 * point)
    letter = "x" if before.up[index] > 0.0 else "X"
    where = {"ha": "left" if side > 0.0 else "right", "bbox": {"fc": "w", "ec": "none", "pad": 0.5}}
    for name, y, start, tip in zip(points, levels, begins[:, 0], ends[:, 0], strict=True):
        head = min(8.0, 1.2 * abs(tip - start) / point)  # a short arrow has a small head
        if head > 0.5:
            marks.arrow(ax, (start, y), (tip, y), mutation_scale=head)
        text = rf"$\Delta {letter}_{{{SUBSCRIPTS[name]}}}$"
        marks.note(ax, (side * max(side * start, side * tip), y), text, (4.0 * side, 0.5), **where)


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
