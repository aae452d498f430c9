"""Systems of units for scenes: what one unit of each quantity is in SI.

A scene has no units built in: lengths, masses and times are in any units, and all others follow.
Constants are those of scipy.constants (CODATA).
"""

import math
from typing import NamedTuple

from scipy import constants

__all__ = ["AG_NM_NS", "ASE", "SI", "Units", "from_energy"]


class Units(NamedTuple):
    """Three units in SI, from which all others follow.

    Multiply a number of a scene or a result by a unit to convert it to SI, divide to convert it
    back.

    Attributes
    ----------
    length : float
        Unit of length [m].
    mass : float
        Unit of mass [kg].
    time : float
        Unit of time [s].

    Examples
    --------
    >>> from tribo import units
    >>> round(units.AG_NM_NS.kT(300.0), 3)
    4.142
    """

    length: float
    mass: float
    time: float

    @property
    def velocity(self) -> float:
        """Unit of velocity [m / s]."""
        return self.length / self.time

    @property
    def energy(self) -> float:
        """Unit of energy and of torque [J]."""
        return self.mass * self.velocity**2

    @property
    def force(self) -> float:
        """Unit of force [N]."""
        return self.energy / self.length

    @property
    def stiffness(self) -> float:
        """Unit of the stiffness of springs [N / m]."""
        return self.force / self.length

    @property
    def damping(self) -> float:
        """Unit of force per velocity [kg / s]."""
        return self.mass / self.time

    def kT(self, kelvin: float) -> float:  # noqa: N802  (as it is written in equations)
        """Boltzmann's constant times a temperature [K]: that of a scene [energy of these units]."""
        return constants.k * kelvin / self.energy


def from_energy(length: float, mass: float, energy: float) -> Units:
    """Units that are given by an energy: the unit of time follows from it.

    Parameters
    ----------
    length, mass, energy : float
        Units of length [m], of mass [kg] and of energy [J], as sigma and epsilon of a
        Lennard-Jones potential.
    """
    return Units(length, mass, length * math.sqrt(mass / energy))


SI = Units(1.0, 1.0, 1.0)
# Attogram, nanometre and nanosecond: forces in pN, stiffnesses in mN / m.
AG_NM_NS = Units(1e-9, 1e-21, 1e-9)
# Those of ASE: angstrom, atomic mass unit and electronvolt; a unit of time is 10.18 fs.
ASE = from_energy(constants.angstrom, constants.atomic_mass, constants.electron_volt)
