"""Cutoffs: another potential's energy and force, changed together so that both end at a distance.

    Truncated     U                                     for r < cutoff: a jump in U and force
    Shifted       U - U(cutoff)                         a jump in the force
    ForceShifted  U - U(cutoff) + (r - cutoff) F(cutoff)   a kink in the force
    Switched      U S(u), u = (r - switch_from) / (cutoff - switch_from) between 0 and 1,
                  S = 1 - 10 u^3 + 15 u^4 - 6 u^5       C2: keeps methods of order 6 at order 6

M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids, Oxford 1987, section 5.2; the
polynomial is the smoothest of degree five with S = 1, 0 and S' = S'' = 0 at the ends.
"""

from typing import Any, NamedTuple

import numpy as np

from tribo.potentials.mixins import OfAnother, OfCharges, inherits, must_be_potential

# All four are linear in U, so they act on what a potential is between any two charges.


class Ended(OfCharges, OfAnother):
    """What all four have in common."""

    cutoff: float

    def clearance(self, r):
        """How far a pair may move before the force is another."""
        return max(self.potential.clearance(r), r - self.cutoff)

    def range(self):
        """Distance from which U and force are zero."""
        return min(self.cutoff, self.potential.range())

    def demands(self: Any) -> Any:
        """Each parameter's name, whether it will do, and what would."""
        again = type(self.potential) in AT_CUTOFF.values()
        return (
            must_be_potential("potential", self.potential),
            ("cutoff", self.cutoff > 0.0, "must be positive"),
            ("cutoff", not again, "must be given once; the potential has one already"),
        )


@inherits(Ended)
class Truncated(NamedTuple):
    """U, cut off."""

    potential: Any
    cutoff: float  # [length]

    def energy_between(self, r, one, other):
        """U(r) between two charges."""
        return (r < self.cutoff) * self.potential.energy_between(r, one, other)

    def force_between(self, r, one, other):
        """-dU/dr between two charges."""
        return (r < self.cutoff) * self.potential.force_between(r, one, other)

    def smoothness(self):
        """At the cutoff U jumps."""
        return min(-1, smoothness_below(self.potential, self.cutoff))


@inherits(Ended)
class Shifted(NamedTuple):
    """U - U(cutoff), cut off."""

    potential: Any
    cutoff: float  # [length]

    def energy_between(self, r, one, other):
        """U(r) between two charges."""
        end = self.potential.energy_between(self.cutoff, one, other)
        return (r < self.cutoff) * (self.potential.energy_between(r, one, other) - end)

    def force_between(self, r, one, other):
        """-dU/dr between two charges."""
        return (r < self.cutoff) * self.potential.force_between(r, one, other)

    def smoothness(self):
        """At the cutoff the force jumps."""
        return min(0, smoothness_below(self.potential, self.cutoff))


@inherits(Ended)
class ForceShifted(NamedTuple):
    """Force less its value at the cutoff, and the energy that goes with it."""

    potential: Any
    cutoff: float  # [length]

    def energy_between(self, r, one, other):
        """U(r) between two charges."""
        end = self.potential.energy_between(self.cutoff, one, other)
        slope = self.potential.force_between(self.cutoff, one, other)
        plain = self.potential.energy_between(r, one, other)
        return (r < self.cutoff) * (plain - end + (r - self.cutoff) * slope)

    def force_between(self, r, one, other):
        """-dU/dr between two charges."""
        end = self.potential.force_between(self.cutoff, one, other)
        return (r < self.cutoff) * (self.potential.force_between(r, one, other) - end)

    def smoothness(self):
        """At the cutoff the force has a kink."""
        return min(1, smoothness_below(self.potential, self.cutoff))


@inherits(Ended)
class Switched(NamedTuple):
    """U, brought to zero between switch_from and cutoff with two continuous derivatives."""

    potential: Any
    cutoff: float  # [length]
    switch_from: float  # [length]

    def energy_between(self, r, one, other):
        """U(r) between two charges."""
        u = (r - self.switch_from) / (self.cutoff - self.switch_from)
        u = np.minimum(np.maximum(u, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        return self.potential.energy_between(r, one, other) * switch

    def force_between(self, r, one, other):
        """-dU/dr between two charges."""
        width = self.cutoff - self.switch_from
        u = np.minimum(np.maximum((r - self.switch_from) / width, 0.0), 1.0)
        switch = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u))
        slope = -30.0 * u * u * (1.0 - u) * (1.0 - u) / width
        force = self.potential.force_between(r, one, other)
        return force * switch - self.potential.energy_between(r, one, other) * slope

    def smoothness(self):
        """How many derivatives of U are continuous at the cutoff."""
        return min(2, smoothness_below(self.potential, self.cutoff))

    def smoothness_within(self):
        """How many derivatives of U are continuous where the switch begins."""
        return min(2, self.potential.smoothness_within())

    def demands(self):
        """Each parameter's name, whether it will do, and what would."""
        below = f"must be below the cutoff {self.cutoff:g}"
        return (
            *Ended.demands(self),
            ("switch_from", self.switch_from > 0.0, "must be positive"),
            ("switch_from", self.switch_from < self.cutoff, below),
        )


def smoothness_below(potential, cutoff):
    """How many derivatives of a potential are continuous at every r < cutoff."""
    if cutoff <= potential.range():
        return potential.smoothness_within()
    return potential.smoothness()


AT_CUTOFF: dict[str, Any] = {
    "switch": Switched,
    "truncate": Truncated,
    "shift": Shifted,
    "force-shift": ForceShifted,
}
