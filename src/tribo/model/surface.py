"""A surface: asperites that share a velocity and a drive."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from tribo.model.asperite import Asperite, Each
from tribo.model.bath import Bath, Langevin, as_bath, as_langevin
from tribo.model.drives import Drive, Ends, Forced, as_bars, as_drive
from tribo.model.roughness import Roughness, as_heights, draw
from tribo.model.springs import Springs, as_springs
from tribo.validation import (
    MANY,
    InputError,
    choice,
    inside,
    is_list,
    number,
    number_or_each,
    shown,
    vector,
    whole,
)


@dataclass(frozen=True, eq=False)
class Initial:
    """Where the pendulums and bars start; None is their place of rest, at rest.

    theta and phi are absolute: an asperite that faces up rests at theta = pi.
    """

    theta: Each | None = None  # [rad]
    phi: Each | None = None  # [rad]
    omega: Each | None = None  # d theta / dt
    nu: Each | None = None  # d phi / dt

    def __post_init__(self) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            if value is not None:
                object.__setattr__(self, f.name, number_or_each(f.name, value))

    def for_each(self, count: int) -> dict[str, np.ndarray | None]:
        """Each given angle and rate as an array of `count`."""
        each: dict[str, np.ndarray | None] = {}
        for f in fields(self):
            value = getattr(self, f.name)
            if isinstance(value, np.ndarray) and value.size != count:
                raise InputError(f.name, f"has {value.size} values for {count} asperites")
            each[f.name] = None if value is None else np.broadcast_to(value, (count,))
        return each


@dataclass(frozen=True, eq=False)
class Surface:
    """One asperite, a row, a grid or any list of them.

    Places are those of the bobs with their theta at rest and phi = 0, whatever `initial` says.
    Lengths, times and masses are in the scene's own units.
    """

    name: str
    facing: str = "down"  # "down": rest angle 0; "up": rest angle pi
    bob: tuple[float, float] = (0.0, 0.0)  # x, y of the first resting bob
    velocity: tuple[float, float] = (0.0, 0.0)
    shape: tuple[int, int] = (1, 1)  # asperites along x, along z; x runs fastest
    spacing: tuple[float, float] = (0.0, 0.0)
    depth: float = 0.0  # z of the first
    heights: np.ndarray | Roughness | None = None  # a shift in y per asperite, up positive
    positions: np.ndarray | None = (
        None  # (n, 3) resting bobs, instead of bob, shape, spacing, depth
    )
    drive: Drive = field(default_factory=Forced)
    bars: str | Ends = "clamped"  # or "free", or forces of the user's own on their ends
    springs: Springs = field(default_factory=Springs)
    bath: Bath = field(default_factory=lambda: as_bath(None))
    langevin: Langevin | None = None
    species: str | tuple[str, ...] = ""  # of the bobs, by which interactions may tell them apart
    asperite: Asperite = field(default_factory=Asperite)
    initial: Initial = field(default_factory=Initial)

    def __post_init__(self) -> None:
        put = object.__setattr__
        if not _is_name(self.name):
            raise InputError("name", f"must be a word without . or /, got {shown(self.name)}")
        choice("facing", self.facing, ["down", "up"])
        put(self, "bob", tuple(vector("bob", self.bob, size=2).tolist()))
        put(self, "velocity", tuple(vector("velocity", self.velocity, size=2).tolist()))
        vector("shape", self.shape, size=2)
        put(self, "shape", tuple(whole(f"shape[{i}]", n, 1) for i, n in enumerate(self.shape)))
        put(self, "spacing", tuple(vector("spacing", self.spacing, size=2).tolist()))
        put(self, "depth", number("depth", self.depth))
        if self.positions is not None:
            put(self, "positions", self._listed_positions())
        if self.count > MANY:
            raise InputError("shape", f"must be at most {MANY} asperites, got {self.count}")
        with inside("drive"):
            put(self, "drive", as_drive(self.drive))
        put(self, "heights", as_heights(self.heights, *self._grid))
        with inside("bars"):
            put(self, "bars", as_bars(self.bars))
        with inside("springs"):
            put(self, "springs", as_springs(self.springs))
            if self.springs and self.positions is not None and self.springs.pairs is None:
                raise InputError("pairs", "is missing; listed positions have no neighbours")
            self.springs.bonds(self.shape, self.count, (False, False))
        with inside("bath"):
            put(self, "bath", as_bath(self.bath))
            if self.bath.inertias.size and self.bars == "clamped":
                raise InputError("torsional", 'has nothing to turn on clamped bars; bars = "free"')
        with inside("langevin"):
            put(self, "langevin", as_langevin(self.langevin))
        put(self, "species", self._checked_species())
        for key, kind in (("asperite", Asperite), ("initial", Initial)):
            value = getattr(self, key)
            if not isinstance(value, kind):
                raise InputError(key, f"must be a tribo.{kind.__name__}, got {shown(value)}")
            with inside(key):
                value.for_each(self.count)

    def _listed_positions(self) -> np.ndarray:
        for key, untouched in (("bob", (0.0, 0.0)), ("shape", (1, 1)), ("spacing", (0.0, 0.0))):
            if getattr(self, key) != untouched:
                raise InputError(key, "cannot go with positions; give one or the other")
        if self.depth != 0.0:
            raise InputError("depth", "cannot go with positions; give one or the other")
        places: Any = self.positions
        if not is_list(places) or len(places) == 0:
            raise InputError("positions", f"must be a list of [x, y, z], got {shown(places)}")
        rows = [vector(f"positions[{i}]", place, size=3) for i, place in enumerate(places)]
        table = np.array(rows)
        table.flags.writeable = False
        return table

    def _checked_species(self) -> str | tuple[str, ...]:
        value: Any = self.species
        if isinstance(value, str):
            return value
        if not is_list(value) or not all(isinstance(name, str) for name in value):
            raise InputError("species", f"must be a name, or one per asperite, got {shown(value)}")
        if len(value) != self.count:
            raise InputError("species", f"has {len(value)} names for {self.count} asperites")
        return tuple(str(name) for name in value)

    @property
    def species_of_each(self) -> np.ndarray:
        """(n,) name of each bob's species."""
        return np.broadcast_to(np.array(self.species), (self.count,))

    @property
    def _grid(self) -> tuple[tuple[int, int], tuple[float, float]]:
        """Shape and spacing; a list has none of the latter."""
        if self.positions is not None:
            return (self.count, 1), (0.0, 0.0)
        return self.shape, self.spacing

    @property
    def count(self) -> int:
        """How many asperites there are."""
        return len(self.positions) if self.positions is not None else self.shape[0] * self.shape[1]

    @property
    def rest(self) -> float:
        """The torsion spring's rest angle theta - phi [rad]."""
        return 0.0 if self.facing == "down" else np.pi

    @property
    def facing_sign(self) -> float:
        """+1 for a surface that faces down, -1 for one that faces up."""
        return 1.0 if self.facing == "down" else -1.0

    def resting_bobs(
        self, origin: tuple[float, float, float] = (0.0, 0.0, 0.0), seed: Any = 0
    ) -> np.ndarray:
        """(n, 3) places of the resting bobs relative to `origin`, which costs no digits.

        `seed` is for heights that are drawn and have none of their own.
        """
        if self.positions is not None:
            places = self.positions - np.array(origin)
        else:
            column, row = np.meshgrid(np.arange(self.shape[0]), np.arange(self.shape[1]))
            places = np.empty((self.count, 3))
            places[:, 0] = (self.bob[0] - origin[0]) + column.ravel() * self.spacing[0]
            places[:, 1] = self.bob[1] - origin[1]
            places[:, 2] = (self.depth - origin[2]) + row.ravel() * self.spacing[1]
        heights = self.drawn_heights(seed)
        if heights is not None:
            places[:, 1] += heights
        return places

    def drawn_heights(self, seed: Any) -> np.ndarray | None:
        """(n,) heights; those of a roughness are drawn, by `seed` if it has none of its own."""
        if isinstance(self.heights, Roughness):
            return draw(self.heights, *self._grid, np.random.default_rng(seed))
        return self.heights

    @property
    def first_bob(self) -> tuple[float, float, float]:
        """Place of the first resting bob, without its height."""
        if self.positions is not None:
            x, y, z = self.positions[0]
            return float(x), float(y), float(z)
        return self.bob[0], self.bob[1], self.depth


def _is_name(value: Any) -> bool:
    """Whether the value can name a surface in files: printable, without a point or a slash."""
    printable = isinstance(value, str) and value.isprintable() and value.strip() != ""
    return printable and not {".", "/"} & set(value)
