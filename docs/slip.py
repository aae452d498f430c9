"""A potential with an error, for the page on report cards: two digits are exchanged."""

import tribo


class Ions(tribo.Potential):
    """Coulomb's potential in eV and Angstrom."""

    charges: float  # product of the two

    def energy(self, r):
        return 14.399645 * self.charges / r

    def force(self, r):
        return 14.399654 * self.charges / r**2
