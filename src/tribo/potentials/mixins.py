"""The interface of a potential, and methods that combined potentials share.

A NamedTuple cannot inherit methods.  ``@inherits(Parent)`` copies those methods of a parent that
the class does not define, so that numba finds them in the class.
"""

from collections.abc import Callable
from typing import Any, Protocol, TypeVar

# A float, an array or SIMD lanes; numba compiles a method for the type with which it is called.
Real = Any
# A class.
C = TypeVar("C", bound=type)
# A parameter's name, whether its constraint is met, and the message if not.
Constraint = tuple[str, bool, str]


class Potential(Protocol):
    """The methods of every complete potential; :mod:`tribo.potentials.registry` describes them."""

    def energy(self, r: Real) -> Real: ...
    def force(self, r: Real) -> Real: ...
    def coupling(self, one: Real, other: Real) -> Real: ...
    def energy_between(self, r: Real, one: Real, other: Real) -> Real: ...
    def force_between(self, r: Real, one: Real, other: Real) -> Real: ...
    def feature(self) -> tuple[float, float]: ...
    def clearance(self, r: Real) -> Real: ...
    def range(self) -> float: ...
    def smoothness(self) -> float: ...
    def smoothness_within(self) -> float: ...
    def domain(self) -> tuple[float, float]: ...
    def constraints(self) -> tuple[Constraint, ...]: ...
    def _asdict(self) -> dict[str, Any]: ...


def inherits(parent: type) -> Callable[[C], C]:
    """Give a class the methods of `parent` that it does not define itself."""

    def with_methods(cls: C) -> C:
        for name in dir(parent):
            if not name.startswith("_") and name not in vars(cls):
                setattr(cls, name, getattr(parent, name))
        return cls

    return with_methods


def must_be_potential(name, part):
    """The constraint on a parameter that must be a potential."""
    return name, hasattr(part, "energy"), "must be a potential"


class BetweenCharges:
    """Energy and force of a class that defines both between any two charges."""

    energy_between: Callable[[Real, Real, Real], Real]
    force_between: Callable[[Real, Real, Real], Real]

    def energy(self, r):
        """Energy U(r) [energy] of two charges of 1 at distance r [length]."""
        return self.energy_between(r, 1.0, 1.0)

    def force(self, r):
        """Force -dU/dr [energy / length] between charges of 1, positive if it repels."""
        return self.force_between(r, 1.0, 1.0)


class Wrapper:
    """Methods other than energy and force, taken from the wrapped `potential`."""

    potential: Potential

    def feature(self):
        """The value of the wrapped potential."""
        return self.potential.feature()

    def clearance(self, r):
        """The value of the wrapped potential."""
        return self.potential.clearance(r)

    def range(self):
        """The value of the wrapped potential."""
        return self.potential.range()

    def smoothness(self):
        """The value of the wrapped potential."""
        return self.potential.smoothness()

    def smoothness_within(self):
        """The value of the wrapped potential."""
        return self.potential.smoothness_within()

    def domain(self):
        """The value of the wrapped potential."""
        return self.potential.domain()

    def constraints(self):
        """For each constraint: the parameter, whether it is met, and the message if not."""
        return (must_be_potential("potential", self.potential),)
