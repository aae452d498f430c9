"""Who acts on whom, as kernels see it: contacts, species, calculators and neighbour lists."""

from __future__ import annotations

import numpy as np

from tribo.kernels.records import Calculator, Contact, Model, Neighbours
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.potentials import Coulomb, as_potential
from tribo.potentials.from_ase import Call, Live, ZeroForce, elements
from tribo.potentials.registry import complete
from tribo.validation import inside

SKIN = 0.3  # of the largest cutoff: how much farther a neighbour list reaches
FEW = 4096  # pairs of bobs, up to which all are looked at rather than listed


def meetings(
    scene: Scene,
) -> tuple[tuple[Contact, ...], tuple[Contact, ...] | None, int, float]:
    """Contacts between surfaces, those within one, how many rows their lists have, and the skin.

    An interaction with a cutoff has a list where its bobs are many.
    """
    between: list[Contact] = []
    within: list[Contact] = []
    rows = 0
    longest = 0.0
    for interaction in scene.interactions:
        reach = interaction.potential.range()
        pairs = scene.pairs(interaction)
        first = []
        for one, other in pairs:
            count = scene.surfaces[one].count
            listed = np.isfinite(reach) and count * scene.surfaces[other].count > FEW
            first.append(rows if listed else -1)
            if listed:
                rows += count
                longest = max(longest, reach)
        inner = any(one == other for one, other in pairs)
        potential = interaction.potential
        if isinstance(potential, Live):
            potential = complete(ZeroForce)(potential.length, potential.reach)
        (within if inner else between).append(
            Contact(
                potential,
                np.array(pairs, dtype=np.int64).reshape(-1, 2),
                np.array(first, dtype=np.int64),
                _kinds(scene, interaction),
            )
        )
    if not between:  # kernels cannot walk through an empty tuple: an interaction of no pairs
        nothing = np.empty(0, dtype=np.int64)
        between.append(Contact(as_potential(Coulomb(0.0)), nothing.reshape(0, 2), nothing, None))
    return tuple(between), tuple(within) or None, rows, SKIN * longest


def neighbours(model: Model, rows: int, skin: float) -> Neighbours:
    """An empty neighbour list of so many rows, to be made when the forces are first wanted."""
    contacts = (*model.contacts, *(model.within or ()))
    anyone = (-1, -1)
    listed = [
        (one, other, row, contact.potential.range() + skin, contact.species)
        for contact in contacts
        for (one, other), row in zip(contact.pairs.tolist(), contact.rows.tolist(), strict=True)
        if row >= 0
    ]
    return Neighbours(
        pairs=np.array([pair[:3] for pair in listed], dtype=np.int64),
        species=np.array([anyone if pair[4] is None else pair[4] for pair in listed], np.int64),
        reach=np.array([pair[3] for pair in listed]),
        start=np.zeros(rows + 1, np.int64),
        index=np.zeros(16 * rows, np.int64),
        place=np.full((model.asperites.size, 2), np.nan),
        skin=skin,
        made=np.zeros(1, np.int64),
    )


def calls(scene: Scene, depths: list[np.ndarray]) -> tuple[Call, ...]:
    """What compiled code calls for the interactions that ASE's calculators compute.

    `depths` are the z of each surface's bobs.
    """
    found = []
    for i, interaction in enumerate(scene.interactions):
        if isinstance(interaction.potential, Live):
            meeting = _meeting(scene, interaction)
            surfaces = [scene.surfaces[k] for k in meeting]
            with inside(f"interaction[{i}]"):
                symbols = elements([name for s in surfaces for name in s.species_of_each.tolist()])
            found.append(
                Call(
                    interaction.potential.calculator,
                    symbols,
                    np.concatenate([depths[k] for k in meeting]),
                    [s.count for s in surfaces],
                    (scene.periodic.x or 0.0, scene.periodic.z or 0.0),
                )
            )
    return tuple(found)


def calculators(scene: Scene, calls: tuple[Call, ...]) -> tuple[Calculator, ...] | None:
    """The same as kernels see it; None without any."""
    live = [item for item in scene.interactions if isinstance(item.potential, Live)]
    found = [
        Calculator(
            call.address, np.array(_meeting(scene, item)), call.place, call.force, call.energy
        )
        for item, call in zip(live, calls, strict=True)
    ]
    return tuple(found) or None


def _meeting(scene: Scene, interaction: Interaction) -> list[int]:
    """Indices of the surfaces that an interaction is between."""
    return sorted({k for pair in scene.pairs(interaction) for k in pair})


def species(scene: Scene) -> np.ndarray | None:
    """(n,) number of each bob's species; None where no interaction asks."""
    if all(interaction.species is None for interaction in scene.interactions):
        return None
    names = np.concatenate([surface.species_of_each for surface in scene.surfaces])
    return np.searchsorted(scene.species, names)


def _kinds(scene: Scene, interaction: Interaction) -> np.ndarray | None:
    """Numbers of the two species that an interaction is between; None where it is for all."""
    if interaction.species is None:
        return None
    return np.searchsorted(scene.species, interaction.species)
