"""What makes a class a potential, and what is made of potentials.

A potential is a NamedTuple of floats with ``energy(self, r)``.  It may say more:

    force(self, r)   -dU/dr; otherwise the derivative is taken from the energy's source where that
                     is a formula, and by a complex step where not: both to round-off
    feature(self)    (length over which the force changes, distance out to which it is felt), by
                     which no step jumps an encounter; otherwise the force is taken to change on
                     the scale of r itself
    clearance(self, r)
                     how far a pair at distance r may move before the force is another; otherwise
                     as feature and range have it
    coupling(self, one, other)
                     what U is multiplied by for bobs of charges one and other, as one * other;
                     otherwise 1
    energy_between(self, r, one, other), force_between(self, r, one, other)
                     U and -dU/dr for bobs of charges one and other, where that is more than
                     coupling times energy and force
    range(self)      distance from which U is zero; otherwise there is none
    smoothness(self) how many derivatives of U are continuous at every r > 0: -1 where U jumps;
                     otherwise all of them are
    smoothness_within(self)
                     the same at every 0 < r < range; otherwise as smoothness
    minimum(self)    (r, U, d2U/dr2) at the minimum, to be checked against U
    domain(self)     (least r, largest r) for which the potential is meant; otherwise any r > 0
    demands(self)    for each parameter that is not any number (its name, whether it will do,
                     what would), as ("sigma", self.sigma > 0.0, "must be positive")
"""

from __future__ import annotations

import math
from typing import Any

from tribo.plugins import classes as plugins
from tribo.potentials.born_mayer import BornMayer
from tribo.potentials.buckingham import Buckingham
from tribo.potentials.coulomb import Coulomb
from tribo.potentials.cutoff import AT_CUTOFF, Switched
from tribo.potentials.derivative import force_from
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.mie import Mie
from tribo.potentials.morse import Morse
from tribo.potentials.plummer import Plummer
from tribo.potentials.spline import Table, from_points
from tribo.potentials.sum import Scaled, Sum
from tribo.potentials.weeks_chandler_andersen import WeeksChandlerAndersen
from tribo.potentials.yukawa import Yukawa
from tribo.validation import InputError, choice, number, shown

SWITCH_FROM = 0.9  # of the cutoff, where it is not said


def _complex_step(self: Any, r: Any) -> Any:
    return -self.energy(r + 1e-100j).imag / 1e-100


def _no_feature(self: Any) -> Any:
    return 0.0, 0.0


def _clearance(self: Any, r: Any) -> Any:
    length, reach = self.feature()
    return max(length, r - min(reach, self.range()))


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


def _smoothness(self: Any) -> Any:
    return self.smoothness()


def _anywhere(self: Any) -> Any:
    return 0.0, math.inf


def _no_demands(self: Any) -> Any:
    return ()


DEFAULTS = {
    "feature": _no_feature,
    "clearance": _clearance,
    "coupling": _no_coupling,
    "energy_between": _energy_between,
    "force_between": _force_between,
    "range": _no_range,
    "smoothness": _smooth,
    "smoothness_within": _smoothness,
    "domain": _anywhere,
    "demands": _no_demands,
}


def complete(cls: Any) -> Any:
    """The class with all that kernels ask of a potential; a complaint if it is none."""
    plugins.check_class(cls, "potential", "energy(self, r)")
    if not hasattr(cls, "force"):
        cls.force = force_from(cls.energy) or _complex_step
    for method, default in DEFAULTS.items():
        if not hasattr(cls, method):
            setattr(cls, method, default)
    return cls


BUILT_IN: dict[str, Any] = {
    "coulomb": complete(Coulomb),
    "morse": complete(Morse),
    "lennard-jones": complete(LennardJones),
    "yukawa": complete(Yukawa),
    "buckingham": complete(Buckingham),
    "born-mayer": complete(BornMayer),
    "weeks-chandler-andersen": complete(WeeksChandlerAndersen),
    "mie": complete(Mie),
    "plummer": complete(Plummer),
}
for _cls in (Sum, Scaled, Table, *AT_CUTOFF.values()):
    complete(_cls)


def as_potential(value: Any) -> Any:
    """An instance whose class is complete, and whose fields are numbers that make sense."""
    complete(type(value))
    if isinstance(value, Table):
        return from_points(value.r, value.values, value.error)
    value = type(value)(
        **{
            name: as_potential(item) if hasattr(item, "_fields") else number(name, item)
            for name, item in value._asdict().items()
        }
    )
    _check(value)
    return value


def _check(potential: Any) -> None:
    """Complain about parameters that make no sense, and about what a class says of itself."""
    demands = plugins.call_method(potential, "potential", "demands")
    try:
        wrong = [(name, problem) for name, will_do, problem in demands if not will_do]
    except (TypeError, ValueError):
        reason = "must give (name, whether it will do, what would) for each"
        raise InputError("potential", plugins.located(potential, "demands", None, reason)) from None
    for name, problem in wrong:
        raise InputError(name, f"{problem}, got {shown(getattr(potential, name))}")
    for method in ("range", "feature", "smoothness", "smoothness_within"):
        plugins.returned_numbers(potential, "potential", method)


def with_cutoff(
    potential: Any, cutoff: float, at_cutoff: str = "switch", switch_from: float | None = None
) -> Any:
    """A potential that ends at `cutoff` [length].

    `at_cutoff` is one of "switch", "force-shift", "shift" and "truncate"; a switch begins at
    `switch_from` [length], or at 0.9 cutoff.  Raises InputError.
    """
    kind = AT_CUTOFF[choice("at_cutoff", at_cutoff, AT_CUTOFF)]
    cutoff = number("cutoff", cutoff)
    if kind is not Switched:
        if switch_from is not None:
            raise InputError("switch_from", f'cannot go with at_cutoff = "{at_cutoff}"')
        return as_potential(kind(potential, cutoff))
    begin = SWITCH_FROM * cutoff if switch_from is None else switch_from
    return as_potential(Switched(potential, cutoff, begin))


def total(*parts: Any) -> Any:
    """The sum of two or more potentials.  Raises InputError."""
    if len(parts) < 2:
        raise InputError("of", f"must be two potentials or more, got {len(parts)}")
    first, *rest = parts
    second = rest[0] if len(rest) == 1 else total(*rest)
    return as_potential(Sum(as_potential(first), as_potential(second)))


def scaled(potential: Any, factor: float) -> Any:
    """A potential times a number, which may be negative.  Raises InputError."""
    return as_potential(Scaled(as_potential(potential), factor))
