"""The members of an ensemble: initial values, velocities and seeds.

A member is determined by its number and the seed of the ensemble, neither by how many there are nor
by the order of their runs: quantities and seeds are drawn for whole blocks of members, each with a
child of that seed, as of numpy.random.SeedSequence, after M. E. O'Neill's seed_seq.
"""

import copy
import hashlib
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from tribo.ensembles.swing_states import DrawnSwings, JointStart, SwingStates, joint_starts
from tribo.model.binding import bound, check_together
from tribo.model.initial import DISPLACEMENTS, UNITS
from tribo.model.keys import FIELD, INTERACTION
from tribo.model.parameters import is_parameter, with_values
from tribo.model.scene import Scene
from tribo.validation import LARGEST_NUMBER, InputError, inside, is_list, must_be, short_repr

VELOCITY = "velocity"
# Numbers that are drawn at once, of one quantity: calls of a distribution take about 0.1 ms.
BLOCK = 4096
# Blocks in memory, of some 0.1 MB: they are drawn for the runs, and again for the data set.
MOST_BLOCKS = 128


@runtime_checkable
class Distribution(Protocol):
    """A distribution, as those of scipy.stats."""

    def rvs(self, *, size: int, random_state: np.random.Generator) -> ArrayLike:
        """Random numbers."""


class Sampler(Protocol):
    """A sampler of scipy.stats.qmc."""

    d: int

    def random(self, n: int) -> np.ndarray:
        """Points in the unit cube, (n, d)."""


# The values of a quantity: an array with a row for each member, or a distribution.
Source = Distribution | SwingStates | DrawnSwings | ArrayLike
# Those of all pendulums together.
JOINT = (SwingStates, DrawnSwings)


class Members(NamedTuple):
    """Some members; it can be pickled."""

    numbers: np.ndarray  # (members,), from 0 on
    seeds: np.ndarray  # of their scenes, (members,)
    # "surface.theta" -> (members, asperites); velocities (members, 2), numbers (members, 1)
    values: dict[str, np.ndarray]

    def start(self, index: int) -> dict[str, float | np.ndarray]:
        """Initial values of a member by its place, as ``Simulation.run`` takes them."""
        return {key: _plain(rows[index]) for key, rows in values_at_start(self.values).items()}

    def scene(self, index: int, scene: Scene, with_start: bool = False) -> Scene:
        """The scene with a member's seed and values, with or without initial values."""
        keys = [key for key in self.values if with_start or not is_start(key)]
        own = {key: _plain(self.values[key][index]) for key in keys}
        moved = replace(scene, seed=int(self.seeds[index]))
        return with_values(moved, own) if own else moved


def _plain(row: np.ndarray) -> float | np.ndarray:
    return row if row.size > 1 else float(row[0])


def is_start(key: str) -> bool:
    """Whether a key of members is that of an initial angle, displacement or rate."""
    of, _, name = key.rpartition(".")
    return name in UNITS | DISPLACEMENTS and "." not in of and of not in (INTERACTION, FIELD)


def values_at_start(values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Initial angles, displacements and their rates alone."""
    return {key: v for key, v in values.items() if is_start(key)}


class DistributionDraw:
    """Values of one key from a distribution; of a velocity, its x component alone is drawn."""

    def __init__(self, key: str, source: Distribution, size: int) -> None:
        self.name = key
        self.keys: tuple[str, ...] = (key,)
        self.dimensions = 1 if key.endswith(f".{VELOCITY}") else size  # numbers of a member
        self.block = max(1, BLOCK // size)  # members that are drawn at once
        self._source = source
        self._size = size

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
            raise InputError(f"vary.{self.name}", "must have ppf, as distributions of SciPy do")
        return {self.name: self._source.ppf(points)}


class SeedDraw:
    """Seeds of the members' scenes."""

    name = ""
    block = BLOCK

    def random(self, rng: np.random.Generator) -> dict[str, np.ndarray]:
        raw = rng.bit_generator.random_raw(BLOCK)  # type: ignore[attr-defined]
        return {self.name: raw >> np.uint64(1)}  # integers in files are signed


SEEDS = SeedDraw()
Draw = DistributionDraw | JointStart


def draws_of(scene: Scene, vary: Mapping[str, Source]) -> dict[str, Draw]:
    """What of `vary` is drawn, by its key there.  Raises InputError."""
    joint = joint_starts(scene, vary)
    draws = dict[str, Draw]()
    for key, source in vary.items():
        if isinstance(source, SwingStates):
            draws[key] = joint[key]
        elif isinstance(source, Distribution):
            draws[key] = DistributionDraw(key, source, size_of(scene, key))
    return draws


class Variation:
    """The differences between the members of an ensemble, as `vary` says.  Raises InputError.

    The seeds of the members' scenes, (members,), are drawn if they are not given.  With numbers
    that are `swept` beside, key -> (points,), each point has the members of `seeds`, whose values
    are drawn alike, and the members of all points are numbered point by point.

    `own_numbers` has the keys of what members differ in beside initial values and seeds.
    """

    def __init__(
        self,
        scene: Scene,
        vary: Mapping[str, Source],
        seed: int,
        seeds: np.ndarray | None = None,
        swept: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        """Check what is varied, beside what is `swept`.  Raises InputError."""
        self.vary = vary
        self.seed = seed
        self._seeds = seeds
        self._velocity_y = {f"{s.name}.{VELOCITY}": s.velocity[1] for s in scene.surfaces}
        swept = swept or {}
        with inside("vary"):
            check_together(scene, {**vary, **swept})
            self._draws = draws_of(scene, vary)
            self._joint = joint_starts(scene, dict.fromkeys(swept, 0.0) | dict(vary))
            plain = [key for key, source in vary.items() if not isinstance(source, JOINT)]
            self._sizes = {key: size_of(scene, key) for key in plain}
            arrays = {
                key: _rows(key, vary[key], size)
                for key, size in self._sizes.items()
                if key not in self._draws
            }
        drawn = {
            key: source.rows for key, source in vary.items() if isinstance(source, DrawnSwings)
        }
        self._arrays = arrays | drawn
        self._swept = {key: np.asarray(each)[:, None] for key, each in swept.items()}
        self._sizes |= {key: size_of(scene, key) for key in swept}
        self._block = lru_cache(MOST_BLOCKS)(self._new_block)
        self.own_numbers = tuple(key for key in (*plain, *swept) if not is_start(key))

    @property
    def lengths(self) -> dict[str, int]:
        """The number of members that each array has values for."""
        return {key: len(rows) for key, rows in self._arrays.items()}

    def check(self, members: int) -> None:
        """Refuse arrays without a value for each of the members, and draws that fail."""
        for key, length in self.lengths.items():
            if length != members:
                problem = f"must have values for {members} members, got {length}"
                raise InputError(f"vary.{key}", problem)
        for draw in self._draws.values():
            self._block(draw, 0)

    def members(self, numbers: np.ndarray) -> Members:
        """The members with some numbers, ascending."""
        drawn = self.drawn(numbers)
        values = {
            key: np.broadcast_to(drawn.values[key], (numbers.size, size))
            for key, size in self._sizes.items()
        }
        with inside("vary"):
            for name, joint in self._joint.items():
                values |= joint.starts(drawn.values[name], values)
        return drawn._replace(values=values)

    def drawn(self, numbers: np.ndarray) -> Members:
        """The members with rows of swing states as they are drawn, under the names of these."""
        mine = numbers
        back = np.arange(numbers.size)
        rows: dict[str, np.ndarray] = {}
        if self._swept and self._seeds is not None:
            points, each = np.divmod(numbers, self._seeds.size)
            rows = {key: self._with_y(key, table[points]) for key, table in self._swept.items()}
            mine, back = np.unique(each, return_inverse=True)
        rows |= {key: self.rows(key, mine)[back] for key in (*self._arrays, *self._draws)}
        given = self._seeds
        seeds = self._drawn(SEEDS, "", mine) if given is None else given[mine]
        return Members(numbers, seeds[back], rows)

    def sample(self, count: int, size: int) -> Members:
        """Some of `count` members: the first, or with arrays, possibly in order, evenly spaced."""
        size = min(size, count)
        numbers = np.arange(size)
        spaced = bool(self._arrays or self._swept)
        return self.members(numbers * count // size if spaced else numbers)

    def identity(self) -> dict[str, str]:
        """What tells the values of each quantity from others: a digest of the first of them."""
        some = np.arange(min([BLOCK, *self.lengths.values()]))
        first = self._arrays | {key: self.rows(key, some) for key in self._draws}
        return {
            key: hashlib.blake2b(values.tobytes(), digest_size=8).hexdigest()
            for key, values in first.items()
        }

    def rows(self, key: str, numbers: np.ndarray) -> np.ndarray:
        """The values of one key of `vary` in some members, (members, 1) or (members, size)."""
        if key in self._arrays:
            return self._with_y(key, self._arrays[key][numbers])
        return self._with_y(key, self._drawn(self._draws[key], key, numbers))

    def _with_y(self, key: str, rows: np.ndarray) -> np.ndarray:
        """Rows of a velocity of which its x component alone is given, with that of the scene."""
        if key in self._velocity_y and rows.shape[1] == 1:
            return np.column_stack([rows, np.full(len(rows), self._velocity_y[key])])
        return rows

    def _drawn(self, draw: Draw | SeedDraw, key: str, numbers: np.ndarray) -> np.ndarray:
        """Values of members whose numbers ascend, from those of whole blocks of members."""
        blocks, places = np.divmod(numbers, draw.block)
        if blocks[0] == blocks[-1]:  # of all members of a small ensemble
            return self._block(draw, int(blocks[0]))[key][places]
        firsts = [0, *((blocks[1:] != blocks[:-1]).nonzero()[0] + 1).tolist(), numbers.size]
        parts = [
            self._block(draw, int(blocks[first]))[key][places[first:stop]]
            for first, stop in pairwise(firsts)
        ]
        return np.concatenate(parts)

    def _new_block(self, draw: Draw | SeedDraw, block: int) -> dict[str, np.ndarray]:
        sequence = np.random.SeedSequence(self.seed, spawn_key=(block, *draw.name.encode()))
        with inside("vary"):
            return draw.random(np.random.default_rng(sequence))


def sources_of(
    scene: Scene, vary: object, sampler: Sampler | None, members: int | None
) -> dict[str, Source]:
    """What members differ in, with a key of each surface in place of "*".  Raises InputError.

    States of swings keep their "*": they are drawn for all surfaces together.  With a sampler, each
    distribution becomes an array (members, numbers of a member): its inverse cumulative function
    ``ppf`` of as many coordinates of the sampler's points, in the order of `vary`.
    """
    if not isinstance(vary, Mapping | None):
        raise InputError("vary", f"must map names to values, got {short_repr(vary)}")
    with inside("vary"):
        found = bound(scene, vary or {})
        check_together(scene, found)
    if sampler is None:
        return found
    if not (hasattr(sampler, "random") and hasattr(sampler, "d")):
        raise must_be("sampler", "one of scipy.stats.qmc", sampler)
    if members is None:
        raise InputError("members", "is missing; a sampler needs the number of members")
    with inside("vary"):
        draws = draws_of(scene, found)
    numbers = sum(draw.dimensions for draw in draws.values())
    if sampler.d != numbers:
        raise InputError(
            "sampler", f"has {sampler.d} dimensions, and members have {numbers} numbers to draw"
        )
    found = {key: source for key, source in found.items() if key not in draws}
    # A copy, so that the sampler draws the same points in a later call.
    points = copy.deepcopy(sampler).random(members)
    first = 0
    for draw in draws.values():
        found |= draw.at_points(points[:, first : first + draw.dimensions])
        first += draw.dimensions
    return found


def is_random(scene: Scene) -> bool:
    """Whether runs of a scene depend on its seed."""
    return scene.is_noisy or any(
        (s.bath and s.bath.temperature) or s.initial.temperature for s in scene.surfaces
    )


def size_of(scene: Scene, key: str) -> int:
    """The length of a quantity's rows: one number for each asperite, or two of a velocity."""
    key = str(key)
    name, _, quantity = key.rpartition(".")
    count = {surface.name: surface.count for surface in scene.surfaces}.get(name)
    if count is not None:
        if quantity == VELOCITY:
            return 2
        if quantity in UNITS | DISPLACEMENTS:
            return scene.initial_value(key)[0].count
        if quantity == "temperature":  # which needs a scene of its own
            with_values(scene, {key: 0.0})
            return 1
    if is_parameter(scene, key):
        return 1
    raise InputError(
        key,
        'must be "surface.theta", or another initial value or the velocity of a surface, or a '
        'number of the scene, as "surface.asperite.kappa" or "interaction.strength"',
    )


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


def _numbers(key: str, value: object) -> np.ndarray:
    """An array of finite floats."""
    try:
        table: np.ndarray = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(key, f"must be numbers, got {short_repr(value)}") from None
    if not np.all(np.abs(table) <= LARGEST_NUMBER):
        raise InputError(key, f"must be finite numbers, at most {LARGEST_NUMBER:g} in magnitude")
    return table
