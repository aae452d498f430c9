"""From a scene to the flat arrays of the kernels, and what each slot of them means."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tribo.drives import Forced, Free, Pulled
from tribo.kernels.powers import CONTACT, DRIVE, ENDS, SLIDE
from tribo.kernels.records import (
    ASPERITE,
    BOB,
    FORCED,
    FREE,
    PULLED,
    RIGID,
    SURFACE,
    Contact,
    Model,
)
from tribo.scene import Scene
from tribo.surface import Surface


@dataclass(frozen=True, eq=False)
class Layout:
    """A scene laid out for the kernels.

    y = (q, v) has the swings of all asperites first, then phi, x and y of those that are free
    to change; s has the accounts.  Slots of -1 are absent.
    """

    scene: Scene
    model: Model
    start: np.ndarray  # y at t = 0
    coordinates: int  # in q
    accounts: int  # in s
    velocity: np.ndarray  # (n, 2) initial velocity of each asperite's surface, in the laboratory
    origin: np.ndarray  # (2,) the place that positions are relative to
    parts: dict[str, slice]  # the asperites of each surface


def laid_out(scene: Scene) -> Layout:
    """Flat arrays for the kernels: only what the scene calls for has a slot."""
    counts = [surface.count for surface in scene.surfaces]
    stops = np.cumsum(counts)
    parts = {
        surface.name: slice(stop - surface.count, stop)
        for surface, stop in zip(scene.surfaces, stops.tolist(), strict=True)
    }
    asperites = np.zeros(scene.count, ASPERITE)
    surfaces = np.zeros(len(scene.surfaces), SURFACE)
    for k, surface in enumerate(scene.surfaces):
        part = parts[surface.name]
        _fill_asperites(asperites[part], surface, scene)
        asperites["surface"][part] = k
        surfaces["start"][k], surfaces["stop"][k] = part.start, part.stop
        surfaces["mass"][k] = np.sum(asperites["mass"][part])
        _fill_surface(surfaces[k : k + 1], surface)
    coordinates = _give_coordinates(asperites, surfaces, scene)
    accounts = _give_accounts(asperites, surfaces)

    bobs = np.zeros(scene.count, BOB)
    bobs["z"] = asperites["z"]
    bobs["charge"] = asperites["charge"]
    model = Model(
        asperites.view(np.recarray),
        surfaces.view(np.recarray),
        tuple(
            Contact(i.potential, np.array(scene.pairs(i), dtype=np.int64).reshape(-1, 2))
            for i in scene.interactions
        ),
        bobs.view(np.recarray),
    )
    return Layout(
        scene=scene,
        model=model,
        start=_start(asperites, scene, parts, coordinates),
        coordinates=coordinates,
        accounts=accounts,
        velocity=np.repeat([surface.velocity for surface in scene.surfaces], counts, axis=0),
        origin=np.array(scene.surfaces[0].first_bob[:2]),
        parts=parts,
    )


def _fill_asperites(asperites: np.ndarray, surface: Surface, scene: Scene) -> None:
    first = scene.surfaces[0]
    each = surface.asperite.for_each(surface.count)
    for name in ("mass", "inertia", "kappa", "l1", "l2", "i2", "bar_length", "charge"):
        asperites[name] = each[name]
    bobs = surface.resting_bobs(first.first_bob)
    asperites["facing"] = surface.facing_sign
    asperites["x"] = bobs[:, 0]
    asperites["y"] = bobs[:, 1] + surface.facing_sign * each["l1"]
    asperites["z"] = bobs[:, 2]
    asperites["vx"] = surface.velocity[0] - first.velocity[0]
    asperites["vy"] = surface.velocity[1] - first.velocity[1]


def _fill_surface(record: np.ndarray, surface: Surface) -> None:
    drive = surface.drive
    if isinstance(drive, Forced):
        record["drive"] = FORCED
    elif isinstance(drive, Free):
        # One rigid asperite is a free one.
        record["drive"] = RIGID if drive.rigid and surface.count > 1 else FREE
    elif isinstance(drive, Pulled):
        record["drive"] = PULLED
        record["stiffness"] = drive.stiffness
        record["speed"] = drive.speed - surface.velocity[0]
    if drive.load is not None:
        record["loaded"] = 1
        record["load"] = -drive.load * surface.facing_sign


def _slots(wanted: np.ndarray, first: int, width: int = 1) -> tuple[np.ndarray, int]:
    """Consecutive slots of `width` for those that want one, -1 for the rest, and what follows."""
    slots = np.where(wanted, first + width * (np.cumsum(wanted) - 1), -1)
    return slots, first + width * int(np.count_nonzero(wanted))


def _give_coordinates(asperites: np.ndarray, surfaces: np.ndarray, scene: Scene) -> int:
    """Hand out the slots of q; returns how many there are."""
    of_surface = surfaces[asperites["surface"]]
    turning = np.array([surface.bars == "free" for surface in scene.surfaces])
    asperites["dof_phi"], stop = _slots(turning[asperites["surface"]], asperites.size)
    asperites["dof_x"], stop = _slots(of_surface["drive"] != FORCED, stop)
    asperites["dof_y"], stop = _slots(of_surface["loaded"] == 1, stop)
    return stop


def _give_accounts(asperites: np.ndarray, surfaces: np.ndarray) -> int:
    """Hand out the slots of s; returns how many there are."""
    of_surface = surfaces[asperites["surface"]]
    sliding = (asperites["dof_x"] >= 0) | (asperites["dof_y"] >= 0)
    driven = np.isin(of_surface["drive"], (RIGID, PULLED)) | (of_surface["loaded"] == 1)
    held = (asperites["dof_phi"] < 0) & (asperites["kappa"] > 0.0)
    asperites["acc_contact"], stop = _slots(np.full(asperites.size, True), 0, CONTACT)
    asperites["acc_slide"], stop = _slots(sliding, stop, SLIDE)
    asperites["acc_drive"], stop = _slots(driven, stop, DRIVE)
    asperites["acc_ends"], stop = _slots(held, stop, ENDS)
    sliding_surfaces = np.isin(np.arange(surfaces.size), asperites["surface"][sliding])
    surfaces["acc_block"], stop = _slots(sliding_surfaces, stop)
    return stop


def _start(
    asperites: np.ndarray, scene: Scene, parts: dict[str, slice], coordinates: int
) -> np.ndarray:
    """y at t = 0; a clamped bar's angle and rate go into its record instead."""
    y = np.zeros(2 * coordinates)
    q, v = y[:coordinates], y[coordinates:]
    for surface in scene.surfaces:
        part = parts[surface.name]
        initial = surface.initial.for_each(surface.count)
        phi = 0.0 if initial["phi"] is None else initial["phi"]
        nu = 0.0 if initial["nu"] is None else initial["nu"]
        asperites["phi"][part], asperites["nu"][part] = phi, nu
        q[part] = phi if initial["theta"] is None else initial["theta"] - surface.rest
        v[part] = 0.0 if initial["omega"] is None else initial["omega"]
        turning = asperites["dof_phi"][part]
        if surface.bars == "free":
            q[turning], v[turning] = phi, nu
    return y
