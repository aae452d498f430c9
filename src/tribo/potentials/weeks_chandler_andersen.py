"""Weeks-Chandler-Andersen:  U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) + epsilon.

It ends at r = 2^(1/6) sigma, from which U = 0.

J. D. Weeks, D. Chandler, H. C. Andersen, J. Chem. Phys. 54 (1971) 5237.
"""

from typing import NamedTuple

# Distance of the minimum of Lennard-Jones, where this potential ends [sigma].
END = 2.0 ** (1.0 / 6.0)


class WeeksChandlerAndersen(NamedTuple):
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

    def energy(self, r):
        """U(r)."""
        s6 = (self.sigma / r) ** 6
        return (r < self.range()) * (4.0 * self.epsilon * s6 * (s6 - 1.0) + self.epsilon)

    def force(self, r):
        """-dU/dr."""
        inverse = 1.0 / r  # which loops over pairs need too
        s6 = (self.sigma * inverse) ** 6
        return (r < self.range()) * (24.0 * self.epsilon * inverse * s6 * (2.0 * s6 - 1.0))

    def feature(self):
        """Length over which the force changes, and the distance beyond which it is weak."""
        return self.sigma / 6.0, END * self.sigma

    def range(self):
        """Distance from which U and force are zero."""
        return END * self.sigma

    def smoothness(self):
        """At its end the force has a kink."""
        return 1

    def smoothness_within(self):
        """Below its end it is as smooth as Lennard-Jones."""
        return float("inf")

    def constraints(self):
        """Each constraint: the parameter, whether it is met, and the message if not."""
        return (
            ("epsilon", self.epsilon >= 0.0, "must not be negative [energy]"),
            ("sigma", self.sigma > 0.0, "must be positive [length]"),
        )
