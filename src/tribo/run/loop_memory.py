"""The arrays of a time loop that runs one member of an ensemble after another, in one array."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from tribo.kernels.simd import LANES
from tribo.kernels.simd_arrays import room


def together(item: Any) -> tuple[Any, np.ndarray]:
    """Nested tuples whose arrays are parts of one array, and that array, restored at once."""
    numbers = room((sum(map(_size, arrays_in(item))),))
    return _moved(item, numbers), numbers


def _size(array: np.ndarray) -> int:
    """Numbers that an array takes, to the end of a block."""
    return -(-array.size // LANES) * LANES


def _moved(item: Any, memory: np.ndarray) -> Any:
    """Nested tuples whose arrays are parts of one array, which is restored at once."""
    places = iter(np.cumsum([0, *map(_size, arrays_in(item))]).tolist())

    def move(one: Any) -> Any:
        if isinstance(one, np.ndarray):
            first = next(places)
            new = memory[first : first + one.size].reshape(one.shape)
            new[...] = one
            return new
        if isinstance(one, tuple):
            parts = [move(each) for each in one]
            return type(one)(*parts) if hasattr(one, "_fields") else tuple(parts)
        return one

    return move(item)


def arrays_in(item: object) -> Iterator[np.ndarray]:
    """All arrays in nested tuples."""
    if isinstance(item, np.ndarray):
        yield item
    elif isinstance(item, tuple):
        for each in item:
            yield from arrays_in(each)
