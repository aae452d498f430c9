"""The type of potentials: fields from annotations, and methods that follow from others."""

import inspect
from collections import namedtuple
from collections.abc import Callable, Mapping
from typing import Any, dataclass_transform

from tribo.potentials.derivative import force_from

# What named tuples have beside their fields.
OF_TUPLES = (
    *("__new__", "__repr__", "__getnewargs__", "__match_args__"),
    *("_make", "_replace", "_asdict", "_fields", "_field_defaults"),
)


# The documentation of methods that have none of their own.
DOCUMENTATION = {
    "energy": "Energy U(r) [energy] at distance r [length], for a coupling of 1.",
    "force": "Force -dU/dr [energy / length] for a coupling of 1, positive if it repels.",
    "energy_between": "Energy U(r) [energy] of two charges at distance r [length].",
    "force_between": "Force -dU/dr [energy / length] between two charges, positive if it repels.",
    "minimum": "Position, energy and curvature (r, U, d2U/dr2) of the minimum.",
}


def _complex_step(self, r):
    return -self.energy(r + 1e-100j).imag / 1e-100


def _complex_step_between(self, r, one, other):
    return -self.energy_between(r + 1e-100j, one, other).imag / 1e-100


def energy_of_charges(self, r, one, other):
    return self.coupling(one, other) * self.energy(r)


def _force_of_charges(self, r, one, other):
    return self.coupling(one, other) * self.force(r)


def following(own: Mapping[str, Any]) -> dict[str, Callable[..., Any]]:
    """The methods that follow from those that a class defines, as a force from its energy.

    They replace what the class inherits, which fits other methods.
    """
    found: dict[str, Callable[..., Any]] = {}
    if "energy" in own and "force" not in own:
        found["force"] = force_from(own["energy"]) or _complex_step
    if own.keys() & {"energy", "coupling"} and "energy_between" not in own:
        found["energy_between"] = energy_of_charges
    sources = {"energy", "force", "coupling", "energy_between"}
    if own.keys() & sources and "force_between" not in own:
        between = "energy_between" in own
        found["force_between"] = _complex_step_between if between else _force_of_charges
    return found


@dataclass_transform(frozen_default=True)
class PotentialType(type):
    """The type of potentials: annotated names become fields, and a force follows from an energy.

    Instances are named tuples of their fields, which numba types by their class.
    """

    def __new__(mcs, name: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> Any:
        """A class with its fields, those of its parents first."""
        methods = following(namespace) | namespace
        for each in DOCUMENTATION.keys() & methods.keys():
            if not methods[each].__doc__:
                methods[each].__doc__ = DOCUMENTATION[each]
        cls = super().__new__(mcs, name, bases, {"__slots__": ()} | methods)
        kinds = inspect.get_annotations(cls)
        own = [each for each, kind in kinds.items() if "ClassVar" not in str(kind)]
        if own:
            inherited = getattr(cls, "_fields", ())
            names = (*inherited, *(each for each in own if each not in inherited))
            given = {each: namespace[each] for each in own if each in namespace}
            defaults = getattr(cls, "_field_defaults", {}) | given
            values = [defaults[each] for each in names if each in defaults]
            plain = namedtuple(name, names, defaults=values)  # type: ignore[misc]
            for each in (*names, *(each for each in OF_TUPLES if each not in namespace)):
                setattr(cls, each, vars(plain)[each])
        return cls
