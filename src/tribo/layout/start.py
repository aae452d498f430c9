"""Coordinates and velocities at the start of a run."""

from collections.abc import Sequence

import numpy as np

from tribo.layout.slots import Numbering
from tribo.model.bath import Bath, thermal_start, thermal_torsional_start
from tribo.model.scene import Scene

Parts = dict[str, slice]  # surface -> its asperites


class Draws:
    """Normal deviates of several runs; `of` is 1 for oscillators of a surface, 3 for its start."""

    def __init__(self, seeds: Sequence[int], surface: int, of: int) -> None:
        self._generators = [np.random.default_rng([seed, surface, of]) for seed in seeds]

    def standard_normal(self, shape: tuple[int, ...]) -> np.ndarray:
        """The next deviates, (runs, *shape)."""
        return np.array([own.standard_normal(shape) for own in self._generators])


def start_of(asperites: np.ndarray, scene: Scene, parts: Parts, numbering: Numbering) -> np.ndarray:
    """y at t = 0; the angle and the rate of a clamped bar are in its record instead."""
    y = np.zeros(2 * numbering.coordinates)
    q, v = y[: numbering.coordinates], y[numbering.coordinates :]
    for surface in scene.surfaces:
        part = parts[surface.name]
        initial = surface.initial.for_each(surface.count)
        phi, nu = asperites["phi"][part], asperites["nu"][part]
        swing = surface.initial_swing
        q[part] = phi if swing is None else swing
        v[part] = 0.0 if initial["omega"] is None else initial["omega"]
        turning = asperites["dof_phi"][part]
        if surface.bars != "clamped":
            q[turning], v[turning] = phi, nu
        for name, values in (("x", q), ("y", q), ("vx", v), ("vy", v)):
            given = initial[name]
            if given is not None:
                values[asperites[f"dof_{name[-1]}"][part]] = given
    draw_starts(asperites, scene, parts, y[None], [scene.seed])
    start_baths(asperites, scene, parts, y[None], [scene.seed])
    return y


def draw_starts(
    asperites: np.ndarray, scene: Scene, parts: Parts, y: np.ndarray, seeds: Sequence[int]
) -> None:
    """Draw swings and rates of surfaces that start at a temperature, in y (runs, 2 coordinates).

    Energies of torsion springs and of motion have Boltzmann's distribution.
    """
    q, v = np.split(y, 2, axis=1)
    for index, surface in enumerate(scene.surfaces):
        temperature = surface.initial.temperature
        if not temperature:
            continue
        part, draws = parts[surface.name], Draws(seeds, index, 3)
        own = asperites[part]

        def drawn(inertia: np.ndarray, T: float = temperature, draws: Draws = draws) -> np.ndarray:
            return np.sqrt(T / inertia) * draws.standard_normal(np.shape(inertia))

        q[:, part] = own["phi"]
        if not surface.asperite.is_rigid:
            q[:, part] += drawn(own["kappa"])
            v[:, part] = drawn(own["inertia"] + own["mass"] * own["pivot"] ** 2)
        if surface.bars != "clamped":
            v[:, own["dof_phi"]] = drawn(own["i2"])
        if scene.slides_along_x(surface):
            mass = np.sum(own["mass"]) if surface.moves_as_one else own["mass"]
            v[:, own["dof_x"]] = drawn(mass).reshape(len(v), -1)
        if scene.slides_along_y(surface):
            v[:, own["dof_y"]] = drawn(own["mass"])


def start_baths(
    asperites: np.ndarray, scene: Scene, parts: Parts, y: np.ndarray, seeds: Sequence[int]
) -> None:
    """Start oscillators at the bars, or drawn about them at temperature T, likewise."""
    q, v = np.split(y, 2, axis=1)
    hang_baths(asperites, scene, parts, q)
    for index, surface in enumerate(scene.surfaces):
        bath, own = surface.bath, asperites[parts[surface.name]]
        if bath.temperature > 0.0:
            draws, slots = Draws(seeds, index, 1), np.concatenate(_bath_slots(own, bath), axis=1)
            dx, dy, vx, vy = thermal_start(bath, draws, own.size)
            turn, rate = thermal_torsional_start(bath, draws, own.size)
            q[:, slots] += np.concatenate([dx, dy, turn], axis=2)
            v[:, slots] = np.concatenate([vx, vy, rate], axis=2)


def _bath_slots(asperites: np.ndarray, bath: Bath) -> list[np.ndarray]:
    """Slots of the oscillators on each bar: along x, along y, and torsional, (asperites, ...)."""
    n = bath.masses.size
    slots = asperites["dof_bath"][:, None] + np.arange(2 * n + bath.inertias.size)
    return np.split(slots, [n, 2 * n], axis=1)


def hang_baths(asperites: np.ndarray, scene: Scene, parts: Parts, q: np.ndarray) -> None:
    """Put all oscillators of q, (..., coordinates), at their bars, where they exert no force."""
    for surface in scene.surfaces:
        own, swing = asperites[parts[surface.name]], q[..., parts[surface.name]]
        # Displacements of the bars from their uniform motion at rest: driven bars stay in place.
        arm = (own["l2"] - own["pivot"]) * own["facing"]
        x, y = -arm * np.sin(swing), -arm * 2.0 * np.sin(0.5 * swing) ** 2
        for bars, slots in ((x, own["dof_x"]), (y, own["dof_y"])):
            if np.all(slots >= 0):
                bars += q[..., slots]
        along_x, along_y, torsional = _bath_slots(own, surface.bath)
        q[..., along_x], q[..., along_y] = x[..., None], y[..., None]
        q[..., torsional] = q[..., own["dof_phi"], None]
