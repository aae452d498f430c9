"""Plummer:  U = strength q_i q_j / sqrt(r^2 + softening^2)."""

import numpy as np

from tribo.potentials.potential import Potential


class Plummer(Potential):
    """U = strength q_i q_j / sqrt(r^2 + softening^2): Coulomb's potential, finite at r = 0.

    Attributes
    ----------
    strength : float
        Strength at large r, of either sign [energy length / charge^2].
    softening : float
        Length below which U flattens [length], positive.

    References
    ----------
    H. C. Plummer, Mon. Not. R. Astron. Soc. 71 (1911) 460.
    """

    strength: float
    softening: float
    _limits = (("softening", ">", "length"),)

    def energy(self, r):
        """Energy U(r) [energy] of two charges of 1 at distance r [length]."""
        return self.strength / np.sqrt(r * r + self.softening * self.softening)

    def force(self, r):
        """Force -dU/dr [energy / length] between charges of 1, positive if it repels."""
        square = r * r + self.softening * self.softening
        return self.strength * r / (square * np.sqrt(square))

    def coupling(self, one, other):
        """Factor q_i q_j of the energy and the force."""
        return one * other

    def feature(self):
        """Length over which the force changes near r = 0 [length]; farther out that length is r."""
        return self.softening, 0.0
