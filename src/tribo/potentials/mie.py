"""Mie (n-m):  U = c epsilon ((sigma/r)^n - (sigma/r)^m),  c = n/(n - m) (n/m)^(m/(n - m)).

G. Mie, Ann. Phys. (Leipzig) 316 (1903) 657.
"""

from typing import NamedTuple


class Mie(NamedTuple):
    """A potential of depth epsilon, zero at sigma; Lennard-Jones for n = 12 and m = 6."""

    epsilon: float  # depth of the minimum [energy]
    sigma: float  # where U changes sign [length]
    n: float  # power of the repulsion
    m: float  # power of the attraction

    def energy(self, r):
        """U(r)."""
        n, m, s = self.n, self.m, self.sigma / r
        return self.epsilon * n / (n - m) * (n / m) ** (m / (n - m)) * (s**n - s**m)

    def force(self, r):
        """-dU/dr."""
        n, m, s = self.n, self.m, self.sigma / r
        return self.epsilon * n / (n - m) * (n / m) ** (m / (n - m)) * (n * s**n - m * s**m) / r

    def feature(self):
        """Length over which the force changes, and distance out to which it is felt."""
        return 2.0 * self.sigma / self.n, 2.0 * self.sigma

    def minimum(self):
        """(r, U, d2U/dr2) at the minimum."""
        r = (self.n / self.m) ** (1.0 / (self.n - self.m)) * self.sigma
        return r, -self.epsilon, self.n * self.m * self.epsilon / (r * r)

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        return (
            ("epsilon", self.epsilon >= 0.0, "must not be negative"),
            ("sigma", self.sigma > 0.0, "must be positive"),
            ("m", self.m > 0.0, "must be positive"),
            ("n", self.n > self.m, f"must be above m = {self.m:g}"),
        )
