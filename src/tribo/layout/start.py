"""Coordinates and velocities at the start of a run."""

from collections.abc import Sequence

import numpy as np

from tribo.layout.slots import Numbering
from tribo.model.bath import Bath, thermal_start, thermal_torsional_start
from tribo.model.scene import Scene

Parts = dict[str, slice]  # surface -> its asperites


class Draws:
    """Normal deviates of several runs, each from a generator of its own.

    `of` says what is drawn for a surface: 1 for oscillators, 3 for a start.
    """

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
    """Draw swings and rates of surfaces that start at a temperature, for runs with some seeds.

    Energies of torsion springs and of motion have Boltzmann's distribution.  `y` is
    (runs, 2 coordinates).
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
        if surface.bath.temperature > 0.0:
            draws = Draws(seeds, index, 1)
            _draw_baths(asperites[parts[surface.name]], surface.bath, q, v, draws)


def _draw_baths(
    asperites: np.ndarray, bath: Bath, q: np.ndarray, v: np.ndarray, draws: Draws
) -> None:
    """Draw the oscillators of one surface, which are at their bars."""
    n, first = bath.masses.size, asperites["dof_bath"]
    if n:
        dx, dy, vx, vy = thermal_start(bath, draws, asperites.size)
        slots = first[:, None] + np.arange(n)
        q[:, slots] += dx
        q[:, slots + n] += dy
        v[:, slots], v[:, slots + n] = vx, vy
    if bath.inertias.size:
        turn, rate = thermal_torsional_start(bath, draws, asperites.size)
        slots = first[:, None] + 2 * n + np.arange(bath.inertias.size)
        q[:, slots] += turn
        v[:, slots] = rate


def hang_baths(asperites: np.ndarray, scene: Scene, parts: Parts, q: np.ndarray) -> None:
    """Put all oscillators where they exert no force: at their bars.

    q is (coordinates,), or (runs, coordinates) of several runs.
    """
    for surface in scene.surfaces:
        own, part = asperites[parts[surface.name]], parts[surface.name]
        n, torsionals = surface.bath.masses.size, surface.bath.inertias.size
        if n:
            slots = own["dof_bath"][:, None] + np.arange(n)
            x, y = displaced_bars(own, part, q)
            q[..., slots], q[..., slots + n] = x[..., None], y[..., None]
        if torsionals:
            slots = own["dof_bath"][:, None] + 2 * n + np.arange(torsionals)
            q[..., slots] = q[..., own["dof_phi"], None]


def displaced_bars(
    asperites: np.ndarray, part: slice, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Displacements of a surface's bars from their uniform motion at rest, along x and y."""
    arm = (asperites["l2"] - asperites["pivot"]) * asperites["facing"]  # driven bars stay in place
    swing = q[..., part]
    x, y = -arm * np.sin(swing), -arm * 2.0 * np.sin(0.5 * swing) ** 2
    for bars, slots in ((x, asperites["dof_x"]), (y, asperites["dof_y"])):
        if np.all(slots >= 0):
            bars += q[..., slots]
    return x, y
