"""The numbers that a page changes: what a pair's module reads, in this order.

They are numbers as scene files have them; whatever follows from them is computed by the module.
"""

from typing import Any

import numpy as np

from tribo.kernels.records import BARS, FREE
from tribo.layout.layout import Layout

# Numbers of each surface.  Bobs are at rest; HEIGHT is added to y.  SLIDES is 1 where the centre of
# mass is free along x, HELD_BAR where a constraint moves the bar, CLAMPED where forces on the bar's
# ends hold it against its torsion spring; else these are 0.
FACING, REST, BOB_X, BOB_Y, HEIGHT, DEPTH, VELOCITY_X, VELOCITY_Y = range(8)
M1, M2, KAPPA, LENGTH, BAR_LENGTH, I2, CHARGE, SWING, OMEGA = range(8, 17)
SLIDES, HELD_BAR, CLAMPED = range(17, 20)
OF_SURFACE = 20
# Numbers of the whole, behind those of two surfaces.
DURATION, OBSERVER_X, OBSERVER_Y = range(2 * OF_SURFACE, 2 * OF_SURFACE + 3)
INPUTS = 2 * OF_SURFACE + 3


def inputs_of(layout: Layout) -> np.ndarray:
    """The numbers of a scene with `tribo.loops.pair_records.is_pair`, (INPUTS,)."""
    scene = layout.scene
    found = np.zeros(INPUTS)
    for k, surface in enumerate(scene.surfaces):
        record = layout.surfaces[k]
        own = layout.asperites[k]
        heights = surface.drawn_heights([scene.seed, k, 0])
        x, y, depth = surface.first_bob
        values: dict[int, Any] = {
            FACING: surface.facing_sign,
            REST: surface.rest,
            BOB_X: x,
            BOB_Y: y,
            HEIGHT: 0.0 if heights is None else heights[0],
            DEPTH: depth,
            VELOCITY_X: surface.velocity[0],
            VELOCITY_Y: surface.velocity[1],
            SWING: layout.start[k],
            OMEGA: layout.start[layout.coordinates + k],
            SLIDES: record.drive == FREE,
            HELD_BAR: record.drive == BARS,
            CLAMPED: own.acc_ends >= 0,
        }
        for place, name in OF_ASPERITE.items():
            values[place] = surface.each[name][0]
        for place, value in values.items():
            found[k * OF_SURFACE + place] = value
    found[DURATION] = scene.duration
    return found


# The parameters of asperites among them.
OF_ASPERITE = {
    M1: "m1",
    M2: "m2",
    KAPPA: "kappa",
    LENGTH: "length",
    BAR_LENGTH: "bar_length",
    I2: "i2",
    CHARGE: "charge",
}
