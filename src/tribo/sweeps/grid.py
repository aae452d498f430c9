"""The points of a sweep: every combination of the values of some keys."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.validation import LARGEST_COUNT, InputError, inside, is_list, must_be, short_repr

# A value of a key.
Value = float | int | str | bool


class Grid:
    """The points of a sweep, numbered from 0; the last key varies fastest.

    Parameters
    ----------
    scene : Scene
        The scene whose values are replaced.
    values : mapping
        Key -> its values.

    Attributes
    ----------
    scene_before : Scene
        As given.
    values : dict
        Key -> its values, as numbers and words of Python.
    shape : tuple of int
        The number of values of each key.

    Raises
    ------
    InputError
        A key or a value cannot be used, alone or together with others.
    """

    def __init__(self, scene: Scene, values: Mapping[str, Sequence[object]]) -> None:
        if not isinstance(values, Mapping) or not values:
            wanted = 'must map keys to values, as {"upper.drive.load": [0.1, 0.2]}'
            raise InputError("values", f"{wanted}, got {short_repr(values)}")
        self.scene_before = scene
        self.values = {str(key): _checked(str(key), items) for key, items in values.items()}
        self.shape = tuple(map(len, self.values.values()))
        if self.size > LARGEST_COUNT:
            raise must_be("values", f"of at most {LARGEST_COUNT} points", self.size)
        with inside("values"):
            self._scenes = [with_values(scene, self.point(index)) for index in range(self.size)]

    @property
    def size(self) -> int:
        """The number of points."""
        return math.prod(self.shape)

    def point(self, index: int) -> dict[str, Value]:
        """The values of a point by their keys."""
        places = np.unravel_index(index, self.shape)
        items = zip(self.values.items(), places, strict=True)
        return {key: values[place] for (key, values), place in items}

    def scene(self, index: int) -> Scene:
        """The scene of a point."""
        return self._scenes[index]

    def label(self, index: int) -> str:
        """The values of a point, as a message writes them."""
        return ", ".join(f"{key} = {value}" for key, value in self.point(index).items())


def _checked(key: str, values: object) -> list[Value]:
    """The values of a key.  Raises InputError."""
    with inside("values"):
        if not is_list(values) or len(values) == 0:
            raise must_be(key, "a list of numbers or words", values)
        items = [item.item() if isinstance(item, np.generic) else item for item in values]
        for item in items:
            if not isinstance(item, (float, int, str)):
                raise must_be(key, "a list of numbers or words", item)
        if len(set(items)) < len(items):
            raise InputError(key, "has a value twice; give each value once")
    return items
