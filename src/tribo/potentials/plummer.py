"""Plummer:  U = strength q_i q_j / sqrt(r^2 + softening^2).

H. C. Plummer, Mon. Not. R. Astron. Soc. 71 (1911) 460.
"""

from typing import NamedTuple

import numpy as np


class Plummer(NamedTuple):
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

    def energy(self, r):
        """U(r) between charges of 1."""
        return self.strength / np.sqrt(r * r + self.softening * self.softening)

    def force(self, r):
        """-dU/dr between charges of 1."""
        square = r * r + self.softening * self.softening
        return self.strength * r / (square * np.sqrt(square))

    def coupling(self, one, other):
        """q_i q_j, by which U and force are multiplied."""
        return one * other

    def feature(self):
        """Length over which the force changes near r = 0; at larger r that length is r."""
        return self.softening, 0.0

    def constraints(self):
        """Each constraint: the parameter, whether it is met, and the message if not."""
        return (("softening", self.softening > 0.0, "must be positive [length]"),)
