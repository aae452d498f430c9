"""Yukawa:  U = strength q_i q_j exp(-screening r) / r.

H. Yukawa, Proc. Phys.-Math. Soc. Jpn. 17 (1935) 48; for charges in a solution, P. Debye and
E. Hueckel, Phys. Z. 24 (1923) 185.
"""

from typing import NamedTuple

import numpy as np


class Yukawa(NamedTuple):
    """The electric potential between two charges that others screen; without, it is Coulomb's."""

    strength: float  # [energy x length], with charges of 1
    screening: float  # [1 / length]

    def energy(self, r):
        """U(r) between charges of 1."""
        return self.strength * np.exp(-self.screening * r) / r

    def force(self, r):
        """-dU/dr between charges of 1."""
        return self.strength * np.exp(-self.screening * r) * (self.screening + 1.0 / r) / r

    def coupling(self, one, other):
        """q_i q_j, by which U and force are multiplied."""
        return one * other

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        return (("screening", self.screening >= 0.0, "must not be negative"),)
