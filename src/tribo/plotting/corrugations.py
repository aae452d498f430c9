"""The corrugation of fields: a line beside the bobs of the surface on which they act."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tribo.model.fields import Corrugation, Field
from tribo.model.scene import Scene
from tribo.plotting.marks import Box
from tribo.plotting.pose import Pose

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
    """The sum of the corrugations that act on a surface, drawn at one height in all poses.

    Its height is that of the strongest sum; modulations with time are not drawn.
    """

    def __init__(self, fields: Sequence[Field], poses: Sequence[Pose]) -> None:
        self._fields = fields
        rod = float(poses[0].rods.max())
        self._half_height = SWELL * rod
        heights = np.concatenate([now.bobs[:, 1] for now in poses])
        # The surface faces down, or up.
        if poses[0].up[0] > 0.0:
            self._middle = float(heights.min()) - DISTANCE * rod
        else:
            self._middle = float(heights.max()) + DISTANCE * rod

    def in_box(self, box: Box) -> Box:
        """The box with room for the line."""
        bottom = min(box.bottom, self._middle - self._half_height)
        top = max(box.top, self._middle + self._half_height)
        return Box(box.left, box.right, bottom, top)

    def draw(self, ax: Axes, t: float, box: Box, shift: np.ndarray, point: float) -> None:
        """Draw the line across a box at a time, all moved by a shift (2,).

        `point` is the length of a typographic point in the axes.
        """
        period = min(field.potential.period for field in self._fields)
        strongest = sum(abs(field.potential.amplitude) for field in self._fields)
        if period < LEAST_PERIOD * point or strongest == 0.0:
            return
        x = np.linspace(box.left, box.right, round(TURN * (box.right - box.left) / period) + 2)
        energy = np.zeros(x.size)
        for field in self._fields:
            own = x - field.origin[0] - field.velocity[0] * t
            energy += field.potential.energy_at(own, 0.0)
        y = self._middle + self._half_height * energy / strongest
        ax.plot(x + shift[0], y + shift[1], color=COLOUR, linewidth=0.8, zorder=1.5)


def corrugation_line(scene: Scene, poses: Sequence[Pose]) -> CorrugationLine | None:
    """The line of the corrugations of a scene; None without any.

    There is none of several surfaces either, where it would run through the bobs of another one.
    """
    fields = [field for field in scene.fields if isinstance(field.potential, Corrugation)]
    return CorrugationLine(fields, poses) if fields and len(scene.surfaces) == 1 else None
