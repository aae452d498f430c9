"""What makes a class a potential, and how one is found by its name.

A potential is a NamedTuple of floats with ``energy(self, r)``.  It may say more:

    force(self, r)   -dU/dr; otherwise the derivative is taken by a complex step, to round-off
    feature(self)    (length over which the force changes, distance out to which it is felt), by
                     which no step jumps an encounter; otherwise the force is taken to change on
                     the scale of r itself
    coupling(self, one, other)
                     what U is multiplied by for bobs of charges one and other, as one * other;
                     otherwise 1
    energy_between(self, r, one, other), force_between(self, r, one, other)
                     U and -dU/dr for bobs of charges one and other, where that is more than
                     coupling times energy and force
    range(self)      distance from which U is zero; otherwise there is none
    smoothness(self) how many derivatives of U are continuous at every r > 0: -1 where U jumps;
                     otherwise all of them are
    minimum(self)    (r, U, d2U/dr2) at the minimum, to be checked against U
    domain(self)     (least r, largest r) for which the potential is meant
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from tribo import plugins
from tribo.checks import POSITIVE, choice, number
from tribo.errors import InputError
from tribo.potentials import from_ase
from tribo.potentials.coulomb import Coulomb
from tribo.potentials.cutoff import AT_CUTOFF, Switched
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.morse import Morse

BUILT_IN: dict[str, Any] = {"coulomb": Coulomb, "morse": Morse, "lennard-jones": LennardJones}
SWITCH_FROM = 0.9  # of the cutoff, where a file does not say


def _complex_step(self: Any, r: Any) -> Any:
    return -self.energy(r + 1e-100j).imag / 1e-100


def _no_feature(self: Any) -> Any:
    return 0.0, 0.0


def _no_coupling(self: Any, one: Any, other: Any) -> Any:
    return 1.0


def _no_range(self: Any) -> Any:
    return math.inf


def _energy_between(self: Any, r: Any, one: Any, other: Any) -> Any:
    return self.coupling(one, other) * self.energy(r)


def _force_between(self: Any, r: Any, one: Any, other: Any) -> Any:
    return self.coupling(one, other) * self.force(r)


def _smooth(self: Any) -> Any:
    return math.inf


DEFAULTS = {
    "force": _complex_step,
    "feature": _no_feature,
    "coupling": _no_coupling,
    "energy_between": _energy_between,
    "force_between": _force_between,
    "range": _no_range,
    "smoothness": _smooth,
}


def complete(cls: Any) -> Any:
    """The class with all that kernels ask of a potential; a complaint if it is none."""
    plugins.check_class(cls, "potential", "energy(self, r)")
    for method, default in DEFAULTS.items():
        if not hasattr(cls, method):
            setattr(cls, method, default)
    return cls


def as_potential(value: Any) -> Any:
    """An instance whose class is complete and whose fields are finite numbers."""
    complete(type(value))
    if type(value) in AT_CUTOFF.values():
        inner = as_potential(value.potential)
        rest = {
            name: number(name, item, POSITIVE)
            for name, item in zip(value._fields[1:], value[1:], strict=True)
        }
        if isinstance(value, Switched) and rest["switch_from"] >= rest["cutoff"]:
            raise InputError(
                "switch_from", f"must be below the cutoff {value.cutoff}, got {value.switch_from}"
            )
        return type(value)(inner, **rest)
    return plugins.with_numbers(value)


def with_cutoff(
    potential: Any, cutoff: float, at_cutoff: str = "switch", switch_from: float | None = None
) -> Any:
    """A potential that ends at `cutoff`, in one of the ways of AT_CUTOFF."""
    kind = AT_CUTOFF[choice("at_cutoff", at_cutoff, AT_CUTOFF)]
    cutoff = number("cutoff", cutoff, POSITIVE)
    if kind is not Switched:
        if switch_from is not None:
            raise InputError("switch_from", f'cannot go with at_cutoff = "{at_cutoff}"')
        return as_potential(kind(potential, cutoff))
    begin = SWITCH_FROM * cutoff if switch_from is None else switch_from
    return as_potential(Switched(potential, cutoff, begin))


def from_table(table: dict[str, Any], folder: Path) -> Any:
    """The potential that a table of a scene file describes, with its parameters and cutoff."""
    parameters = dict(table)
    if "potential" not in parameters:
        raise InputError("potential", "is missing")
    name = parameters.pop("potential")
    if name == "ase":
        return from_ase.from_table(parameters)
    ending = {
        key: parameters.pop(key)
        for key in ("cutoff", "at_cutoff", "switch_from")
        if key in parameters
    }
    potential = as_potential(plugins.instance(class_named(name, folder), parameters))
    if not ending:
        return potential
    if "cutoff" not in ending:
        raise InputError(next(iter(ending)), "needs a cutoff")
    return with_cutoff(potential, **ending)


def class_named(name: Any, folder: Path) -> Any:
    """The class of a built-in name, or of ``file.py:Class`` with the path relative to `folder`."""
    if not isinstance(name, str):
        raise InputError("potential", f"must be a name, got {name!r}")
    if ".py:" in name:
        return complete(plugins.class_in_file("potential", name, folder))
    if name not in BUILT_IN:
        known = ", ".join(f'"{k}"' for k in BUILT_IN)
        raise InputError("potential", f'must be {known} or "yourfile.py:YourClass", got {name!r}')
    return complete(BUILT_IN[name])


def as_table(potential: Any) -> dict[str, Any]:
    """The table of a scene file that `from_table` reads."""
    if isinstance(potential, from_ase.Live):
        return {"potential": "ase"} | from_ase.as_table(potential)
    table: dict[str, Any] = potential._asdict()
    for word, kind in AT_CUTOFF.items():
        if type(potential) is kind:
            return as_table(table.pop("potential")) | table | {"at_cutoff": word}
    return {"potential": plugins.name_of(potential, BUILT_IN)} | table
