"""Values of members from the quasi-random points of scipy.stats.qmc."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Protocol

import numpy as np

from tribo.ensembles.members import Source, draws_of
from tribo.model.scene import Scene
from tribo.validation import InputError, inside, must_be


class Sampler(Protocol):
    """A sampler of scipy.stats.qmc."""

    d: int

    def random(self, n: int) -> np.ndarray:
        """Points in the unit cube, (n, d)."""


def sampled(
    sampler: Sampler | None, members: int | None, scene: Scene, vary: Mapping[str, Source]
) -> dict[str, Source]:
    """`vary` with the points of a sampler, if there is one, in place of random numbers.

    Each distribution becomes an array (members, numbers of a member): its inverse cumulative
    function ``ppf`` of as many coordinates of the points, in the order of `vary`.  The sampler is
    copied, so that it draws the same points in a later call.  Raises InputError.
    """
    if sampler is None:
        return dict(vary)
    if not (hasattr(sampler, "random") and hasattr(sampler, "d")):
        raise must_be("sampler", "one of scipy.stats.qmc", sampler)
    if members is None:
        raise InputError("members", "is missing; a sampler needs the number of members")
    with inside("vary"):
        draws = draws_of(scene, vary)
    numbers = sum(draw.dimensions for draw in draws.values())
    if sampler.d != numbers:
        raise InputError(
            "sampler", f"has {sampler.d} dimensions, and members have {numbers} numbers to draw"
        )
    found = {key: source for key, source in vary.items() if key not in draws}
    points, first = copy.deepcopy(sampler).random(members), 0
    for draw in draws.values():
        found |= draw.at_points(points[:, first : first + draw.dimensions])
        first += draw.dimensions
    return found
