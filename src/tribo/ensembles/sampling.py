"""Values of members from grids, and from the quasi-random points of scipy.stats.qmc."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from tribo.ensembles.members import VELOCITY, Distribution, Source, size_of
from tribo.ensembles.swing_states import joint_starts
from tribo.model.scene import Scene
from tribo.validation import InputError, inside, short_repr, vector


class Sampler(Protocol):
    """A sampler of scipy.stats.qmc."""

    d: int

    def random(self, n: int) -> np.ndarray:
        """Points in the unit cube, (n, d)."""


def grid(axes: Mapping[str, ArrayLike]) -> dict[str, np.ndarray]:
    """All combinations of the values of some quantities, for the argument `vary` of an ensemble.

    Parameters
    ----------
    axes : mapping
        Key of a quantity, as "upper.theta" -> its values (points,).

    Returns
    -------
    dict
        Key -> (members,), where members is the product of all numbers of points.  The last
        quantity changes fastest: ``data["upper.w1"].values.reshape(points of each axis)`` is a
        table over the grid.

    Raises
    ------
    InputError
        An axis is not a list of numbers.
    """
    if not isinstance(axes, Mapping) or not axes:
        raise InputError("axes", f"must map quantities to values, got {short_repr(axes)}")
    with inside("axes"):
        lines = [vector(key, values) for key, values in axes.items()]
    tables = np.meshgrid(*lines, indexing="ij")
    return {key: table.ravel() for key, table in zip(axes, tables, strict=True)}


def sampled(
    sampler: Sampler, n: int | None, scene: Scene, vary: Mapping[str, Source]
) -> dict[str, Source]:
    """`vary` with the points of a sampler in place of random numbers.

    Each distribution becomes an array (n, numbers of a member): its inverse cumulative function
    ``ppf`` of as many coordinates of the points, in the order of `vary`.  The sampler is copied, so
    that it draws the same points in a later call.

    Raises
    ------
    InputError
        The sampler has another number of dimensions than `vary` has numbers to draw, a distribution
        has no ``ppf``, or `n` is missing.
    """
    if not (hasattr(sampler, "random") and hasattr(sampler, "d")):
        raise InputError("sampler", f"must be one of scipy.stats.qmc, got {short_repr(sampler)}")
    if n is None:
        raise InputError("n", "is missing; a sampler needs the number of members")
    found = dict(vary)
    with inside("vary"):
        joint = {each.name: each for each in joint_starts(scene, vary).values()}
        drawn = dimensions(scene, vary)
        for key in drawn:
            if key not in joint and not hasattr(vary[key], "ppf"):
                raise InputError(key, "must have ppf, as a distribution of scipy.stats has")
    if sampler.d != sum(drawn.values()):
        raise InputError(
            "sampler",
            f"has {sampler.d} dimensions, and members have {sum(drawn.values())} numbers to draw",
        )
    points, first = copy.deepcopy(sampler).random(n), 0
    for key, size in drawn.items():
        own = points[:, first : first + size]
        if key in joint:
            del found[key]
            found |= joint[key].values(own)
        else:
            found[key] = vary[key].ppf(own)  # type: ignore[union-attr]
        first += size
    return found


def dimensions(scene: Scene, vary: Mapping[str, Source]) -> dict[str, int]:
    """The numbers that a member draws, by the keys of distributions.

    Raises InputError if a key names no quantity of the scene.
    """
    joint = {each.name: each.dimensions for each in joint_starts(scene, vary).values()}
    return {
        key: joint[key] if key in joint else _size(scene, key)
        for key, source in vary.items()
        if key in joint or isinstance(source, Distribution)
    }


def _size(scene: Scene, key: str) -> int:
    return 1 if key.endswith(f".{VELOCITY}") else size_of(scene, key)
