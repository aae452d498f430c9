"""Starts of pendulums from the ensembles of statistical mechanics, in the energy of the drive.

Without contact a pendulum keeps e = 1/2 J omega^2 + 1/2 kappa (theta - phi - rest)^2.  J is
m1 l1^2 + m2 l2^2, or m1 length^2 on driven bars: with it, angles and rates move as an
incompressible fluid, which theorems on mean energies need.  In these variables a start of N
pendulums has N energies and N phases.  The phases are uniform; the energies are drawn by the
ensemble, from numbers that are uniform between 0 and 1.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo import validation as check
from tribo.layout.own_numbers import ASPERITE_PART, parameters_of_members
from tribo.model.binding import EVERY, SWING_STATE
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.validation import InputError, short_repr

# Uniform numbers that are drawn at once, at least those of one member.
BLOCK = 16_384


class SwingStates(ABC):
    """A distribution of the energies of pendulums."""

    def uniforms(self, count: int) -> int:
        """The uniform numbers from which the energies of `count` pendulums are drawn."""
        return count

    @abstractmethod
    def energies(self, uniforms: np.ndarray, count: int) -> np.ndarray:
        """Energies (members, count), from numbers (members, uniforms)."""


@dataclass(frozen=True)
class Canonical(SwingStates):
    """Pendulums in thermal equilibrium: swings and rates are independent normal deviates.

    Attributes
    ----------
    temperature : float
        Temperature [energy], with k_B = 1.

    Raises
    ------
    InputError
        If the temperature is negative.
    """

    temperature: float

    def __post_init__(self) -> None:
        check.fields(self, temperature=check.one(check.NOT_NEGATIVE, "energy"))

    def energies(self, uniforms: np.ndarray, count: int) -> np.ndarray:
        """Exponential deviates."""
        return -self.temperature * np.log1p(-uniforms)


@dataclass(frozen=True)
class _TotalEnergy(SwingStates):
    energy: float

    def __post_init__(self) -> None:
        check.fields(self, energy=check.one(check.POSITIVE, "energy"))


class Microcanonical(_TotalEnergy):
    """Pendulums with a given total energy, which is shared uniformly.

    Attributes
    ----------
    energy : float
        Total energy, or that of a single pendulum [energy].

    Raises
    ------
    InputError
        It is not positive.
    """

    def uniforms(self, count: int) -> int:
        """The last energy is what the others leave."""
        return count - 1

    def energies(self, uniforms: np.ndarray, count: int) -> np.ndarray:
        return self.energy * _shares(uniforms)


class EnergyBall(_TotalEnergy):
    """Pendulums whose total energy has an upper limit, uniform in the space of angles and rates.

    For N pendulums, the probability of a total energy of at most e is (e / energy)^N.

    Attributes
    ----------
    energy : float
        Upper limit of the total energy [energy].

    Raises
    ------
    InputError
        It is not positive.
    """

    def energies(self, uniforms: np.ndarray, count: int) -> np.ndarray:
        return self.energy * uniforms[:, :1] ** (1.0 / count) * _shares(uniforms[:, 1:])


def _shares(uniforms: np.ndarray) -> np.ndarray:
    """Uniform shares of 1, (members, n + 1), each cut off what those before it have left."""
    parts = uniforms.shape[1]
    left = (1.0 - uniforms) ** (1.0 / np.arange(parts, 0, -1))
    after = np.cumprod(np.pad(left, ((0, 0), (1, 0)), constant_values=1.0), axis=1)
    return after * np.pad(1.0 - left, ((0, 0), (0, 1)), constant_values=1.0)


@dataclass(frozen=True, eq=False)
class DrawnSwings:
    """Swings and rates of all members that were drawn before, as rows of :class:`JointStart`."""

    rows: np.ndarray


class JointStart:
    """The starts of all pendulums of some surfaces, drawn together, for the key `name`.

    What is drawn does not depend on the numbers of a pendulum: rows (members, 2 pendulums) have
    sqrt(kappa) (theta - phi - rest) and sqrt(J) omega, of which energies are half the squares.
    """

    def __init__(
        self, name: str, states: SwingStates | DrawnSwings, surfaces: list[Surface]
    ) -> None:
        """Find how many numbers a member takes, unless all rows are drawn already."""
        self.name = name
        self.keys = tuple(f"{s.name}.{part}" for s in surfaces for part in ("swing", "omega"))
        stops = np.cumsum([surface.count for surface in surfaces])
        self._surfaces = surfaces
        self._splits = stops[:-1]
        self._count = int(stops[-1])
        if isinstance(states, SwingStates):
            self._states = states
            self.dimensions = states.uniforms(self._count) + self._count  # numbers of a member
            self.block = max(1, BLOCK // self.dimensions)  # members that are drawn at once

    def random(self, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """The name -> random rows of a block of members."""
        return {self.name: self._rows(rng.random((self.block, self.dimensions)))}

    def at_points(self, points: np.ndarray) -> dict[str, DrawnSwings]:
        """The name -> rows from points in the unit cube (members, dimensions)."""
        return {self.name: DrawnSwings(self._rows(points))}

    def _rows(self, points: np.ndarray) -> np.ndarray:
        first = self.dimensions - self._count
        size = np.sqrt(2.0 * self._states.energies(points[:, :first], self._count))
        phases = 2.0 * np.pi * points[:, first:]
        return np.concatenate([size * np.cos(phases), size * np.sin(phases)], axis=1)

    def starts(self, rows: np.ndarray, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Key -> (members, asperites), with the numbers of members in `values`.

        Raises InputError if a pendulum has no energy that it keeps.
        """
        found: dict[str, np.ndarray] = {}
        swings, rates = (np.split(each, self._splits, 1) for each in np.split(rows, 2, axis=1))
        for surface, swing, rate in zip(self._surfaces, swings, rates, strict=True):
            each = _numbers_of(surface, len(rows), values)
            _check_stiffness(self.name, surface.name, each["kappa"])
            phi = surface.initial_of_each["phi"]
            phi = values.get(f"{surface.name}.phi", phi)
            found[f"{surface.name}.swing"] = phi + swing / np.sqrt(each["kappa"])
            found[f"{surface.name}.omega"] = rate / np.sqrt(_swing_inertia(surface, each))
        return found


def _numbers_of(
    surface: Surface, members: int, values: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """The parameters of pendulums, (members, asperites), or (asperites,) where they are alike."""
    if not any(key.startswith(f"{surface.name}.{ASPERITE_PART}.") for key in values):
        return surface.each
    own = parameters_of_members(surface, members, values)
    return {name: each.reshape(members, -1) for name, each in own.items()}


def _swing_inertia(surface: Surface, each: Mapping[str, np.ndarray]) -> np.ndarray:
    """The inertia J in the energy that belongs to the drive, of each asperite."""
    if surface.drive.holds_bars:
        return np.asarray(each["m1"] * each["length"] ** 2)
    return each["inertia"]


def joint_starts(scene: Scene, vary: Mapping[str, Any]) -> dict[str, JointStart]:
    """The starts that are drawn together, by their names.  Raises InputError."""
    found: dict[str, JointStart] = {}
    for name, source in vary.items():
        drawn = isinstance(source, (SwingStates, DrawnSwings))
        if (name.rpartition(".")[2] == SWING_STATE) != drawn:
            raise InputError(
                name,
                f'must be tribo.Canonical, Microcanonical or EnergyBall for "...{SWING_STATE}", '
                f"and for this alone, got {short_repr(source)}",
            )
        if drawn:
            joint = JointStart(name, source, _swinging(scene, name, vary))
            for other in found.values():
                if both := {*joint.keys} & {*other.keys}:
                    raise InputError(name, f"cannot go with {other.name}, which draws {min(both)}")
            found[name] = joint
    return found


def _swinging(scene: Scene, key: str, vary: Mapping[str, Any]) -> list[Surface]:
    """The surfaces that a key names, whose pendulums have an energy that they keep."""
    name = key.rpartition(".")[0]
    surfaces = [each for each in scene.surfaces if name in (each.name, EVERY)]
    if not surfaces:
        raise InputError(key, f"must name a surface of the scene, got {name!r}")
    for surface in surfaces:
        if f"{surface.name}.{ASPERITE_PART}.kappa" not in vary:
            _check_stiffness(key, surface.name, surface.each["kappa"])
        if surface.drive.block:
            raise InputError(key, f"cannot be drawn: the block {surface.name} shares its energy")
        if surface.initial.temperature:
            raise InputError(key, f"cannot go with {surface.name}.initial.temperature")
    return surfaces


def _check_stiffness(key: str, surface: str, kappa: np.ndarray) -> None:
    if not np.all((kappa > 0.0) & np.isfinite(kappa)):
        raise InputError(key, f"needs a finite {surface}.{ASPERITE_PART}.kappa > 0")
