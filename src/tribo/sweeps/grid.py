"""The points of a sweep: every combination of the values of some keys."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple, SupportsIndex

import numpy as np

from tribo.ensembles.members import size_of
from tribo.model.binding import EVERY, bound, check_together
from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.validation import LARGEST_COUNT, InputError, inside, is_list, must_be, scalar, short_repr

Value = float | int | str | bool
# The dimension of keys that are swept together.
POINT = "point"
# One key, or several that are swept together.
Keys = str | tuple[str, ...]


class Axis(NamedTuple):
    """The values of one key, or of several that are swept together."""

    name: str  # of the dimension: the key, or a short name of several
    keys: tuple[str, ...]
    rows: list[tuple[Value, ...]]  # a value of each key, at each place

    def at(self, place: SupportsIndex) -> dict[str, Value]:
        """The values at a place by their keys."""
        return dict(zip(self.keys, self.rows[place], strict=True))


def values_at(axes: Sequence[Axis], places: Iterable[SupportsIndex]) -> dict[str, Value]:
    """The values at a place on each axis, by their keys."""
    found: dict[str, Value] = {}
    for axis, place in zip(axes, places, strict=True):
        found |= axis.at(place)
    return found


class Grid:
    """The points of a sweep, from 0; the last key varies fastest.  Raises InputError."""

    def __init__(
        self, scene: Scene, values: Mapping[Keys, Sequence[object]], point: str = POINT
    ) -> None:
        """Check keys and values of all axes; `point` is the dimension of joined keys.

        Raises InputError.
        """
        if not isinstance(values, Mapping) or not values:
            wanted = 'must map keys to values, as {"upper.drive.load": [0.1, 0.2]}'
            raise InputError("values", f"{wanted}, got {short_repr(values)}")
        self.scene = scene
        with inside("values"):
            self.axes = _named([_axis(key, items) for key, items in values.items()], point)
            self.keys = [key for axis in self.axes for key in axis.keys]
            self.shape = tuple(len(axis.rows) for axis in self.axes)
            self.size = math.prod(self.shape)
            for key in self.keys:
                if self.keys.count(key) > 1:
                    raise InputError(key, "is swept twice; give each key once")
            # Key of one surface -> the key that gives its value.
            self.bound = bound(scene, {key: key for key in self.keys})
            self.names = [self.name_in_file(axis.name) for axis in self.axes]
            check_together(scene, self.bound)
            if self.size > LARGEST_COUNT:
                raise must_be("", f"of at most {LARGEST_COUNT} points", self.size)
            self.first = with_values(scene, self.point(0))  # the scene of the first point
            # Names of axes of which all values are numbers in which members may differ.
            self.of_numbers = {axis.name for axis in self.axes if self._has_numbers(axis)}
            for axis in self.axes:
                self._check(axis)

    def _check(self, axis: Axis) -> None:
        """Raise InputError about values that cannot be used beside the first of other keys.

        Of numbers in which members may differ the extremes are tried, as of other members.
        """
        if axis.name not in self.of_numbers:
            first = self.point(0)
            for place in range(1, len(axis.rows)):
                with_values(self.scene, first | axis.at(place))
            return
        columns = np.array(axis.rows, float).T
        for place in sorted({*columns.argmin(axis=1).tolist(), *columns.argmax(axis=1).tolist()}):
            own = axis.at(place)
            if place:
                with_values(self.first, {key: own[self.bound[key]] for key in self.bound_to(own)})

    def name_in_file(self, key: str) -> str:
        """The name of a key among dimensions and coordinates: no name in a file begins with "*"."""
        if not key.startswith(f"{EVERY}."):
            return key
        return "+".join(own.partition(".")[0] for own in self.bound_to([key])) + key[len(EVERY) :]

    def _has_numbers(self, axis: Axis) -> bool:
        """Whether all values are numbers in which members may differ."""
        if any(isinstance(each, (str, bool)) for row in axis.rows for each in row):
            return False
        try:
            return all(size_of(self.scene, key) for key in self.bound_to(axis.keys))
        except InputError:
            return False

    def bound_to(self, keys: Iterable[str]) -> list[str]:
        """The keys, each of one surface, whose values some of the keys give."""
        given = {*keys}
        return [key for key, giver in self.bound.items() if giver in given]

    def point(self, index: int) -> dict[str, Value]:
        """The values of a point by their keys."""
        return values_at(self.axes, np.unravel_index(index, self.shape))

    def label(self, index: int) -> str:
        """The values of a point, as a message writes them."""
        return ", ".join(f"{key} = {value}" for key, value in self.point(index).items())

    def identity(self) -> dict[str, list[list[Value]]]:
        """All values, as JSON."""
        return {",".join(axis.keys): [list(row) for row in axis.rows] for axis in self.axes}


def _named(axes: list[Axis], point: str) -> list[Axis]:
    """Axes, of which those of several keys have a short name: `point`, `point_2`, ..."""
    keys = {key for axis in axes for key in axis.keys}
    if not isinstance(point, str) or not point or point in (*keys, "member", "time"):
        raise must_be("point", 'a name that is no key and no other dimension, as "point"', point)
    named = []
    joined = 0
    for axis in axes:
        name = axis.name
        if len(axis.keys) > 1:
            joined += 1
            name = point if joined == 1 else f"{point}_{joined}"
        named.append(axis._replace(name=name))
    return named


def _axis(key: object, values: object) -> Axis:
    """The values of one key, or of a tuple of keys.  Raises InputError."""
    together = isinstance(key, tuple)
    keys = tuple(map(str, key)) if isinstance(key, tuple) else (str(key),)
    name = ",".join(keys)
    rows = []
    if not is_list(values) or len(values) == 0:
        raise must_be(name, "a list of numbers or words", values)
    for item in values.tolist() if isinstance(values, np.ndarray) else values:
        if together and not (is_list(item) and len(item) == len(keys)):
            raise must_be(name, f"a list of {len(keys)} values each, one for each key", item)
        row = tuple(map(scalar, item if together else [item]))
        for each in row:
            if not isinstance(each, (float, int, str)):
                wanted = "a list of numbers or words"
                if is_list(each):  # one of two numbers has a key of its own
                    wanted += f", as those of {name}.0 or {name}.1 are"
                raise must_be(name, wanted, each)
        rows.append(row)
    if len(set(rows)) < len(rows):
        raise InputError(name, "has a value twice; give each value once")
    return Axis(name, keys, rows)
