"""The members of an ensemble: initial values, velocities and seeds.

A member is determined by its number and the seed of the ensemble.  Quantities and seeds are drawn
for whole blocks of members, each quantity and block with a seed that is a child of the ensemble's.
So neither the number of members nor the order of their runs changes any.
The children are those of numpy.random.SeedSequence, after M. E. O'Neill's seed_seq.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from tribo.ensembles.swing_states import JointStart, SwingStates, joint_starts
from tribo.integrators.methods import noisy
from tribo.model.initial import UNITS, UNITS_OF_DISPLACEMENTS
from tribo.model.parameters import is_parameter, of_each_surface, with_values
from tribo.model.scene import Scene
from tribo.validation import LARGEST_NUMBER, InputError, inside, is_list, short_repr

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


def values_at_start(values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Initial angles and their rates alone."""

    def is_initial(key: str) -> bool:
        of, _, name = key.rpartition(".")
        return name in UNITS and "." not in of  # a reservoir has a temperature too

    return {key: v for key, v in values.items() if is_initial(key)}


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
            own = {key: v for key, v in own.items() if key not in values_at_start(own)}
        moved = replace(scene, seed=self.seed)
        return with_values(moved, _plain(own)) if own else moved

    @property
    def start(self) -> dict[str, float | np.ndarray]:
        """Initial angles and rates, as ``Simulation.run`` takes them."""
        return _plain(values_at_start(self.values))


def _plain(values: Mapping[str, np.ndarray]) -> dict[str, float | np.ndarray]:
    return {key: v if v.size > 1 else float(v[0]) for key, v in values.items()}


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
        self._arrays: dict[str, np.ndarray] = {}
        self._distributions: dict[str, Distribution] = {}
        self.sizes: dict[str, int] = {}
        with inside("vary"):
            self._joint = joint_starts(scene, vary)
            for key, source in [*vary.items(), *self._joint.items()]:
                if isinstance(source, SwingStates):
                    continue
                size = self.sizes[key] = size_of(scene, key)
                if isinstance(source, JointStart):
                    continue
                if isinstance(source, Distribution):
                    self._distributions[key] = source
                else:
                    self._arrays[key] = _rows(key, source, size)
        self._last_seeds: tuple[int, np.ndarray] = (-1, np.empty(0))
        self._last_draws: dict[str, tuple[int, np.ndarray]] = {}
        of_start = [f"{s.name}.{name}" for s in scene.surfaces for name in UNITS]
        self.own_numbers = tuple(key for key in self.sizes if key not in of_start)

    @property
    def lengths(self) -> dict[str, int]:
        """The number of members that each array has values for."""
        return {key: len(rows) for key, rows in self._arrays.items()}

    def member(self, number: int) -> Member:
        """A member by its number, from 0 on."""
        return self.members(np.array([number])).member(0)

    def members(self, numbers: np.ndarray) -> Members:
        """The members with some numbers, ascending."""
        values = {
            key: np.broadcast_to(self.rows(key, numbers), (numbers.size, size))
            for key, size in self.sizes.items()
        }
        return Members(numbers, self.seeds(numbers), values)

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

    def seeds(self, numbers: np.ndarray) -> np.ndarray:
        """The seeds of the scenes of some members, (members,)."""
        if self._seeds is not None:
            return self._seeds[numbers]
        return _of_blocks(numbers, BLOCK, self._seeds_of)

    def rows(self, key: str, numbers: np.ndarray) -> np.ndarray:
        """The values of one quantity in some members, (members, 1) or (members, size)."""
        if key in self._arrays:
            rows = self._arrays[key][numbers]
        elif key in self._joint:
            each = self._joint[key].block
            rows = _of_blocks(numbers, each, lambda block: self._draw_joint(key, block))
        else:
            each = self._members_in_block(key)
            rows = _of_blocks(numbers, each, lambda block: self._draw(key, block))
        if key in self._velocity_y and rows.shape[1] == 1:  # its x component
            return np.column_stack([rows, np.full(len(rows), self._velocity_y[key])])
        return rows

    def _members_in_block(self, key: str) -> int:
        return max(1, BLOCK // self.sizes[key])

    def _sequence(self, block: int, key: str = "") -> np.random.SeedSequence:
        return np.random.SeedSequence(self.seed, spawn_key=(block, *key.encode()))

    def _seeds_of(self, block: int) -> np.ndarray:
        """The seeds of a block of members."""
        if self._last_seeds[0] != block:
            seeds = np.random.PCG64(self._sequence(block)).random_raw(BLOCK)
            self._last_seeds = block, seeds >> np.uint64(1)  # integers in files are signed
        return self._last_seeds[1]

    def _draw(self, key: str, block: int) -> np.ndarray:
        """The random values of one quantity in a block of members."""
        known = self._last_draws.get(key)
        if known is not None and known[0] == block:
            return known[1]
        rng = np.random.default_rng(self._sequence(block, key))
        size, members = self.sizes[key], self._members_in_block(key)
        wanted = 1 if key in self._velocity_y else size
        with inside("vary"):
            drawn = self._distributions[key].rvs(size=members * wanted, random_state=rng)
            value = _numbers(key, drawn)
            if value.size not in (members, members * size):
                got = value.size / members
                raise InputError(key, f"must draw 1 or {size} numbers, got {got:g}")
        rows = value.reshape(members, -1)
        self._last_draws[key] = block, rows
        return rows

    def _draw_joint(self, key: str, block: int) -> np.ndarray:
        """The values of one of the quantities that are drawn together, in a block of members."""
        joint = self._joint[key]
        return joint.draw(block, np.random.default_rng(self._sequence(block, joint.name)))[key]


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
            "is empty, and the scene draws nothing: all members would be the same; vary a start, "
            "give a reservoir, bath or start a temperature, or sweep the seed of random heights",
        )


def is_random(scene: Scene) -> bool:
    """Whether runs of a scene depend on its seed."""
    return noisy(scene) or any(
        (s.bath and s.bath.temperature) or s.initial.temperature for s in scene.surfaces
    )


def _of_blocks(numbers: np.ndarray, size: int, values: Callable[[int], np.ndarray]) -> np.ndarray:
    """Values by ascending numbers, from those of whole blocks of numbers."""
    blocks, firsts = np.unique(numbers // size, return_index=True)
    parts = np.split(numbers, firsts[1:])
    return np.concatenate(
        [values(int(block))[part % size] for block, part in zip(blocks, parts, strict=True)]
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
    return known and quantity in (*UNITS_OF_DISPLACEMENTS, "temperature")


def _rows(key: str, source: Source, size: int) -> np.ndarray:
    """Values (n, 1) or (n, size), a row for each member."""
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
            key, f"must be of shape (members,) or (members, {size}), got {np.shape(table)}"
        )
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
