"""Morse:  U = D (exp(-2 alpha (r - r0)) - 2 exp(-alpha (r - r0)))."""

import numpy as np

from tribo.potentials.potential import Potential


class Morse(Potential):
    """U = D (exp(-2 alpha (r - r0)) - 2 exp(-alpha (r - r0))): a minimum of depth D at r0.

    Attributes
    ----------
    D : float
        Depth of the minimum [energy], not negative.
    alpha : float
        Inverse width of the minimum [1 / length], positive.
    r0 : float
        Distance of the minimum [length].

    References
    ----------
    P. M. Morse, Phys. Rev. 34 (1929) 57.
    """

    D: float
    alpha: float
    r0: float
    _limits = (("D", ">=", "energy"), ("alpha", ">", "1 / length"))

    def energy(self, r):
        """Energy U(r) [energy] at distance r [length]."""
        e = np.exp(-self.alpha * (r - self.r0))
        return self.D * e * (e - 2.0)

    def force(self, r):
        """Force -dU/dr [energy / length], positive if it repels."""
        e = np.exp(-self.alpha * (r - self.r0))
        return 2.0 * self.alpha * self.D * e * (e - 1.0)

    def feature(self):
        return 1.0 / self.alpha, self.r0 + 6.0 / self.alpha

    def minimum(self):
        """Position, energy and curvature (r, U, d2U/dr2) of the minimum."""
        return self.r0, -self.D, 2.0 * self.D * self.alpha * self.alpha
