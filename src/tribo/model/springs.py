"""Lattice springs between neighbouring bars of one surface.

Energy 1/2 k |(r2_i - r2_j) - (r2_i - r2_j)_rest|^2, rest meaning every theta at its rest angle
and phi = 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.validation import NOT_NEGATIVE, InputError, flag, known_keys, number, vector, whole


@dataclass(frozen=True)
class Springs:
    """Springs along x and along z, or between listed pairs."""

    stiffness: float | tuple[float, float] = 0.0  # [force / length]; two: along x, along z
    wrap: bool = False  # tie the ends of every row along the scene's periodic directions, or all
    pairs: tuple[tuple[int, int], ...] | None = None  # instead of neighbours on the grid
    turned: float = 0.0  # angle by which the rest vectors are turned [rad]

    def __post_init__(self) -> None:
        put = object.__setattr__
        if isinstance(self.stiffness, (list, tuple, np.ndarray)):
            both = vector("stiffness", self.stiffness, NOT_NEGATIVE, size=2)
            put(self, "stiffness", tuple(both.tolist()))
        else:
            put(self, "stiffness", number("stiffness", self.stiffness, NOT_NEGATIVE))
        flag("wrap", self.wrap)
        put(self, "turned", number("turned", self.turned))
        if self.pairs is not None:
            if not isinstance(self.pairs, (list, tuple, np.ndarray)):
                raise InputError("pairs", f"must be a list of pairs, got {self.pairs!r}")
            put(self, "pairs", tuple(self._pair(i, p) for i, p in enumerate(self.pairs)))
            if self.wrap:
                raise InputError("wrap", "cannot go with pairs; list the pairs that close the row")
            if isinstance(self.stiffness, tuple):
                raise InputError("stiffness", "must be one number where pairs are listed")

    @staticmethod
    def _pair(index: int, value: Any) -> tuple[int, int]:
        if not isinstance(value, (list, tuple)) or len(value) != 2:
            raise InputError(f"pairs[{index}]", f"must be two asperites' indices, got {value!r}")
        one, other = (whole(f"pairs[{index}]", n, 0) for n in value)
        if one == other:
            raise InputError(f"pairs[{index}]", f"must be two different asperites, got {value!r}")
        return one, other

    def __bool__(self) -> bool:
        return any(k > 0.0 for k in self._both) and self.pairs != ()

    @property
    def _both(self) -> tuple[float, float]:
        if isinstance(self.stiffness, tuple):
            return self.stiffness
        return (self.stiffness, self.stiffness)

    def bonds(
        self, shape: tuple[int, int], count: int, periodic: tuple[bool, bool]
    ) -> tuple[np.ndarray, np.ndarray]:
        """(m, 2) ends and (m,) stiffness of every spring; those of zero stiffness are none.

        `periodic` says whether the scene is, along x and along z.
        """
        if self.pairs is not None:
            for i, pair in enumerate(self.pairs):
                if max(pair) >= count:
                    raise InputError(f"pairs[{i}]", f"names no asperite; there are {count}")
            listed = self.pairs if self else ()
            return np.array(listed, dtype=np.int64).reshape(-1, 2), np.full(
                len(listed), self._both[0]
            )
        index = np.arange(shape[0] * shape[1]).reshape(shape[1], shape[0])
        ends, stiffnesses = [np.empty((0, 2), dtype=np.int64)], [np.empty(0)]
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


def as_springs(value: Any) -> Springs:
    """Springs from a table of a scene file, None, or themselves."""
    if value is None:
        return Springs()
    if isinstance(value, Springs):
        return value
    return Springs(**known_keys(value, Springs.__dataclass_fields__))
