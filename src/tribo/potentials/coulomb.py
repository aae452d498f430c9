"""Coulomb:  U = strength q_i q_j / r."""

from tribo.potentials.potential import Potential


class Coulomb(Potential):
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

    def energy(self, r):
        """Energy U(r) [energy] of two charges of 1 at distance r [length]."""
        return self.strength / r

    def force(self, r):
        """Force -dU/dr [energy / length] between charges of 1, positive if it repels."""
        inverse = 1.0 / r  # loops over pairs compute it too
        return self.strength * inverse * inverse

    def coupling(self, one, other):
        """Factor q_i q_j of the energy and the force."""
        return one * other
