"""Forces of a user's own, for benchmarks/effects.py."""

from typing import NamedTuple


class Push(NamedTuple):
    """A constant force beside that which cancels the contact."""

    push: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """The force on a bar."""
        return self.push - fx, -fy


class Hinge(NamedTuple):
    """Springs on the ends of a bar that resist its rotation."""

    stiffness: float

    def end_forces(self, t, phi, nu, twist):
        """The forces on both ends."""
        force = self.stiffness * phi
        return 0.0, force, 0.0, -force
