"""Weeks-Chandler-Andersen:  U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) + epsilon.

It ends at r = 2^(1/6) sigma, from which U = 0.

J. D. Weeks, D. Chandler, H. C. Andersen, J. Chem. Phys. 54 (1971) 5237.
"""

from typing import NamedTuple

END = 2.0 ** (1.0 / 6.0)  # where Lennard-Jones has its minimum [sigma]


class WeeksChandlerAndersen(NamedTuple):
    """The repulsive part of Lennard-Jones: a core that ends where U and force are zero."""

    epsilon: float  # U at sigma [energy]
    sigma: float  # [length]

    def energy(self, r):
        """U(r)."""
        s6 = (self.sigma / r) ** 6
        return (r < self.range()) * (4.0 * self.epsilon * s6 * (s6 - 1.0) + self.epsilon)

    def force(self, r):
        """-dU/dr."""
        s6 = (self.sigma / r) ** 6
        return (r < self.range()) * (24.0 * self.epsilon / r * s6 * (2.0 * s6 - 1.0))

    def feature(self):
        """Length over which the force changes, and distance out to which it is felt."""
        return self.sigma / 6.0, END * self.sigma

    def range(self):
        """Distance from which U and force are zero."""
        return END * self.sigma

    def smoothness(self):
        """At its end the force has a kink."""
        return 1

    def smoothness_within(self):
        """Nearer than its end it is as smooth as Lennard-Jones."""
        return float("inf")

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        return (
            ("epsilon", self.epsilon >= 0.0, "must not be negative"),
            ("sigma", self.sigma > 0.0, "must be positive"),
        )
