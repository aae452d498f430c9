"""Lattice springs between neighbouring bars of one surface.

Energy 1/2 k |(r2_i - r2_j) - (r2_i - r2_j)_rest|^2, rest meaning every theta at its rest angle
and phi = 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.checks import NOT_NEGATIVE, flag, known_keys, number, vector, whole
from tribo.errors import InputError


@dataclass(frozen=True)
class Springs:
    """Springs along x and along z, or between listed pairs."""

    stiffness: float | tuple[float, float] = 0.0  # [force / length]; two: along x, along z
    wrap: bool = False  # tie the ends of every row, as of a periodic one
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

    def bonds(self, shape: tuple[int, int], count: int) -> list[tuple[int, int, float]]:
        """(i, j, stiffness) of every spring; springs of zero stiffness are none at all."""
        if self.pairs is not None:
            for i, pair in enumerate(self.pairs):
                if max(pair) >= count:
                    raise InputError(f"pairs[{i}]", f"names no asperite; there are {count}")
            return [(i, j, self._both[0]) for i, j in self.pairs] if self else []
        nx, nz = shape
        index = np.arange(nx * nz).reshape(nz, nx)
        bonds: list[tuple[int, int, float]] = []
        for axis, stiffness in ((1, self._both[0]), (0, self._both[1])):
            if stiffness == 0.0:
                continue
            length = index.shape[axis]
            first = np.take(index, range(length - 1), axis)
            second = np.take(index, range(1, length), axis)
            if self.wrap and length > 2:
                first = np.concatenate([first, np.take(index, [length - 1], axis)], axis)
                second = np.concatenate([second, np.take(index, [0], axis)], axis)
            pairs = zip(first.ravel().tolist(), second.ravel().tolist(), strict=True)
            bonds += [(i, j, stiffness) for i, j in pairs]
        return bonds


def as_springs(value: Any) -> Springs:
    """Springs from a table of a scene file, None, or themselves."""
    if value is None:
        return Springs()
    if isinstance(value, Springs):
        return value
    return Springs(**known_keys(value, Springs.__dataclass_fields__))
