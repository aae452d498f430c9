"""Which words of an image each key of a scene with rows or grids changes, found by trying.

A key adds to some words a multiple of its change.  Words that the module sets itself from the
parameters of asperites are left to it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tribo.layout.layout import Layout, lay_out
from tribo.live_pages.image import WORD, Image
from tribo.live_pages.keys import OF_SURFACE, ROUNDING, TRIED, present_number
from tribo.live_pages.lattice import Program, program_of
from tribo.model.drive import Drive
from tribo.model.keys import INTERACTION
from tribo.model.number import changes
from tribo.model.parameters import with_values
from tribo.model.scene import Scene
from tribo.model.schedule import OF_SINE
from tribo.model.tables import field_names
from tribo.potentials.by_key import values_by_key
from tribo.validation import InputError

# Change of all keys at once, in units of their values or of 1.
TOGETHER = 2.0**-10
# Keys of drives, springs and fields that are numbers.
OF_DRIVE = ("stiffness", "speed", "load", "stiffness_y", "damping", "damping_y")
# Most points of a schedule that are tried.
MOST_POINTS = 20
OF_FIELD = ("velocity.0", "velocity.1")


class Words(NamedTuple):
    """A key, its value, and by how much each of some words grows with it."""

    key: str
    value: float
    places: np.ndarray
    factors: np.ndarray


def candidates(scene: Scene) -> list[str]:
    """The keys of a scene that may be numbers."""
    found = ["duration"]
    if len(scene.interactions) == 1:
        values = values_by_key(scene.interactions[0].potential)
        found += [f"{INTERACTION}.{name}" for name in values]
    if len(scene.fields) == 1:
        found += [f"field.{name}" for name in scene.fields[0].potential._fields]
    for surface in scene.surfaces:
        before = surface.name
        found += [f"{before}.{name}" for name in OF_SURFACE if name != "theta"]
        found += [f"{before}.asperite.{name}" for name in field_names(type(surface.asperite))]
        found += [f"{before}.drive.{name}" for name in OF_DRIVE if hasattr(surface.drive, name)]
        found += [f"{before}.drive.{name}" for name in _numbers_of_schedules(surface.drive)]
        found += [f"{before}.drive.{name}" for name in getattr(surface.drive.plugin, "_fields", ())]
        found += [f"{before}.springs.stiffness"]
    return found


def _numbers_of_schedules(drive: Drive) -> list[str]:
    """The keys of all numbers of the schedules that a drive follows."""
    found = []
    for name in field_names(type(drive)):
        value = getattr(drive, name)
        parts = {name: value}
        if isinstance(value, tuple):
            parts = {f"{name}.{axis}": each for axis, each in enumerate(value)}
        for key, each in parts.items():
            if not changes(each):
                continue
            if each.is_sine:
                found += [f"{key}.{number}" for number in OF_SINE]
                continue
            for k in range(min(len(each.points), MOST_POINTS)):
                found.append(f"{key}.{k}.1")
                if each.kind == "steps":  # of others, slopes are no straight lines in times
                    found.append(f"{key}.{k}.0")
    return found


def words_of_keys(layout: Layout, program: Program) -> list[Words]:
    """The keys of a scene that a page can change."""
    scene = layout.scene
    image = program.image()
    free = np.ones(image.words.size, bool)
    free[places_of(program, image)] = False
    found = []
    for key in candidates(scene):
        value = present_number(scene, layout, key)
        if value is None:
            continue
        tried = list(_tried(scene, program.method, image, key, value))
        own = _words(image, free, value, tried) if len(tried) > 1 else None
        if own is not None:
            found.append(Words(key, value, *own))
    return [each._replace(key=shown(each.key)) for each in _together(layout, program, image, found)]


def shown(key: str) -> str:
    """A key as pages have it: the velocity is that along x."""
    return key.replace("velocity.0", "velocity")


def _together(layout: Layout, program: Program, image: Image, found: list[Words]) -> list[Words]:
    """The keys whose changes add up: of those that do not, as a cutoff and where its switch begins
    by default, the first.
    """
    values = {}
    expected = image.words.view(float).copy()
    for each in found:
        change = TOGETHER * (abs(each.value) or 1.0)
        values[each.key] = each.value + change
        expected[each.places] += each.factors * change
    other = lay_out(with_values(layout.scene, values))
    words = program_of(other, 1.0, program.method).image().words.view(float)
    kept: list[Words] = []
    taken: set[int] = set()
    for each in found:
        own = each.places
        wrong = np.abs(words[own] - expected[own]) > 1e-9 * np.maximum(1.0, np.abs(words[own]))
        clashes = set(own[wrong].tolist())
        if not clashes & taken:
            kept.append(each)
            taken |= clashes
    return kept


def places_of(program: Program, image: Image) -> np.ndarray:
    """The places of the words that the module derives from parameters."""
    places: list[int] = []
    for view in program.derived:
        if view.size == 0:
            continue
        first = image.place_of(view)
        steps = np.zeros(view.shape, int)
        for axis, stride in enumerate(view.strides):
            shape = [1] * view.ndim
            shape[axis] = -1
            steps += stride * np.arange(view.shape[axis]).reshape(shape)
        places += ((first + steps.ravel()) // WORD).tolist()
    return np.array(places, int)


def _tried(scene: Scene, method: str, image: Image, key: str, value: float) -> Any:
    """Values near the present one that a scene can have, with its words; two at most."""
    count = 0
    for change in TRIED:
        other = value + change * (abs(value) or 1.0)
        try:
            layout = lay_out(with_values(scene, {key: other}))
            found = program_of(layout, 1.0, method).image()
        except InputError:
            continue
        if is_alike(image, found):
            yield other, found.words.view(float)
            count += 1
        if count == 2:
            return


def is_alike(one: Image, other: Image) -> bool:
    """Whether two images have the same arrays at the same places."""
    return (
        one.size == other.size
        and one.words.size == other.words.size
        and np.array_equal(one.addresses, other.addresses)
        and np.array_equal(one.words[one.addresses], other.words[one.addresses])
        and np.array_equal(one.units, other.units)
    )


def _words(image: Image, free: np.ndarray, value: float, tried: Any) -> Any:
    """Places and factors of words that follow on straight lines; None if one does otherwise."""
    (one, first), (other, second) = tried
    before = image.words.view(float)
    differs = (first.view(int) != image.words) | (second.view(int) != image.words)
    places = np.flatnonzero(differs & free)
    start, first, second = before[places], first[places], second[places]
    if places.size == 0 or not np.all(np.isfinite([start, first, second])):
        return None
    factors = (second - first) / (other - one)
    nearest = np.round(factors)
    factors = np.where(np.abs(factors - nearest) < ROUNDING, nearest, factors)
    size = np.abs(start) + np.abs(factors * value)
    for each, words in ((one, first), (other, second)):
        expected = start + factors * (each - value)
        if np.any(np.abs(expected - words) > 1e3 * ROUNDING * (size + np.abs(expected))):
            return None
    return places, factors
