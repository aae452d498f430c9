"""Morse:  U = D (exp(-2 alpha (r - r0)) - 2 exp(-alpha (r - r0))).

P. M. Morse, Phys. Rev. 34 (1929) 57.
"""

from typing import NamedTuple

import numpy as np


class Morse(NamedTuple):
    """A bond of depth D at distance r0."""

    D: float  # depth of the minimum [energy]
    alpha: float  # 1 / width [1 / length]
    r0: float  # place of the minimum [length]

    def energy(self, r):
        """U(r)."""
        e = np.exp(-self.alpha * (r - self.r0))
        return self.D * e * (e - 2.0)

    def force(self, r):
        """-dU/dr."""
        e = np.exp(-self.alpha * (r - self.r0))
        return 2.0 * self.alpha * self.D * e * (e - 1.0)

    def feature(self):
        """Length over which the force changes, and distance out to which it is felt."""
        return 1.0 / self.alpha, self.r0 + 6.0 / self.alpha

    def minimum(self):
        """(r, U, d2U/dr2) at the minimum."""
        return self.r0, -self.D, 2.0 * self.D * self.alpha * self.alpha

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        return (
            ("D", self.D >= 0.0, "must not be negative"),
            ("alpha", self.alpha > 0.0, "must be positive"),
        )
