"""Mie (n-m):  U = c epsilon ((sigma/r)^n - (sigma/r)^m),  c = n/(n - m) (n/m)^(m/(n - m))."""

from tribo.potentials.potential import Potential


class Mie(Potential):
    """U = c epsilon ((sigma/r)^n - (sigma/r)^m) with c = n/(n - m) (n/m)^(m/(n - m)).

    n = 12 and m = 6 give Lennard-Jones.

    Attributes
    ----------
    epsilon : float
        Depth of the minimum [energy], not negative.
    sigma : float
        Distance at which U changes sign [length], positive.
    n : float
        Power of the repulsion, above m.
    m : float
        Power of the attraction, positive.

    References
    ----------
    G. Mie, Ann. Phys. (Leipzig) 316 (1903) 657.
    """

    epsilon: float
    sigma: float
    n: float
    m: float
    _limits = (("epsilon", ">=", "energy"), ("sigma", ">", "length"), ("m", ">", ""))

    def energy(self, r):
        """Energy U(r) [energy] at distance r [length]."""
        n, m, s = self.n, self.m, self.sigma / r
        return self.epsilon * n / (n - m) * (n / m) ** (m / (n - m)) * (s**n - s**m)

    def force(self, r):
        """Force -dU/dr [energy / length], positive if it repels."""
        inverse = 1.0 / r  # loops over pairs compute it too
        n, m, s = self.n, self.m, self.sigma * inverse
        scale = self.epsilon * n / (n - m) * (n / m) ** (m / (n - m))
        return scale * (n * s**n - m * s**m) * inverse

    def feature(self):
        return 2.0 * self.sigma / self.n, 2.0 * self.sigma

    def minimum(self):
        """Position, energy and curvature (r, U, d2U/dr2) of the minimum."""
        r = (self.n / self.m) ** (1.0 / (self.n - self.m)) * self.sigma
        return r, -self.epsilon, self.n * self.m * self.epsilon / (r * r)

    def constraints(self):
        return (*super().constraints(), ("n", self.n > self.m, f"must be above m = {self.m:g}"))
