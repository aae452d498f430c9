"""Gaussian:  U = height exp(-r^2 / (2 width^2)).

F. H. Stillinger, J. Chem. Phys. 65 (1976) 3968.
"""

from typing import NamedTuple

import numpy as np

# Distance at which U has fallen to 3e-7 of its height [width].
WEAK_FROM = 5.5


class Gaussian(NamedTuple):
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

    def energy(self, r):
        """U(r)."""
        x = r / self.width
        return self.height * np.exp(-0.5 * x * x)

    def force(self, r):
        """-dU/dr."""
        x = r / self.width
        return self.height / self.width * x * np.exp(-0.5 * x * x)

    def feature(self):
        """Length over which the force changes, and the distance beyond which it is weak."""
        return self.width, WEAK_FROM * self.width

    def smoothness(self):
        """All derivatives are continuous."""
        return float("inf")

    def range(self):
        """It is zero at no finite distance."""
        return float("inf")

    def constraints(self):
        """Each constraint: the parameter, whether it is met, and the message if not."""
        return (("width", self.width > 0.0, "must be positive [length]"),)
