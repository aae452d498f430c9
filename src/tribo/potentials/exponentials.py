"""Exponential repulsion, alone and with an attraction."""

import numpy as np

from tribo.potentials.potential import Potential

# Distance at which a repulsion has fallen to 3e-7 of A [rho].
WEAK_FROM = 15.0


class Morse(Potential):
    """U = D (exp(-2 alpha (r - r0)) - 2 exp(-alpha (r - r0))): a minimum of depth D at r0.

    Attributes
    ----------
    D : float
        Depth of the minimum [energy], not negative.
    alpha : float
        Inverse width of the minimum [1 / length], positive.
    r0 : float
        Distance of the minimum [length].

    References
    ----------
    P. M. Morse, Phys. Rev. 34 (1929) 57.
    """

    D: float
    alpha: float
    r0: float
    _limits = (("D", ">=", "energy"), ("alpha", ">", "1 / length"))
    _key = "morse"

    def energy(self, r):
        e = np.exp(-self.alpha * (r - self.r0))
        return self.D * e * (e - 2.0)

    def force(self, r):
        e = np.exp(-self.alpha * (r - self.r0))
        return 2.0 * self.alpha * self.D * e * (e - 1.0)

    def acts_at_all(self):
        return self.D != 0.0

    def feature(self):
        return 1.0 / self.alpha, self.r0 + 6.0 / self.alpha

    def minimum(self):
        return self.r0, -self.D, 2.0 * self.D * self.alpha * self.alpha


class BornMayer(Potential):
    """U = A exp(-r/rho): the repulsion of closed shells.

    Attributes
    ----------
    A : float
        Energy at r = 0 [energy], not negative.
    rho : float
        Length over which U falls by a factor e [length], positive.

    References
    ----------
    M. Born, J. E. Mayer, Z. Phys. 75 (1932) 1.
    """

    A: float
    rho: float
    _limits = (("A", ">=", "energy"), ("rho", ">", "length"))
    _key = "born-mayer"

    def energy(self, r):
        return self.A * np.exp(-r / self.rho)

    def force(self, r):
        return self.A / self.rho * np.exp(-r / self.rho)

    def acts_at_all(self):
        return self.A != 0.0

    def feature(self):
        return self.rho, WEAK_FROM * self.rho


class Buckingham(Potential):
    """U = A exp(-r/rho) - C/r^6: repulsion of closed shells, attraction of induced dipoles.

    Attributes
    ----------
    A : float
        Energy of the repulsion at r = 0 [energy], positive.
    rho : float
        Length over which the repulsion falls by a factor e [length], positive.
    C : float
        Strength of the attraction [energy length^6], not negative.

    References
    ----------
    R. A. Buckingham, Proc. R. Soc. Lond. A 168 (1938) 264.
    """

    A: float
    rho: float
    C: float
    _limits = (("A", ">", "energy"), ("rho", ">", "length"), ("C", ">=", "energy length^6"))
    _key = "buckingham"

    def energy(self, r):
        return self.A * np.exp(-r / self.rho) - self.C / r**6

    def force(self, r):
        inverse = 1.0 / r  # loops over pairs compute it too
        return self.A / self.rho * np.exp(-r / self.rho) - 6.0 * self.C * inverse**7

    def feature(self):
        return self.rho, WEAK_FROM * self.rho

    def _stationary(self, branch):
        """r where the slope is zero: the barrier (branch 0) or the minimum (-1); nan if neither.

        Below the barrier the potential falls without limit.  The slope is zero where
        r^7 exp(-r/rho) = 6 C rho/A: at r = -7 rho W(-x) on the two real branches of Lambert's W,
        with x = (6 C/(A rho^6))^(1/7) / 7; for x > 1/e neither exists.
        """
        from scipy.special import lambertw

        x = (6.0 * self.C / (self.A * self.rho**6)) ** (1.0 / 7.0) / 7.0
        w = lambertw(-x, branch)
        return float(-7.0 * self.rho * w.real) if w.imag == 0.0 else float("nan")

    def minimum(self):
        """Position, energy and curvature (r, U, d2U/dr2) of the minimum; nan if there is none."""
        r = self._stationary(-1)
        curvature = self.A / self.rho**2 * np.exp(-r / self.rho) - 42.0 * self.C / r**8
        return r, self.energy(r), curvature

    def domain(self):
        """Smallest and largest valid r [length]: from the top of the barrier to infinity."""
        barrier = self._stationary(0)
        return (barrier if barrier > 0.0 else 0.0), float("inf")
