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

from tribo.potentials.combined import BetweenCharges, Wrapper
from tribo.potentials.potential import AT_CUTOFF


class WithCutoff(BetweenCharges, Wrapper):
    """The methods that all cutoffs share.

    Cutoffs are linear in U, so they apply to the potential between any two charges.

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

    def range(self):
        return min(self.cutoff, self.potential.range())

    def smoothness(self):
        """Number of continuous derivatives of U at every r > 0; -1 where U jumps."""
        ends = self.cutoff <= self.potential.range()
        below = self.potential.smoothness_within() if ends else self.potential.smoothness()
        return min(self._at_cutoff, below)

    def constraints(self):
        repeated = type(self.potential) in AT_CUTOFF.values()
        problem = "must be given once; the potential has another"
        return (*super().constraints(), ("cutoff", not repeated, problem))


class Truncated(WithCutoff):
    """U below the cutoff, zero beyond: U and the force jump."""

    _at_cutoff = -1  # U jumps

    def energy_between(self, r, one, other):
        return (r < self.cutoff) * self.potential.energy_between(r, one, other)

    def force_between(self, r, one, other):
        return (r < self.cutoff) * self.potential.force_between(r, one, other)


class Shifted(WithCutoff):
    """U - U(cutoff) below the cutoff, zero beyond: the force jumps."""

    _at_cutoff = 0  # the force jumps

    def energy_between(self, r, one, other):
        end = self.potential.energy_between(self.cutoff, one, other)
        return (r < self.cutoff) * (self.potential.energy_between(r, one, other) - end)

    def force_between(self, r, one, other):
        return (r < self.cutoff) * self.potential.force_between(r, one, other)


class ForceShifted(WithCutoff):
    """U - U(cutoff) + (r - cutoff) F(cutoff) below the cutoff: the force has a kink."""

    _at_cutoff = 1  # the force has a kink

    def energy_between(self, r, one, other):
        end = self.potential.energy_between(self.cutoff, one, other)
        slope = self.potential.force_between(self.cutoff, one, other)
        plain = self.potential.energy_between(r, one, other)
        return (r < self.cutoff) * (plain - end + (r - self.cutoff) * slope)

    def force_between(self, r, one, other):
        end = self.potential.force_between(self.cutoff, one, other)
        return (r < self.cutoff) * (self.potential.force_between(r, one, other) - end)


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

    def energy_between(self, r, one, other):
        inverse = 1.0 / (self.cutoff - self.switch_from)  # loops over pairs compute it once
        u = np.minimum(np.maximum((r - self.switch_from) * inverse, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        return self.potential.energy_between(r, one, other) * switch

    def force_between(self, r, one, other):
        inverse = 1.0 / (self.cutoff - self.switch_from)
        u = np.minimum(np.maximum((r - self.switch_from) * inverse, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        slope = -30.0 * inverse * u * u * (1.0 - u) * (1.0 - u)
        force = self.potential.force_between(r, one, other)
        return force * switch - self.potential.energy_between(r, one, other) * slope

    def smoothness_within(self):
        """Number of continuous derivatives of U at switch_from."""
        return min(2, self.potential.smoothness_within())

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
