"""Potentials made of others: sums, multiples, and what both share with cutoffs.

From its range on a part is zero, whatever its formula gives there, which may be no number.
"""

import numpy as np

from tribo.potentials.potential import COMBINED, Potential, as_potential


class Sum(Potential):
    """The sum of two potentials: U = U_first + U_second.

    Each part multiplies its own energy by the charges, so in a sum of a charged and an uncharged
    potential only the charged one is multiplied by q_i q_j.

    Attributes
    ----------
    first, second : Potential
        Each is zero from its own range on.
    """

    first: Potential
    second: Potential

    @classmethod
    def of(cls, first: Potential, second: Potential) -> Potential:
        """The sum, of three potentials that of the first and of a sum, whatever the brackets."""
        if type(first) is cls:
            return as_potential(cls(first.first, cls.of(first.second, second)))
        return as_potential(cls(first, second))

    def energy(self, r):
        own = np.where(r < self.first.range_of_all(), self.first.energy(r), 0.0)
        its = np.where(r < self.second.range_of_all(), self.second.energy(r), 0.0)
        return own + its

    def force(self, r):
        own = np.where(r < self.first.range_of_all(), self.first.force(r), 0.0)
        its = np.where(r < self.second.range_of_all(), self.second.force(r), 0.0)
        return own + its

    def energy_between(self, r, one, other):
        own = self.first.energy_between(r, one, other)
        its = self.second.energy_between(r, one, other)
        own = np.where(r < self.first.range_of_all(), own, 0.0)
        return own + np.where(r < self.second.range_of_all(), its, 0.0)

    def force_between(self, r, one, other):
        own = self.first.force_between(r, one, other)
        its = self.second.force_between(r, one, other)
        own = np.where(r < self.first.range_of_all(), own, 0.0)
        return own + np.where(r < self.second.range_of_all(), its, 0.0)

    def acts_at_all(self):
        """Whether either part acts."""
        return self.first.acts_at_all() or self.second.acts_at_all()

    def acts_between(self, one, other):
        """Whether either part acts between two charges."""
        return self.first.acts_between(one, other) or self.second.acts_between(one, other)

    def clearance_between(self, r, one, other):
        """The smaller clearance of the two parts."""
        own = self.first.clearance_between(r, one, other)
        return min(own, self.second.clearance_between(r, one, other))

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
        return self.smoothness_below(self.range())

    def smoothness_below(self, end):
        """That of the less smooth part, which may jump or bend beyond."""
        return min(part.smoothness_below(end) for part in self)

    def energy_subtracted(self, charge):
        """That of both parts."""
        return self.first.energy_subtracted(charge) + self.second.energy_subtracted(charge)

    def domain(self):
        """The distances that are in both domains."""
        low, high = self.first.domain()
        other_low, other_high = self.second.domain()
        return max(low, other_low), min(high, other_high)


class Wrapper(Potential):
    """A potential whose methods other than energy and force are those of another."""

    potential: Potential

    def acts_at_all(self):
        return self.potential.acts_at_all()

    def acts_between(self, one, other):
        return self.potential.acts_between(one, other)

    def clearance_between(self, r, one, other):
        return self.potential.clearance_between(r, one, other)

    def feature(self):
        return self.potential.feature()

    def clearance(self, r):
        return self.potential.clearance(r)

    def range(self):
        return self.potential.range()

    def smoothness(self):
        return self.potential.smoothness()

    def smoothness_within(self):
        return self.potential.smoothness_within()

    def smoothness_below(self, end):
        return self.potential.smoothness_below(end)

    def energy_subtracted(self, charge):
        return self.potential.energy_subtracted(charge)

    def domain(self):
        return self.potential.domain()


class Scaled(Wrapper):
    """A potential times a number: U = factor U_potential.

    Attributes
    ----------
    potential : Potential
        The potential.
    factor : float
        A number of either sign.
    """

    factor: float

    def energy(self, r):
        return self.factor * self.potential.energy(r)

    def force(self, r):
        return self.factor * self.potential.force(r)

    def energy_subtracted(self, charge):
        """That of the potential, times the factor."""
        return abs(self.factor) * self.potential.energy_subtracted(charge)

    def acts_at_all(self):
        """Whether the factor is not zero, and the potential acts."""
        return self.factor != 0.0 and self.potential.acts_at_all()

    def acts_between(self, one, other):
        """Whether the factor is not zero, and the potential acts between two charges."""
        return self.factor != 0.0 and self.potential.acts_between(one, other)

    def clearance_between(self, r, one, other):
        """That of the potential; infinite where the factor is zero."""
        return self.potential.clearance_between(r, one, other) if self.factor != 0.0 else np.inf

    def energy_between(self, r, one, other):
        return self.factor * self.potential.energy_between(r, one, other)

    def force_between(self, r, one, other):
        return self.factor * self.potential.force_between(r, one, other)


COMBINED |= {"sum": Sum, "scaled": Scaled}
