"""Potentials made of others:  U = U_first + U_second,  and  U = factor U_potential.

Each part knows what it makes of two charges, so a sum of a charged and an uncharged one
multiplies the charged one alone by q_i q_j.  A sum of more than two is a sum in a sum.
"""

from typing import Any, NamedTuple

from tribo.potentials.mixins import OfAnother, OfCharges, inherits, must_be_potential


@inherits(OfCharges)
class Sum(NamedTuple):
    """The sum of two potentials."""

    first: Any
    second: Any

    def energy_between(self, r, one, other):
        """U(r) between two charges; each part is zero from its range on."""
        first = (r < self.first.range()) * self.first.energy_between(r, one, other)
        second = (r < self.second.range()) * self.second.energy_between(r, one, other)
        return first + second

    def force_between(self, r, one, other):
        """-dU/dr between two charges."""
        first = (r < self.first.range()) * self.first.force_between(r, one, other)
        second = (r < self.second.range()) * self.second.force_between(r, one, other)
        return first + second

    def feature(self):
        """The shorter length of the two, and the larger distance."""
        length, reach = self.first.feature()
        other_length, other_reach = self.second.feature()
        return min(length, other_length), max(reach, other_reach)

    def clearance(self, r):
        """How far a pair may move before either force is another."""
        return min(self.first.clearance(r), self.second.clearance(r))

    def range(self):
        """Distance from which both are zero."""
        return max(self.first.range(), self.second.range())

    def smoothness(self):
        """That of the rougher one."""
        return min(self.first.smoothness(), self.second.smoothness())

    def smoothness_within(self):
        """That of the rougher one, but for where the sum ends."""
        end = self.range()
        return min(
            part.smoothness_within() if part.range() == end else part.smoothness() for part in self
        )

    def domain(self):
        """Where both are meant."""
        (low, high), (other_low, other_high) = self.first.domain(), self.second.domain()
        return max(low, other_low), min(high, other_high)

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        return tuple(map(must_be_potential, self._fields, self))


@inherits(OfAnother)
class Scaled(NamedTuple):
    """A potential times a number."""

    potential: Any
    factor: float

    def energy(self, r):
        """U(r) between charges of 1."""
        return self.factor * self.potential.energy(r)

    def force(self, r):
        """-dU/dr between charges of 1."""
        return self.factor * self.potential.force(r)

    def energy_between(self, r, one, other):
        """U(r) between two charges."""
        return self.factor * self.potential.energy_between(r, one, other)

    def force_between(self, r, one, other):
        """-dU/dr between two charges."""
        return self.factor * self.potential.force_between(r, one, other)
