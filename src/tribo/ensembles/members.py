"""The members of an ensemble: initial values, velocities and seeds.

A member is determined by its number and the seed of the ensemble.  Quantities and seeds are drawn
for whole blocks of members, each quantity and block with a seed that is a child of the ensemble's.
So neither the number of members nor the order of their runs changes any.
The children are those of numpy.random.SeedSequence, after M. E. O'Neill's seed_seq.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from tribo.ensembles.swing_states import SwingStates, joint_starts
from tribo.integrators.methods import noisy
from tribo.model.initial import DISPLACEMENTS, UNITS
from tribo.model.parameters import FIELD, INTERACTION, is_parameter, of_each_surface, with_values
from tribo.model.scene import Scene
from tribo.validation import LARGEST_NUMBER, InputError, inside, is_list, must_be, short_repr

VELOCITY = "velocity"
# Numbers that are drawn at once, of one quantity: calls of a distribution take about 0.1 ms.
BLOCK = 4096


@runtime_checkable
class Distribution(Protocol):
    """A distribution, as those of scipy.stats."""

    def rvs(self, *, size: int, random_state: np.random.Generator) -> ArrayLike:
        """Random numbers."""


# The values of a quantity: an array with a row for each member, or a distribution.
Source = Distribution | SwingStates | ArrayLike


class Members(NamedTuple):
    """Some members; it can be pickled."""

    numbers: np.ndarray  # (members,), from 0 on
    seeds: np.ndarray  # of their scenes, (members,)
    # "surface.theta" -> (members, asperites); velocities (members, 2), numbers (members, 1)
    values: dict[str, np.ndarray]

    def member(self, index: int) -> Member:
        """One of them, by its place among these."""
        values = {key: rows[index] for key, rows in self.values.items()}
        return Member(int(self.numbers[index]), int(self.seeds[index]), values)


def is_start(key: str) -> bool:
    """Whether a key of members is that of an initial angle or its rate."""
    of, _, name = key.rpartition(".")
    return name in UNITS and "." not in of and of not in (INTERACTION, FIELD)


def values_at_start(values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Initial angles and their rates alone."""
    return {key: v for key, v in values.items() if is_start(key)}


@dataclass(frozen=True, eq=False)
class Member:
    """One member; its values are rows of those of :class:`Members`."""

    number: int
    seed: int
    values: dict[str, np.ndarray]

    def scene(self, scene: Scene, with_start: bool = False) -> Scene:
        """The scene with the member's seed and values, with or without initial angles and rates."""
        own = self.values
        if not with_start:
            own = {key: v for key, v in own.items() if not is_start(key)}
        moved = replace(scene, seed=self.seed)
        return with_values(moved, _plain(own)) if own else moved

    @property
    def start(self) -> dict[str, float | np.ndarray]:
        """Initial angles and rates, as ``Simulation.run`` takes them."""
        return _plain(values_at_start(self.values))


def _plain(values: Mapping[str, np.ndarray]) -> dict[str, float | np.ndarray]:
    return {key: v if v.size > 1 else float(v[0]) for key, v in values.items()}


class Draw(Protocol):
    """What is drawn for whole blocks of members: the values of one or several keys."""

    name: str  # its key in `vary`
    keys: tuple[str, ...]
    dimensions: int  # numbers that a member draws
    block: int  # members that are drawn at once

    def random(self, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """Random values of a block of members, key -> (block, size)."""

    def at_points(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """The values at points in the unit cube (members, dimensions)."""


class DistributionDraw:
    """Values of one key from a distribution; of a velocity, its x component alone is drawn."""

    def __init__(self, key: str, source: Distribution, size: int) -> None:
        self.name = key
        self.keys: tuple[str, ...] = (key,)
        self.dimensions = 1 if key.endswith(f".{VELOCITY}") else size
        self.block = max(1, BLOCK // size)
        self._source, self._size = source, size

    def random(self, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """Random values; the distribution may draw all numbers of a member at once."""
        drawn = self._source.rvs(size=self.block * self.dimensions, random_state=rng)
        value = _numbers(self.name, drawn)
        if value.size not in (self.block, self.block * self._size):
            got = value.size / self.block
            raise InputError(self.name, f"must draw 1 or {self._size} numbers, got {got:g}")
        return {self.name: value.reshape(self.block, -1)}

    def at_points(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """The inverse cumulative function of the points.  Raises InputError if there is none."""
        if not hasattr(self._source, "ppf"):
            wanted = "must have ppf, as a distribution of scipy.stats has"
            raise InputError(f"vary.{self.name}", wanted)
        return {self.name: self._source.ppf(points)}


class SeedDraw:
    """Seeds of the members' scenes."""

    name, block = "", BLOCK

    def random(self, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """Seeds (block,)."""
        raw = rng.bit_generator.random_raw(BLOCK)  # type: ignore[attr-defined]
        return {self.name: raw >> np.uint64(1)}  # integers in files are signed


def draws_of(scene: Scene, vary: Mapping[str, Source]) -> dict[str, Draw]:
    """What of `vary` is drawn, by its key there.  Raises InputError."""
    joint, draws = joint_starts(scene, vary), dict[str, Draw]()
    for key, source in vary.items():
        if isinstance(source, SwingStates):
            draws[key] = joint[key]
        elif isinstance(source, Distribution):
            draws[key] = DistributionDraw(key, source, size_of(scene, key))
    return draws


class Variation:
    """The differences between the members of an ensemble.

    `vary` maps "surface.theta" (or another initial value), "surface.velocity" or a number of the
    scene to an array with a row for each member, or to a distribution; "surface.swing_state" to one
    of swings and rates together.  The seeds of the members' scenes, (members,), are drawn if they
    are not given.  `sizes` has the length of each quantity's rows, `own_numbers` the keys of what
    members differ in beside initial angles and rates, and seeds.  Raises InputError if a name, an
    array or a distribution cannot be used.
    """

    def __init__(
        self, scene: Scene, vary: Mapping[str, Source], seed: int, seeds: np.ndarray | None = None
    ) -> None:
        self.seed = seed
        self._seeds = seeds
        self._velocity_y = {f"{s.name}.{VELOCITY}": s.velocity[1] for s in scene.surfaces}
        with inside("vary"):
            draws = draws_of(scene, vary)
            self._draws = {key: draw for draw in draws.values() for key in draw.keys}
            plain = [key for key, source in vary.items() if not isinstance(source, SwingStates)]
            keys = dict.fromkeys([*plain, *self._draws])
            self.sizes = {key: size_of(scene, key) for key in keys}
            self._arrays = {
                key: _rows(key, vary[key], size)
                for key, size in self.sizes.items()
                if key not in self._draws
            }
        self._last: dict[str, tuple[int, dict[str, np.ndarray]]] = {}
        self.own_numbers = tuple(key for key in self.sizes if not is_start(key))

    @property
    def lengths(self) -> dict[str, int]:
        """The number of members that each array has values for."""
        return {key: len(rows) for key, rows in self._arrays.items()}

    def check_lengths(self, members: int) -> None:
        """Raise InputError about an array that has not a value for each of the members."""
        for key, length in self.lengths.items():
            if length != members:
                problem = f"must have values for {members} members, got {length}"
                raise InputError(f"vary.{key}", problem)

    def member(self, number: int) -> Member:
        """A member by its number, from 0 on."""
        return self.members(np.array([number])).member(0)

    def members(self, numbers: np.ndarray) -> Members:
        """The members with some numbers, ascending."""
        values = {
            key: np.broadcast_to(self.rows(key, numbers), (numbers.size, size))
            for key, size in self.sizes.items()
        }
        seeds = self._seeds
        seeds = self._drawn(SeedDraw(), "", numbers) if seeds is None else seeds[numbers]
        return Members(numbers, seeds, values)

    def sample(self, count: int, size: int) -> Members:
        """So many of `count` members, or all if they are fewer: the first, or with arrays, which
        may be in order, at equal distances.
        """
        size = min(size, count)
        numbers = np.arange(size)
        return self.members(numbers * count // size if self._arrays else numbers)

    def identity(self) -> dict[str, str]:
        """What tells the values of each quantity from others: a digest of the first of them."""
        some = min([BLOCK, *self.lengths.values()])
        return {
            key: _digest(self._arrays.get(key, self.rows(key, np.arange(some))))
            for key in self.sizes
        }

    def rows(self, key: str, numbers: np.ndarray) -> np.ndarray:
        """The values of one quantity in some members, (members, 1) or (members, size)."""
        if key in self._arrays:
            rows = self._arrays[key][numbers]
        else:
            rows = self._drawn(self._draws[key], key, numbers)
        if key in self._velocity_y and rows.shape[1] == 1:  # its x component
            return np.column_stack([rows, np.full(len(rows), self._velocity_y[key])])
        return rows

    def _drawn(self, draw: Draw | SeedDraw, key: str, numbers: np.ndarray) -> np.ndarray:
        """Values of members whose numbers ascend, from those of whole blocks of members."""
        blocks, firsts = np.unique(numbers // draw.block, return_index=True)
        parts = np.split(numbers % draw.block, firsts[1:])
        pairs = zip(blocks.tolist(), parts, strict=True)
        return np.concatenate([self._block(draw, block)[key][part] for block, part in pairs])

    def _block(self, draw: Draw | SeedDraw, block: int) -> dict[str, np.ndarray]:
        """The random values of a block of members, of which the last one is remembered."""
        last = self._last.get(draw.name)
        if last is None or last[0] != block:
            sequence = np.random.SeedSequence(self.seed, spawn_key=(block, *draw.name.encode()))
            with inside("vary"):
                last = block, draw.random(np.random.default_rng(sequence))
            self._last[draw.name] = last
        return last[1]


def of_surfaces(scene: Scene, vary: object) -> dict[str, Source]:
    """What members differ in, with a key of each surface in place of "*".  Raises InputError.

    States of swings keep their "*": they are drawn for all surfaces together.
    """
    if vary is None:
        return {}
    if not isinstance(vary, Mapping):
        raise InputError("vary", f"must map names to values, got {short_repr(vary)}")
    found: dict[str, Source] = {}
    for key, source in vary.items():
        joint = isinstance(source, SwingStates)
        found |= {key: source} if joint else of_each_surface(scene, {key: source})
    return found


def check_members_differ(scene: Scene, vary: Mapping[str, Source]) -> None:
    """Refuse members that would all be the same.  Raises InputError."""
    if not (is_random(scene) or vary):
        raise InputError(
            "vary",
            "is empty, and nothing is random, so that all members would be the same; vary a start, "
            "give a reservoir, bath or start a temperature, or sweep the seed of random heights",
        )


def is_random(scene: Scene) -> bool:
    """Whether runs of a scene depend on its seed."""
    return noisy(scene) or any(
        (s.bath and s.bath.temperature) or s.initial.temperature for s in scene.surfaces
    )


def size_of(scene: Scene, key: str) -> int:
    """The length of a quantity's rows: one number for each asperite, or two of a velocity."""
    name, _, quantity = str(key).rpartition(".")
    known = name in [s.name for s in scene.surfaces]
    if known and quantity == VELOCITY:
        return 2
    if known and quantity in UNITS:
        return scene.initial_value(key)[0].count
    if _is_of_scene(scene, str(key)):
        with_values(scene, {str(key): 0.0})
        surface = next(s for s in scene.surfaces if s.name == name)
        return 1 if quantity == "temperature" else surface.count
    if is_parameter(scene, str(key)):
        return 1
    raise InputError(
        str(key),
        'must be "surface.theta", or another initial value or the velocity of a surface, or a '
        'number of the scene, as "surface.asperite.kappa" or "interaction.strength"',
    )


def _is_of_scene(scene: Scene, key: str) -> bool:
    """Whether a key is of an initial displacement, its rate, or the temperature of a start.

    These need a scene of their own.
    """
    name, _, quantity = key.rpartition(".")
    known = name in [surface.name for surface in scene.surfaces]
    return known and quantity in (*DISPLACEMENTS, "temperature")


def _rows(key: str, source: Source, size: int) -> np.ndarray:
    """Values (n, 1) or (n, size), a row for each member."""
    if not is_list(source):
        wanted = "an array with a value for each member, or a distribution as those of scipy.stats"
        raise must_be(key, wanted, source)
    table = _numbers(key, source)
    if table.ndim == 1:
        table = table[:, None]
    if table.ndim != 2 or table.shape[1] not in (1, size):
        raise must_be(key, f"of shape (members,) or (members, {size})", np.shape(table))
    return table


def _digest(values: np.ndarray) -> str:
    return hashlib.blake2b(np.ascontiguousarray(values).tobytes(), digest_size=8).hexdigest()


def _numbers(key: str, value: object) -> np.ndarray:
    """An array of finite floats."""
    try:
        table: np.ndarray = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(key, f"must be numbers, got {short_repr(value)}") from None
    if not np.all(np.abs(table) <= LARGEST_NUMBER):
        raise InputError(key, f"must be finite numbers, at most {LARGEST_NUMBER:g} in magnitude")
    return table
