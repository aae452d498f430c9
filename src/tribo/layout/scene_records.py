"""The asperites and the surfaces of a scene as records: one for each."""

from __future__ import annotations

import numpy as np

from tribo.kernels import records
from tribo.kernels.records import BARS, CUSTOM, FORCED, FREE, PULLED, PUSHED, RIGID
from tribo.model.drives import DrivenBars, Ends, Forced, Free, Pulled, Pushed
from tribo.model.scene import Scene
from tribo.model.surface import Surface


def scene_records(scene: Scene, parts: dict[str, slice]) -> tuple[np.ndarray, np.ndarray]:
    """The asperites and the surfaces, but for their slots."""
    asperites = np.zeros(scene.count, records.ASPERITE)
    surfaces = np.zeros(len(scene.surfaces), records.SURFACE)
    for k, surface in enumerate(scene.surfaces):
        part = parts[surface.name]
        _fill_asperites(asperites[part], scene, k)
        asperites["surface"][part] = k
        surfaces["mass"][k] = np.sum(asperites["mass"][part])
        hung = surface.count * float(np.sum(surface.bath.masses))
        surfaces["total_mass"][k] = surfaces["mass"][k] + hung
        surfaces["inverse_total_mass"][k] = 1.0 / surfaces["total_mass"][k]
        surfaces["turning"][k] = np.any(asperites["nu"][part] != 0.0)
        surfaces["tilted"][k] = surfaces["turning"][k] | np.any(asperites["phi"][part] != 0.0)
        _fill_surface(surfaces[k : k + 1], surface, scene.surfaces[0])
    return asperites, surfaces


def resting_bobs(scene: Scene, index: int) -> np.ndarray:
    """(n, 3) resting bobs of a surface, relative to the first surface's first."""
    origin = scene.surfaces[0].first_bob
    return scene.surfaces[index].resting_bobs(origin, seed=[scene.seed, index, 0])


def _fill_asperites(asperites: np.ndarray, scene: Scene, index: int) -> None:
    surface, first = scene.surfaces[index], scene.surfaces[0]
    fill_parameters(asperites, surface, surface.each, resting_bobs(scene, index))
    asperites["facing"] = surface.facing_sign
    asperites["vx"] = surface.velocity[0] - first.velocity[0]
    asperites["vy"] = surface.velocity[1] - first.velocity[1]
    initial = surface.initial.for_each(surface.count)
    for name in ("phi", "nu"):
        asperites[name] = 0.0 if initial[name] is None else initial[name]


def fill_parameters(
    asperites: np.ndarray, surface: Surface, each: dict[str, np.ndarray], bobs: np.ndarray
) -> None:
    """Fill in what follows from the parameters of asperites, as `Asperite.for_each` gives them.

    Their resting bobs are `bobs` (n, 3).
    """
    for name in ("mass", "inertia", "kappa", "l1", "l2", "i2", "bar_length"):
        asperites[name] = each[name]
    if surface.asperite.is_rigid:
        asperites["kappa"] = 0.0  # a constraint holds them, and they store no energy
    if isinstance(surface.drive, DrivenBars):
        asperites["pivot"] = each["l2"]
    asperites["x"] = bobs[:, 0]
    asperites["y"] = bobs[:, 1] + surface.facing_sign * each["l1"]


def _fill_surface(record: np.ndarray, surface: Surface, first: Surface) -> None:
    record["oscillators"] = surface.bath.masses.size
    record["torsionals"] = surface.bath.inertias.size
    record["facing"] = surface.facing_sign
    record["fixed"] = surface.asperite.is_rigid
    record["user_ends"] = isinstance(surface.bars, Ends)
    record["vx"] = surface.velocity[0] - first.velocity[0]
    record["vy"] = surface.velocity[1] - first.velocity[1]
    drive = surface.drive
    # A rigid body of one asperite is a free asperite.
    free = RIGID if surface.moves_as_one else FREE
    kinds = {Forced: FORCED, Free: free, DrivenBars: BARS, Pulled: PULLED, Pushed: PUSHED}
    record["drive"] = kinds.get(type(drive), CUSTOM)
    if isinstance(drive, Pulled):
        record["stiffness"] = drive.stiffness
        record["speed"] = drive.speed - surface.velocity[0]
    elif isinstance(drive, Pushed):
        record["loaded"] = 1
        record["push"], record["load"] = drive.force
        record["push_rate"], record["load_rate"] = drive.rate
    if drive.load is not None:
        record["loaded"] = 1
        record["load"] = -drive.load * surface.facing_sign
    for reservoir in surface.reservoirs:
        before = "swing_" if reservoir.on == "swing" else ""
        record[f"{before}gamma"] = reservoir.gamma
        record[f"{before}temperature"] = reservoir.temperature
        if reservoir.velocity is not None:
            record["reservoir_x"] = reservoir.velocity[0] - surface.velocity[0]
            record["reservoir_y"] = reservoir.velocity[1] - surface.velocity[1]
