"""A scene that begins from a state, with the heights and the angles of clamped bars of the state.

Surfaces are matched by their names.  A state has displacements from the places where its scene puts
the asperites, so these places must be the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from tribo.loops.saved_state import State
from tribo.model.identity import first_difference, plain_table
from tribo.model.initial import Initial
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.validation import InputError

# Keys of a surface that place it.
PLACES = ("facing", "bob", "velocity", "shape", "spacing", "depth", "positions", "species")
# Arrays of a bath's oscillators.
OSCILLATORS = ("masses", "frequencies", "inertias", "torsional_frequencies")


def fitted(scene: Scene, state: State) -> tuple[Scene, tuple[str, ...]]:
    """The scene with what it takes from a state, and a note where that is not what it would draw.

    Raises InputError if it lacks a surface or a bath of the state, or has others.
    """
    before = {surface.name: surface for surface in state.scene.surfaces}
    _check_surfaces(scene, state.scene)
    heights = state.heights
    surfaces = []
    notes = []
    for index, surface in enumerate(scene.surfaces):
        other = before[surface.name]
        _check_bath(surface, other)
        mine = surface.drawn_heights([scene.seed, index, 0])
        if not np.array_equal(_numbers(mine), _numbers(heights[surface.name])):
            surface = _with_heights(surface, other, heights[surface.name])
            notes.append(f'the random heights of "{surface.name}" are those of the state')
        surfaces.append(_with_clamps(surface, other, state))
    if all(new is old for new, old in zip(surfaces, scene.surfaces, strict=True)):
        return scene, ()
    return replace(scene, surfaces=tuple(surfaces)), tuple(notes)


def _check_surfaces(scene: Scene, before: Scene) -> None:
    """Refuse surfaces that only one of the scenes has, and those that are at other places."""
    places, others = map(_places, (before, scene))
    for names, one, whose in ((places, others, "scene"), (others, places, "state")):
        if missing := next((name for name in names if name not in one), None):
            raise InputError(
                "start",
                f'must be a state of this scene, but surface "{missing}" is not in the {whose}',
            )
    for name, place in places.items():
        if (other := first_difference(place, others[name])) is not None:
            raise InputError(
                "start", f'must be a state of this scene, but surface "{name}": {other}'
            )


def _places(scene: Scene) -> dict[str, dict[str, object]]:
    """Surface -> its settings on which the meaning of its coordinates depends."""
    tables: list[Mapping[str, Any]] = plain_table(scene)["surface"]
    found = {}
    for table in tables:
        own = {key: table.get(key) for key in PLACES}
        own["asperite.length"] = table["asperite"]["length"]
        found[table["name"]] = own
    return found


def _check_bath(surface: Surface, before: Surface) -> None:
    one = surface.bath
    other = before.bath
    if not all(np.array_equal(getattr(one, k), getattr(other, k)) for k in OSCILLATORS):
        raise InputError(
            "start",
            f'must be a state of this scene, but the oscillators of "{surface.name}" are others',
        )


def _numbers(heights: np.ndarray | None) -> np.ndarray | float:
    """Heights, or zeros in place of none."""
    return np.zeros(1) if heights is None or not np.any(heights) else heights


def _with_heights(surface: Surface, before: Surface, heights: np.ndarray | None) -> Surface:
    """The surface with the heights of the state, if it would draw others.  Raises InputError."""
    draws = surface.draws_heights and heights is not None
    if draws and before.roughness is not None:
        draws = surface.roughness == replace(before.roughness, seed=None)
    if not draws:
        raise InputError(
            "start",
            f'must be a state of this scene, but the heights of "{surface.name}" are others in it',
        )
    return replace(surface, heights=heights)


def _with_clamps(surface: Surface, before: Surface, state: State) -> Surface:
    """The surface with clamped bars that go on from their angles, at their rates.

    Clamped bars turn uniformly, so their angle at t = 0 and their rate tell all of them.
    """
    if surface.turns_bars:
        return surface
    count = surface.count
    table = state.surfaces[surface.name]
    phi = table["phi"] - table["nu"] * state.t
    nu = table["nu"]
    if not before.turns_bars:
        phi, nu = (before.initial.for_each(count)[name] for name in ("phi", "nu"))
    own = surface.initial.for_each(count)
    if np.array_equal(own["phi"], phi) and np.array_equal(own["nu"], nu):
        return surface
    if surface.asperite.is_rigid and np.any(nu != 0.0):
        raise InputError(
            "start",
            f'must have bars of "{surface.name}" that do not turn, as asperite.kappa = inf here, '
            f"but they turn at {np.max(np.abs(nu)):.3g}",
        )
    return replace(surface, initial=Initial(phi=phi, nu=nu))
