"""The bobs that are closest to one another, and contact between surfaces over time.

Two bobs are in contact where they repel each other: closer than the largest distance at which the
force between them is repulsive.  Of a potential that repels without an end, this is the distance at
which its energy is a fraction of the energies that it competes with.

Notes say where surfaces part for good or never meet: where no bob is within reach of the other
surface, which an attraction is too.  The reach is the range of the potential, or, without one, the
largest distance at which its energy is that fraction.  A potential that states no distance beyond
which it is weak, as that of Coulomb, has neither.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from tribo.kernels.kinematics import nearest_image, rod_position
from tribo.kernels.model import Contact
from tribo.layout.layout import Layout, once_per_layout
from tribo.ledger.motion import Motion
from tribo.ledger.nearest import MOST_PAIRS, nearest
from tribo.ledger.samples import Samples
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.surface import Surface

# Time without contact at the end of a run after which surfaces count as parted: at least so much of
# the run, and so many times the longest time between two contacts before.  A surface that hops or
# slips has such times of about equal length.
LEAST_PART = 0.1
LONGER = 2.0
# What notes on such surfaces say.
PART = "part for good"
# Times after one with a tree that may be settled by it, at most.
AHEAD = 64
# Energy of two bobs in contact, at least, as a fraction of torsion by 1 rad and of k_B T.
IN_CONTACT = 0.01
# Distances at which a potential is looked at, in steps of 2 %: in units of its range, or without
# one of the distance beyond which it is weak, which a part of a sum may exceed by far.
WITHIN_RANGE = np.geomspace(1.0, 0.01, 234)
DISTANCES = np.geomspace(1e3, 0.05, 500)
# Unlike charges of a surface up to which each has its own distance of contact.
MOST_CHARGES = 32
# Halvings of a step of 2 %, to 1e-12 of the distance of contact.
HALVINGS = 36


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
    if not np.isfinite(places).all():
        return
    places, box = in_box(layout, places)
    parts = list(layout.parts.values())
    for contact in layout.model.contacts:
        for one, other in contact.pairs:
            mine = parts[one]
            theirs = parts[other]
            own = places[mine]
            # Within a surface, the nearest bob to each is that bob itself.
            rank = 2 if one == other else 1
            candidates = places[theirs]
            distances, indices = nearest(own, candidates, box, rank)
            i = int(np.argmin(distances))
            near = int(indices[i])
            if near < len(candidates):  # a surface of one bob has no other
                pair = mine.start + i, theirs.start + near
                yield Closest(float(distances[i]), *pair), contact


def in_box(layout: Layout, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places of bobs in the scene's box, and its lengths along each axis, 0 where there is none."""
    x, z = layout.model.box or (0.0, 0.0)
    box = np.array([x, 0.0, z])
    places = places.copy()
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
    for span in layout.whole_spans:
        motion = Motion(layout, span, samples)
        a = span.asperites
        x = a.x + a.vx * motion.t + motion.x
        y = a.y + a.vy * motion.t + motion.y
        mine = places[:, span.place]
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
    """The distance at which bobs of two surfaces are in contact."""

    distance: float  # [length]
    ends: bool  # whether their potential is zero beyond it
    mine: np.ndarray  # the bobs of the first surface, by their numbers there
    theirs: np.ndarray
    # False where unlike charges among them are in contact at other distances, at most at this one.
    is_exact: bool


def touching(
    layout: Layout,
    samples: Samples,
    counts: Callable[[tuple[int, int]], bool] = lambda pair: True,
    repelling: bool = False,
) -> np.ndarray:
    """Whether any bobs of two surfaces that `counts` selects are within reach, (times, pairs).

    Only surfaces that have a reach count.  With `repelling`, whether the bobs are in contact.
    """
    reaches = repulsions_of(layout) if repelling else _reaches_of(layout)
    pairs = {pair: reach for pair, reach in reaches.items() if counts(pair)}
    if not pairs:
        return np.empty((samples.t.size, 0), bool)
    # Notes and the series of both surfaces ask for the same pairs.
    known = samples.contacts.setdefault((layout, repelling), {})
    if missing := pairs.keys() - known.keys():
        places = bob_places(layout, samples)
        known |= {pair: _in_contact(layout, places, pair, pairs[pair]) for pair in missing}
    return np.column_stack([known[pair] for pair in pairs])


def any_within_reach(layout: Layout) -> bool:
    """Whether any two surfaces have a reach, so that :func:`touching` tells something."""
    return bool(_reaches_of(layout))


def separation_notes(layout: Layout, t: np.ndarray, contact: np.ndarray) -> Iterator[str]:
    """Notes on surfaces that never touch, or part for good; `contact` is of :func:`touching`."""
    scene = layout.scene
    for (pair, reach), touches in zip(_reaches_of(layout).items(), contact.T, strict=True):
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
    found = []
    for own in touches.swapaxes(0, 1):
        found.append(any(_part(t, t[each]) for each in own.T))
    return np.array(found)


def _part(t: np.ndarray, met: np.ndarray) -> bool:
    """Whether the time after the last contact is long, by the times of recorded contacts."""
    if met.size == 0:
        return False
    before = float(np.max(np.diff(met), initial=0.0))
    return bool(t[-1] - met[-1] > max(LEAST_PART * (t[-1] - t[0]), LONGER * before))


@once_per_layout
def _reaches_of(layout: Layout) -> dict[tuple[int, int], list[Reach]]:
    return _reaches(layout.scene)


@once_per_layout
def repulsions_of(layout: Layout) -> dict[tuple[int, int], list[Reach]]:
    return _reaches(layout.scene, repelling=True)


def _reaches(scene: Scene, repelling: bool = False) -> dict[tuple[int, int], list[Reach]]:
    """Of each two surfaces that interact by potentials with a reach alone, their distances.

    Bobs of one surface that act on one another are no contact of it.
    """
    found: dict[tuple[int, int], list[Reach]] = {}
    endless = set()
    for interaction in scene.interactions:
        pairs = _pairs_of_two(scene, interaction)
        if not has_reach(interaction):
            endless.update(pairs)
            continue
        ends = bool(np.isfinite(interaction.potential.range()))
        least = _least_energy(scene, interaction)
        species = interaction.species
        for pair in pairs:
            for kinds in {species, species and species[::-1]}:
                one, other = (
                    _bobs_by_charge(scene.surfaces[k], kinds and kinds[place])
                    for place, k in enumerate(pair)
                )
                for charges, mine in one:
                    for its, theirs in other:
                        distances = [
                            reach_of(interaction.potential, own, another, least, repelling)
                            for own, another in itertools.product(charges, its)
                        ]
                        far = max(distances)
                        is_exact = min(distances) == far
                        reach = Reach(far, ends, mine, theirs, is_exact)
                        found.setdefault(pair, []).append(reach)
    return {pair: reach for pair, reach in found.items() if pair not in endless}


def _pairs_of_two(scene: Scene, interaction: Interaction) -> list[tuple[int, int]]:
    """The pairs of two surfaces between which an interaction acts."""
    return [(one, other) for one, other in scene.pairs(interaction) if one != other]


def _bobs_by_charge(
    surface: Surface, kind: str | None
) -> list[tuple[tuple[float, ...], np.ndarray]]:
    """Bobs of a species, or of any, in groups of one charge, or of one sign if there are many.

    With each group stands its charge, or the smallest and the largest of its sign.
    """
    charges = np.broadcast_to(surface.each["charge"], surface.count)
    chosen = np.full(surface.count, True)
    if kind is not None:
        chosen &= surface.species_of_each == kind
    groups = charges if np.unique(charges[chosen]).size <= MOST_CHARGES else np.sign(charges)
    found = []
    for value in np.unique(groups[chosen]).tolist():
        bobs = np.flatnonzero(chosen & (groups == value))
        ends = {float(np.min(charges[bobs])), float(np.max(charges[bobs]))}
        found.append((tuple(ends), bobs))
    return found


def _in_contact(
    layout: Layout, places: np.ndarray, pair: tuple[int, int], reaches: list[Reach]
) -> np.ndarray:
    """Whether any two bobs of two surfaces are in contact, (times,), from (times, n, 3)."""
    one, other = (places[:, layout.parts[layout.scene.surfaces[k].name]] for k in pair)
    found = np.zeros(len(places), dtype=bool)
    for reach in reaches:
        mine, theirs = (
            bobs if chosen.size == bobs.shape[1] else bobs[:, chosen]
            for bobs, chosen in ((one, reach.mine), (other, reach.theirs))
        )
        found |= _any_within(layout, mine, theirs, reach.distance)
    return found


def _any_within(
    layout: Layout, mine: np.ndarray, theirs: np.ndarray, distance: float
) -> np.ndarray:
    """Whether any two of some places (times, n, 3) and (times, m, 3) are closer than a distance."""
    found = np.zeros(len(mine), dtype=bool)
    if not (mine.size and theirs.size and distance > 0.0):
        return found
    with np.errstate(invalid="ignore"):
        y = mine[..., 1]
        their_y = theirs[..., 1]
        gap = np.maximum(y.min(axis=1) - their_y.max(axis=1), their_y.min(axis=1) - y.max(axis=1))
        near = np.isfinite(mine).all(axis=(1, 2)) & np.isfinite(theirs).all(axis=(1, 2))
        near &= gap < distance
    mine = mine[near]
    theirs = theirs[near]
    if mine.shape[1] * theirs.shape[1] <= MOST_PAIRS:
        between = nearest_images(layout, mine[:, :, None] - theirs[:, None])
        found[near] = np.linalg.norm(between, axis=-1).min(axis=(1, 2)) < distance
        return found
    found[near] = _by_trees(layout, mine, theirs, distance)
    return found


def _by_trees(layout: Layout, mine: np.ndarray, theirs: np.ndarray, distance: float) -> np.ndarray:
    """The same of many bobs; a tree finds the closest pair at a time.

    That pair settles all times at which it is in contact.  If it is not, neither is any pair at
    later times until the bobs of the two surfaces have moved by what is missing.
    """
    found = np.zeros(len(mine), dtype=bool)
    open_times = np.ones(len(mine), dtype=bool)
    in_mine, box = in_box(layout, mine)
    in_theirs, _ = in_box(layout, theirs)
    while open_times.any():
        k = int(np.argmax(open_times))
        distances, places = nearest(in_mine[k], in_theirs[k], box)
        i = int(np.argmin(distances))
        open_times[k] = False
        found[k] = distances[i] < distance
        later = k + 1 + np.flatnonzero(open_times[k + 1 : k + 1 + AHEAD])
        if found[k]:
            between = nearest_images(layout, mine[later, i] - theirs[later, places[i]])
            settled = np.linalg.norm(between, axis=1) < distance
            found[later] = settled
        else:
            moved = sum(_largest_move(each[later], each[k]) for each in (mine, theirs))
            settled = distances[i] - moved >= distance
        open_times[later[settled]] = False
    return found


def _largest_move(later: np.ndarray, before: np.ndarray) -> np.ndarray:
    """The largest distance that a bob has moved, (times,), from (times, n, 3) and (n, 3)."""
    return np.sqrt(np.max(np.sum((later - before) ** 2, axis=2), axis=1, initial=0.0))


def has_reach(interaction: Interaction) -> bool:
    """Whether a potential ends, or states a distance beyond which it is weak."""
    potential = interaction.potential
    if math.isfinite(potential.range()):
        return True
    if not hasattr(potential, "feature"):  # a calculator, or code that is not loaded
        return False
    return 0.0 < float(potential.feature()[1]) < math.inf


def _least_energy(scene: Scene, interaction: Interaction) -> float:
    """The energy from which on two bobs are in contact where a potential does not end."""
    surfaces = [scene.surfaces[k] for pair in scene.pairs(interaction) for k in pair]
    if not surfaces:
        return 0.0
    stiffness = np.concatenate([surface.each["kappa"] for surface in surfaces])
    torsion = 0.5 * float(np.min(stiffness[np.isfinite(stiffness)], initial=np.inf))  # by 1 rad
    warm = [surface.bath.temperature for surface in surfaces]
    warm += [each.warmest for surface in surfaces for each in surface.reservoirs]
    return IN_CONTACT * ((torsion if torsion < np.inf else 0.0) + max(0.0, *warm))


def real(value: Any) -> float:
    """A number as compiled code has it: NaN where Python goes on with a complex one."""
    return math.nan if isinstance(value, complex) else float(value)


@lru_cache(maxsize=2 * MOST_CHARGES**2)
def reach_of(potential: Any, one: float, other: float, least: float, repelling: bool) -> float:
    """The largest distance at which two charges act on each other, or repel each other [length].

    Without a range, the energy is at least `least` there, or the distance that beyond which the
    potential is weak; inside of an attraction every repulsion counts.
    """
    ends = math.isfinite(potential.range())
    if ends and not repelling:
        return float(potential.range_between(one, other))
    weak_from = float(potential.feature()[1])
    distances = potential.range() * WITHIN_RANGE if ends else weak_from * DISTANCES

    def look(r: float) -> tuple[float, float]:
        energy = real(potential.energy_between(r, one, other))
        return energy, real(potential.force_between(r, one, other)) if repelling else 0.0

    try:
        with np.errstate(all="ignore"):
            energies, forces = np.array([look(r) for r in distances.tolist()]).T
            strong = np.abs(energies) >= least if least > 0.0 else distances <= weak_from
            if not repelling:
                return float(np.max(distances, where=strong, initial=0.0))
            inside = ends | np.logical_or.accumulate(forces < 0.0)
            repels = (forces > 0.0) & (inside | strong)
            if not np.any(repels):
                return 0.0
            k = int(np.argmax(repels))
            near = float(distances[k])
            far = float(distances[max(0, k - 1)])
            for _ in range(HALVINGS if inside[k] else 0):
                middle = 0.5 * (near + far)
                near, far = (middle, far) if look(middle)[1] > 0.0 else (near, middle)
            return near
    except Exception:  # a user's methods may raise anything: it is reported when they are compiled
        return float(distances[0])


def contact_distance_of(scene: Scene, surface: Surface) -> float:
    """The largest distance at which bobs of a surface are in contact with another [length]."""
    return max((each.distance for each in _repulsions_on(scene, surface)), default=0.0)


def _repulsions_on(scene: Scene, surface: Surface) -> list[Reach]:
    index = scene.index_of(surface.name)
    pairs = _reaches(scene, repelling=True).items()
    return [reach for pair, own in pairs if index in pair for reach in own]


def has_contact_distance(scene: Scene, surface: Surface) -> bool:
    """Whether all contacts of a surface with others have a range, or decay.

    They have none where more unlike charges than `MOST_CHARGES` make unlike distances.
    """
    index = scene.index_of(surface.name)
    mine = [i for i in scene.interactions if any(index in pair for pair in _pairs_of_two(scene, i))]
    if not mine or not all(map(has_reach, mine)):
        return False
    return all(reach.is_exact for reach in _repulsions_on(scene, surface))
