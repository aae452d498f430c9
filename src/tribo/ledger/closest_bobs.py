"""The bobs that are closest to one another among those that interact."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from tribo.kernels.kinematics import bob_position, nearest_image
from tribo.kernels.records import Contact
from tribo.layout.layout import Layout
from tribo.ledger.motion import motions, swing_direction
from tribo.ledger.samples import Samples


class Closest(NamedTuple):
    """The two bobs of two surfaces that are closest to one another."""

    distance: float  # [length]
    one: int  # numbers of their asperites
    other: int


def closest_bobs(layout: Layout, sample: Samples) -> Closest | None:
    """The closest of all bobs that interact, in one sample of a run.

    None where no bobs interact, or where a position is not finite.
    """
    return min((found for found, _ in closest_of_contacts(layout, sample)), default=None)


def closest_of_contacts(layout: Layout, sample: Samples) -> Iterator[tuple[Closest, Contact]]:
    """The closest bobs of each two surfaces in contact; nothing where a position is not finite."""
    places = bob_places(layout, sample)[0]
    if not np.all(np.isfinite(places)):
        return
    places, box = in_box(layout, places)
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
                yield Closest(float(distances[i, 0]), *pair), contact


def in_box(layout: Layout, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places of bobs in the scene's box, and its lengths along each axis, 0 where there is none."""
    x, z = layout.model.box or (0.0, 0.0)
    box, places = np.array([x, 0.0, z]), places.copy()
    periodic = box > 0.0
    for _ in range(2):  # the remainder of a tiny negative number is a period, which trees refuse
        places[..., periodic] %= box[periodic]
    return places, box


def nearest_images(layout: Layout, between: np.ndarray) -> np.ndarray:
    """Vectors between bobs, (..., 3), as those between nearest images in the scene's box."""
    box = layout.model.box
    if box is None:
        return between
    x, y, z = np.moveaxis(between, -1, 0)
    return np.stack([nearest_image(x, box.x), y, nearest_image(z, box.z)], axis=-1)


def bob_places(layout: Layout, samples: Samples) -> np.ndarray:
    """Positions of all bobs at all times, (times, n, 3), in the frame of the first surface."""
    places = np.empty((samples.t.size, layout.asperites.size, 3))
    places[..., 2] = layout.depths
    for index in range(len(layout.scene.surfaces)):
        for span, motion in motions(layout, samples, index):
            a = span.asperites
            x, y = a.x + a.vx * motion.t + motion.x, a.y + a.vy * motion.t + motion.y
            x, y = bob_position(x, y, a.l1, *swing_direction(a.facing, motion.swing))
            places[:, span.place, 0], places[:, span.place, 1] = x, y
    return places


def asperite_names(layout: Layout, indices: Iterable[int]) -> str:
    """Two asperites, as a part of a sentence."""
    return " and ".join(asperite_name(layout, index) for index in indices)


def asperite_name(layout: Layout, index: int) -> str:
    """An asperite by its surface and its place there, from 0 on."""
    for name, part in layout.parts.items():
        if part.start <= index < part.stop:
            return f'asperite {index - part.start} of "{name}"'
    raise IndexError(index)
