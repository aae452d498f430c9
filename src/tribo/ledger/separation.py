"""The bobs that are closest to one another, and contact between surfaces over time.

Notes say where surfaces part for good or never meet.  Two bobs are in contact within the range of a
potential that ends.  Of a potential that decays without an end, they are so within the largest
distance at which its energy is a fraction of the energies that it competes with.  A potential that
states no distance beyond which it is weak has no such distance, as that of Coulomb.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np

from tribo.kernels.kinematics import nearest_image, rod_position
from tribo.kernels.records import Contact
from tribo.layout.layout import Layout
from tribo.ledger.nearest import MOST_PAIRS, nearest
from tribo.ledger.motion import motions
from tribo.ledger.samples import Samples
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.surface import Surface

# Time without contact at the end of a run after which surfaces count as parted: at least so much of
# the run, and so many times the longest time between two contacts before.  A surface that hops or
# slips has such times of about equal length.
LEAST_PART, LONGER = 0.1, 2.0
# What notes on such surfaces say.
PART = "part for good"
# Energy of two bobs in contact, at least, as a fraction of torsion by 1 rad and of k_B T.
IN_CONTACT = 0.01
# Distances at which a decaying potential is looked at, in units of that beyond which it is weak:
# a tail r^-6 falls by 4e3 up to the largest, and steps of 2 % resolve the smallest.
DISTANCES = np.geomspace(4.0, 0.05, 220)


class Closest(NamedTuple):
    """The two bobs of two surfaces that are closest to one another."""

    distance: float  # [length]
    one: int  # numbers of their asperites
    other: int


def closest_bobs(layout: Layout, sample: Samples) -> Closest | None:
    """The closest bobs that interact in a sample; None without any, or without finite places."""
    return min((found for found, _ in closest_of_contacts(layout, sample)), default=None)


def closest_of_contacts(layout: Layout, sample: Samples) -> Iterator[tuple[Closest, Contact]]:
    """The closest bobs of each two surfaces in contact; nothing where a position is not finite."""
    places = bob_places(layout, sample)[0]
    if not np.all(np.isfinite(places)):
        return
    places, box = in_box(layout, places)
    for contact in layout.model.contacts:
        for one, other in contact.pairs:
            mine, theirs = (layout.surfaces[k] for k in (one, other))
            own = places[mine.start : mine.stop]
            # Within a surface, the nearest bob to each is that bob itself.
            rank = 2 if one == other else 1
            candidates = places[theirs.start : theirs.stop]
            distances, indices = nearest(own, candidates, box, rank)
            i = int(np.argmin(distances))
            near = int(indices[i])
            if near < len(candidates):  # a surface of one bob has no other
                pair = int(mine.start) + i, int(theirs.start) + near
                yield Closest(float(distances[i]), *pair), contact


def in_box(layout: Layout, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places of bobs in the scene's box, and its lengths along each axis, 0 where there is none."""
    x, z = layout.model.box or (0.0, 0.0)
    box, places = np.array([x, 0.0, z]), places.copy()
    periodic = box > 0.0
    for _ in range(2):  # the remainder of a tiny negative number is a period, which trees refuse
        places[..., periodic] %= box[periodic]
    return places, box


def nearest_images(layout: Layout, between: np.ndarray) -> np.ndarray:
    """Vectors between bobs, (..., 3), as those between nearest images in the scene's box."""
    box = layout.model.box
    if box is None:
        return between
    x, y, z = np.moveaxis(between, -1, 0)
    return np.stack([nearest_image(x, box.x), y, nearest_image(z, box.z)], axis=-1)


def bob_places(layout: Layout, samples: Samples) -> np.ndarray:
    """Positions of all bobs at all times, (times, n, 3), in the frame of the first surface."""
    places = np.empty((samples.t.size, layout.asperites.size, 3))
    places[..., 2] = layout.depths
    for index in range(len(layout.scene.surfaces)):
        for motion in motions(layout, samples, index):
            a = motion.span.asperites
            x, y = a.x + a.vx * motion.t + motion.x, a.y + a.vy * motion.t + motion.y
            mine = places[:, motion.span.place]
            mine[..., 0], mine[..., 1] = rod_position(x, y, a.l1, *motion.direction)
    return places


def asperite_names(layout: Layout, indices: Iterable[int]) -> str:
    return " and ".join(asperite_name(layout, index) for index in indices)


def asperite_name(layout: Layout, index: int) -> str:
    """An asperite by its surface and its place there, from 0 on."""
    for name, part in layout.parts.items():
        if part.start <= index < part.stop:
            return f'asperite {index - part.start} of "{name}"'
    raise IndexError(index)


class Reach(NamedTuple):
    """The distance of two bobs in contact."""

    distance: float  # [length]
    ends: bool  # whether their potential is zero beyond it
    species: tuple[str, str] | None  # of the two bobs; None for any


def touching(
    layout: Layout, samples: Samples, counts: Callable[[tuple[int, int]], bool] = lambda pair: True
) -> np.ndarray:
    """Whether any bobs of two surfaces with a range that `counts` selects touch, (times, pairs)."""
    pairs = [item for item in _reaches(layout.scene).items() if counts(item[0])]
    if not pairs:
        return np.empty((samples.t.size, 0), bool)
    places = bob_places(layout, samples)
    return np.column_stack([_in_contact(layout, places, *each) for each in pairs])


def separation_notes(scene: Scene, t: np.ndarray, contact: np.ndarray) -> Iterator[str]:
    """Notes on surfaces that never touch, or part for good; `contact` is of :func:`touching`."""
    for (pair, reach), touches in zip(_reaches(scene).items(), contact.T, strict=True):
        one, other = (scene.surfaces[k] for k in pair)
        met = t[touches]
        loaded = any(surface.drive.load is not None for surface in (one, other))
        if met.size == 0 and all(each.ends for each in reach):
            yield (
                f'at no recorded time was a bob of "{one.name}" within the range of contact, '
                f'{max(each.distance for each in reach):.4g}, of a bob of "{other.name}"; start '
                "them closer to one another, or run for longer"
            )
        elif (loaded or "forces" in scene.output.series) and _part(t, met):
            yield (
                f'"{one.name}" and "{other.name}" {PART}: none of their bobs was in contact '
                f"after t = {met[-1]:.6g}; averages over time include the time from there on"
            )


def parted(layout: Layout, samples: Samples) -> np.ndarray:
    """Whether two surfaces with a load part for good in each of several runs, (members,)."""

    def is_loaded(pair: tuple[int, int]) -> bool:
        return any(layout.scene.surfaces[k].drive.load is not None for k in pair)

    t = samples.t[:: samples.runs]
    touches = touching(layout, samples, is_loaded).reshape(t.size, samples.runs, -1)
    return np.array([any(_part(t, t[each]) for each in own.T) for own in touches.swapaxes(0, 1)])


def _part(t: np.ndarray, met: np.ndarray) -> bool:
    """Whether the time after the last contact is long, by the times of recorded contacts."""
    if met.size == 0:
        return False
    before = float(np.max(np.diff(met), initial=0.0))
    return bool(t[-1] - met[-1] > max(LEAST_PART * (t[-1] - t[0]), LONGER * before))


def _reaches(scene: Scene) -> dict[tuple[int, int], list[Reach]]:
    """Of each two surfaces that interact by potentials with a range alone, their distances."""
    found: dict[tuple[int, int], list[Reach]] = {}
    endless = set()
    for interaction in scene.interactions:
        distance = contact_distance(scene, interaction)
        for pair in scene.pairs(interaction):
            if distance is None:
                endless.add(pair)
            else:
                ends = bool(np.isfinite(interaction.potential.range()))
                found.setdefault(pair, []).append(Reach(distance, ends, interaction.species))
    return {pair: reach for pair, reach in found.items() if pair not in endless}


def _in_contact(
    layout: Layout, places: np.ndarray, pair: tuple[int, int], reaches: list[Reach]
) -> np.ndarray:
    """Whether any two bobs of two surfaces are in contact, (times,), from (times, n, 3)."""
    surfaces = [layout.scene.surfaces[k] for k in pair]
    bobs = [places[:, layout.parts[surface.name]] for surface in surfaces]
    found = np.zeros(len(places), dtype=bool)
    for distance, _, species in reaches:
        for kinds in {species, species and species[::-1]}:
            mine, theirs = bobs
            if kinds is not None:
                mine, theirs = (
                    each[:, surface.species_of_each == kind]
                    for each, surface, kind in zip(bobs, surfaces, kinds, strict=True)
                )
            found |= _any_within(layout, mine, theirs, distance)
    return found


def _any_within(
    layout: Layout, mine: np.ndarray, theirs: np.ndarray, distance: float
) -> np.ndarray:
    """Whether any two of some places (times, n, 3) and (times, m, 3) are closer than a distance."""
    found = np.zeros(len(mine), dtype=bool)
    if not (mine.size and theirs.size and distance > 0.0):
        return found
    with np.errstate(invalid="ignore"):
        y, their_y = mine[..., 1], theirs[..., 1]
        gap = np.maximum(y.min(axis=1) - their_y.max(axis=1), their_y.min(axis=1) - y.max(axis=1))
        near = np.isfinite(mine).all(axis=(1, 2)) & np.isfinite(theirs).all(axis=(1, 2))
        near &= gap < distance
    mine, theirs = mine[near], theirs[near]
    if mine.shape[1] * theirs.shape[1] <= MOST_PAIRS:
        between = nearest_images(layout, mine[:, :, None] - theirs[:, None])
        found[near] = np.linalg.norm(between, axis=-1).min(axis=(1, 2)) < distance
        return found
    (mine, box), (theirs, _) = in_box(layout, mine), in_box(layout, theirs)
    for k, own, others in zip(np.flatnonzero(near), mine, theirs, strict=True):
        found[k] = np.min(nearest(own, others, box)[0]) < distance
    return found


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
    stiffness = np.concatenate([surface.each["kappa"] for surface in surfaces])
    torsion = 0.5 * float(np.min(stiffness[np.isfinite(stiffness)], initial=np.inf))  # by 1 rad
    warm = [surface.bath.temperature for surface in surfaces]
    warm += [each.temperature for surface in surfaces for each in surface.reservoirs]
    least = IN_CONTACT * ((torsion if torsion < np.inf else 0.0) + max(0.0, *warm))
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
