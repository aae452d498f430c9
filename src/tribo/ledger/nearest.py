"""The nearest of many points."""

import numpy as np

# Pairs of points up to which all distances take less time than a tree: 60 us for a tree of few,
# and 0.15 s once to import what builds it.
MOST_PAIRS = 400


def nearest(
    places: np.ndarray, others: np.ndarray, box: np.ndarray, rank: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Distance and index of the nearest of `others` (m, 3) to each of some places (..., 3).

    Both are in a box, whose lengths (3,) are 0 where it is not periodic.  With a `rank` of 2 it is
    the second nearest.  Where there is none the distance is infinite, and the index m.
    """
    if places.size // 3 * len(others) <= MOST_PAIRS:
        return _by_distances(places, others, box, rank)
    from scipy.spatial import KDTree

    distances, indices = KDTree(others, boxsize=box).query(places, k=[rank])
    return distances[..., 0], indices[..., 0]


def _by_distances(
    places: np.ndarray, others: np.ndarray, box: np.ndarray, rank: int
) -> tuple[np.ndarray, np.ndarray]:
    """The distances of the nearest by rank, and which it is, from those of all pairs."""
    if len(others) < rank:
        shape = places.shape[:-1]
        return np.full(shape, np.inf), np.full(shape, len(others))
    between = places[..., None, :] - others
    for axis in np.flatnonzero(box):
        between[..., axis] -= box[axis] * np.round(between[..., axis] / box[axis])
    distances = np.sqrt(np.add.reduce(between**2, axis=-1))
    if len(others) == 1:
        return distances[..., 0], np.zeros(distances.shape[:-1], int)
    indices = distances.argsort(axis=-1, kind="stable")[..., rank - 1]
    return np.take_along_axis(distances, indices[..., None], axis=-1)[..., 0], indices
