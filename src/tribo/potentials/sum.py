"""Combined potentials:  U = U_first + U_second,  and  U = factor U_potential.

Each part multiplies its own energy by the charges, so in a sum of a charged and an uncharged
potential only the charged one is multiplied by q_i q_j.  A sum of three potentials is the sum of
the first and of a sum.
"""

from typing import NamedTuple

from tribo.potentials.mixins import BetweenCharges, Potential, Wrapper, inherits, must_be_potential


@inherits(BetweenCharges)
class Sum(NamedTuple):
    """The sum of two potentials: U = U_first + U_second.

    Attributes
    ----------
    first, second : NamedTuple
        Potentials; each is zero from its own range on.
    """

    first: Potential
    second: Potential

    def energy_between(self, r, one, other):
        """Energy U(r) [energy] of two charges at distance r [length]."""
        first = (r < self.first.range()) * self.first.energy_between(r, one, other)
        second = (r < self.second.range()) * self.second.energy_between(r, one, other)
        return first + second

    def force_between(self, r, one, other):
        """Force -dU/dr [energy / length] between two charges, positive if it repels."""
        first = (r < self.first.range()) * self.first.force_between(r, one, other)
        second = (r < self.second.range()) * self.second.force_between(r, one, other)
        return first + second

    def feature(self):
        """The shorter length of the two, and the larger distance."""
        length, reach = self.first.feature()
        other_length, other_reach = self.second.feature()
        return min(length, other_length), max(reach, other_reach)

    def clearance(self, r):
        """Distance that a pair at r may move before either force changes considerably."""
        return min(self.first.clearance(r), self.second.clearance(r))

    def range(self):
        """Distance from which both parts are zero."""
        return max(self.first.range(), self.second.range())

    def smoothness(self):
        """That of the less smooth part."""
        return min(self.first.smoothness(), self.second.smoothness())

    def smoothness_within(self):
        """That of the less smooth part, without the point where the sum ends."""
        end = self.range()
        return min(
            part.smoothness_within() if part.range() == end else part.smoothness() for part in self
        )

    def domain(self):
        """The distances that are in both domains."""
        (low, high), (other_low, other_high) = self.first.domain(), self.second.domain()
        return max(low, other_low), min(high, other_high)

    def constraints(self):
        """For each constraint: the parameter, whether it is met, and the message if not."""
        return tuple(map(must_be_potential, self._fields, self))


@inherits(Wrapper)
class Scaled(NamedTuple):
    """A potential times a number: U = factor U_potential.

    Attributes
    ----------
    potential : NamedTuple
        The potential.
    factor : float
        A number of either sign.
    """

    potential: Potential
    factor: float

    def energy(self, r):
        """Energy U(r) [energy] of two charges of 1 at distance r [length]."""
        return self.factor * self.potential.energy(r)

    def force(self, r):
        """Force -dU/dr [energy / length] between charges of 1, positive if it repels."""
        return self.factor * self.potential.force(r)

    def energy_between(self, r, one, other):
        """Energy U(r) [energy] of two charges at distance r [length]."""
        return self.factor * self.potential.energy_between(r, one, other)

    def force_between(self, r, one, other):
        """Force -dU/dr [energy / length] between two charges, positive if it repels."""
        return self.factor * self.potential.force_between(r, one, other)
