"""Cutoffs: potentials whose energy and force are zero beyond a distance.

    Truncated     U                                     for r < cutoff: a jump in U and force
    Shifted       U - U(cutoff)                         a jump in the force
    ForceShifted  U - U(cutoff) + (r - cutoff) F(cutoff)   a kink in the force
    Switched      U S(u), u = (r - switch_from) / (cutoff - switch_from) between 0 and 1,
                  S = 1 - 10 u^3 + 15 u^4 - 6 u^5       C2: keeps methods of order 6 at order 6

M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids, Oxford 1987, section 5.2; the
polynomial is the smoothest of degree five with S = 1, 0 and S' = S'' = 0 at the ends.
"""

import numpy as np

from tribo.potentials.combined import BetweenCharges, Wrapper, must_be_potential
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

    def clearance(self, r):
        """Distance that a pair at r may move before the force changes considerably."""
        return max(self.potential.clearance(r), r - self.cutoff)

    def range(self):
        """Distance from which U and the force are zero [length]."""
        return min(self.cutoff, self.potential.range())

    def constraints(self):
        """For each constraint: the parameter, whether it is met, and the message if not."""
        repeated = type(self.potential) in AT_CUTOFF.values()
        return (
            must_be_potential("potential", self.potential),
            ("cutoff", self.cutoff > 0.0, "must be positive [length]"),
            ("cutoff", not repeated, "must be given once; the potential has another"),
        )


class Truncated(WithCutoff):
    """U below the cutoff, zero beyond: U and the force jump.

    Attributes
    ----------
    potential : Potential
        The potential without a cutoff.
    cutoff : float
        Distance from which U and the force are zero [length], positive.
    """

    def energy_between(self, r, one, other):
        """Energy U(r) [energy] of two charges at distance r [length]."""
        return (r < self.cutoff) * self.potential.energy_between(r, one, other)

    def force_between(self, r, one, other):
        """Force -dU/dr [energy / length] between two charges, positive if it repels."""
        return (r < self.cutoff) * self.potential.force_between(r, one, other)

    def smoothness(self):
        """Number of continuous derivatives of U; -1, since U jumps at the cutoff."""
        return min(-1, smoothness_below(self.potential, self.cutoff))


class Shifted(WithCutoff):
    """U - U(cutoff) below the cutoff, zero beyond: the force jumps.

    Attributes
    ----------
    potential : Potential
        The potential without a cutoff.
    cutoff : float
        Distance from which U and the force are zero [length], positive.
    """

    def energy_between(self, r, one, other):
        """Energy U(r) [energy] of two charges at distance r [length]."""
        end = self.potential.energy_between(self.cutoff, one, other)
        return (r < self.cutoff) * (self.potential.energy_between(r, one, other) - end)

    def force_between(self, r, one, other):
        """Force -dU/dr [energy / length] between two charges, positive if it repels."""
        return (r < self.cutoff) * self.potential.force_between(r, one, other)

    def smoothness(self):
        """Number of continuous derivatives of U; at most 0, since the force jumps."""
        return min(0, smoothness_below(self.potential, self.cutoff))


class ForceShifted(WithCutoff):
    """U - U(cutoff) + (r - cutoff) F(cutoff) below the cutoff: the force has a kink.

    Attributes
    ----------
    potential : Potential
        The potential without a cutoff.
    cutoff : float
        Distance from which U and the force are zero [length], positive.
    """

    def energy_between(self, r, one, other):
        """Energy U(r) [energy] of two charges at distance r [length]."""
        end = self.potential.energy_between(self.cutoff, one, other)
        slope = self.potential.force_between(self.cutoff, one, other)
        plain = self.potential.energy_between(r, one, other)
        return (r < self.cutoff) * (plain - end + (r - self.cutoff) * slope)

    def force_between(self, r, one, other):
        """Force -dU/dr [energy / length] between two charges, positive if it repels."""
        end = self.potential.force_between(self.cutoff, one, other)
        return (r < self.cutoff) * (self.potential.force_between(r, one, other) - end)

    def smoothness(self):
        """Number of continuous derivatives of U; at most 1, since the force has a kink."""
        return min(1, smoothness_below(self.potential, self.cutoff))


class Switched(WithCutoff):
    """U S(u): U reduced to zero between switch_from and cutoff, twice continuously differentiable.

    S = 1 - 10 u^3 + 15 u^4 - 6 u^5 with u = (r - switch_from) / (cutoff - switch_from) in [0, 1].

    Attributes
    ----------
    potential : Potential
        The potential without a cutoff.
    cutoff : float
        Distance from which U and the force are zero [length], positive.
    switch_from : float
        Distance from which U is reduced [length], positive and below the cutoff.
    """

    switch_from: float

    def energy_between(self, r, one, other):
        """Energy U(r) [energy] of two charges at distance r [length]."""
        inverse = 1.0 / (self.cutoff - self.switch_from)  # loops over pairs compute it once
        u = np.minimum(np.maximum((r - self.switch_from) * inverse, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        return self.potential.energy_between(r, one, other) * switch

    def force_between(self, r, one, other):
        """Force -dU/dr [energy / length] between two charges, positive if it repels."""
        inverse = 1.0 / (self.cutoff - self.switch_from)
        u = np.minimum(np.maximum((r - self.switch_from) * inverse, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        slope = -30.0 * inverse * u * u * (1.0 - u) * (1.0 - u)
        force = self.potential.force_between(r, one, other)
        return force * switch - self.potential.energy_between(r, one, other) * slope

    def smoothness(self):
        """Number of continuous derivatives of U at the cutoff."""
        return min(2, smoothness_below(self.potential, self.cutoff))

    def smoothness_within(self):
        """Number of continuous derivatives of U at switch_from."""
        return min(2, self.potential.smoothness_within())

    def constraints(self):
        """For each constraint: the parameter, whether it is met, and the message if not."""
        below = f"must be below the cutoff {self.cutoff:g} [length]"
        return (
            *WithCutoff.constraints(self),
            ("switch_from", self.switch_from > 0.0, "must be positive [length]"),
            ("switch_from", self.switch_from < self.cutoff, below),
        )


def smoothness_below(potential, cutoff):
    """Number of continuous derivatives of a potential at every r < cutoff."""
    if cutoff <= potential.range():
        return potential.smoothness_within()
    return potential.smoothness()


AT_CUTOFF |= {
    "switch": Switched,
    "truncate": Truncated,
    "shift": Shifted,
    "force-shift": ForceShifted,
}
