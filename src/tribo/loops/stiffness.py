"""The stiffness of forces that a run with reservoirs has met, and the steps that resolve it.

A splitting with reservoirs draws from a distribution of its own: after steps h, the kinetic
temperature of a coordinate is too high by the factor 1 / (1 - (w h / 2)^2), where w^2 is the mean
of the curvature of the potential at the temperature, over the inertia of the coordinate.  The mean
is what matters: no step resolves the hardest collision of a long run, and none has to.
"""

from typing import NamedTuple

import numpy as np

from tribo.integrators.stiffness import EVERY
from tribo.kernels import records as row
from tribo.kernels.records import OF_MEMBERS
from tribo.layout.layout import Layout
from tribo.layout.scene_records import MemberNumbers
from tribo.layout.tables import constants_of

# Largest phase w h of the stiffest motion in a step [rad]: the kinetic temperature is 1 % too high.
MOST_TURN = 0.2
# The phase at which steps are chosen: a motion may be 1.8 times as stiff before it exceeds the
# former.  The kinetic temperature is 0.6 % too high.
AIMED_TURN = 0.15
# Standard deviations of a mean over n pairs of kicks, of its logarithm times sqrt(n), by which the
# phase may exceed MOST_TURN: few pairs show a stiffness that is due to chance.
CHANCE = 2.0
# Least correlation of displacements and changes of acceleration at which a coordinate that moves
# less than it should at its temperature, such as one that starts at rest, has a frequency.
CORRELATED = 0.5
# Steps after which a run first looks at its stiffness; it does so again after each doubling.
FIRST_LOOK = 8 * EVERY


class Stiffness(NamedTuple):
    """What runs have met; each an array (members,), or numbers of one run."""

    pairs: int  # of kicks that were compared
    frequency: np.ndarray  # of the stiffest motion [rad / time]; NaN where it ran away
    curvature: np.ndarray  # largest mean curvature of a coordinate over its inertia [1 / time^2]

    def exceeds(self, step: float) -> np.ndarray:
        """Whether a step does not resolve the stiffest motion."""
        chance = 1.0 + CHANCE / np.sqrt(max(self.pairs, 1))
        return ~(np.asarray(self.frequency) * step <= MOST_TURN * chance)

    def excess(self, step: float) -> np.ndarray:
        """The part by which the kinetic temperature of a coordinate is too high, infinite at 1."""
        part = 0.25 * step * step * np.asarray(self.curvature)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(part < 1.0, part / (1.0 - part), np.inf)

    def shorter(self, step: float) -> float:
        """A step below `step` that should resolve the stiffest motion: at most half of it."""
        frequency = float(np.max(self.frequency))
        if not np.isfinite(frequency) or frequency <= 0.0:
            return 0.5 * step
        return min(0.5 * step, AIMED_TURN / frequency)


def stiffness_of(
    layout: Layout, sums: np.ndarray, steps: int, step: float, numbers: MemberNumbers | None = None
) -> Stiffness:
    """The stiffness by sums over watched kicks, (3, core) or (members, 3, core), of so many steps.

    A coordinate that moves less than at its temperature counts as if it moved so: an error that is
    below 1 % of that energy does not matter.
    """
    pairs = (steps + EVERY - 2) // EVERY
    moved, together, changed = np.moveaxis(sums, -2, 0)
    thermal = pairs * step * step * _thermal_squares(layout, numbers)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        floor = np.maximum(moved, thermal)
        squares = np.where(floor > 0.0, np.sqrt(changed / floor), 0.0)
        own = np.where(moved > 0.0, together / moved, 0.0)
        squares = np.where(together > CORRELATED * np.sqrt(changed * moved), np.maximum(own, squares), squares)
        curvature = np.where(floor > 0.0, np.abs(together) / floor, 0.0)
        frequency = np.sqrt(np.max(squares, axis=-1, initial=0.0))
    return Stiffness(pairs, frequency, np.max(curvature, axis=-1, initial=0.0))


def _thermal_squares(layout: Layout, numbers: MemberNumbers | None) -> np.ndarray:
    """Mean squares of velocities at the temperatures of reservoirs, ([members,] core).

    Surfaces without a reservoir have the highest temperature of the others.
    """
    constants = layout.constants
    own: dict[str, np.ndarray] = {name: np.asarray(layout.surfaces[name]) for name in OF_MEMBERS}
    if numbers is not None:
        constants = constants_of(layout.scene, numbers.asperites.ravel())
        constants = constants.reshape(len(constants), *numbers.asperites.shape)
        own = {name: numbers.of_surfaces[..., k] for k, name in enumerate(OF_MEMBERS)}
    bars = np.where(own["gamma"] > 0.0, own["temperature"], 0.0)
    swings = np.where(own["swing_gamma"] > 0.0, own["swing_temperature"], 0.0)
    warmest = np.maximum(bars, swings)
    highest = np.max(warmest, axis=-1, keepdims=True)
    a = layout.asperites
    temperature = np.where(warmest > 0.0, warmest, highest)[..., a.surface]
    found = np.zeros((*temperature.shape[:-1], layout.core))
    swing = np.arange(a.size)
    for slots, inertia in (
        (swing, row.INERTIA),
        (a.dof_phi, row.I2),
        (a.dof_x, row.MASS),
        (a.dof_y, row.MASS),
    ):
        present = slots >= 0
        found[..., slots[present]] = temperature[..., present] / constants[inertia][..., present]
    return found
