"""Soft spheres:  U = epsilon (sigma/r)^n."""

from tribo.potentials.potential import Potential


class SoftSphere(Potential):
    """U = epsilon (sigma/r)^n: a repulsion by an inverse power, smooth at every r.

    Attributes
    ----------
    epsilon : float
        Energy at sigma [energy], not negative.
    sigma : float
        Length [length], positive.
    n : float
        Power, positive.

    References
    ----------
    W. G. Hoover et al., J. Chem. Phys. 52 (1970) 4931.
    """

    epsilon: float
    sigma: float
    n: float
    _limits = (("epsilon", ">=", "energy"), ("sigma", ">", "length"), ("n", ">", ""))

    def energy(self, r):
        """Energy U(r) [energy] at distance r [length]."""
        return self.epsilon * (self.sigma / r) ** self.n

    def force(self, r):
        """Force -dU/dr [energy / length], positive if it repels."""
        inverse = 1.0 / r  # loops over pairs compute it too
        return self.n * self.epsilon * (self.sigma * inverse) ** self.n * inverse

    def feature(self):
        return 2.0 * self.sigma / max(self.n, 2.0), 2.0 * self.sigma
