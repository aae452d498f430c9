"""The pairs of bobs of different surfaces that are in contact: those that repel each other.

This is the definition of :mod:`tribo.ledger.separation`: two bobs are in contact where they are
closer than the largest distance at which the force between them is repulsive.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from tribo.layout.layout import Layout
from tribo.ledger.nearest import MOST_PAIRS
from tribo.ledger.separation import in_box, nearest_images, repulsions_of


class ContactPairs(NamedTuple):
    """Pairs of bobs in contact at one time, each once, by the numbers of all asperites."""

    mine: np.ndarray  # (contacts,) of the surface
    theirs: np.ndarray  # (contacts,) of the others
    distance: np.ndarray  # (contacts,) between the bobs [length]

    def of_asperites(self, part: slice) -> np.ndarray:
        """How many contacts each asperite of the surface has, (asperites,)."""
        return np.bincount(self.mine - part.start, minlength=part.stop - part.start)


def contact_pairs(layout: Layout, places: np.ndarray, index: int) -> Iterator[ContactPairs]:
    """The contacts of one surface at each time, from places of all bobs (times, n, 3)."""
    groups = [*_groups(layout, index)]
    for at_one_time in places:
        found = [_within(layout, at_one_time, *group) for group in groups]
        every = np.concatenate([np.empty((3, 0)), *found], axis=1)
        pairs, first = np.unique(every[:2].astype(int), axis=1, return_index=True)
        yield ContactPairs(pairs[0], pairs[1], every[2, first])


def _groups(layout: Layout, index: int) -> Iterator[tuple[np.ndarray, np.ndarray, float]]:
    """Bobs of a surface, bobs of another one, and the distance at which they are in contact."""
    starts = [part.start for part in layout.parts.values()]
    for pair, reaches in repulsions_of(layout).items():
        if index not in pair:
            continue
        for reach in reaches:
            one = starts[pair[0]] + reach.mine
            other = starts[pair[1]] + reach.theirs
            mine, theirs = (one, other) if pair[0] == index else (other, one)
            yield mine, theirs, reach.distance


def _within(
    layout: Layout, places: np.ndarray, mine: np.ndarray, theirs: np.ndarray, distance: float
) -> np.ndarray:
    """Pairs of some bobs that are closer than a distance, and their distances, (3, pairs)."""
    mine = mine[np.isfinite(places[mine]).all(axis=1)]
    theirs = theirs[np.isfinite(places[theirs]).all(axis=1)]
    if not (mine.size and theirs.size and distance > 0.0):
        return np.empty((3, 0))
    if mine.size * theirs.size <= MOST_PAIRS:
        between = nearest_images(layout, places[mine][:, None] - places[theirs])
        lengths = np.linalg.norm(between, axis=-1)
        i, j = np.nonzero(lengths < distance)
        return np.stack([mine[i], theirs[j], lengths[i, j]])
    from scipy.spatial import KDTree

    own, box = in_box(layout, places[mine])
    others, _ = in_box(layout, places[theirs])
    trees = [KDTree(each, boxsize=box) for each in (own, others)]
    near = trees[0].sparse_distance_matrix(trees[1], distance, output_type="ndarray")
    near = near[near["v"] < distance]
    return np.stack([mine[near["i"]], theirs[near["j"]], near["v"]])


def counts_of_contacts(
    layout: Layout, places: np.ndarray, index: int, part: slice
) -> tuple[np.ndarray, np.ndarray]:
    """Contacts of each asperite of a surface, (times, asperites), and of all, (times,)."""
    each: Sequence[np.ndarray] = [
        pairs.of_asperites(part) for pairs in contact_pairs(layout, places, index)
    ]
    counts = np.array(each).reshape(len(places), -1)
    return counts, counts.sum(axis=1)
