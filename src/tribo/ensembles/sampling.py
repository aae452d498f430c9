"""Values of members from the quasi-random points of scipy.stats.qmc."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Protocol

import numpy as np

from tribo.ensembles.members import VELOCITY, Distribution, Source, size_of
from tribo.ensembles.swing_states import joint_starts
from tribo.model.scene import Scene
from tribo.validation import InputError, inside, short_repr


class Sampler(Protocol):
    """A sampler of scipy.stats.qmc."""

    d: int

    def random(self, n: int) -> np.ndarray:
        """Points in the unit cube, (n, d)."""


def sampled(
    sampler: Sampler, members: int | None, scene: Scene, vary: Mapping[str, Source]
) -> dict[str, Source]:
    """`vary` with the points of a sampler in place of random numbers. Raises InputError.

    Each distribution becomes an array (members, numbers of a member): its inverse cumulative
    function ``ppf`` of as many coordinates of the points, in the order of `vary`.  The sampler is
    copied, so that it draws the same points in a later call.
    """
    if not (hasattr(sampler, "random") and hasattr(sampler, "d")):
        raise InputError("sampler", f"must be one of scipy.stats.qmc, got {short_repr(sampler)}")
    if members is None:
        raise InputError("members", "is missing; a sampler needs the number of members")
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
    points, first = copy.deepcopy(sampler).random(members), 0
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
