"""A start that differs from another by some roundings.

Runs from one start share the rounding of the places of bobs.  At an equilibrium that is unstable,
such as a bar on the maximum of a field, this rounding is all that moves them, in all runs alike:
with 1e-8 requested, one of 5 time units was off by 15 times its estimate.  So one of the runs that
are compared begins from other roundings.
"""

from __future__ import annotations

import numpy as np

from tribo.accuracy.scales import EPSILON
from tribo.layout.layout import Layout

# Roundings of a place: those of its terms, of sine and cosine in it, and of the sum.
ROUNDINGS = 4.0


def rounded_start(layout: Layout, start: np.ndarray) -> np.ndarray:
    """The start with bars and pendulums displaced by the rounding of their bobs' places.

    Parameters
    ----------
    layout
        the scene
    start
        (..., 2 coordinates)
    """
    found, a = start.copy(), layout.asperites
    moved = np.hypot(a.vx - a.vx[0], a.vy - a.vy[0]) * layout.scene.duration
    arm = a.l1 + a.l2
    place = EPSILON * (np.hypot(a.x, a.y) + moved + arm)
    signs = np.random.default_rng(0).choice([-1.0, 1.0], (3, a.size))
    angles = np.arange(a.size)
    for slots, sign, shift in zip(
        (angles, a.dof_x, a.dof_y), signs, (place / arm, place, place), strict=True
    ):
        present = slots >= 0
        found[..., slots[present]] += (sign * shift)[present]
    return found
