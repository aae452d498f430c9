"""Where asperites are at one time, with the shapes to draw, and the force between them there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.run.result import Result
from tribo.validation import InputError


@dataclass(frozen=True, eq=False)
class Pose:
    """Where an asperite is and what it measures [length, rad]; places are (2,)."""

    cm: np.ndarray  # centre of mass
    theta: float  # of the rod, from straight down
    phi: float  # of the bar
    l1: float  # from the centre of mass to the bob
    l2: float  # from the centre of mass to the bar
    bar_length: float
    facing: str = "down"
    depth: float = 0.0  # z

    @property
    def length(self) -> float:
        """Of the rod, which everything else is drawn in proportion to."""
        return self.l1 + self.l2

    @property
    def along(self) -> np.ndarray:
        """Unit vector from bar to bob."""
        return np.array([np.sin(self.theta), -np.cos(self.theta)])

    @property
    def bob(self) -> np.ndarray:
        """The bob's centre."""
        return self.cm + self.l1 * self.along

    @property
    def bar(self) -> np.ndarray:
        """The bar's centre."""
        return self.cm - self.l2 * self.along

    @property
    def ends(self) -> np.ndarray:
        """(2, 2) the bar's left and right end."""
        half = 0.5 * self.bar_length * np.array([np.cos(self.phi), np.sin(self.phi)])
        return np.array([self.bar - half, self.bar + half])

    @property
    def up(self) -> float:
        """+1 if the bar is above the bob, -1 if it is below."""
        return 1.0 if self.facing == "down" else -1.0


Poses = dict[str, list[Pose]]  # the asperites of each surface


def poses(result: Result, t: float) -> Poses:
    """All asperites at a time; between samples by the rates that were recorded with them."""
    if not result.t[0] <= t <= result.t[-1]:
        raise InputError("t", f"must be from {result.t[0]:g} to {result.t[-1]:g}, got {t}")
    return {surface.name: _surface_poses(result, surface, t) for surface in result.scene.surfaces}


def _surface_poses(result: Result, surface: Surface, t: float) -> list[Pose]:
    from scipy.interpolate import CubicHermiteSpline

    series = result[surface.name]
    rates = {"x_cm": "vx_cm", "y_cm": "vy_cm", "theta": "omega", "phi": "nu"}
    x, y, theta, phi = (
        CubicHermiteSpline(result.t, series[name], series[rate])(t) for name, rate in rates.items()
    )
    each = surface.asperite.for_each(surface.count)
    l1, l2, bar = each["l1"], each["l2"], each["bar_length"]
    z = surface.resting_bobs()[:, 2]
    return [
        Pose(np.array([x[k], y[k]]), theta[k], phi[k], l1[k], l2[k], bar[k], surface.facing, z[k])
        for k in range(surface.count)
    ]


def contact_force(result: Result, there: Poses, surface: str, asperite: int) -> np.ndarray:
    """(2,) force of all bobs of other surfaces on one."""
    scene = result.scene
    charges = {s.name: s.asperite.for_each(s.count)["charge"] for s in scene.surfaces}
    mine, charge = there[surface][asperite], charges[surface][asperite]
    force = np.zeros(2)
    for interaction in scene.interactions:
        potential = interaction.potential
        for pair in scene.pairs(interaction):
            names = [scene.surfaces[i].name for i in pair]
            for name in set(names) - {surface} if surface in names else ():
                for other, its_charge in zip(there[name], charges[name], strict=True):
                    away = separation(scene, mine, other)
                    r = float(np.linalg.norm(away))
                    if r < potential.range():
                        force += potential.force_between(r, charge, its_charge) / r * away[:2]
    return force


def separation(scene: Scene, one: Pose, other: Pose) -> np.ndarray:
    """(3,) from one bob's nearest image to another."""
    away = np.array([*(one.bob - other.bob), one.depth - other.depth])
    for axis, length in ((0, scene.periodic.x), (2, scene.periodic.z)):
        if length is not None:
            away[axis] -= length * np.round(away[axis] / length)
    return away
