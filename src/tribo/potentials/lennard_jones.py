"""Lennard-Jones:  U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6)."""

from tribo.potentials.potential import Potential


class LennardJones(Potential):
    """U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6): a minimum of depth epsilon, zero at sigma.

    Attributes
    ----------
    epsilon : float
        Depth of the minimum [energy], not negative.
    sigma : float
        Distance at which U changes sign [length], positive.

    References
    ----------
    J. E. Jones, Proc. R. Soc. Lond. A 106 (1924) 463.
    """

    epsilon: float
    sigma: float
    _limits = (("epsilon", ">=", "energy"), ("sigma", ">", "length"))

    def energy(self, r):
        """Energy U(r) [energy] at distance r [length]."""
        s6 = (self.sigma * (1.0 / r)) ** 6  # as below, so that both are computed once
        return 4.0 * self.epsilon * s6 * (s6 - 1.0)

    def force(self, r):
        """Force -dU/dr [energy / length], positive if it repels."""
        inverse = 1.0 / r  # loops over pairs compute it too
        s6 = (self.sigma * inverse) ** 6
        return 24.0 * self.epsilon * inverse * s6 * (2.0 * s6 - 1.0)

    def feature(self):
        return self.sigma / 6.0, 2.0 * self.sigma

    def minimum(self):
        """Position, energy and curvature (r, U, d2U/dr2) of the minimum."""
        r = 2.0 ** (1.0 / 6.0) * self.sigma
        return r, -self.epsilon, 72.0 * self.epsilon / (r * r)
