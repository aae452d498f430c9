"""Weeks-Chandler-Andersen:  U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) + epsilon.

It ends at r = 2^(1/6) sigma, from which U = 0.
"""

from tribo.potentials.potential import Potential

# Distance of the minimum of Lennard-Jones, where this potential ends [sigma].
END = 2.0 ** (1.0 / 6.0)


class WeeksChandlerAndersen(Potential):
    """U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) + epsilon below 2^(1/6) sigma, else 0.

    The repulsive part of Lennard-Jones, which ends where U and the force are zero.

    Attributes
    ----------
    epsilon : float
        Energy at sigma [energy], not negative.
    sigma : float
        Length of Lennard-Jones [length], positive.

    References
    ----------
    J. D. Weeks, D. Chandler, H. C. Andersen, J. Chem. Phys. 54 (1971) 5237.
    """

    epsilon: float
    sigma: float
    _limits = (("epsilon", ">=", "energy"), ("sigma", ">", "length"))

    def energy(self, r):
        """Energy U(r) [energy] at distance r [length]."""
        s6 = (self.sigma / r) ** 6
        return (r < self.range()) * (4.0 * self.epsilon * s6 * (s6 - 1.0) + self.epsilon)

    def force(self, r):
        """Force -dU/dr [energy / length], positive if it repels."""
        inverse = 1.0 / r  # loops over pairs compute it too
        s6 = (self.sigma * inverse) ** 6
        return (r < self.range()) * (24.0 * self.epsilon * inverse * s6 * (2.0 * s6 - 1.0))

    def feature(self):
        return self.sigma / 6.0, END * self.sigma

    def range(self):
        return END * self.sigma

    def smoothness(self):
        """Number of continuous derivatives of U: the force has a kink at its end."""
        return 1

    def smoothness_within(self):
        """Number of continuous derivatives of U below its end: all."""
        return float("inf")
