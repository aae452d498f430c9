"""Potentials, fields and drives as a user writes them; the solver has their formulae again."""

from typing import NamedTuple

import numpy as np

import tribo


class Cap(tribo.Potential):
    """A repulsion that ends; beyond its range the formula goes on."""

    A: float
    d: float

    def energy(self, r):
        """A cubic that reaches zero at d."""
        return self.A * (1.0 - r / self.d) ** 3

    def range(self):
        """Where it ends."""
        return self.d


class Dimple(tribo.Potential):
    """An attraction without an end."""

    depth: float
    width: float

    def energy(self, r):
        """The square of a Lorentzian."""
        return -self.depth / (1.0 + (r / self.width) ** 2) ** 2


class Trap(NamedTuple):
    """A harmonic trap in the plane."""

    along: float
    across: float

    def energy_at(self, x, y):
        """Stiffer in one direction than in the other."""
        return 0.5 * self.along * x * x + 0.5 * self.across * y * y


class Shaker(NamedTuple):
    """A periodic drive with friction."""

    strength: float
    frequency: float
    damping: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """It cancels the contact force along y."""
        return self.strength * np.cos(self.frequency * t) - self.damping * vx, -fy
