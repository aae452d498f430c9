"""A scene: the physics of a run, and nothing numerical."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np

from tribo.model.drives import Custom, Ends, Forced, Pulled
from tribo.model.fields import Field
from tribo.model.settings import Numerics, Output
from tribo.model.surface import Surface
from tribo.potentials.from_ase import Live
from tribo.potentials.registry import as_potential
from tribo.validation import (
    POSITIVE,
    InputError,
    inside,
    is_list,
    known_keys,
    number,
    shown,
    whole,
)


class Effect(StrEnum):
    """Something that a scene can call for; `description` says what it is."""

    description: str

    CONTACT = "contact", "forces between the bobs of different surfaces"
    SWING = "swing", "pendulums on torsion springs"
    SLIDING = "sliding", "centres of mass that can leave their uniform motion"
    TURNING_BARS = "turning bars", "bars that are free to turn"
    CLAMPED_ENDS = (
        "clamped ends",
        "forces on the ends of clamped bars that have a torsion spring to hold",
    )
    PULL = "pull", "springs to a moving stage"
    LOAD = "load", "a force that presses the surfaces together"
    OWN_DRIVE = "own drive", "forces f2 of the user's own"
    OWN_ENDS = "own ends", "forces of the user's own on the ends of bars"
    SPRINGS = "springs", "lattice springs between neighbouring bars"
    BATH = "bath", "oscillators on every bar"
    TORSIONAL_BATH = "torsional bath", "torsional oscillators on every bar"
    LANGEVIN = "langevin", "damping and noise at every bar"
    FIELD = "field", "external fields on bobs"
    CALCULATOR = "calculator", "contact computed by an ASE calculator, at its own cost"
    CONTACT_WITHIN = "contact within", "forces among the bobs of one surface"
    CUTOFF = (
        "cutoff",
        "interactions that end at a distance, by neighbour lists where there are many bobs",
    )
    PERIODIC = "periodic", "nearest images along x or z"

    def __new__(cls, name: str, description: str) -> Effect:
        """A string with a description."""
        effect = str.__new__(cls, name)
        effect._value_ = name
        effect.description = description
        return effect


@dataclass(frozen=True)
class Periodic:
    """Lengths of a periodic scene; None where it is not."""

    x: float | None = None
    z: float | None = None

    def __post_init__(self) -> None:
        for name in ("x", "z"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, number(name, getattr(self, name), POSITIVE))

    def __bool__(self) -> bool:
        return self.x is not None or self.z is not None


def as_periodic(value: Any) -> Periodic:
    """A period from its table in a scene file, or itself."""
    if isinstance(value, Periodic):
        return value
    with inside("periodic"):
        return Periodic(**known_keys(value, ["x", "z"]))


@dataclass(frozen=True)
class Interaction:
    """A potential, and the two surfaces whose bobs it acts between (None: every two).

    `between` one surface and itself is contact among its own bobs, which is internal to it.
    With `species` it acts only between a bob of the one species and a bob of the other.
    """

    potential: Any
    between: tuple[str, str] | None = None
    species: tuple[str, str] | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        if isinstance(self.potential, Live):
            self._check_live()
        else:
            put(self, "potential", as_potential(self.potential))
        for key, what in (("between", "surfaces"), ("species", "species")):
            names = getattr(self, key)
            if names is None:
                continue
            if not is_list(names) or len(names) != 2 or not all(isinstance(n, str) for n in names):
                raise InputError(key, f"must be the names of two {what}, got {shown(names)}")
            put(self, key, tuple(names))

    def _check_live(self) -> None:
        if self.species is not None:
            raise InputError("species", "cannot go with a calculator; it knows the elements itself")
        if self.between is not None and self.between[0] == self.between[1]:
            raise InputError("between", "must name two surfaces; a calculator acts between them")


@dataclass(frozen=True, eq=False)
class Scene:
    """Surfaces, what acts between them, and for how long.

    `output` and `numerics` travel with the file that a scene came from, not with the physics.
    """

    surfaces: tuple[Surface, ...]
    interactions: tuple[Interaction, ...]
    duration: float
    title: str = ""
    seed: int = 0
    periodic: Periodic = field(default_factory=Periodic)
    fields: tuple[Field, ...] = ()
    output: Output = field(default_factory=Output)
    numerics: Numerics = field(default_factory=Numerics)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "duration", number("duration", self.duration, POSITIVE))
        put(self, "seed", whole("seed", self.seed, 0))
        if not isinstance(self.title, str):
            raise InputError("title", f"must be text, got {shown(self.title)}")
        for name, kind in (("output", Output), ("numerics", Numerics)):
            value = getattr(self, name)
            if not isinstance(value, kind):
                raise InputError(name, f"must be a tribo.{kind.__name__}, got {shown(value)}")
        put(self, "surfaces", self._checked_surfaces())
        put(self, "interactions", self._checked_interactions())
        put(self, "fields", self._checked_fields())
        put(self, "periodic", as_periodic(self.periodic))
        self._check_period()
        times = self.output.times
        if times is not None and times[-1] > self.duration:
            raise InputError(
                "output.times", f"must end by the duration {self.duration}, got {times[-1]}"
            )

    def _checked_surfaces(self) -> tuple[Surface, ...]:
        if not isinstance(self.surfaces, (list, tuple)) or not self.surfaces:
            raise InputError("surface", "is missing; a scene has at least one surface")
        for i, surface in enumerate(self.surfaces):
            if not isinstance(surface, Surface):
                raise InputError(f"surface[{i}]", f"must be a tribo.Surface, got {shown(surface)}")
            if surface.name in [s.name for s in self.surfaces[:i]]:
                raise InputError(f"surface[{i}].name", f'"{surface.name}" is taken; give another')
        return tuple(self.surfaces)

    def _checked_interactions(self) -> tuple[Interaction, ...]:
        value: Any = self.interactions
        if isinstance(value, (Interaction, Live)) or hasattr(value, "energy"):
            value = [value]
        if not isinstance(value, (list, tuple)):
            raise InputError(
                "interaction", f"must be a potential or a list of them, got {shown(value)}"
            )
        interactions = tuple(
            item if isinstance(item, Interaction) else Interaction(item) for item in value
        )
        names = [s.name for s in self.surfaces]
        for i, interaction in enumerate(interactions):
            with inside(f"interaction[{i}]"):
                for name in interaction.between or ():
                    if name not in names:
                        raise InputError(
                            "between", f"names no surface {shown(name)}; there are {names}"
                        )
                for name in interaction.species or ():
                    if name not in self.species:
                        raise InputError(
                            "species", f"names no species {shown(name)}; there are {self.species}"
                        )
        self._refuse_two_for_one_pair(interactions)
        return interactions

    def _checked_fields(self) -> tuple[Field, ...]:
        value = [self.fields] if isinstance(self.fields, Field) else self.fields
        if not isinstance(value, (list, tuple)):
            raise InputError("field", f"must be a list of fields, got {shown(value)}")
        names = [s.name for s in self.surfaces]
        for i, item in enumerate(value):
            if not isinstance(item, Field):
                raise InputError(f"field[{i}]", f"must be a tribo.Field, got {shown(item)}")
            for name in item.on:
                if name not in names:
                    raise InputError(
                        f"field[{i}].on", f"names no surface {shown(name)}; there are {names}"
                    )
        return tuple(value)

    def _check_period(self) -> None:
        """Nearest images are right only up to half the box."""
        for name in ("x", "z"):
            length = getattr(self.periodic, name)
            for i, interaction in enumerate(self.interactions):
                reach = interaction.potential.range()
                if length is not None and reach > 0.5 * length:
                    raise InputError(
                        f"interaction[{i}].cutoff",
                        f"must be at most half of periodic.{name} = {length:g}, got {reach:g}",
                    )

    def _refuse_two_for_one_pair(self, interactions: tuple[Interaction, ...]) -> None:
        seen: dict[tuple[int, int], list[set[str] | None]] = {}
        for i, interaction in enumerate(interactions):
            kinds = set(interaction.species) if interaction.species else None
            for pair in self.pairs(interaction):
                before = seen.setdefault(pair, [])
                if before and (kinds is None or None in before or kinds in before):
                    names = tuple(self.surfaces[k].name for k in pair)
                    raise InputError(
                        f"interaction[{i}].between",
                        f"{names} interact already; give each pair once",
                    )
                before.append(kinds)

    def pairs(self, interaction: Interaction) -> list[tuple[int, int]]:
        """Indices of the pairs of surfaces between which an interaction acts."""
        if interaction.between is None:
            return list(itertools.combinations(range(len(self.surfaces)), 2))
        names = [s.name for s in self.surfaces]
        one, other = sorted(names.index(name) for name in interaction.between)
        return [(one, other)]

    def initial_value(self, key: Any) -> tuple[Surface, str]:
        """The surface and the quantity that "surface.theta" names.  Raises InputError."""
        name, _, quantity = str(key).rpartition(".")
        surface = next((s for s in self.surfaces if s.name == name), None)
        if surface is None or quantity not in ("theta", "phi", "omega", "nu"):
            raise InputError(str(key), 'must be "surface.theta", or phi, omega or nu of a surface')
        if quantity in ("phi", "nu") and surface.bars == "clamped":
            raise InputError(str(key), "cannot be changed on clamped bars of a prepared scene")
        return surface, quantity

    def with_heights(self) -> Scene:
        """The same scene with the heights that its seed draws as numbers: no seed changes them."""
        surfaces = [
            replace(surface, heights=surface.drawn_heights([self.seed, index, 0]))
            for index, surface in enumerate(self.surfaces)
        ]
        return replace(self, surfaces=tuple(surfaces))

    @property
    def species(self) -> list[str]:
        """The species of the bobs, in alphabetical order."""
        return sorted({name for s in self.surfaces for name in s.species_of_each.tolist()})

    def meets_itself(self, surface: Surface) -> bool:
        """Whether the surface's own bobs interact."""
        return any(i.between == (surface.name, surface.name) for i in self.interactions)

    @property
    def count(self) -> int:
        """How many asperites there are."""
        return sum(surface.count for surface in self.surfaces)

    @property
    def smoothness(self) -> float:
        """Continuous derivatives that all potentials' energies have; 0 where one jumps."""
        own = (interaction.potential.smoothness() for interaction in self.interactions)
        return max(0, min(own, default=math.inf))

    @property
    def effects(self) -> frozenset[Effect]:
        """The effects that the scene calls for; no other is simulated."""
        present = {Effect.SWING}
        pairs = [pair for i in self.interactions for pair in self.pairs(i)]
        if any(one != other for one, other in pairs):
            present.add(Effect.CONTACT)
        if any(one == other for one, other in pairs):
            present.add(Effect.CONTACT_WITHIN)
        if any(isinstance(i.potential, Live) for i in self.interactions):
            present.add(Effect.CALCULATOR)
        for s in self.surfaces:
            if self.slides_along_x(s) or self.slides_along_y(s):
                present.add(Effect.SLIDING)
            if isinstance(s.drive, Pulled):
                present.add(Effect.PULL)
            if s.drive.load is not None:
                present.add(Effect.LOAD)
            if isinstance(s.drive, Custom):
                present.add(Effect.OWN_DRIVE)
            if isinstance(s.bars, Ends):
                present.add(Effect.OWN_ENDS)
            if s.springs:
                present.add(Effect.SPRINGS)
            if s.bath.masses.size:
                present.add(Effect.BATH)
            if s.bath.inertias.size:
                present.add(Effect.TORSIONAL_BATH)
            if s.langevin:
                present.add(Effect.LANGEVIN)
            if s.bars != "clamped":
                present.add(Effect.TURNING_BARS)
            elif np.any(np.asarray(s.asperite.kappa) > 0.0):
                present.add(Effect.CLAMPED_ENDS)
        if self.fields:
            present.add(Effect.FIELD)
        if self.periodic:
            present.add(Effect.PERIODIC)
        if any(np.isfinite(i.potential.range()) for i in self.interactions):
            present.add(Effect.CUTOFF)
        return frozenset(present)

    def shaken(self, surface: Surface) -> bool:
        """Whether forces that no drive cancels act on the surface's asperites."""
        fields = any(surface.name in item.on for item in self.fields)
        lattice = bool(surface.springs) or surface.bath.masses.size > 0
        lattice = lattice or self.meets_itself(surface)
        return fields or lattice or bool(surface.langevin) or isinstance(surface.bars, Ends)

    def slides_along_x(self, surface: Surface) -> bool:
        """Whether the surface's centres of mass can leave their uniform motion along x."""
        return not isinstance(surface.drive, Forced) or self.shaken(surface)

    def slides_along_y(self, surface: Surface) -> bool:
        """Whether the surface's centres of mass can leave their uniform motion along y."""
        pressed = surface.drive.load is not None or isinstance(surface.drive, Custom)
        return pressed or self.shaken(surface)

    @property
    def times(self) -> np.ndarray:
        """The times to be recorded; the start and the end are always among them."""
        if self.output.times is None:
            return np.linspace(0.0, self.duration, self.output.samples)
        return np.union1d(np.array(self.output.times), [0.0, self.duration])

    def save(self, path: Any) -> None:
        """Write the scene file that :func:`tribo.load_scene` reads."""
        from tribo.model.scene_writer import save_scene

        save_scene(self, path)
