"""The members of an ensemble: what each has of its own, which its number and the seed alone decide.

Member k has seeds of its own, one for each quantity that is drawn and one for what its scene draws
(noise, thermal starts), all children of the ensemble's seed: how many members there are, and who
runs them, changes none.  M. E. O'Neill's seed_seq, as numpy.random.SeedSequence has it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from tribo.integrators.methods import noisy
from tribo.model.scene import Scene
from tribo.model.surface import Initial
from tribo.validation import LARGEST_NUMBER, InputError, inside, is_list, short_repr

VELOCITY = "velocity"


@dataclass(frozen=True, eq=False)
class Member:
    """One member: initial values and velocities in place of the scene's, and a seed."""

    number: int
    seed: int  # of its scene: draws thermal starts and noise
    values: dict[str, np.ndarray]  # "surface.theta" -> (1,) or (asperites,), ".velocity" -> (2,)

    def scene(self, scene: Scene) -> Scene:
        """The scene with the member's seed and velocities; initial angles and rates are left."""
        surfaces = [
            replace(s, velocity=tuple(self.values.get(f"{s.name}.{VELOCITY}", s.velocity)))
            for s in scene.surfaces
        ]
        return replace(scene, surfaces=tuple(surfaces), seed=self.seed)

    @property
    def start(self) -> dict[str, Any]:
        """Initial angles and rates, as ``Simulation.run`` takes them."""
        own = {key: v for key, v in self.values.items() if not key.endswith(f".{VELOCITY}")}
        return {key: v if v.size > 1 else float(v[0]) for key, v in own.items()}


class Variation:
    """What differs between the members of a scene's ensemble.

    `vary` maps "surface.theta" (or phi, omega, nu) and "surface.velocity" to an array, a row for
    each member, or to a distribution with ``rvs(size=, random_state=)``.
    """

    def __init__(self, scene: Scene, vary: Mapping[str, Any], seed: int) -> None:
        """Check all names and arrays.  Raises InputError."""
        if not isinstance(vary, Mapping):
            raise InputError("vary", f"must map names to values, got {short_repr(vary)}")
        self._seed = seed
        self._climb = {f"{s.name}.{VELOCITY}": s.velocity[1] for s in scene.surfaces}
        self._sources: dict[str, Any] = {}
        self.sizes: dict[str, int] = {}  # how many numbers each quantity has
        with inside("vary"):
            for key, source in vary.items():
                size = self.sizes[key] = _size(scene, key)
                self._sources[key] = source if _draws(source) else _rows(key, source, size)
        self.random = noisy(scene) or any(s.bath and s.bath.temperature for s in scene.surfaces)
        self.moves = any(key in self._climb for key in self._sources)
        if not (self.random or self._sources):
            raise InputError(
                "vary",
                "is empty, and nothing in the scene is drawn: all members would be the same; vary "
                'an initial value, as "surface.theta", or give a reservoir or a bath a temperature',
            )

    @property
    def lengths(self) -> dict[str, int]:
        """How many members each array is for."""
        own = self._sources.items()
        return {key: len(source) for key, source in own if isinstance(source, np.ndarray)}

    def member(self, number: int) -> Member:
        """A member by its number, from 0 on."""
        values = {key: self._value(key, number) for key in self._sources}
        (seed,) = self._sequence(number).generate_state(1, np.uint64)
        return Member(number, int(seed >> np.uint64(1)), values)  # files have signed ones

    def _sequence(self, number: int, key: str = "") -> np.random.SeedSequence:
        return np.random.SeedSequence(self._seed, spawn_key=(number, *key.encode()))

    def _value(self, key: str, number: int) -> np.ndarray:
        """A member's own values of one quantity."""
        source, size = self._sources[key], self.sizes[key]
        if isinstance(source, np.ndarray):
            value = source[number]
        else:
            rng = np.random.default_rng(self._sequence(number, key))
            drawn = source.rvs(size=1 if key in self._climb else size, random_state=rng)
            with inside("vary"):
                value = _numbers(key, drawn).ravel()
                if value.size not in (1, size):
                    raise InputError(key, f"draws {value.size} numbers where {size} are wanted")
        if key in self._climb and value.size == 1:  # its x component
            return np.array([value[0], self._climb[key]])
        return value


def _draws(source: Any) -> bool:
    return callable(getattr(source, "rvs", None))


def _size(scene: Scene, key: Any) -> int:
    """How many numbers a quantity has: one for each asperite, or two of a velocity."""
    name, _, quantity = str(key).rpartition(".")
    known = name in [s.name for s in scene.surfaces]
    if known and quantity == VELOCITY:
        return 2
    if known and quantity in [f.name for f in fields(Initial)]:
        return scene.initial_value(key)[0].count
    raise InputError(
        str(key), 'must be "surface.theta", or phi, omega, nu or velocity of a surface'
    )


def _rows(key: str, source: Any, size: int) -> np.ndarray:
    """(n, 1) or (n, size) values, a row for each member."""
    if not is_list(source):
        raise InputError(
            key,
            "must be an array with a value for each member, or a distribution as those of "
            f"scipy.stats, got {short_repr(source)}",
        )
    table = _numbers(key, source)
    if table.ndim == 1:
        table = table[:, None]
    if table.ndim != 2 or table.shape[1] not in (1, size):
        raise InputError(
            key, f"must be of shape (members,) or (members, {size}), got {np.shape(source)}"
        )
    return table


def _numbers(key: str, value: Any) -> np.ndarray:
    """An array of finite floats."""
    try:
        table = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(key, f"must be numbers, got {short_repr(value)}") from None
    if not np.all(np.abs(table) <= LARGEST_NUMBER):
        raise InputError(key, f"must be finite numbers, at most {LARGEST_NUMBER:g} in magnitude")
    return table
