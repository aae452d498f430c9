"""Coulomb:  U = strength q_i q_j / r.

C.-A. de Coulomb, Histoire de l'Academie Royale des Sciences (1785) 569.
"""

from typing import NamedTuple


class Coulomb(NamedTuple):
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
        """U(r) between charges of 1."""
        return self.strength / r

    def force(self, r):
        """-dU/dr between charges of 1."""
        inverse = 1.0 / r  # which loops over pairs need too
        return self.strength * inverse * inverse

    def coupling(self, one, other):
        """q_i q_j, by which U and force are multiplied."""
        return one * other
