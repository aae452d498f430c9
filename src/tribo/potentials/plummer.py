"""Plummer:  U = strength q_i q_j / sqrt(r^2 + softening^2).

H. C. Plummer, Mon. Not. R. Astron. Soc. 71 (1911) 460.
"""

from typing import NamedTuple

import numpy as np


class Plummer(NamedTuple):
    """Coulomb's potential, softened so that it is finite where two charges meet."""

    strength: float  # [energy x length], with charges of 1
    softening: float  # [length]

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
        """Length over which the force changes near r = 0; farther out it is r itself."""
        return self.softening, 0.0

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        return (("softening", self.softening > 0.0, "must be positive"),)
