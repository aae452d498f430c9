"""Potentials between charges: bare, screened and softened."""

import numpy as np

from tribo.potentials.potential import Potential


class Charged(Potential):
    """A potential that is multiplied by the charges of both bobs."""

    def coupling(self, one, other):
        """Factor q_i q_j of the energy and the force."""
        return one * other


class Coulomb(Charged):
    """U = strength q_i q_j / r: the electric potential between two charges.

    Attributes
    ----------
    strength : float
        1 / (4 pi eps0), of either sign [energy length / charge^2]; with charges of 1, the paper's
        q Q / (4 pi eps0).

    References
    ----------
    C.-A. de Coulomb, Histoire de l'Academie Royale des Sciences (1785) 569.
    """

    strength: float
    _key = "coulomb"

    def energy(self, r):
        return self.strength / r

    def force(self, r):
        inverse = 1.0 / r  # loops over pairs compute it too
        return self.strength * inverse * inverse

    def acts_at_all(self):
        return self.strength != 0.0


class Yukawa(Charged):
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
    _key = "yukawa"

    def energy(self, r):
        return self.strength * np.exp(-self.screening * r) / r

    def force(self, r):
        inverse = 1.0 / r  # loops over pairs compute it too
        return self.strength * np.exp(-self.screening * r) * (self.screening + inverse) * inverse

    def acts_at_all(self):
        return self.strength != 0.0


class Plummer(Charged):
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
    _key = "plummer"

    def energy(self, r):
        return self.strength / np.sqrt(r * r + self.softening * self.softening)

    def force(self, r):
        square = r * r + self.softening * self.softening
        return self.strength * r / (square * np.sqrt(square))

    def acts_at_all(self):
        return self.strength != 0.0

    def feature(self):
        """Length over which the force changes near r = 0 [length]; farther out that length is r."""
        return self.softening, 0.0
