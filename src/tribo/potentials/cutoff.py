"""Cutoffs: potentials whose energy and force are zero beyond a distance.

    Truncated     U                                     for r < cutoff: a jump in U and force
    Shifted       U - U(cutoff)                         a jump in the force
    ForceShifted  U - U(cutoff) + (r - cutoff) F(cutoff)   a kink in the force
    Switched      U S(u), u = (r - switch_from) / (cutoff - switch_from) between 0 and 1,
                  S = 1 - 10 u^3 + 15 u^4 - 6 u^5       C2: keeps methods of order 6 at order 6

M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids, Oxford 1987, section 5.2; the
polynomial is the smoothest of degree five with S = 1, 0 and S' = S'' = 0 at the ends.
"""

from typing import ClassVar

import numpy as np

from tribo.potentials.combined import Wrapper
from tribo.potentials.potential import AT_CUTOFF


class WithCutoff(Wrapper):
    """The methods that all cutoffs share.

    Cutoffs are linear in U, so they apply to the potential between any two charges.  What they
    subtract is zero where the cutoff is beyond the range of the potential.

    Attributes
    ----------
    potential : Potential
        The potential without a cutoff.
    cutoff : float
        Distance from which U and the force are zero [length], positive.
    """

    cutoff: float
    _limits = (("cutoff", ">", "length"),)
    # Number of continuous derivatives of U at the cutoff; -1 where U jumps.
    _at_cutoff: ClassVar[int]

    def clearance(self, r):
        """Distance that a pair at r may move before the force changes considerably."""
        return max(self.potential.clearance(r), r - self.cutoff)

    def clearance_between(self, r, one, other):
        """The same of two charges; infinite where no force acts between them."""
        return max(self.potential.clearance_between(r, one, other), r - self.cutoff)

    def range(self):
        return min(self.cutoff, self.potential.range())

    def smoothness(self):
        """Number of continuous derivatives of U at every r > 0; -1 where U jumps."""
        if self.cutoff > self.potential.range():  # where U and the force are zero
            return self.potential.smoothness()
        return min(self._at_cutoff, self.smoothness_within())

    def smoothness_within(self):
        """Number of continuous derivatives of U below the cutoff."""
        return self.potential.smoothness_below(self.range())

    def smoothness_below(self, end):
        """Number of continuous derivatives of U at every r below `end` [length]."""
        return self.smoothness_within() if end <= self.range() else self.smoothness()

    def constraints(self):
        repeated = type(self.potential) in AT_CUTOFF.values()
        problem = "must be given once; the potential has another"
        return (*super().constraints(), ("cutoff", not repeated, problem))


class Truncated(WithCutoff):
    """U below the cutoff, zero beyond: U and the force jump."""

    _at_cutoff = -1  # U jumps
    acts_at_all = Wrapper.acts_at_all
    acts_between = Wrapper.acts_between

    def energy(self, r):
        return 1.0 * np.where(r < self.range(), self.potential.energy(r), 0.0)

    def energy_between(self, r, one, other):
        return 1.0 * np.where(r < self.range(), self.potential.energy_between(r, one, other), 0.0)

    def force(self, r):
        return 1.0 * np.where(r < self.range(), self.potential.force(r), 0.0)

    def force_between(self, r, one, other):
        return 1.0 * np.where(r < self.range(), self.potential.force_between(r, one, other), 0.0)


class Shifted(WithCutoff):
    """U - U(cutoff) below the cutoff, zero beyond: the force jumps."""

    _at_cutoff = 0  # the force jumps
    acts_at_all = Wrapper.acts_at_all
    acts_between = Wrapper.acts_between

    def energy(self, r):
        end = self.potential.energy(self.cutoff)
        end = np.where(self.cutoff < self.potential.range(), end, 0.0)
        return 1.0 * np.where(r < self.range(), self.potential.energy(r) - end, 0.0)

    def energy_between(self, r, one, other):
        end = self.potential.energy_between(self.cutoff, one, other)
        end = np.where(self.cutoff < self.potential.range(), end, 0.0)
        return 1.0 * np.where(
            r < self.range(), self.potential.energy_between(r, one, other) - end, 0.0
        )

    def force(self, r):
        return 1.0 * np.where(r < self.range(), self.potential.force(r), 0.0)

    def force_between(self, r, one, other):
        return 1.0 * np.where(r < self.range(), self.potential.force_between(r, one, other), 0.0)

    def energy_subtracted(self, charge):
        """U at the cutoff, and what the potential itself subtracts."""
        inner = self.potential
        end = self.cutoff
        found = inner.energy_subtracted(charge)
        if end < inner.range():
            found += abs(float(inner.energy_between(end, charge, charge)))
        return found


class ForceShifted(WithCutoff):
    """U - U(cutoff) + (r - cutoff) F(cutoff) below the cutoff: the force has a kink."""

    _at_cutoff = 1  # the force has a kink
    acts_at_all = Wrapper.acts_at_all
    acts_between = Wrapper.acts_between

    def energy(self, r):
        end = self.potential.energy(self.cutoff)
        end = np.where(self.cutoff < self.potential.range(), end, 0.0)
        slope = self.potential.force(self.cutoff)
        slope = np.where(self.cutoff < self.potential.range(), slope, 0.0)
        shifted = self.potential.energy(r) - end + (r - self.cutoff) * slope
        return 1.0 * np.where(r < self.range(), shifted, 0.0)

    def energy_between(self, r, one, other):
        end = self.potential.energy_between(self.cutoff, one, other)
        end = np.where(self.cutoff < self.potential.range(), end, 0.0)
        slope = self.potential.force_between(self.cutoff, one, other)
        slope = np.where(self.cutoff < self.potential.range(), slope, 0.0)
        shifted = self.potential.energy_between(r, one, other) - end + (r - self.cutoff) * slope
        return 1.0 * np.where(r < self.range(), shifted, 0.0)

    def force(self, r):
        end = np.where(self.cutoff < self.potential.range(), self.potential.force(self.cutoff), 0.0)
        return 1.0 * np.where(r < self.range(), self.potential.force(r) - end, 0.0)

    def force_between(self, r, one, other):
        end = self.potential.force_between(self.cutoff, one, other)
        end = np.where(self.cutoff < self.potential.range(), end, 0.0)
        return 1.0 * np.where(
            r < self.range(), self.potential.force_between(r, one, other) - end, 0.0
        )

    def energy_subtracted(self, charge):
        """U and its slope at the cutoff, and what the potential itself subtracts."""
        inner = self.potential
        end = self.cutoff
        found = inner.energy_subtracted(charge)
        if end < inner.range():
            found += abs(float(inner.energy_between(end, charge, charge)))
            found += abs(float(end * inner.force_between(end, charge, charge)))
        return found


class Switched(WithCutoff):
    """U S(u): U reduced to zero between switch_from and cutoff, twice continuously differentiable.

    S = 1 - 10 u^3 + 15 u^4 - 6 u^5 with u = (r - switch_from) / (cutoff - switch_from) in [0, 1].

    Attributes
    ----------
    switch_from : float
        Distance from which U is reduced [length], positive and below the cutoff.
    """

    switch_from: float
    _limits = (*WithCutoff._limits, ("switch_from", ">", "length"))
    _at_cutoff = 2
    acts_at_all = Wrapper.acts_at_all
    acts_between = Wrapper.acts_between

    def energy(self, r):
        inverse = 1.0 / (self.cutoff - self.switch_from)  # loops over pairs compute it once
        u = np.minimum(np.maximum((r - self.switch_from) * inverse, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        return 1.0 * np.where(r < self.range(), self.potential.energy(r) * switch, 0.0)

    def energy_between(self, r, one, other):
        inverse = 1.0 / (self.cutoff - self.switch_from)  # loops over pairs compute it once
        u = np.minimum(np.maximum((r - self.switch_from) * inverse, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        return 1.0 * np.where(
            r < self.range(), self.potential.energy_between(r, one, other) * switch, 0.0
        )

    def force(self, r):
        inverse = 1.0 / (self.cutoff - self.switch_from)
        u = np.minimum(np.maximum((r - self.switch_from) * inverse, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        slope = -30.0 * inverse * u * u * (1.0 - u) * (1.0 - u)
        force = self.potential.force(r) * switch - self.potential.energy(r) * slope
        return 1.0 * np.where(r < self.range(), force, 0.0)

    def force_between(self, r, one, other):
        """The force on two charges: U' switch + U switch', with the opposite sign."""
        inverse = 1.0 / (self.cutoff - self.switch_from)
        u = np.minimum(np.maximum((r - self.switch_from) * inverse, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        slope = -30.0 * inverse * u * u * (1.0 - u) * (1.0 - u)
        force = (
            self.potential.force_between(r, one, other) * switch
            - self.potential.energy_between(r, one, other) * slope
        )
        return 1.0 * np.where(r < self.range(), force, 0.0)

    def smoothness(self):
        """Number of continuous derivatives of U at every r > 0: two at switch_from."""
        return min(2, super().smoothness())

    def smoothness_within(self):
        """Number of continuous derivatives of U below the cutoff: two at switch_from."""
        return min(2, super().smoothness_within())

    def constraints(self):
        below = f"must be below the cutoff {self.cutoff:g} [length]"
        met = self.switch_from < self.cutoff
        return (*super().constraints(), ("switch_from", met, below))


AT_CUTOFF |= {
    "switch": Switched,
    "truncate": Truncated,
    "shift": Shifted,
    "force-shift": ForceShifted,
}
