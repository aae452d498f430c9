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
from tribo.model.drives import DrivenBars
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.validation import InputError, short_repr

SWING_STATE = "swing_state"
EVERY = "*"
# Keys of a surface that cannot differ between members whose starts are drawn in these energies.
FIXED = (
    *("swing", "theta", "phi", "omega", "temperature"),
    *("asperite.kappa", "asperite.m1", "asperite.m2", "asperite.length"),
)
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


class JointStart:
    """The starts of all pendulums of some surfaces, drawn together, for the key `name`."""

    def __init__(self, name: str, states: SwingStates, surfaces: list[Surface]) -> None:
        self.name = name
        self._states = states
        self._stops = np.cumsum([surface.count for surface in surfaces])
        self._stiffness = np.concatenate([surface.each["kappa"] for surface in surfaces])
        self._inertia = np.concatenate([_swing_inertia(surface) for surface in surfaces])
        self._phi = np.concatenate([s.initial.for_each(s.count)["phi"] for s in surfaces])
        self.keys = tuple(f"{s.name}.{part}" for s in surfaces for part in ("swing", "omega"))
        self.dimensions = states.uniforms(self._phi.size) + self._phi.size  # numbers of a member
        self.block = max(1, BLOCK // self.dimensions)  # members that are drawn at once

    def random(self, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """Key -> (block, asperites), random."""
        return self.at_points(rng.random((self.block, self.dimensions)))

    def at_points(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Key -> (members, asperites), from points in the unit cube (members, dimensions)."""
        count = self._phi.size
        first = self.dimensions - count
        energies = self._states.energies(points[:, :first], count)
        phases = 2.0 * np.pi * points[:, first:]
        swing = self._phi + np.sqrt(2.0 * energies / self._stiffness) * np.cos(phases)
        omega = np.sqrt(2.0 * energies / self._inertia) * np.sin(phases)
        columns = [np.split(each, self._stops[:-1], axis=1) for each in (swing, omega)]
        both = (each for pair in zip(*columns, strict=True) for each in pair)
        return dict(zip(self.keys, both, strict=True))


def _swing_inertia(surface: Surface) -> np.ndarray:
    """The inertia J in the energy that belongs to the drive, of each asperite."""
    each = surface.each
    if isinstance(surface.drive, DrivenBars):
        return np.asarray(each["m1"] * each["length"] ** 2)
    return each["inertia"]


def joint_starts(scene: Scene, vary: Mapping[str, Any]) -> dict[str, JointStart]:
    """The starts that are drawn together, by their names.  Raises InputError."""
    found: dict[str, JointStart] = {}
    for name, source in vary.items():
        if (name.rpartition(".")[2] == SWING_STATE) != isinstance(source, SwingStates):
            raise InputError(
                name,
                f'must be tribo.Canonical, Microcanonical or EnergyBall for "...{SWING_STATE}", '
                f"and for this alone, got {short_repr(source)}",
            )
        if isinstance(source, SwingStates):
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
        kappa = surface.each["kappa"]
        if not np.all((kappa > 0.0) & np.isfinite(kappa)):
            raise InputError(key, f"needs a finite {surface.name}.asperite.kappa > 0")
        if surface.initial.temperature:
            raise InputError(key, f"cannot go with {surface.name}.initial.temperature")
        for own in FIXED:
            if f"{surface.name}.{own}" in vary:
                raise InputError(key, f"cannot go with {surface.name}.{own} in vary")
    return surfaces
