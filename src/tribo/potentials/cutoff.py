"""Cutoffs: another potential's energy and force, changed together so that both end at a distance.

    Truncated     U                                     for r < cutoff: a jump in U and force
    Shifted       U - U(cutoff)                         a jump in the force
    ForceShifted  U - U(cutoff) + (r - cutoff) F(cutoff)   a kink in the force
    Switched      U S(u), u = (r - switch_from) / (cutoff - switch_from) between 0 and 1,
                  S = 1 - 10 u^3 + 15 u^4 - 6 u^5       C2: keeps methods of order 6 at order 6

M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids, Oxford 1987, section 5.2; the
polynomial is the smoothest of degree five with S = 1, 0 and S' = S'' = 0 at the ends.
"""

from typing import Any, NamedTuple

import numpy as np


class Truncated(NamedTuple):
    """U, cut off."""

    potential: Any
    cutoff: float  # [length]

    def energy(self, r):
        """U(r)."""
        return (r < self.cutoff) * self.potential.energy(r)

    def force(self, r):
        """-dU/dr."""
        return (r < self.cutoff) * self.potential.force(r)

    def coupling(self, one, other):
        """As the potential has it."""
        return self.potential.coupling(one, other)

    def feature(self):
        """As the potential has it."""
        return self.potential.feature()

    def range(self):
        """Distance from which U and force are zero."""
        return self.cutoff

    def smoothness(self):
        """At the cutoff U jumps."""
        return min(-1, self.potential.smoothness())


class Shifted(NamedTuple):
    """U - U(cutoff), cut off."""

    potential: Any
    cutoff: float  # [length]

    def energy(self, r):
        """U(r)."""
        return (r < self.cutoff) * (self.potential.energy(r) - self.potential.energy(self.cutoff))

    def force(self, r):
        """-dU/dr."""
        return (r < self.cutoff) * self.potential.force(r)

    def coupling(self, one, other):
        """As the potential has it."""
        return self.potential.coupling(one, other)

    def feature(self):
        """As the potential has it."""
        return self.potential.feature()

    def range(self):
        """Distance from which U and force are zero."""
        return self.cutoff

    def smoothness(self):
        """At the cutoff the force jumps."""
        return min(0, self.potential.smoothness())


class ForceShifted(NamedTuple):
    """Force less its value at the cutoff, and the energy that goes with it."""

    potential: Any
    cutoff: float  # [length]

    def energy(self, r):
        """U(r)."""
        end = self.potential.energy(self.cutoff)
        slope = self.potential.force(self.cutoff)
        return (r < self.cutoff) * (self.potential.energy(r) - end + (r - self.cutoff) * slope)

    def force(self, r):
        """-dU/dr."""
        return (r < self.cutoff) * (self.potential.force(r) - self.potential.force(self.cutoff))

    def coupling(self, one, other):
        """As the potential has it."""
        return self.potential.coupling(one, other)

    def feature(self):
        """As the potential has it."""
        return self.potential.feature()

    def range(self):
        """Distance from which U and force are zero."""
        return self.cutoff

    def smoothness(self):
        """At the cutoff the force has a kink."""
        return min(1, self.potential.smoothness())


class Switched(NamedTuple):
    """U, brought to zero between switch_from and cutoff with two continuous derivatives."""

    potential: Any
    cutoff: float  # [length]
    switch_from: float  # [length]

    def energy(self, r):
        """U(r)."""
        u = (r - self.switch_from) / (self.cutoff - self.switch_from)
        u = np.minimum(np.maximum(u, 0.0), 1.0)
        return self.potential.energy(r) * (1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u)))

    def force(self, r):
        """-dU/dr."""
        width = self.cutoff - self.switch_from
        u = np.minimum(np.maximum((r - self.switch_from) / width, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        slope = -30.0 * u * u * (1.0 - u) * (1.0 - u) / width
        return self.potential.force(r) * switch - self.potential.energy(r) * slope

    def coupling(self, one, other):
        """As the potential has it."""
        return self.potential.coupling(one, other)

    def feature(self):
        """As the potential has it."""
        return self.potential.feature()

    def range(self):
        """Distance from which U and force are zero."""
        return self.cutoff

    def smoothness(self):
        """How many derivatives of U are continuous at the cutoff."""
        return min(2, self.potential.smoothness())


AT_CUTOFF = {
    "switch": Switched,
    "truncate": Truncated,
    "shift": Shifted,
    "force-shift": ForceShifted,
}
