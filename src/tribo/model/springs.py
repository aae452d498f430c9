"""Lattice springs between neighbouring bars of one surface.

Energy 1/2 k |(r2_i - r2_j) - (r2_i - r2_j)_rest|^2, where rest means every theta at its rest angle
and phi = 0.
"""

from dataclasses import dataclass

import numpy as np

from tribo import validation as check
from tribo.model.tables import from_table
from tribo.validation import InputError, is_list, must_be


@dataclass(frozen=True)
class Springs:
    """Lattice springs along x and along z, or between listed pairs of bars.

    Attributes
    ----------
    stiffness : float or (float, float)
        Stiffness k of each spring [force / length]; two numbers: along x, along z.
    wrap : bool
        Whether springs join the two ends of every row, along the periodic directions of the
        scene; along both directions if the scene is not periodic.
    pairs : list of (int, int), optional
        Indices of the bars that are joined, instead of neighbours on the grid; each pair once.
    turned : float
        Angle by which the rest vectors are rotated [rad], which rotates a whole scene.

    Raises
    ------
    InputError
        If a value is out of range, a pair is listed twice, or `pairs` goes with `wrap` or with two
        stiffnesses.
    """

    stiffness: float | tuple[float, float] = 0.0
    wrap: bool = False
    pairs: tuple[tuple[int, int], ...] | None = None
    turned: float = 0.0

    def __post_init__(self) -> None:
        """Check the values; listed pairs must be different, and exclude `wrap`."""
        kind = check.pair if is_list(self.stiffness) else check.one
        check.fields(self, stiffness=kind(check.NOT_NEGATIVE, "force / length"))
        check.fields(self, wrap=check.boolean, turned=check.one(unit="rad"))
        if self.pairs is not None:
            if not is_list(self.pairs):
                raise must_be("pairs", "a list of pairs of indices", self.pairs)
            pairs = tuple(self._pair(i, p) for i, p in enumerate(self.pairs))
            object.__setattr__(self, "pairs", pairs)
            joined: set[tuple[int, int]] = set()
            for i, (one, other) in enumerate(pairs):
                if (min(one, other), max(one, other)) in joined:
                    raise must_be(f"pairs[{i}]", "a pair not listed before", (one, other))
                joined.add((min(one, other), max(one, other)))
            if self.wrap:
                raise InputError("wrap", "cannot go with pairs; list the pairs that close the row")
            if isinstance(self.stiffness, tuple):
                raise must_be("stiffness", "one number where pairs are listed", self.stiffness)

    @staticmethod
    def _pair(index: int, value: object) -> tuple[int, int]:
        field = f"pairs[{index}]"
        if not is_list(value) or len(value) != 2:
            raise must_be(field, "the indices of two asperites", value)
        one, other = (check.integer(field, n, 0) for n in value)
        if one == other:
            raise must_be(field, "two different asperites", value)
        return one, other

    def __bool__(self) -> bool:
        one, other = self._both
        return (one > 0.0 or other > 0.0) and self.pairs != ()

    @property
    def _both(self) -> tuple[float, float]:
        if isinstance(self.stiffness, tuple):
            return self.stiffness
        return (self.stiffness, self.stiffness)

    def bonds(
        self, shape: tuple[int, int], count: int, periodic: tuple[bool, bool]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Ends (m, 2) and stiffness (m,) of every spring whose stiffness is not zero.

        `periodic` says whether the scene is periodic along x and along z.
        """
        if self.pairs is not None:
            for i, pair in enumerate(self.pairs):
                if max(pair) >= count:
                    raise must_be(f"pairs[{i}]", f"indices from 0 to {count - 1}", pair)
            listed = np.array(self.pairs if self else (), dtype=np.int64).reshape(-1, 2)
            return listed, np.full(len(listed), self._both[0])
        index = np.arange(shape[0] * shape[1]).reshape(shape[1], shape[0])
        ends = [np.empty((0, 2), dtype=np.int64)]
        stiffnesses = [np.empty(0)]
        for along, (axis, stiffness) in enumerate(zip((1, 0), self._both, strict=True)):
            length = index.shape[axis]
            ring = self.wrap and length > 1 and (periodic[along] or not any(periodic))
            tied = length if ring else length - 1
            if stiffness > 0.0:
                first = np.take(index, range(tied), axis).ravel()
                second = np.take(index, [(n + 1) % length for n in range(tied)], axis).ravel()
                ends.append(np.column_stack([first, second]))
                stiffnesses.append(np.full(first.size, stiffness))
        return np.concatenate(ends), np.concatenate(stiffnesses)


def as_springs(value: object) -> Springs:
    """Springs from a table of a scene file, None (no springs), or Springs unchanged."""
    return Springs() if value is None else from_table(Springs, value)
