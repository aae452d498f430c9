"""The distance within which two bobs count as in contact.

It is the range of a potential that ends.  Of a potential that decays without an end, it is the
largest distance at which its energy is a fraction of the energies that it competes with.  A
potential that states no distance beyond which it is weak has none, as that of Coulomb.
"""

from __future__ import annotations

import math

import numpy as np

from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.surface import Surface

# Energy of two bobs in contact, at least, as a fraction of torsion by 1 rad and of k_B T.
IN_CONTACT = 0.01
# Distances at which a decaying potential is looked at, in units of that beyond which it is weak:
# a tail r^-6 falls by 4e3 up to the largest, and steps of 2 % resolve the smallest.
DISTANCES = np.geomspace(4.0, 0.05, 220)


def contact_distance(scene: Scene, interaction: Interaction) -> float | None:
    """The distance of two bobs in contact [length]; None without a range, or without bobs."""
    potential = interaction.potential
    if math.isfinite(ends := potential.range()):
        return float(ends)
    if not hasattr(potential, "feature"):  # a calculator, or code that is not loaded
        return None
    weak_from = float(potential.feature()[1])
    if not 0.0 < weak_from < math.inf:
        return None
    surfaces = [scene.surfaces[k] for pair in scene.pairs(interaction) for k in pair]
    if not surfaces:
        return None
    least = IN_CONTACT * (_torsion(surfaces) + max(map(_temperature, surfaces)))
    charge = max(float(np.max(np.abs(surface.each["charge"]))) for surface in surfaces)
    distances = (weak_from * DISTANCES).tolist()
    try:
        with np.errstate(all="ignore"):
            energies = [abs(potential.energy_between(r, charge, charge)) for r in distances]
    except Exception:  # a user's energy may raise anything: it is reported when it is compiled
        return weak_from
    strong = (r for r, energy in zip(distances, energies, strict=True) if energy >= least)
    return next(strong, 0.0) if least > 0.0 else weak_from


def has_contact_distance(scene: Scene, surface: Surface) -> bool:
    """Whether all contacts of a surface with others have a range, or decay."""
    index = [each.name for each in scene.surfaces].index(surface.name)
    mine = [i for i in scene.interactions if any(index in pair for pair in scene.pairs(i))]
    return bool(mine) and all(contact_distance(scene, i) is not None for i in mine)


def _torsion(surfaces: list[Surface]) -> float:
    """The energy of torsion by 1 rad of the softest asperite; 0 if all are rigid."""
    stiffness = np.concatenate([surface.each["kappa"] for surface in surfaces])
    finite = stiffness[np.isfinite(stiffness)]
    return 0.5 * float(np.min(finite)) if finite.size else 0.0


def _temperature(surface: Surface) -> float:
    """The largest temperature of a surface's reservoirs and baths, times k_B."""
    return max(surface.bath.temperature, *(each.temperature for each in surface.reservoirs), 0.0)
