"""Gaussian:  U = height exp(-r^2 / (2 width^2))."""

import numpy as np

from tribo.potentials.potential import Potential

# Distance at which U has fallen to 3e-7 of its height [width].
WEAK_FROM = 5.5


class Gaussian(Potential):
    """U = height exp(-r^2 / (2 width^2)): a soft core of finite height, smooth at every r.

    Attributes
    ----------
    height : float
        Energy at r = 0, of either sign [energy]; a negative one attracts.
    width : float
        Standard deviation of the curve [length], positive.

    References
    ----------
    F. H. Stillinger, J. Chem. Phys. 65 (1976) 3968.
    """

    height: float
    width: float
    _limits = (("width", ">", "length"),)

    def energy(self, r):
        """Energy U(r) [energy] at distance r [length]."""
        x = r / self.width
        return self.height * np.exp(-0.5 * x * x)

    def force(self, r):
        """Force -dU/dr [energy / length], positive if it repels."""
        x = r / self.width
        return self.height / self.width * x * np.exp(-0.5 * x * x)

    def feature(self):
        return self.width, WEAK_FROM * self.width
