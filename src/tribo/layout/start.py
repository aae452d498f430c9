"""Coordinates and velocities at the start of a run."""

from collections.abc import Sequence

import numpy as np

from tribo.kernels.kinematics import versine
from tribo.layout.slots import Numbering
from tribo.model.bath import Bath
from tribo.model.scene import Scene


class Draws:
    """Normal deviates of several runs; `of` is 1 for oscillators of a surface, 3 for its start."""

    def __init__(self, seeds: Sequence[int], surface: int, of: int) -> None:
        self._generators = [np.random.default_rng([seed, surface, of]) for seed in seeds]

    def standard_normal(self, shape: tuple[int, ...]) -> np.ndarray:
        """The next deviates, (runs, *shape)."""
        return np.array([own.standard_normal(shape) for own in self._generators])


def start_of(asperites: np.ndarray, scene: Scene, numbering: Numbering) -> np.ndarray:
    """y at t = 0; the angle and the rate of a clamped bar are in its record instead."""
    y = np.zeros(2 * numbering.coordinates)
    q, v = halves(y)
    for surface, part in zip(scene.surfaces, scene.parts.values(), strict=True):
        own = asperites[part]
        initial = surface.initial_of_each
        swing = surface.initial_swing
        q[part] = initial["phi"] if swing is None else swing
        v[part] = initial["omega"]
        if surface.tilts and surface.asperite.is_rigid:  # rods turn with their bars
            v[part] = initial["nu"]
        for name, rate in (("phi", "nu"), ("x", "vx"), ("y", "vy")):
            slots = own[f"dof_{name}"]
            if slots[0] >= 0:
                q[slots] = initial[name]
                v[slots] = initial[rate]
    draw_starts(asperites, scene, y[None], [scene.seed])
    start_baths(asperites, scene, y[None], [scene.seed])
    return y


def halves(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Views of the coordinates and of their rates in y, (..., 2 coordinates)."""
    coordinates = y.shape[-1] // 2
    return y[..., :coordinates], y[..., coordinates:]


def draw_starts(asperites: np.ndarray, scene: Scene, y: np.ndarray, seeds: Sequence[int]) -> None:
    """Draw swings and rates of surfaces that start at a temperature, in y (runs, 2 coordinates).

    Energies of torsion springs and of motion have Boltzmann's distribution.
    """
    q, v = halves(y)
    for index, surface in enumerate(scene.surfaces):
        temperature = surface.initial.temperature
        if not temperature:
            continue
        part = scene.parts[surface.name]
        draws = Draws(seeds, index, 3)
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
            as_one = surface.moves_as_one or surface.is_rigid_block
            mass = np.sum(own["mass"]) if as_one else own["mass"]
            v[:, own["dof_x"]] = drawn(mass).reshape(len(v), -1)
        if scene.slides_along_y(surface):
            mass = np.sum(own["mass"]) if surface.is_rigid_block else own["mass"]
            v[:, own["dof_y"]] = drawn(mass).reshape(len(v), -1)


def start_baths(asperites: np.ndarray, scene: Scene, y: np.ndarray, seeds: Sequence[int]) -> None:
    """Start oscillators at the bars, or drawn about them at a temperature T, likewise.

    Their variances are T / (m w^2) of displacements, in each direction, and T / m of velocities;
    those of torsional ones have the moment of inertia in place of the mass m.
    """
    q, v = halves(y)
    hang_baths(asperites, scene, q)
    for index, surface in enumerate(scene.surfaces):
        bath = surface.bath
        if bath.temperature == 0.0:
            continue
        draws = Draws(seeds, index, 1)
        *linear, torsional = bath_slots(asperites[scene.parts[surface.name]], bath)
        for masses, frequencies, directions in (
            (bath.masses, bath.frequencies, linear),
            (bath.inertias, bath.torsional_frequencies, [torsional]),
        ):
            speed = np.sqrt(bath.temperature / masses)
            for slots in directions:
                q[:, slots] += speed / frequencies * draws.standard_normal(slots.shape)
            for slots in directions:
                v[:, slots] = speed * draws.standard_normal(slots.shape)


def bath_slots(asperites: np.ndarray, bath: Bath) -> list[np.ndarray]:
    """Slots of the oscillators on each bar: along x, along y, and torsional, (asperites, ...)."""
    n = bath.masses.size
    slots = asperites["dof_bath"][:, None] + np.arange(2 * n + bath.inertias.size)
    return [slots[:, :n], slots[:, n : 2 * n], slots[:, 2 * n :]]


def hang_baths(asperites: np.ndarray, scene: Scene, q: np.ndarray) -> None:
    """Put all oscillators of q, (..., coordinates), at their bars, where they exert no force."""
    for surface, part in zip(scene.surfaces, scene.parts.values(), strict=True):
        own = asperites[part]
        swing = q[..., part]
        # Displacements of the bars from their uniform motion at rest: driven bars stay in place.
        arm = (own["l2"] - own["pivot"]) * own["facing"]
        x = -arm * np.sin(swing)
        y = -arm * versine(swing)
        for bars, slots in ((x, own["dof_x"]), (y, own["dof_y"])):
            if (slots >= 0).all():
                bars += q[..., slots]
        along_x, along_y, torsional = bath_slots(own, surface.bath)
        q[..., along_x] = x[..., None]
        q[..., along_y] = y[..., None]
        q[..., torsional] = q[..., own["dof_phi"], None]
