"""External fields, lattice springs and user forces, as kernels read them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tribo.kernels import records
from tribo.kernels.records import Custom, FieldOn
from tribo.model.fields import Corrugation, Field
from tribo.model.scene import Scene

Records = np.recarray[Any, Any]  # whose fields are read as attributes


def fields_on_surfaces(
    scene: Scene, origin: np.ndarray, accounts: int
) -> tuple[tuple[FieldOn, ...] | None, int]:
    """The external fields; each moving field has an account for the work of moving it."""
    names = [surface.name for surface in scene.surfaces]
    velocity = np.array(scene.surfaces[0].velocity)
    fields = []
    for item in scene.fields:
        drift = np.array(item.velocity)
        moves = bool(np.any(drift != 0.0))
        fields.append(
            FieldOn(
                potential=item.potential,
                surfaces=np.array([names.index(name) for name in item.on]),
                origin=_in_frame_of(item, origin),
                velocity=velocity - drift,
                drift=drift,
                anchor=np.zeros(2),
                account=accounts if moves else -1,
            )
        )
        accounts += moves
    return tuple(fields) or None, accounts


def _in_frame_of(field: Field, origin: np.ndarray) -> np.ndarray:
    """The scene's origin in the field's own frame at t = 0 (2,).

    In a corrugation whole periods are left out, so that its phase keeps all digits far from x = 0;
    fmod is exact.
    """
    if isinstance(field.potential, Corrugation):
        x, start = (math.fmod(x, field.potential.period) for x in (origin[0], field.origin[0]))
        return np.array([x - start, 0.0])
    return origin - np.array(field.origin)


def bonds(scene: Scene, parts: dict[str, slice], asperites: np.ndarray) -> Records | None:
    """All lattice springs; None without any."""
    periodic = (scene.periodic.x is not None, scene.periodic.z is not None)
    tables = []
    for surface in scene.surfaces:
        first = parts[surface.name].start
        ends, stiffness = surface.springs.bonds(surface.shape, surface.count, periodic)
        table = np.zeros(len(ends), records.BOND)
        table["i"], table["j"] = first + ends[:, 0], first + ends[:, 1]
        table["stiffness"] = stiffness
        turned = surface.springs.turned
        if turned != 0.0:
            # The distance of the resting bars, minus the same distance turned.
            bars = np.array(
                [asperites["x"], asperites["y"] + asperites["facing"] * asperites["l2"]]
            )
            x, y = bars[:, table["i"]] - bars[:, table["j"]]
            less, sin = 2.0 * np.sin(0.5 * turned) ** 2, np.sin(turned)
            table["x"], table["y"] = less * x + sin * y, less * y - sin * x
        tables.append(table)
    together = np.concatenate(tables)
    return together.view(np.recarray) if together.size else None


def user_forces(
    scene: Scene, origin: np.ndarray, place: str, kind: type
) -> tuple[Custom, ...] | None:
    """User forces at one place, "drive" or "bars", of the surfaces; None without any."""
    velocity = np.array(scene.surfaces[0].velocity)
    own = [
        Custom(getattr(surface, place).force, k, origin, velocity)
        for k, surface in enumerate(scene.surfaces)
        if isinstance(getattr(surface, place), kind)
    ]
    return tuple(own) or None
