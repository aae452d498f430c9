"""Potentials: small frozen classes of numbers with methods, which can be added and multiplied.

A potential derives from :class:`Potential` or is a NamedTuple of floats, with ``energy(self, r)``.
A class that defines ``energy`` inherits no force, and no energy between charges.  It inherits what
describes U, as feature and smoothness, which assumes no more than the defaults do; but it must
define a range where its parent has one.  :class:`Potential` has defaults of all further methods but

    force(self, r)   -dU/dr; without it, the derivative of the energy's source where that is a
                     formula, else by a complex step: both to round-off
    energy_between(self, r, one, other), force_between(self, r, one, other)
                     U and -dU/dr for bobs of charges one and other, where these are not coupling
                     times energy and force
    minimum(self)    (r, U, d2U/dr2) at the minimum, to be checked against U
"""

from __future__ import annotations

import functools
import inspect
import math
from collections import namedtuple
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, ClassVar, Self, dataclass_transform

from tribo.plugins import classes as plugins
from tribo.plugins.complex_steps import unlike_slope
from tribo.plugins.sources import is_own
from tribo.plugins.unloaded import Unloaded
from tribo.potentials.derivative import factors_of, force_from
from tribo.potentials.factors import factors_by_call
from tribo.validation import NOT_NEGATIVE, POSITIVE, InputError, choice, must_be, number, short_repr

# A float, an array or SIMD lanes; numba compiles a method for the type with which it is called.
Real = Any
# A parameter's name, whether its constraint is met, and the message if not.
Constraint = tuple[str, bool, str]

# The classes that `with_cutoff` makes, by the words of scene files; tribo.potentials.cutoff.
AT_CUTOFF: dict[str, Any] = {}
# The classes that sums and products make, by the words of scene files; tribo.potentials.combined.
COMBINED: dict[str, Any] = {}
# Distance from which a switched potential is reduced, if it is not given [cutoff].
SWITCH_FROM = 0.9
# Pairs of charges of which each potential acts on one, unless it acts on none or has unusual rules.
CHARGES = (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (0.0, 0.0), (0.0, 1.0), (1.0, 2.0), (2.0, 2.0)
# Distances at which a force by a complex step is compared with the energy's slope [length].
STEPPED_AT = tuple(0.0137 * 1.618**k for k in range(25))
# What named tuples have beside their fields.
OF_TUPLES = (
    *("__new__", "__repr__", "__getnewargs__", "__match_args__"),
    *("_make", "_replace", "_asdict", "_fields", "_field_defaults"),
)


# The documentation of this package's methods that have none of their own.
DOCUMENTATION = {
    "energy": "Energy U(r) [energy] at distance r [length], for a coupling of 1.",
    "force": "Force -dU/dr [energy / length] for a coupling of 1, positive if it repels.",
    "energy_between": "Energy U(r) [energy] of two charges at distance r [length].",
    "force_between": "Force -dU/dr [energy / length] between two charges, positive if it repels.",
    "acts_at_all": "Whether U of some charges differs from zero at any distance.",
    "acts_between": "Whether U of two charges differs from zero at any distance.",
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


def _energy_of_charges_one(self, r):
    return self.energy_between(r, 1.0, 1.0)


def _force_of_charges_one(self, r):
    return self.force_between(r, 1.0, 1.0)


def acts_if_coupled(self, one, other):
    """Whether U of two charges differs from zero at any distance: where they are coupled."""
    return self.acts_at_all() and self.coupling(one, other) != 0.0


def _acts_by(factors: tuple[str, ...]) -> Callable[..., Any]:
    """Whether an energy that is a product with some fields as its factors differs from zero."""
    text = " and ".join(f"self.{name} != 0.0" for name in factors) or "True"
    made: dict[str, Callable[..., Any]] = {}
    # As text, since numba reads fields by names that stand in the source alone.
    exec(f"def acts_at_all(self):\n    return {text}", {}, made)
    method = made["acts_at_all"]
    method.__module__ = __name__
    method.__doc__ = DOCUMENTATION["acts_at_all"]
    return method


def following(own: Mapping[str, Any]) -> dict[str, Callable[..., Any]]:
    """The methods that follow from those that a class defines, as a force from its energy.

    They replace what the class inherits, which fits other methods.
    """
    found: dict[str, Callable[..., Any]] = {}
    between = "energy_between" in own
    if "energy" in own and "force" not in own:
        found["force"] = force_from(own["energy"]) or _complex_step
    if own.keys() & {"energy", "coupling"} and not between:
        found["energy_between"] = energy_of_charges
    sources = {"energy", "force", "coupling", "energy_between"}
    if own.keys() & sources and "force_between" not in own:
        found["force_between"] = _complex_step_between if between else _force_of_charges
    if own.keys() & sources and "acts_between" not in own:
        found["acts_between"] = acts_if_coupled
    if own.keys() & {"energy", "force", "energy_between"}:
        factors = ()
        if "energy" in own and not between:
            factors = factors_of(own["energy"]) or factors_by_call(own["energy"])
        found["acts_at_all"] = _acts_by(factors)
    return found


@dataclass_transform(frozen_default=True)
class PotentialType(type):
    """The type of potentials: annotated names become fields, and a force follows from an energy.

    Instances are named tuples of their fields, which numba types by their class.
    """

    def __new__(mcs, name: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> Any:
        """A class with its fields, those of its parents first."""
        methods = following(namespace) | namespace
        if "energy_between" in methods and not any(hasattr(each, "energy") for each in bases):
            methods = {"energy": _energy_of_charges_one, "force": _force_of_charges_one} | methods
        for each in DOCUMENTATION.keys() & methods.keys():
            method = methods[each]
            if not method.__doc__ and method.__module__.startswith("tribo."):  # none of a user's
                method.__doc__ = DOCUMENTATION[each]
        cls: Any = super().__new__(mcs, name, bases, {"__slots__": ()} | methods)
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
            cls._parts = (*cls._parts, *(each for each in own if "Potential" in str(kinds[each])))
        return cls


class Potential(tuple[Any, ...], metaclass=PotentialType):
    """The base of potentials: ``a + b``, ``2.0 * a`` and ``a.with_cutoff(2.5)`` are potentials.

    A class that derives from it annotates its parameters, as ``epsilon: float``, and defines
    ``energy(self, r)``; all other methods have defaults.
    """

    _fields: ClassVar[tuple[str, ...]] = ()
    _field_defaults: ClassVar[dict[str, Any]] = {}
    # Its name in scene files, that of a potential of tribo.
    _key: ClassVar[str]
    # Parameters that are potentials.
    _parts: ClassVar[tuple[str, ...]] = ()
    # Parameters that are positive, ">", or not negative, ">=", and their units.
    _limits: ClassVar[tuple[tuple[str, str, str], ...]] = ()
    # Arithmetic with numbers and arrays of numpy is that of this class.
    __array_ufunc__ = None

    if TYPE_CHECKING:

        def _asdict(self) -> dict[str, Any]: ...
        def _replace(self, **fields: Any) -> Self: ...
        def energy(self, r: Real) -> Real: ...
        def force(self, r: Real) -> Real: ...
        def energy_between(self, r: Real, one: Real, other: Real) -> Real: ...
        def force_between(self, r: Real, one: Real, other: Real) -> Real: ...

    def coupling(self, one: Real, other: Real) -> Real:
        """Factor of the energy and the force of two charges, as one * other: 1."""
        return 1.0

    def feature(self) -> tuple[float, float]:
        """Length over which the force changes, and distance beyond which it is weak [length].

        Steps are limited by them so that none jumps over an encounter.
        """
        return 0.0, 0.0  # the length is r itself, at all distances

    def clearance(self, r: Real) -> Real:
        """Distance that a pair at r may move before the force changes considerably."""
        length, reach = self.feature()
        return max(length, r - min(reach, self.range()))

    def acts_at_all(self) -> bool:
        """Whether U of some charges differs from zero at any distance; not with a strength of 0."""
        return True

    def acts_between(self, one: Real, other: Real) -> bool:
        """Whether U of two charges differs from zero at any distance.

        Where it does not, as with a strength of zero, there is no encounter.
        """
        return self.acts_at_all() and self.coupling(one, other) != 0.0

    def clearance_between(self, r: Real, one: Real, other: Real) -> Real:
        """The clearance of two charges: infinite where no force acts between them."""
        return self.clearance(r) if self.acts_between(one, other) else math.inf

    def range_between(self, one: Real, other: Real) -> Real:
        """The range of two charges: zero where no force acts between them."""
        return self.range() if self.acts_between(one, other) else 0.0

    def range_of_all(self) -> Real:
        """The largest range of any charges: zero where no force acts at all."""
        return self.range() if self.acts_at_all() else 0.0

    def range(self) -> float:
        """Distance from which U and the force are zero [length]; infinity by default."""
        return math.inf

    def smoothness(self) -> float:
        """Number of continuous derivatives of U at every r > 0, -1 where U jumps."""
        return math.inf

    def smoothness_within(self) -> float:
        """Number of continuous derivatives of U within its range."""
        return self.smoothness()

    def smoothness_below(self, end: float) -> float:
        """Number of continuous derivatives of U at every r below `end` [length]."""
        return self.smoothness_within() if end <= self.range() else self.smoothness()

    def energy_subtracted(self, charge: float) -> float:
        """What cutoffs subtract from the energies of bobs with this charge, at most [energy]."""
        return 0.0

    def domain(self) -> tuple[float, float]:
        """Smallest and largest valid r [length]."""
        return 0.0, math.inf

    def constraints(self) -> tuple[Constraint, ...]:
        """For each constraint: the parameter, whether it is met, and the message if not.

        As ("sigma", self.sigma > 0.0, "must be positive [length]").
        """
        found = [
            (name, hasattr(getattr(self, name), "energy"), "must be a potential")
            for name in self._parts
        ]
        for name, sign, unit in self._limits:
            problem, holds = {">": POSITIVE, ">=": NOT_NEGATIVE}[sign]
            met = holds(getattr(self, name))
            suffix = f" [{unit}]" if unit else ""
            found.append((name, met, problem + suffix))
        return tuple(found)

    def with_cutoff(
        self, cutoff: float, at_cutoff: str = "switch", switch_from: float | None = None
    ) -> Potential:
        """The potential, made zero from a cutoff on.

        Parameters
        ----------
        cutoff : float
            Distance from which U and the force are zero [length].
        at_cutoff : str
            "switch" (U and two derivatives continuous), "force-shift" (U and the force
            continuous), "shift" (U continuous) or "truncate".
        switch_from : float, optional
            Distance from which a switched potential is reduced [length]; 0.9 cutoff if None.

        Raises
        ------
        InputError
            If a parameter is invalid, or the potential has a cutoff.
        """
        kind = AT_CUTOFF[choice("at_cutoff", at_cutoff, AT_CUTOFF)]
        cutoff = number("cutoff", cutoff, unit="length")
        if at_cutoff == "switch":
            begin = SWITCH_FROM * cutoff if switch_from is None else switch_from
            return as_potential(kind(self, cutoff, begin))
        if switch_from is not None:
            raise InputError("switch_from", f'cannot go with at_cutoff = "{at_cutoff}"')
        return as_potential(kind(self, cutoff))

    def with_checked_fields(self) -> Self:
        """The same with floats and checked potentials as its fields.  Raises InputError."""
        values = {
            name: as_potential(item) if hasattr(item, "_fields") else number(name, item)
            for name, item in self._asdict().items()
        }
        return type(self)(**values)

    def __add__(self, other: object) -> Potential:  # type: ignore[override]
        """The sum; only charged parts are multiplied by the charges."""
        return COMBINED["sum"].of(self, _added(other))

    def __radd__(self, other: object) -> Potential:
        """The sum; 0, with which `sum` begins, changes nothing."""
        if isinstance(other, int) and other == 0:
            return self
        return COMBINED["sum"].of(_added(other), self)

    def __sub__(self, other: object) -> Potential:
        return COMBINED["sum"].of(self, -1.0 * _added(other))

    def __neg__(self) -> Potential:
        return -1.0 * self

    def __mul__(self, factor: object) -> Potential:  # type: ignore[override]
        """The potential times a number of either sign."""
        return as_potential(COMBINED["scaled"](self, number("factor", factor)))

    __rmul__ = __mul__  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        """Whether the other is of the same class with the same numbers."""
        return type(self) is type(other) and tuple.__eq__(self, other)  # type: ignore[arg-type]

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash((type(self), tuple(self)))


@functools.cache
def complete(cls: Any) -> Any:
    """The class, or one with all methods that is derived from it if it is a plain NamedTuple.

    Raises InputError if it is no potential, or inherits a range beside an energy of its own, which
    would end there.
    """
    plugins.check_class(cls, "potential", "energy(self, r)", " or derive from tribo.Potential")
    if _has_no_energy(cls):
        raise InputError("potential", f"{cls.__name__} has no method energy(self, r)")
    if _inherits_range(cls):
        problem = "defines an energy but inherits range; define range too, beyond which U is zero"
        raise InputError("potential", f"{cls.__name__} {problem}")
    if issubclass(cls, Potential):
        return cls
    return plugins.completed(cls, (Potential,), following, complete, as_potential)


def _has_no_energy(cls: Any) -> bool:
    """Whether the energy of a class is that of its charges, and that of these its energy."""
    energies = getattr(cls, "energy", None), getattr(cls, "energy_between", None)
    return energies == (_energy_of_charges_one, energy_of_charges)


def _inherits_range(cls: type) -> bool:
    """Whether a user's class defines an energy and inherits a range that is not infinite."""
    energies = (None, energy_of_charges)
    for ancestor in cls.__mro__:
        methods = vars(ancestor)
        if "range" in methods or is_own(ancestor):
            return False
        if "energy" in methods or methods.get("energy_between") not in energies:
            return getattr(cls, "range", Potential.range) is not Potential.range
    return False


def as_potential(value: Any) -> Any:
    """A potential with all methods that runs need, and finite, valid parameters.

    Parameters
    ----------
    value : Potential or NamedTuple
        An instance of a built-in or user-defined class.

    Raises
    ------
    InputError
        If the class is no potential, or a parameter is not valid.
    """
    if isinstance(value, Unloaded):
        return value  # only a scene that is run needs more
    if isinstance(value, type) and hasattr(value, "_fields"):
        fields = ", ".join(f"{name}=..." for name in value._fields)
        problem = f"must be an instance, {value.__name__}({fields}), got the class {value.__name__}"
        raise InputError("potential", problem)
    if not hasattr(value, "_fields"):
        wanted = "a potential, of a class that derives from tribo.Potential or a NamedTuple"
        raise must_be("potential", wanted, value)
    value = plugins.as_built_in(value)
    cls: Any = type(value)
    potential = complete(cls)(*value).with_checked_fields()
    _check(potential)
    return potential


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
    _check_complex_step(potential)


def _check_complex_step(potential: Potential) -> None:
    """Refuse an energy whose complex step is not its slope, as that of ``abs(r)`` is not."""
    cls: Any = type(potential)
    if cls.force is not _complex_step and cls.force_between is not _complex_step_between:
        return
    one, other = acting_charges(potential)
    for r in STEPPED_AT:
        unlike = unlike_slope(
            lambda r: potential.energy_between(r, one, other),
            lambda r: (-potential.force_between(r, one, other),),
            r,
        )
        if unlike:
            problem = (
                f"{cls.__name__} has no force, and complex numbers do not give the slope of its "
                f"energy: dU/dr is {unlike}; define force(self, r)"
            )
            raise InputError("potential", problem)


def acting_charges(potential: Potential) -> tuple[float, float]:
    """Two charges between which a potential acts: of 1 if it does, as most potentials do."""
    with suppress(Exception):  # of the user's code, whose line the compiler names
        for one, other in CHARGES:
            if potential.acts_between(one, other):
                return one, other
    return CHARGES[0]


def _added(part: object) -> Potential:
    """A part of a sum.  Raises InputError if it is no potential."""
    if not hasattr(part, "_fields"):
        raise InputError("potential", f"can be added to potentials only, not to {short_repr(part)}")
    return as_potential(part)
