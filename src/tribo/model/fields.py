"""External fields on bobs: fixed in the laboratory, or moving through it at a constant velocity.

A field is a NamedTuple of numbers with ``energy_at(self, x, y)`` and, optionally,
``force_at(self, x, y) -> (fx, fy)``, the negative gradient; without it, or where a subclass defines
another energy, a complex step computes the gradient to round-off.  x and y are the position of a
bob in the field's own frame.

A field that depends on time has ``energy_at_time(self, t, x, y)`` instead and, optionally,
``force_at_time(self, t, x, y)`` and ``power_at_time(self, t, x, y)``, the derivative of the energy
by t, which is the field's own time: zero where it begins to act.  A class may also have
``period_along_x(self)`` [length], of a field that repeats along x, and
``largest_curvature(self)`` [energy / length^2].
"""

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tribo import validation as check
from tribo.model.schedule import Schedule, as_schedule
from tribo.plugins import classes as plugins
from tribo.plugins.complex_steps import unlike_slope
from tribo.plugins.sources import is_own
from tribo.plugins.unloaded import Unloaded
from tribo.validation import InputError, is_list, must_be

# Signature of the method that a plug-in needs, as messages quote it.
ENERGY_AT = "energy_at(self, x, y)"
ENERGY_AT_TIME = "energy_at_time(self, t, x, y)"


class Corrugation(NamedTuple):
    """U = -amplitude cos(2 pi x / period): the substrate of the Prandtl-Tomlinson model.

    L. Prandtl, Z. Angew. Math. Mech. 8 (1928) 85; G. A. Tomlinson, Phil. Mag. 7 (1929) 905.

    Attributes
    ----------
    amplitude : float
        Half the height of the barriers [energy].
    period : float
        Distance between minima [length].
    """

    amplitude: float
    period: float

    def energy_at(self, x, y):  # type: ignore[no-untyped-def]
        """U(x) [energy]."""
        return -self.amplitude * np.cos(2.0 * np.pi * x / self.period)

    def force_at(self, x, y):  # type: ignore[no-untyped-def]
        """-grad U [force]."""
        q = 2.0 * np.pi / self.period
        return -self.amplitude * q * np.sin(q * x), 0.0

    def period_along_x(self) -> float:
        """Distance along x after which the field repeats [length]."""
        return self.period

    def largest_curvature(self) -> float:
        """The largest second derivative of U [energy / length^2]."""
        return abs(self.amplitude) * (2.0 * np.pi / self.period) ** 2


def period_of(potential: Any) -> float | None:
    """The period of a field along x, if its class has ``period_along_x(self)``."""
    return potential.period_along_x() if _is_of_its_energy(potential, "period_along_x") else None


def curvature_of(potential: Any) -> float:
    """The largest curvature, if the field's class has ``largest_curvature(self)``; else 0."""
    declared = _is_of_its_energy(potential, "largest_curvature")
    return potential.largest_curvature() if declared else 0.0


def _is_of_its_energy(potential: Any, name: str) -> bool:
    """Whether a field has a method, and not from a parent of the class that defines its energy."""
    for cls in type(potential).__mro__:
        if "made_by" in vars(cls):  # a class of ours, with all that its parent has
            continue
        if name in vars(cls):
            return True
        if "energy_at" in vars(cls):
            return False
    return False


def _complex_step(self, x, y):  # type: ignore[no-untyped-def]
    fx = -self.energy_at(x + 1e-100j, y + 0j).imag / 1e-100
    fy = -self.energy_at(x + 0j, y + 1e-100j).imag / 1e-100
    return fx, fy


def _complex_step_at_time(self, t, x, y):  # type: ignore[no-untyped-def]
    fx = -self.energy_at_time(t + 0j, x + 1e-100j, y + 0j).imag / 1e-100
    fy = -self.energy_at_time(t + 0j, x + 0j, y + 1e-100j).imag / 1e-100
    return fx, fy


def _complex_step_in_time(self, t, x, y):  # type: ignore[no-untyped-def]
    return self.energy_at_time(t + 1e-100j, x + 0j, y + 0j).imag / 1e-100


# The derivatives that follow from the energies of a class, unless it defines them.
FOLLOWING: dict[str, dict[str, Callable[..., Any]]] = {
    "energy_at": {"force_at": _complex_step},
    "energy_at_time": {
        "force_at_time": _complex_step_at_time,
        "power_at_time": _complex_step_in_time,
    },
}


COMPLEX_STEPS = (_complex_step, _complex_step_at_time, _complex_step_in_time)
# Where these are compared with differences: times, and places on either side [time, length].
STEPPED_AT = tuple(
    (0.0137 * 2.618**k, 0.0171 * (-1.618) ** k, 0.0213 * (-1.618) ** (k // 2)) for k in range(20)
)


def _following(own: Mapping[str, Any]) -> dict[str, Any]:
    """The derivatives that a class with some methods of its own lacks, by name."""
    found: dict[str, Any] = {}
    for energy, derived in FOLLOWING.items():
        if energy in own:
            found |= {name: step for name, step in derived.items() if name not in own}
    return found


def depends_on_time(potential: Any) -> bool:
    """Whether a field has an energy that depends on its own time."""
    return hasattr(potential, "energy_at_time")


def _energy_of(cls: Any) -> str:
    """The method that a class of fields needs.  Raises InputError if it has two energies."""
    if not hasattr(cls, "energy_at_time"):
        return ENERGY_AT
    if hasattr(cls, "energy_at"):
        problem = f"{cls.__name__} must have one of {ENERGY_AT} and {ENERGY_AT_TIME}, not both"
        raise InputError("kind", problem)
    return ENERGY_AT_TIME


@functools.cache
def complete(cls: Any) -> Any:
    """The class, or one with a force that fits its energy, derived from it if it is a user's."""
    if is_own(cls):
        return cls
    return plugins.completed(cls, (), _following, complete, as_field_potential)


# Keys of a field beside those of its potential.
SETTINGS = ("on", "origin", "velocity", "modulation")

BUILT_IN: dict[str, Any] = {"corrugation": Corrugation}


@dataclass(frozen=True)
class Field:
    """An external field, and the surfaces on whose bobs it acts.

    Attributes
    ----------
    potential : Corrugation or NamedTuple
        The field's potential: built in, or a user's own with ``energy_at(self, x, y)``, or
        ``energy_at_time(self, t, x, y)`` of one that depends on time.
    on : list of str
        Names of the surfaces, each once.
    origin : (float, float)
        Position of the field's own (0, 0) at t = 0 [length].
    velocity : (float, float)
        Velocity of the field in the laboratory [length / time].
    modulation : Schedule, optional
        Factor on the potential, which changes with time without steps [1].

    Raises
    ------
    InputError
        If the potential cannot be used, a surface is named twice, or a value is out of range.
    """

    potential: Any
    on: Sequence[str]
    origin: tuple[float, float] = (0.0, 0.0)
    velocity: tuple[float, float] = (0.0, 0.0)
    modulation: Schedule | None = None

    @property
    def changes(self) -> bool:
        """Whether its potential changes with time, in its own frame."""
        return self.modulation is not None or depends_on_time(self.potential)

    def __post_init__(self) -> None:
        """Check what acts on which surfaces, and how its strength changes.  Raises InputError."""
        object.__setattr__(self, "potential", as_field_potential(self.potential))
        if not is_list(self.on) or len(self.on) == 0:
            raise must_be("on", "a list of names of surfaces", self.on)
        if any(name in self.on[:i] for i, name in enumerate(self.on)):
            raise must_be("on", "each surface once; a field acts once on each", self.on)
        object.__setattr__(self, "on", tuple(self.on))
        velocity = check.pair(unit="length / time")
        check.fields(self, origin=check.pair(unit="length"), velocity=velocity)
        if self.modulation is not None:
            with check.inside("modulation"):
                modulation = as_schedule(self.modulation)
                if modulation.jumps:
                    raise InputError("", "must have no steps; a field that jumps has no power")
            object.__setattr__(self, "modulation", modulation)


def as_field_potential(value: Any) -> Any:
    """A potential that has energy_at and force_at and whose fields are finite numbers."""
    plugins.check_class(type(value), "kind", _energy_of(type(value)))
    if isinstance(value, Unloaded):
        return value
    value = plugins.as_built_in(value)
    if not hasattr(value, "made_by"):
        cls: Any = type(value)
        value = complete(cls)(*value)
    value = plugins.with_numbers(value)
    if isinstance(value, Corrugation) and value.period <= 0.0:
        raise must_be("period", "positive [length]", value.period)
    _check_complex_steps(value)
    return value


def _check_complex_steps(field: Any) -> None:
    """Refuse an energy whose complex steps are not its slopes, as those of ``abs(x)`` are not."""
    cls: Any = type(field)
    for name, derivative_at in DERIVATIVES.items():
        if getattr(cls, name, None) not in COMPLEX_STEPS:
            continue
        for place in STEPPED_AT:
            if unlike := unlike_slope(*derivative_at(field, *place)):
                problem = (
                    f"{cls.__name__} has no {name}, and complex numbers do not give the slope of "
                    f"its energy: it is {unlike}; define {name}"
                )
                raise InputError("kind", problem)


def _by_place(field: Any, t: float, x: float, y: float) -> tuple[Any, ...]:
    return field.energy_at, lambda x, y: _negative(field.force_at(x, y)), x, y


def _by_place_at_time(field: Any, t: float, x: float, y: float) -> tuple[Any, ...]:
    def energy(x: float, y: float) -> Any:
        return field.energy_at_time(t, x, y)

    return energy, lambda x, y: _negative(field.force_at_time(t, x, y)), x, y


def _by_time(field: Any, t: float, x: float, y: float) -> tuple[Any, ...]:
    def energy(t: float) -> Any:
        return field.energy_at_time(t, x, y)

    return energy, lambda t: [field.power_at_time(t, x, y)], t


def _negative(force: tuple[float, float]) -> tuple[float, float]:
    return -force[0], -force[1]


# The energy, its slopes by the methods that may be complex steps, and the numbers at a place.
DERIVATIVES = {
    "force_at": _by_place,
    "force_at_time": _by_place_at_time,
    "power_at_time": _by_time,
}


def from_table(table: Any, folder: Path) -> Field:
    parameters = check.known_keys(table, table, ["kind", "on"])
    settings = {k: parameters.pop(k) for k in SETTINGS if k in parameters}
    kind = parameters.pop("kind")
    if plugins.is_named(kind):
        return Field(plugins.from_file("kind", kind, parameters, folder, _energy_of), **settings)
    cls = BUILT_IN[check.choice("kind", kind, BUILT_IN)]
    return Field(plugins.instance(cls, parameters), **settings)


def as_table(field: Field) -> dict[str, Any]:
    settings = {name: list(getattr(field, name)) for name in ("on", "origin", "velocity")}
    if field.modulation is not None:
        settings["modulation"] = field.modulation.as_table()  # type: ignore[assignment]
    kind = plugins.name_of(field.potential, BUILT_IN)
    return {"kind": kind} | field.potential._asdict() | settings
