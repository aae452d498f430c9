"""The two bobs that are closest to one another among those that interact."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from tribo.kernels.kinematics import bob_position
from tribo.run.layout import Layout
from tribo.run.motion import motions, swing_direction
from tribo.run.samples import Samples


def closest_bobs(layout: Layout, sample: Samples) -> tuple[float, int, int] | None:
    """Their distance and the numbers of their asperites.

    Parameters
    ----------
    layout : Layout
        The scene.
    sample : Samples
        One sample of a run.

    Returns
    -------
    distance, one, other : float, int, int
        [length]; None where no bobs interact, or where a position is not finite.
    """
    places = _places(layout, sample)
    if not np.all(np.isfinite(places)):
        return None
    box = np.zeros(3)
    if layout.model.box is not None:
        box[:] = layout.model.box.x, 0.0, layout.model.box.z
        periodic = box > 0.0
        places[:, periodic] %= box[periodic]
    found: list[tuple[float, int, int]] = []
    for contact in (*layout.model.contacts, *(layout.model.within or ())):
        for one, other in contact.pairs:
            mine, theirs = (layout.surfaces[k] for k in (one, other))
            own = places[mine.start : mine.stop]
            tree = KDTree(places[theirs.start : theirs.stop], boxsize=box)
            # Within a surface, the nearest bob to each is that bob itself.
            rank = 2 if one == other else 1
            distances, indices = tree.query(own, k=[rank])
            i = int(np.argmin(distances[:, 0]))
            near = int(indices[i, 0])
            if near < tree.n:  # a surface of one bob has no other
                pair = int(mine.start) + i, int(theirs.start) + near
                found.append((float(distances[i, 0]), *pair))
    return min(found, default=None)


def _places(layout: Layout, sample: Samples) -> np.ndarray:
    """Positions of all bobs at the time of a sample, (n, 3), in the frame of the first surface."""
    places = np.empty((layout.asperites.size, 3))
    places[:, 2] = layout.depths
    for index in range(len(layout.scene.surfaces)):
        for batch, motion in motions(layout, sample, index):
            a = batch.asperites
            x, y = a.x + a.vx * motion.t + motion.x, a.y + a.vy * motion.t + motion.y
            tx, ty = swing_direction(a.facing, motion.swing)
            x, y = bob_position(x, y, a.l1, tx, ty)
            places[batch.place, 0], places[batch.place, 1] = x[0], y[0]
    return places
