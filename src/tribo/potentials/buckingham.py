"""Buckingham:  U = A exp(-r/rho) - C/r^6.

R. A. Buckingham, Proc. R. Soc. Lond. A 168 (1938) 264.

The slope is zero where r^7 exp(-r/rho) = 6 C rho/A: at the top of a barrier, nearer than which
the potential falls without end and means nothing, and at the minimum outside it.  Both are
r = -7 rho W(-x) with x = (6 C/(A rho^6))^(1/7) / 7, by the two real branches of Lambert's W; for
x > 1/e there is neither.
"""

from typing import NamedTuple

import numpy as np

FELT = 15.0  # distance by which the repulsion has fallen to 3e-7 of A [rho]


class Buckingham(NamedTuple):
    """The repulsion of closed shells and the attraction of induced dipoles."""

    A: float  # of the repulsion, at r = 0 [energy]
    rho: float  # length over which the repulsion falls by e [length]
    C: float  # of the attraction [energy x length^6]

    def energy(self, r):
        """U(r)."""
        return self.A * np.exp(-r / self.rho) - self.C / r**6

    def force(self, r):
        """-dU/dr."""
        return self.A / self.rho * np.exp(-r / self.rho) - 6.0 * self.C / r**7

    def feature(self):
        """Length over which the force changes, and distance out to which it is felt."""
        return self.rho, FELT * self.rho

    def _flat(self, branch):
        """Where the slope is zero: at the barrier (branch 0), at the minimum (-1); nan if not."""
        from scipy.special import lambertw

        x = (6.0 * self.C / (self.A * self.rho**6)) ** (1.0 / 7.0) / 7.0
        w = lambertw(-x, branch)
        return float(-7.0 * self.rho * w.real) if w.imag == 0.0 else float("nan")

    def minimum(self):
        """(r, U, d2U/dr2) at the minimum; not numbers where there is none."""
        r = self._flat(-1)
        curvature = self.A / self.rho**2 * np.exp(-r / self.rho) - 42.0 * self.C / r**8
        return r, self.energy(r), curvature

    def domain(self):
        """From the top of the barrier, to any distance."""
        barrier = self._flat(0)
        return (barrier if barrier > 0.0 else 0.0), float("inf")

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        return (
            ("A", self.A > 0.0, "must be positive"),
            ("rho", self.rho > 0.0, "must be positive"),
            ("C", self.C >= 0.0, "must not be negative"),
        )
