"""A layout whose bobs are where other roundings would have put them.

All runs of a layout share the rounding of its places.  At an equilibrium that is unstable, such as
a bar on the maximum of a field, it is all that moves anything, in all runs alike: in 5 units of
time, an error grew to 70 times the difference of two runs.  So one of the runs that are compared
has other places.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tribo.compiler.lanes_memory import room
from tribo.kernels.records import X_START, Y_START
from tribo.layout.layout import Layout

# Largest error of rounding to the nearest double, relative to it.
UNIT = 0.5 * float(np.finfo(float).eps)


def shifts(layout: Layout) -> np.ndarray:
    """One rounding of the place of each bob, along x and y, of either sign (2, asperites)."""
    a = layout.asperites
    moved = np.hypot(a.vx - a.vx[0], a.vy - a.vy[0]) * layout.scene.duration
    place = np.hypot(a.x, a.y) + moved + a.l1 + a.l2
    signs = np.random.default_rng(0).choice([-1.0, 1.0], (2, a.size))
    return np.asarray(UNIT * place * signs)


def with_other_rounding(layout: Layout) -> Layout:
    """The same layout with all bobs displaced by a rounding of their places."""
    (x, y), columns = shifts(layout), layout.places.columns
    asperites, each = layout.asperites.copy(), room(layout.model.each.shape)
    asperites.x += x
    asperites.y += y
    each[:] = layout.model.each
    each[X_START, columns] += x
    each[Y_START, columns] += y
    return replace(layout, asperites=asperites, model=layout.model._replace(each=each))
