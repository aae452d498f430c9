"""The stiffness of forces that a run with reservoirs has met, and the steps that resolve it.

A splitting with reservoirs draws from a distribution of its own: after steps h, the kinetic
temperature of a coordinate is too high by the factor 1 / (1 - (w h / 2)^2), where w^2 is the mean
of the curvature of the potential at the temperature, over the inertia of the coordinate.  The mean
is what matters: no step resolves the hardest collision of a long run, and none has to.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tribo.integrators.stiffness import EVERY
from tribo.kernels import records as row
from tribo.kernels.records import OF_MEMBERS
from tribo.layout.layout import Layout, once_per_layout
from tribo.layout.legs import begun_of
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
# Schedules of temperatures, and the numbers of surfaces that they replace.
TEMPERATURES = {"heat": "temperature", "swing_heat": "swing_temperature"}
# Steps after which a run first looks at its stiffness; it does so again after each doubling.
FIRST_LOOK = 8 * EVERY


class Stiffness(NamedTuple):
    """What runs have met; each an array (members,), or numbers of one run."""

    pairs: int  # of kicks that were compared
    frequency: np.ndarray  # of the stiffest motion [rad / time]; NaN where it ran away
    # Largest mean curvature over the inertia, of one kind of coordinates of a surface [1 / time^2].
    curvature: np.ndarray

    def of_members(self, selected: np.ndarray) -> Stiffness:
        """That of some members, by their indices or a mask."""
        return Stiffness(self.pairs, self.frequency[selected], self.curvature[selected])

    def together(self) -> Stiffness:
        """That of members as one."""
        frequency = np.sqrt(np.mean(self.frequency**2))
        return Stiffness(self.pairs * self.frequency.size, frequency, np.mean(self.curvature))

    def exceeds(self, step: float) -> np.ndarray:
        """Whether a step does not resolve the stiffest motion."""
        chance = 1.0 + CHANCE / np.sqrt(max(self.pairs, 1))
        return ~(np.asarray(self.frequency) * step <= MOST_TURN * chance)

    def excess(self, step: float) -> np.ndarray:
        """The part by which the kinetic temperature is too high; infinite where it has no bound."""
        part = 0.25 * step * step * np.asarray(self.curvature)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(part < 1.0, part / (1.0 - part), np.inf)

    def shorter(self, step: float) -> float:
        """A step below `step` that should resolve the stiffest motion: at most half of it."""
        frequency = float(np.max(self.frequency))
        if not np.isfinite(frequency) or frequency <= 0.0:
            return 0.5 * step
        return min(0.5 * step, AIMED_TURN / frequency)


class ThermalMotion(NamedTuple):
    """Inertias of coordinates and the squares of their rates at the temperature, per coordinate."""

    inertias: np.ndarray  # ([members,] core)
    squares: np.ndarray  # ([members,] core) [rad^2 or length^2 / time^2]


def stiffness_of(
    layout: Layout, sums: np.ndarray, steps: int, step: float, numbers: MemberNumbers | None = None
) -> Stiffness:
    """The stiffness by sums over watched kicks, (3, core) or (members, 3, core), of so many steps.

    A coordinate that moves less than at its temperature counts as if it moved so: an error that is
    below 1 % of that energy does not matter.
    """
    pairs = (steps + EVERY - 2) // EVERY
    moved, together, changed = np.moveaxis(sums, -2, 0)
    thermal = _thermal_motion(layout) if numbers is None else _thermal_motion_of(layout, numbers)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        floor = np.maximum(moved, pairs * step * step * thermal.squares)
        squares = np.where(floor > 0.0, np.sqrt(changed / floor), 0.0)
        own = np.where(moved > 0.0, together / moved, 0.0)
        is_own = together > CORRELATED * np.sqrt(changed * moved)
        squares = np.where(is_own, np.maximum(own, squares), squares)
        frequency = np.sqrt(np.max(squares, axis=-1, initial=0.0))
        finite = np.isfinite(thermal.inertias)
        weights = np.where(finite, thermal.inertias, 0.0)
        curvature = np.zeros(frequency.shape)
        for alike in _alike(layout):
            total = np.sum(weights[..., alike] * floor[..., alike], axis=-1)
            mean = np.sum(weights[..., alike] * together[..., alike], axis=-1) / total
            curvature = np.maximum(curvature, np.where(total > 0.0, mean, 0.0))
    return Stiffness(pairs, frequency, curvature)


@once_per_layout
def _thermal_motion(layout: Layout) -> ThermalMotion:
    """That of all members that have the numbers of the scene."""
    return _thermal_motion_of(layout, None)


def _thermal_motion_of(layout: Layout, numbers: MemberNumbers | None) -> ThermalMotion:
    """That of members with numbers of their own, or of the scene's without them."""
    temperature, constants = _of_members(layout, numbers)
    shape = (*temperature.shape[:-1], layout.core)
    inertias = np.zeros(shape)
    squares = np.zeros(shape)
    for slots, present, inertia in _kinds(layout):
        inertias[..., slots] = constants[inertia][..., present]
        if inertia == row.MASS:
            inertias[..., slots] *= _moved_with(layout)[present]
        squares[..., slots] = temperature[..., present] / inertias[..., slots]
    return ThermalMotion(inertias, squares)


@once_per_layout
def _alike(layout: Layout) -> list[np.ndarray]:
    """The slots of the coordinates of one kind of one surface, for each kind and surface."""
    found = []
    for slots, present, _ in _kinds(layout):
        owners = layout.asperites.surface[present]
        found += [slots[owners == surface] for surface in np.unique(owners)]
    return found


@once_per_layout
def _kinds(layout: Layout) -> list[tuple[np.ndarray, np.ndarray, int]]:
    """Slots of coordinates of one kind, the asperites that have them, and rows of their inertia."""
    a = layout.asperites
    each = (
        (np.arange(a.size), row.INERTIA),
        (a.dof_phi, row.I2),
        (a.dof_x, row.MASS),
        (a.dof_y, row.MASS),
    )
    return [(slots[slots >= 0], np.flatnonzero(slots >= 0), inertia) for slots, inertia in each]


def _moved_with(layout: Layout) -> np.ndarray:
    """The mass that moves with each asperite, in units of its own: that of its block."""
    a = layout.asperites
    whole = layout.surfaces.mass[a.surface] / a.mass
    return np.where(layout.surfaces.block[a.surface] > 0, whole, 1.0)


def _of_members(layout: Layout, numbers: MemberNumbers | None) -> tuple[np.ndarray, np.ndarray]:
    """Temperature of the reservoir and constants of asperites, ([rows,] [members,] asperites).

    Surfaces without a reservoir have the highest temperature of the others.
    """
    constants = layout.constants
    own: dict[str, np.ndarray] = {name: np.asarray(layout.surfaces[name]) for name in OF_MEMBERS}
    if numbers is not None:
        constants = constants_of(layout.scene, numbers.asperites.ravel())
        constants = constants.reshape(len(constants), *numbers.asperites.shape)
        own = {name: numbers.of_surfaces[..., k] for k, name in enumerate(OF_MEMBERS)}
    own |= _mean_temperatures(layout, own)
    bars = np.where(own["gamma"] > 0.0, own["temperature"], 0.0)
    swings = np.where(own["swing_gamma"] > 0.0, own["swing_temperature"], 0.0)
    warmest = np.maximum(bars, swings)
    highest = np.max(warmest, axis=-1, keepdims=True)
    each = np.where(warmest > 0.0, warmest, highest)[..., layout.asperites.surface]
    for surface in layout.scene.surfaces:
        if not all(reservoir.is_uniform for reservoir in surface.reservoirs):
            own_of_each = np.zeros(surface.count)
            for reservoir in surface.reservoirs:
                gamma, heat = reservoir.for_each(surface.count)
                own_of_each = np.maximum(own_of_each, np.where(gamma > 0.0, heat, 0.0))
            # Those without a reservoir have the lowest of the others: between two, heat flows.
            warm = own_of_each[own_of_each > 0.0]
            lowest = np.min(warm, initial=np.inf) if warm.size else 0.0
            part = layout.parts[surface.name]
            each[..., part] = np.where(own_of_each > 0.0, own_of_each, lowest)
    return each, constants


def _mean_temperatures(layout: Layout, own: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Temperatures of reservoirs, of which those that follow schedules are means over the run."""
    found: dict[str, np.ndarray] = {}
    for each in layout.scheduled:
        if each.name in TEMPERATURES:
            name = TEMPERATURES[each.name]
            ends = np.array([layout.beginning, layout.scene.duration])
            ends = ends - begun_of(each, layout.begun)
            mean = np.diff(each.schedule.integral(ends)) / np.diff(ends)
            found.setdefault(name, own[name].copy())[..., each.surface] = mean
    return found
