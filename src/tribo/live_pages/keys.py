"""Which numbers of the module each key of a scene sets, found by trying.

A key sets some numbers, each to a multiple of its value plus a constant: ``upper.theta`` sets a
swing to its value less the angle at rest, and a cutoff sets where its switch begins too.  The keys
of a scene are those of `--set`; trying them leaves their rules where they are.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from tribo.layout.layout import Layout, lay_out
from tribo.live_pages.inputs import inputs_of
from tribo.loops.pair_records import is_pair
from tribo.model.keys import INTERACTION
from tribo.model.parameters import value_of, with_values
from tribo.model.scene import Scene
from tribo.model.tables import field_names
from tribo.potentials.by_key import values_by_key
from tribo.validation import InputError

# Keys of a surface whose values are numbers, beside those of its asperites.
OF_SURFACE = ("bob.0", "bob.1", "velocity.0", "velocity.1", "depth", "swing", "theta", "omega")
# Changes that are tried, in units of the present value or of 1, and the relative size of what
# rounding leaves of a number that does not follow.
TRIED = (0.125, 0.25, -0.125, -0.25)
ROUNDING = 1e-12


class Part(NamedTuple):
    """A number that a key sets: to `factor` times the value of the key, plus `constant`."""

    place: int
    factor: float
    constant: float


class Key(NamedTuple):
    key: str
    value: float
    parts: tuple[Part, ...]


def numbers_of(layout: Layout) -> np.ndarray:
    """All numbers that keys can set: those of the pair, and those of the potential."""
    return np.concatenate([inputs_of(layout), flat(layout.model.contacts[0].potential)])


def flat(potential: Any) -> list[float]:
    """The numbers of a potential and of its parts, in the order of its fields, without arrays."""
    found: list[float] = []
    for value in potential:
        if isinstance(value, tuple):
            found += flat(value)
        elif not isinstance(value, np.ndarray):
            found.append(float(value))
    return found


def candidates(scene: Scene) -> list[str]:
    """The keys of a pair that are numbers."""
    found = ["duration"]
    for surface in scene.surfaces:
        found += [f"{surface.name}.{name}" for name in OF_SURFACE]
        found += [f"{surface.name}.asperite.{name}" for name in field_names(type(surface.asperite))]
    values = values_by_key(scene.interactions[0].potential)
    return [*(f"{INTERACTION}.{name}" for name in values), *found]


def keys_of(scene: Scene) -> list[Key]:
    """The keys of a pair's scene that are numbers, with the numbers that they set."""
    layout = lay_out(scene)
    before = numbers_of(layout)
    found = []
    for key in candidates(scene):
        value = present_number(scene, layout, key)
        if value is None:
            continue
        tried = list(_tried(scene, key, value))
        parts = _parts(before, value, tried) if len(tried) > 1 else None
        if parts:
            name = key.replace("velocity.0", "velocity")
            found.append(Key(name, value, parts))
    return found


def numbers_at(scene: Scene) -> np.ndarray | None:
    """The numbers of a scene; None if it is no pair that the module runs."""
    layout = lay_out(scene)
    return numbers_of(layout) if is_pair(layout) else None


def present_number(scene: Scene, layout: Layout, key: str) -> float | None:
    """The number that a key has in the scene or in its start; None if it has none."""
    value = value_of(scene, key)
    name, _, rest = key.partition(".")
    if value is None and rest in ("swing", "theta", "omega"):  # not given
        surface = scene.surfaces[scene.index_of(name)]
        place = scene.parts[name].start + layout.coordinates * (rest == "omega")
        value = float(layout.start[place]) + surface.rest * (rest == "theta")
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return None
    return float(value)


def _tried(scene: Scene, key: str, value: float) -> Any:
    """Values near the present one that a scene can have, with its numbers; two at most."""
    count = 0
    for change in TRIED:
        other = value + change * (abs(value) or 1.0)
        try:
            numbers = numbers_at(with_values(scene, {key: other}))
        except InputError:
            continue
        if numbers is not None:
            yield other, numbers
            count += 1
        if count == 2:
            return


def _parts(before: np.ndarray, value: float, tried: Any) -> tuple[Part, ...] | None:
    """The numbers that follow from a value on a straight line; None if one does otherwise."""
    (one, first), (other, second) = tried
    found = []
    for place in np.flatnonzero((first != before) | (second != before)).tolist():
        factor = (second[place] - first[place]) / (other - one)
        nearest = round(factor)
        factor = float(nearest) if abs(factor - nearest) < ROUNDING else float(factor)
        constant = before[place] - factor * value
        size = abs(before[place]) + abs(factor * value)
        constant = 0.0 if abs(constant) <= ROUNDING * size else float(constant)
        for each, numbers in tried:
            expected = factor * each + constant
            if abs(expected - numbers[place]) > 1e3 * ROUNDING * (size + abs(expected)):
                return None
        found.append(Part(place, factor, constant))
    return tuple(found)
