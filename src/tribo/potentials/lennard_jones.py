"""Lennard-Jones:  U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6).

J. E. Jones, Proc. R. Soc. Lond. A 106 (1924) 463.
"""

from typing import NamedTuple


class LennardJones(NamedTuple):
    """The 12-6 potential of depth epsilon, zero at sigma."""

    epsilon: float  # depth of the minimum [energy]
    sigma: float  # where U changes sign [length]

    def energy(self, r):
        """U(r)."""
        s6 = (self.sigma / r) ** 6
        return 4.0 * self.epsilon * s6 * (s6 - 1.0)

    def force(self, r):
        """-dU/dr."""
        s6 = (self.sigma / r) ** 6
        return 24.0 * self.epsilon / r * s6 * (2.0 * s6 - 1.0)

    def feature(self):
        """Length over which the force changes, and distance out to which it is felt."""
        return self.sigma / 6.0, 2.0 * self.sigma
