"""What potentials made of others have in common: NamedTuples cannot inherit, but can be given.

A class that is marked with ``@inherits(Parent)`` has all methods of the Parent but those it
defines itself, and numba finds them there as if they had been written there.
"""

from collections.abc import Callable
from typing import Any


def inherits(parent: type) -> Callable[[Any], Any]:
    """Give a class the methods of `parent` that it does not define itself."""

    def given(cls: Any) -> Any:
        for name in dir(parent):
            if not name.startswith("_") and name not in vars(cls):
                setattr(cls, name, getattr(parent, name))
        return cls

    return given


def must_be_potential(name, part):
    """What is demanded of a parameter that must be a potential."""
    return name, hasattr(part, "energy"), "must be a potential"


class OfCharges:
    """Energy and force of a class that says what they are between any two charges."""

    energy_between: Any
    force_between: Any

    def energy(self, r):
        """U(r) between charges of 1."""
        return self.energy_between(r, 1.0, 1.0)

    def force(self, r):
        """-dU/dr between charges of 1."""
        return self.force_between(r, 1.0, 1.0)


class OfAnother:
    """All but energy and force of a class made of one `potential`, as that has it."""

    potential: Any

    def feature(self):
        """As the potential has it."""
        return self.potential.feature()

    def clearance(self, r):
        """As the potential has it."""
        return self.potential.clearance(r)

    def range(self):
        """As the potential has it."""
        return self.potential.range()

    def smoothness(self):
        """As the potential has it."""
        return self.potential.smoothness()

    def smoothness_within(self):
        """As the potential has it."""
        return self.potential.smoothness_within()

    def domain(self):
        """As the potential has it."""
        return self.potential.domain()

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        return (must_be_potential("potential", self.potential),)
