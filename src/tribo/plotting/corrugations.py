"""Fields that repeat along x: a line beside the bobs of the surface on which they act."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tribo.model.fields import Field, depends_on_time, period_of
from tribo.plotting.marks import Box
from tribo.plotting.pose import Pose
from tribo.results.run_result import RunResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOUR = "#6b7280"
# Distance of its middle from the nearest bob, and half its height [rod length].
DISTANCE = 0.3
SWELL = 0.1
# Least period [points]: a line of shorter ones would be a band.
LEAST_PERIOD = 6.0
# Points of the line in a period.
TURN = 24


class CorrugationLine:
    """The sum of the fields that act on a surface, drawn at one height in all poses.

    The energy is that at the height of the lowest bob, or of the highest one of a surface that
    faces up, and its scale is that of the drawing.  Modulations with time are not drawn.
    """

    def __init__(
        self, fields: Sequence[Field], anchors: Sequence[np.ndarray], poses: Sequence[Pose]
    ) -> None:
        self._fields = fields
        self._anchors = anchors  # (2,) each: displacements at t = 0
        self._period = min(filter(None, (period_of(field.potential) for field in fields)))
        rod = float(poses[0].rods.max())
        self._half_height = SWELL * rod
        heights = np.concatenate([now.bobs[:, 1] for now in poses])
        faces_down = poses[0].up[0] > 0.0
        self._bob = float(heights.min() if faces_down else heights.max())
        self._middle = self._bob - DISTANCE * rod if faces_down else self._bob + DISTANCE * rod

    def in_box(self, box: Box) -> Box:
        """The box with room for the line."""
        bottom = min(box.bottom, self._middle - self._half_height)
        top = max(box.top, self._middle + self._half_height)
        return Box(box.left, box.right, bottom, top)

    def draw(self, ax: Axes, t: float, box: Box, shift: np.ndarray, point: float) -> None:
        """Draw the line across a box at a time, all moved by a shift (2,).

        `point` is the length of a typographic point in the axes.
        """
        if self._period < LEAST_PERIOD * point:
            return
        periods = (box.right - box.left) / self._period
        x = np.linspace(box.left, box.right, round(TURN * periods) + 2)
        energy = np.array([self._energy(t, place) for place in x.tolist()])
        if not np.ptp(energy) > 0.0:
            return
        level = 2.0 * (energy - energy.min()) / np.ptp(energy) - 1.0
        y = self._middle + self._half_height * level
        ax.plot(x + shift[0], y + shift[1], color=COLOUR, linewidth=0.8, zorder=1.5)

    def _energy(self, t: float, x: float) -> float:
        """The energy at a place along x; users' functions may take no arrays."""
        energy = 0.0
        for field, anchor in zip(self._fields, self._anchors, strict=True):
            own_x = x - field.origin[0] - anchor[0] - field.velocity[0] * t
            own_y = self._bob - field.origin[1] - anchor[1] - field.velocity[1] * t
            energy += float(field.potential.energy_at(own_x, own_y))
        return energy


def corrugation_line(result: RunResult, poses: Sequence[Pose]) -> CorrugationLine | None:
    """The line of the fields of a run that repeat along x and do not change; None without any.

    There is none of several surfaces either, where it would run through the bobs of another one.
    """
    scene = result.scene
    chosen = [
        k
        for k, field in enumerate(scene.fields)
        if period_of(field.potential) is not None and not depends_on_time(field.potential)
    ]
    if not chosen or len(scene.surfaces) > 1:
        return None
    anchors = result.state().anchors[len(scene.surfaces) :]
    fields = [scene.fields[k] for k in chosen]
    return CorrugationLine(fields, [anchors[k] for k in chosen], poses)
