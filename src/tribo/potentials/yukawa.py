"""Yukawa:  U = strength q_i q_j exp(-screening r) / r.

H. Yukawa, Proc. Phys.-Math. Soc. Jpn. 17 (1935) 48; for charges in a solution, P. Debye and
E. Hueckel, Phys. Z. 24 (1923) 185.
"""

from typing import NamedTuple

import numpy as np


class Yukawa(NamedTuple):
    """U = strength q_i q_j exp(-screening r) / r: the potential between two screened charges.

    Attributes
    ----------
    strength : float
        Strength of the unscreened potential, of either sign [energy length / charge^2].
    screening : float
        Inverse screening length [1 / length], not negative; 0 gives Coulomb's potential.

    References
    ----------
    H. Yukawa, Proc. Phys.-Math. Soc. Jpn. 17 (1935) 48.
    """

    strength: float
    screening: float

    def energy(self, r):
        """U(r) between charges of 1."""
        return self.strength * np.exp(-self.screening * r) / r

    def force(self, r):
        """-dU/dr between charges of 1."""
        inverse = 1.0 / r  # which loops over pairs need too
        return self.strength * np.exp(-self.screening * r) * (self.screening + inverse) * inverse

    def coupling(self, one, other):
        """q_i q_j, by which U and force are multiplied."""
        return one * other

    def constraints(self):
        """Each constraint: the parameter, whether it is met, and the message if not."""
        return (("screening", self.screening >= 0.0, "must not be negative [1 / length]"),)
