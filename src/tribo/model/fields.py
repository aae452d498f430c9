"""External fields on bobs: fixed in the laboratory, or moving through it at a constant velocity.

A field is a NamedTuple of numbers with ``energy_at(self, x, y)``, and, if wanted,
``force_at(self, x, y) -> (fx, fy)``, the negative gradient; otherwise that is taken by a complex
step, to round-off.  x and y are a bob's place in the field's own frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tribo.plugins import classes as plugins
from tribo.validation import InputError, choice, vector


class Corrugation(NamedTuple):
    """U = -amplitude cos(2 pi x / period): the substrate of Prandtl-Tomlinson work."""

    amplitude: float  # [energy]
    period: float  # [length]

    def energy_at(self, x, y):  # type: ignore[no-untyped-def]
        """U(x)."""
        return -self.amplitude * np.cos(2.0 * np.pi * x / self.period)

    def force_at(self, x, y):  # type: ignore[no-untyped-def]
        """-grad U."""
        q = 2.0 * np.pi / self.period
        return -self.amplitude * q * np.sin(q * x), 0.0


def _complex_step(self, x, y):  # type: ignore[no-untyped-def]
    fx = -self.energy_at(x + 1e-100j, y + 0j).imag / 1e-100
    fy = -self.energy_at(x + 0j, y + 1e-100j).imag / 1e-100
    return fx, fy


BUILT_IN: dict[str, Any] = {"corrugation": Corrugation}


@dataclass(frozen=True)
class Field:
    """A field, and the surfaces on whose bobs it acts."""

    potential: Any
    on: tuple[str, ...]
    origin: tuple[float, float] = (0.0, 0.0)  # where the field's own (0, 0) is at t = 0
    velocity: tuple[float, float] = (0.0, 0.0)  # of the field, in the laboratory

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "potential", as_field_potential(self.potential))
        if isinstance(self.on, str) or not isinstance(self.on, (list, tuple)) or not self.on:
            raise InputError("on", f"must be a list of surfaces' names, got {self.on!r}")
        put(self, "on", tuple(self.on))
        put(self, "origin", tuple(vector("origin", self.origin, size=2).tolist()))
        put(self, "velocity", tuple(vector("velocity", self.velocity, size=2).tolist()))


def as_field_potential(value: Any) -> Any:
    """An instance with energy_at and force_at whose fields are finite numbers."""
    plugins.check_class(type(value), "kind", "energy_at(self, x, y)")
    if not hasattr(type(value), "force_at"):
        type(value).force_at = _complex_step
    value = plugins.with_numbers(value)
    if isinstance(value, Corrugation) and value.period <= 0.0:
        raise InputError("period", f"must be positive, got {value.period}")
    return value


def from_table(table: Any, folder: Path) -> Field:
    """The field that a table of a scene file describes."""
    if not isinstance(table, dict):
        raise InputError("", f"must be a table, got {table!r}")
    parameters = dict(table)
    for key in ("kind", "on"):
        if key not in parameters:
            raise InputError(key, "is missing")
    place = {k: parameters.pop(k) for k in ("on", "origin", "velocity") if k in parameters}
    kind = parameters.pop("kind")
    if plugins.is_named(kind):
        cls = plugins.class_named("kind", kind, folder)
        plugins.check_class(cls, "kind", "energy_at(self, x, y)")
    else:
        cls = BUILT_IN[choice("kind", kind, BUILT_IN)]
    return Field(plugins.instance(cls, parameters), **place)


def as_table(field: Field) -> dict[str, Any]:
    """The table of a scene file that `from_table` reads."""
    place = {"on": list(field.on), "origin": list(field.origin), "velocity": list(field.velocity)}
    kind = plugins.name_of(field.potential, BUILT_IN)
    return {"kind": kind} | field.potential._asdict() | place
