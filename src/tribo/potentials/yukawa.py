"""Yukawa:  U = strength q_i q_j exp(-screening r) / r."""

import numpy as np

from tribo.potentials.potential import Potential


class Yukawa(Potential):
    """U = strength q_i q_j exp(-screening r) / r: the potential between two screened charges.

    Attributes
    ----------
    strength : float
        Strength of the unscreened potential, of either sign [energy length / charge^2].
    screening : float
        Inverse screening length [1 / length], not negative; 0 gives Coulomb's potential.

    References
    ----------
    H. Yukawa, Proc. Phys.-Math. Soc. Jpn. 17 (1935) 48; for charges in a solution, P. Debye and
    E. Hueckel, Phys. Z. 24 (1923) 185.
    """

    strength: float
    screening: float
    _limits = (("screening", ">=", "1 / length"),)

    def energy(self, r):
        """Energy U(r) [energy] of two charges of 1 at distance r [length]."""
        return self.strength * np.exp(-self.screening * r) / r

    def force(self, r):
        """Force -dU/dr [energy / length] between charges of 1, positive if it repels."""
        inverse = 1.0 / r  # loops over pairs compute it too
        return self.strength * np.exp(-self.screening * r) * (self.screening + inverse) * inverse

    def coupling(self, one, other):
        """Factor q_i q_j of the energy and the force."""
        return one * other
