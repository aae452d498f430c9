"""The protocol of a potential, the built-in potentials by name, and combined potentials.

A potential is a NamedTuple of floats with ``energy(self, r)``, or derives from one.  A subclass
that defines ``energy`` inherits no force, and no energy between charges.  It inherits what
describes U, as feature and smoothness, which assumes no more than the defaults do; but it must
define a range where its parent has one.  A potential may define further methods:

    force(self, r)   -dU/dr; without it, the derivative of the energy's source where that is a
                     formula, else by a complex step: both to round-off
    feature(self)    (length over which the force changes, distance beyond which it is weak), from
                     which steps are limited so that none jumps over an encounter; without it, the
                     length is r itself
    clearance(self, r)
                     distance that a pair at r may move before the force changes considerably;
                     without it, from feature and range
    coupling(self, one, other)
                     factor of U for bobs of charges one and other, as one * other; without it, 1
    energy_between(self, r, one, other), force_between(self, r, one, other)
                     U and -dU/dr for bobs of charges one and other, where these are not coupling
                     times energy and force
    range(self)      distance from which U is zero; without it, infinity
    smoothness(self) number of continuous derivatives of U at every r > 0, -1 where U jumps;
                     without it, infinity
    smoothness_within(self)
                     the same at every 0 < r < range; without it, as smoothness
    minimum(self)    (r, U, d2U/dr2) at the minimum, to be checked against U
    domain(self)     (smallest r, largest r) at which the potential is valid; without it, r > 0
    constraints(self)
                     for each constrained parameter (its name, whether the constraint is met, the
                     message if not), as ("sigma", self.sigma > 0.0, "must be positive [length]")
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any

from tribo.plugins import classes as plugins
from tribo.plugins.unloaded import Unloaded
from tribo.potentials.born_mayer import BornMayer
from tribo.potentials.buckingham import Buckingham
from tribo.potentials.coulomb import Coulomb
from tribo.potentials.cutoff import AT_CUTOFF, Switched
from tribo.potentials.derivative import force_from
from tribo.potentials.gaussian import Gaussian
from tribo.potentials.hertz import Hertz
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.mie import Mie
from tribo.potentials.mixins import Potential
from tribo.potentials.morse import Morse
from tribo.potentials.plummer import Plummer
from tribo.potentials.soft_sphere import SoftSphere
from tribo.potentials.spline import Table, from_points
from tribo.potentials.sum import Scaled, Sum
from tribo.potentials.weeks_chandler_andersen import WeeksChandlerAndersen
from tribo.potentials.yukawa import Yukawa
from tribo.validation import InputError, choice, number, short_repr

# Distance from which a switched potential is reduced, if it is not given [cutoff].
SWITCH_FROM = 0.9


def _complex_step(self, r):
    return -self.energy(r + 1e-100j).imag / 1e-100


def _no_feature(self):
    return 0.0, 0.0


def _clearance(self, r):
    length, reach = self.feature()
    return max(length, r - min(reach, self.range()))


def _no_coupling(self, one, other):
    return 1.0


def _no_range(self):
    return math.inf


def _energy_between(self, r, one, other):
    return self.coupling(one, other) * self.energy(r)


def _force_between(self, r, one, other):
    return self.coupling(one, other) * self.force(r)


def _complex_step_between(self, r, one, other):
    return -self.energy_between(r + 1e-100j, one, other).imag / 1e-100


def _force_of(cls):
    """The force between charges, of whichever energy a class defines nearer to itself."""
    others = min(plugins.generation(cls, name) for name in ("energy", "force", "coupling"))
    between = plugins.generation(cls, "energy_between")
    return _complex_step_between if between <= others else _force_between


def _smooth(self):
    return math.inf


def _smoothness(self):
    return self.smoothness()


def _anywhere(self):
    return 0.0, math.inf


def _no_constraints(self):
    return ()


DEFAULTS = {
    "feature": _no_feature,
    "clearance": _clearance,
    "coupling": _no_coupling,
    "range": _no_range,
    "smoothness": _smooth,
    "smoothness_within": _smoothness,
    "domain": _anywhere,
    "constraints": _no_constraints,
}


def _default(method, cls):
    return DEFAULTS[method]


# Methods that follow from others: from which, and how they are made for a class, in this order.
FOLLOWING = {
    "force": (("energy",), lambda cls: force_from(cls.energy) or _complex_step),
    "energy_between": (("energy", "coupling"), lambda cls: _energy_between),
    "force_between": (("energy_between", "force", "energy", "coupling"), _force_of),
}


def complete(cls: Any) -> Any:
    """The class with every method that kernels call.

    Raises InputError if it is no potential, or inherits a range beside an energy of its own, which
    would end there.
    """
    plugins.check_class(cls, "potential", "energy(self, r)")
    energy = min(plugins.generation(cls, name) for name in ("energy", "energy_between"))
    if energy < plugins.generation(cls, "range") < math.inf:
        problem = "defines an energy but inherits range; define range too, beyond which U is zero"
        raise InputError("potential", f"{cls.__name__} {problem}")
    for method, (sources, make) in FOLLOWING.items():
        plugins.give(cls, method, make, sources)
    for method in DEFAULTS:
        plugins.give(cls, method, partial(_default, method))
    return cls


BUILT_IN: dict[str, type] = {
    "coulomb": complete(Coulomb),
    "morse": complete(Morse),
    "lennard-jones": complete(LennardJones),
    "yukawa": complete(Yukawa),
    "buckingham": complete(Buckingham),
    "born-mayer": complete(BornMayer),
    "weeks-chandler-andersen": complete(WeeksChandlerAndersen),
    "mie": complete(Mie),
    "plummer": complete(Plummer),
    "hertz": complete(Hertz),
    "soft-sphere": complete(SoftSphere),
    "gaussian": complete(Gaussian),
}
for _cls in (Sum, Scaled, Table, *AT_CUTOFF.values()):
    complete(_cls)


def as_potential(value: Any) -> Potential:
    """A potential with a complete class and finite, valid parameters.

    Parameters
    ----------
    value : NamedTuple
        An instance of a built-in or user-defined class.

    Returns
    -------
    NamedTuple
        Its parameters are floats, and its class has all methods that runs need.

    Raises
    ------
    InputError
        If the class is no potential, or a parameter is not valid.
    """
    if isinstance(value, Unloaded):
        return value  # type: ignore[return-value]  # only a scene that is run needs more
    complete(type(value))
    if type(value) is Table:
        table: Any = from_points(value.r, value.values, value.error)
        return table
    value = type(value)(
        **{
            name: as_potential(item) if hasattr(item, "_fields") else number(name, item)
            for name, item in value._asdict().items()
        }
    )
    _check(value)
    return value


def _check(potential: Potential) -> None:
    """Raise InputError for parameters, or results of the class's own methods, that are invalid."""
    constraints = plugins.call_method(potential, "potential", "constraints")
    try:
        broken = [(name, problem) for name, met, problem in constraints if not met]
    except (TypeError, ValueError):
        reason = "must return (parameter, whether its constraint is met, message) for each"
        raise InputError(
            "potential", plugins.located(potential, "constraints", None, reason)
        ) from None
    for name, problem in broken:
        raise InputError(name, f"{problem}, got {short_repr(getattr(potential, name))}")
    for method in ("range", "feature", "smoothness", "smoothness_within"):
        plugins.returned_numbers(potential, "potential", method)


def with_cutoff(
    potential: Any, cutoff: float, at_cutoff: str = "switch", switch_from: float | None = None
) -> Potential:
    """A potential that is zero from a cutoff on.

    Parameters
    ----------
    potential : NamedTuple
        A potential without a cutoff.
    cutoff : float
        Distance from which U and the force are zero [length].
    at_cutoff : str
        "switch" (U and two derivatives continuous), "force-shift" (U and the force continuous),
        "shift" (U continuous) or "truncate".
    switch_from : float, optional
        Distance from which a switched potential is reduced [length]; 0.9 cutoff if None.

    Returns
    -------
    Switched, ForceShifted, Shifted or Truncated

    Raises
    ------
    InputError
        If a parameter is invalid, or the potential has a cutoff.
    """
    kind = AT_CUTOFF[choice("at_cutoff", at_cutoff, AT_CUTOFF)]
    cutoff = number("cutoff", cutoff, unit="length")
    if kind is not Switched:
        if switch_from is not None:
            raise InputError("switch_from", f'cannot go with at_cutoff = "{at_cutoff}"')
        return as_potential(kind(potential, cutoff))
    begin = SWITCH_FROM * cutoff if switch_from is None else switch_from
    return as_potential(Switched(potential, cutoff, begin))


def sum_of(*parts: object) -> Potential:
    """The sum of two or more potentials.

    Parameters
    ----------
    *parts : NamedTuple
        Potentials; only charged ones are multiplied by the charges.

    Returns
    -------
    Sum

    Raises
    ------
    InputError
        If there are fewer than two parts, or one is no potential.
    """
    if len(parts) < 2:
        raise InputError("of", f"must be two or more potentials, got {len(parts)}")
    first, *rest = parts
    second = rest[0] if len(rest) == 1 else sum_of(*rest)
    return as_potential(Sum(as_potential(first), as_potential(second)))


def scaled(potential: object, factor: float) -> Potential:
    """A potential times a number.

    Parameters
    ----------
    potential : NamedTuple
        A potential.
    factor : float
        A number of either sign.

    Returns
    -------
    Scaled

    Raises
    ------
    InputError
        If the factor is no finite number, or `potential` is no potential.
    """
    return as_potential(Scaled(as_potential(potential), factor))
