"""The contacts of a surface over time, with the distribution of their forces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.kernels.records import CHARGE
from tribo.layout.layout import Layout, lay_out
from tribo.ledger.contact_pairs import ContactPairs, contact_pairs
from tribo.ledger.separation import MOST_CHARGES, has_contact_distance
from tribo.results.run_result import RunResult, of_all
from tribo.validation import InputError, integer

if TYPE_CHECKING:
    import xarray


def contacts(result: RunResult, surface: str, bins: int = 20) -> xarray.Dataset:
    """The contacts of a surface with others at each recorded time, and their forces.

    Two bobs are in contact where they repel each other, as for :meth:`time_without_contact`.
    The numbers follow from the recorded places of the bobs; the scene's output needs no series.

    Parameters
    ----------
    surface : str
        Name of the surface.
    bins : int
        Number of bins of the distribution of forces, which are of equal width.

    Returns
    -------
    xarray.Dataset
        ``number`` (time,) of contacts, each a pair of bobs; ``share`` (time,) of the asperites
        that have one; ``force_mean`` and ``force_largest`` (time,), the repulsive force of a
        contact [force], NaN where there is none; and ``force_count`` (time, bin), the number of
        contacts whose force is between ``force_low`` and ``force_high`` (bin,).

    Raises
    ------
    InputError
        If there is no such surface, its contacts have no range, as that of Coulomb, or the places
        of single asperites were not kept.
    """
    import xarray

    index = result.scene.index_of(surface)
    integer("bins", bins, 1, 100_000)
    if not has_contact_distance(result.scene, result.scene.surfaces[index]):
        raise InputError(
            "surface",
            f'must have contacts with a range; those of "{surface}" have none: it interacts with '
            "no other surface, by a potential that does not state where it is weak, or its range "
            f"depends on more than {MOST_CHARGES} unlike charges",
        )
    layout = lay_out(result.scene)
    part = layout.parts[surface]
    found = list(contact_pairs(layout, _places(result, layout), index))
    forces = [pair_forces(layout, pairs) for pairs in found]
    largest = max((float(np.max(own)) for own in forces if own.size), default=1.0)
    # Interactions that attract may exceed the repulsion of one by which bobs are in contact.
    edges = np.linspace(0.0, largest if largest > 0.0 else 1.0, bins + 1)
    share = [np.mean(pairs.of_asperites(part) > 0) for pairs in found]
    means = [np.mean(own) if own.size else np.nan for own in forces]
    maxima = [np.max(own) if own.size else np.nan for own in forces]
    counts = [np.histogram(own, edges)[0] for own in forces]
    force = {"units": "force"}
    number = {"units": "1", "long_name": f"contacts of {surface}"}
    part_of_all = {"units": "1", "long_name": f"share of asperites of {surface} in contact"}
    variables = {
        "number": ("time", [pairs.mine.size for pairs in found], number),
        "share": ("time", share, part_of_all),
        "force_mean": ("time", means, force | {"long_name": "mean force of a contact"}),
        "force_largest": ("time", maxima, force | {"long_name": "largest force of a contact"}),
        "force_count": (
            ("time", "bin"),
            np.reshape(counts, (len(found), bins)),
            {"units": "1", "long_name": "contacts with a force in the bin"},
        ),
    }
    coordinates = {
        "time": ("time", result.t, {"units": "time"}),
        "force_low": ("bin", edges[:-1], force),
        "force_high": ("bin", edges[1:], force),
    }
    return xarray.Dataset(variables, coordinates, {"surface": surface})


def _places(result: RunResult, layout: Layout) -> np.ndarray:
    """Positions of all bobs at the recorded times, (times, n, 3), from the first bob."""
    bobs = np.stack([of_all(result, "x_bob"), of_all(result, "y_bob")], axis=2)
    depths = np.broadcast_to(layout.depths[:, None], (*bobs.shape[:2], 1))
    return np.concatenate([bobs - layout.origin, depths], axis=2)


def pair_forces(layout: Layout, pairs: ContactPairs) -> np.ndarray:
    """The repulsive force of each pair, by all interactions between its bobs, (pairs,)."""
    scene = layout.scene
    charges = layout.model.each[CHARGE, layout.places.columns]
    surface_of = np.repeat(np.arange(len(scene.surfaces)), [s.count for s in scene.surfaces])
    species = np.concatenate([each.species_of_each for each in scene.surfaces])
    total = np.zeros(pairs.mine.size)
    for interaction in scene.interactions:
        acts = np.zeros(total.size, bool)
        for pair in scene.pairs(interaction):
            mine = surface_of[pairs.mine]
            theirs = surface_of[pairs.theirs]
            acts |= (np.minimum(mine, theirs) == min(pair)) & (
                np.maximum(mine, theirs) == max(pair)
            )
        if interaction.species is not None:
            one, other = interaction.species
            mine = species[pairs.mine]
            theirs = species[pairs.theirs]
            acts &= ((mine == one) & (theirs == other)) | ((mine == other) & (theirs == one))
        at = np.flatnonzero(acts)
        if at.size == 0:
            continue
        arguments = pairs.distance[at], charges[pairs.mine[at]], charges[pairs.theirs[at]]
        total[at] += _forces_between(interaction.potential, *arguments)
    return total


def _forces_between(
    potential: Any, distances: np.ndarray, mine: np.ndarray, theirs: np.ndarray
) -> np.ndarray:
    """The force between each two charges; a user's formula may take numbers alone."""
    try:
        return np.asarray(potential.force_between(distances, mine, theirs), float)
    except (TypeError, ValueError):
        every = zip(distances.tolist(), mine.tolist(), theirs.tolist(), strict=True)
        return np.array([float(potential.force_between(*each)) for each in every])
