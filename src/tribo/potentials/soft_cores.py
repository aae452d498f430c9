"""Soft cores, whose energy is finite at every distance."""

import numpy as np

from tribo.potentials.potential import Potential

# Distance at which U has fallen to 3e-7 of its height [width].
WEAK_FROM = 5.5


class Gaussian(Potential):
    """U = height exp(-r^2 / (2 width^2)): a soft core of finite height, smooth at every r.

    Attributes
    ----------
    height : float
        Energy at r = 0, of either sign [energy]; a negative one attracts.
    width : float
        Standard deviation of the curve [length], positive.

    References
    ----------
    F. H. Stillinger, J. Chem. Phys. 65 (1976) 3968.
    """

    height: float
    width: float
    _limits = (("width", ">", "length"),)
    _key = "gaussian"

    def energy(self, r):
        x = r / self.width
        return self.height * np.exp(-0.5 * x * x)

    def force(self, r):
        x = r / self.width
        return self.height / self.width * x * np.exp(-0.5 * x * x)

    def acts_at_all(self):
        return self.height != 0.0

    def feature(self):
        return self.width, WEAK_FROM * self.width


class Hertz(Potential):
    """U = A (1 - r/d)^(5/2) below d, else 0: the contact of two elastic spheres.

    Two equal spheres of diameter d, Young's modulus E and Poisson's ratio nu have
    A = 2 E d^3 / (15 (1 - nu^2)).

    Attributes
    ----------
    A : float
        Energy at r = 0 [energy], not negative.
    d : float
        Distance below which the spheres touch [length], positive.

    References
    ----------
    L. D. Landau, E. M. Lifshitz, Theory of Elasticity, Pergamon 1970, section 9.
    """

    A: float
    d: float
    _limits = (("A", ">=", "energy"), ("d", ">", "length"))
    _key = "hertz"

    def energy(self, r):
        overlap = np.maximum(1.0 - r / self.d, 0.0)
        return self.A * overlap * overlap * np.sqrt(overlap)

    def force(self, r):
        overlap = np.maximum(1.0 - r / self.d, 0.0)
        return 2.5 * self.A / self.d * overlap * np.sqrt(overlap)

    def acts_at_all(self):
        return self.A != 0.0

    def feature(self):
        return 0.25 * self.d, self.d

    def range(self):
        return self.d

    def smoothness(self):
        """Number of continuous derivatives of U: at d the third is infinite."""
        return 2

    def smoothness_within(self):
        """Number of continuous derivatives of U below d: all."""
        return float("inf")
