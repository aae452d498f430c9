"""Born-Mayer:  U = A exp(-r/rho).

M. Born, J. E. Mayer, Z. Phys. 75 (1932) 1.
"""

from typing import NamedTuple

import numpy as np

FELT = 15.0  # distance by which U has fallen to 3e-7 of A [rho]


class BornMayer(NamedTuple):
    """The repulsion of closed shells."""

    A: float  # U at r = 0 [energy]
    rho: float  # length over which U falls by e [length]

    def energy(self, r):
        """U(r)."""
        return self.A * np.exp(-r / self.rho)

    def force(self, r):
        """-dU/dr."""
        return self.A / self.rho * np.exp(-r / self.rho)

    def feature(self):
        """Length over which the force changes, and distance out to which it is felt."""
        return self.rho, FELT * self.rho

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        return (
            ("A", self.A >= 0.0, "must not be negative"),
            ("rho", self.rho > 0.0, "must be positive"),
        )
