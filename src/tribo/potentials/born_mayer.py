"""Born-Mayer:  U = A exp(-r/rho)."""

import numpy as np

from tribo.potentials.potential import Potential

# Distance at which U has fallen to 3e-7 of A [rho].
WEAK_FROM = 15.0


class BornMayer(Potential):
    """U = A exp(-r/rho): the repulsion of closed shells.

    Attributes
    ----------
    A : float
        Energy at r = 0 [energy], not negative.
    rho : float
        Length over which U falls by a factor e [length], positive.

    References
    ----------
    M. Born, J. E. Mayer, Z. Phys. 75 (1932) 1.
    """

    A: float
    rho: float
    _limits = (("A", ">=", "energy"), ("rho", ">", "length"))

    def energy(self, r):
        """Energy U(r) [energy] at distance r [length]."""
        return self.A * np.exp(-r / self.rho)

    def force(self, r):
        """Force -dU/dr [energy / length], positive if it repels."""
        return self.A / self.rho * np.exp(-r / self.rho)

    def feature(self):
        return self.rho, WEAK_FROM * self.rho
