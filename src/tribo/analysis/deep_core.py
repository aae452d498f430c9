"""Bobs that start deep in the repulsive core of a potential."""

import math
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from tribo.kernels.model import Contact
from tribo.kernels.records import CHARGE
from tribo.layout.layout import Layout, once_per_layout
from tribo.ledger.samples import Samples
from tribo.ledger.separation import Closest, asperite_names, closest_of_contacts
from tribo.model.number import largest

# Energy of two bobs, in units of the other energies of their asperites, from which they are deep in
# a core: those of Lennard-Jones are from 0.75 sigma on.
DEEP = 100.0
# Distances at which the depth of a potential is looked for, in units of that of the bobs.
DISTANCES = np.geomspace(1.0, 100.0, 31)


@once_per_layout
def core_notes(layout: Layout) -> tuple[str, ...]:
    """A note on the bobs that start deepest in a core, with their energy."""
    n = layout.coordinates
    start = Samples.at_zero(layout)
    start.t[0] = layout.beginning
    start.y[0, : layout.core] = layout.start[: layout.core]
    start.y[0, layout.core :] = layout.start[n : n + layout.core]
    found = []
    for bobs, contact in closest_of_contacts(layout, start):
        energy, other = _energies(layout, bobs, contact)
        if energy > DEEP * other > 0.0:
            found.append((energy / other, energy, bobs))
    if not found:
        return ()
    ratio, energy, bobs = max(found)
    scene = layout.scene
    advice = "start them farther apart"
    for surface in (scene.surfaces[layout.asperites.surface[k]] for k in bobs[1:]):
        slides = scene.slides_along_x(surface) or scene.slides_along_y(surface)
        if slides or not surface.asperite.is_rigid:
            advice = "start them farther apart, or from tribo.relax(scene)"
    return (
        f"the bobs of {asperite_names(layout, bobs[1:])} start deep in a repulsive core: "
        f"{bobs.distance:.3g} apart, with an energy of {energy:.3g}, {ratio:.1g} times their other "
        f"energies; {advice}",
    )


def _energies(layout: Layout, bobs: Closest, contact: Contact) -> tuple[float, float]:
    """The energy of two bobs that repel each other, else 0, and the largest of their others."""
    columns = layout.places.columns[list(bobs[1:])]
    species = layout.model.species
    if contact.species is not None and species is not None:
        kinds = sorted(species[columns].tolist())
        if kinds != sorted(contact.species.tolist()):
            return 0.0, 0.0
    charges = layout.model.each[CHARGE, columns]
    energy = contact.potential.energy_between
    r = bobs.distance * DISTANCES
    try:
        with np.errstate(all="ignore"):
            if not energy(r[0], *charges) > energy(r[1], *charges):
                return 0.0, 0.0
            energies = _energies_at(energy, r, charges)
    # A user's energy may raise anything: its errors are reported when it is compiled.
    except Exception:
        return 0.0, 0.0
    return float(energies[0]), max(-float(np.min(energies)), _other_energies(layout, bobs))


def _energies_at(energy: Callable[..., Any], r: np.ndarray, charges: np.ndarray) -> np.ndarray:
    """Energies of two charges at distances r (n,): one by one if the potential takes no arrays."""
    with suppress(Exception):
        together = np.asarray(energy(r, *charges), float)
        if together.shape == r.shape:
            return together
    return np.array([energy(distance, *charges) for distance in r], float)


def _other_energies(layout: Layout, bobs: Closest) -> float:
    """The largest energy of two asperites but for contact, over the length of a rod [energy]."""
    pair = np.asarray(layout.asperites)[list(bobs[1:])]
    vx, other_vx = pair["vx"].tolist()
    vy, other_vy = pair["vy"].tolist()
    speed = math.hypot(vx - other_vx, vy - other_vy)
    rods = (pair["l1"] + pair["l2"]).tolist()
    mass = max(pair["mass"].tolist())
    kappa = max(pair["kappa"].tolist())
    energies = [0.5 * mass * speed**2, 0.5 * kappa]
    for k, rod in zip(pair["surface"].tolist(), rods, strict=True):
        surface = layout.scene.surfaces[k]
        drive = surface.drive
        energies += [largest(drive.load) * rod, surface.bath.temperature]
        energies += [each.warmest for each in surface.reservoirs]
        energies.append(0.0 if drive.stage is None else 0.5 * drive.stage.stiffness * rod**2)
    return max(energies)
