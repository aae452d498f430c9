"""Contacts between bobs, as kernels read them: species, calculators and neighbour lists."""

import itertools

import numpy as np
from numba import config

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.kernels.model import Active, Boxes, Calculator, Cells, Contact, Neighbours, Tables
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.potentials import Coulomb, as_potential
from tribo.potentials.from_ase import Call, ZeroForce, elements
from tribo.validation import inside

# How much farther than the largest cutoff a neighbour list reaches, relative to the cutoff: longer
# lists cost more in each evaluation, shorter ones have to be rebuilt more often.
SKIN = 0.1
# Pairs of bobs up to which every pair is visited, rather than a neighbour list.
UNLISTED_PAIRS = 4096
# Pairs of unlike charges of two surfaces up to which each is asked whether it is coupled.
MOST_CHARGES = 100_000
# How much farther than the list of neighbours the active packs reach, in units of its skin: more
# active packs cost more in each step, a shorter margin has them selected more often.
MARGIN = 10.0
# Room of a neighbour list, in units of what it needed when it had too little: bobs that approach
# one another need somewhat more soon after.
EXTRA_ROOM = 1.5
# Pairs of bobs in an evaluation from which threads share it, listed ones in units of packs of
# eight: a step then takes 0.2 ms or more, and to divide it takes a hundredth of that.
SHARED_PAIRS = 100_000
# Packs with bobs in reach of a bob, as a list names them.
LISTED_PACKS = 6


def lay_out_contacts(scene: Scene) -> tuple[tuple[Contact, ...], int, float]:
    """The contacts of a scene, at least one; those among the bobs of one surface come last.

    Also the rows of the neighbour list, 0 without one, and how much farther than the cutoff it
    reaches [length].  An interaction with a cutoff has a list where its bobs are many.
    """
    found: list[Contact] = []
    rows = 0
    longest = 0.0
    for interaction in scene.interactions:
        reach = interaction.potential.range()
        pairs = [pair for pair in scene.pairs(interaction) if are_coupled(scene, interaction, pair)]
        first = []
        for one, other in pairs:
            count = scene.surfaces[one].count
            listed = np.isfinite(reach) and count * scene.surfaces[other].count > UNLISTED_PAIRS
            first.append(rows if listed else -1)
            if listed:
                rows += count
                longest = max(longest, reach)
        inner = any(one == other for one, other in pairs)
        potential = interaction.potential
        live = interaction.calculator
        if live is not None:
            potential = ZeroForce(live.length, live.reach)
        both = np.array(pairs, np.int64).reshape(-1, 2)
        named = interaction.species
        kinds = None if named is None else np.searchsorted(scene.species, named)
        found.append(Contact(potential, both, np.array(first, np.int64), kinds, inner or None))
    if not found:  # kernels cannot iterate over an empty tuple: a contact without pairs
        nothing = np.empty(0, dtype=np.int64)
        found.append(Contact(as_potential(Coulomb(0.0)), nothing.reshape(0, 2), nothing, None))
    return tuple(sorted(found, key=lambda each: bool(each.within))), rows, SKIN * longest


def are_coupled(scene: Scene, interaction: Interaction, pair: tuple[int, int]) -> bool:
    """Whether the charges of any bobs of two surfaces are coupled by an interaction.

    One that acts on none at all, as with a strength of zero, is not left out: other runs of the
    same layout may have another strength.
    """
    potential = interaction.potential
    if interaction.calculator is not None:
        return True
    # Not np.unique, which imports masked arrays.
    ones, others = (sorted(set(scene.surfaces[k].each["charge"].tolist())) for k in pair)
    if len(ones) * len(others) > MOST_CHARGES:
        return True
    try:
        if not potential.acts_at_all():
            return True
        return any(itertools.starmap(potential.acts_between, itertools.product(ones, others)))
    except Exception:  # of the user's code, whose line the compiler names
        return True


def neighbours(scene: Scene, model: Tables, rows: int, skin: float, splits: bool) -> Neighbours:
    """An empty list of so many rows, which reaches by `skin` farther than the cutoff [length].

    Without rows it has no memory.
    """
    if rows == 0:
        return NO_NEIGHBOURS
    pairs = []
    kinds = []
    reach = []
    for contact in model.contacts:
        for (one, other), row in zip(contact.pairs, contact.rows, strict=True):
            if row >= 0:
                pairs.append((one, other, row))
                kinds.append((-1, -1) if contact.species is None else contact.species)
                reach.append(contact.potential.range() + skin)
    return _no_lists(model.each.shape[1] // LANES)._replace(
        pairs=np.array(pairs, np.int64),
        species=np.array(kinds, np.int64),
        reach=np.array(reach),
        start=np.zeros(rows + 1, np.int64),
        index=np.zeros(8 * rows, np.int32),
        skin=skin,
        active=active_packs(scene, model, skin) if splits else ALL_ACTIVE,
    )


def _no_lists(packs: int) -> Neighbours:
    """Lists without rows, with room for so many packs."""
    cells = (np.empty(size, np.int64) for size in (2 * packs + 17, packs, packs))
    return Neighbours(
        pairs=np.empty((0, 3), np.int64),
        species=np.empty((0, 2), np.int64),
        reach=np.empty(0),
        start=np.zeros(1, np.int64),
        index=np.empty(0, np.int32),
        place=nowhere(LANES * packs),
        skin=0.0,
        made=np.zeros(1, np.int64),
        crossed=np.zeros(1, np.int64),
        listed=np.full(1, np.nan),
        active=ALL_ACTIVE,
        own=empty_boxes(packs),
        others=empty_boxes(packs),
        cells=Cells(np.zeros(2), np.zeros(2), np.zeros(2, np.int64), *cells),
    )


def active_packs(scene: Scene, model: Tables, skin: float) -> Active:
    """All packs, before the first selection; none where no asperite can be inactive."""
    unlisted: set[int] = set()  # surfaces of pairs without lists
    for contact in model.contacts:
        unlisted.update(contact.pairs[contact.rows < 0].ravel().tolist())
    eligible = []
    for k, surface in enumerate(scene.surfaces):
        # Nothing but contact acts on its asperites, and its bars move uniformly.
        drive = surface.drive
        uniform = (drive.holds_bars or drive.cancels_contact) and drive.plugin is None
        acted_on = scene.has_uncancelled_forces(surface) or surface.reservoir("swing") is not None
        turning = surface.bath.inertias.size > 0 or model.surfaces[k].turning
        eligible.append(
            uniform and not (surface.is_rigid_block or acted_on or turning or k in unlisted)
        )
    if model.calculators is not None or not any(eligible):
        return ALL_ACTIVE
    count = model.each.shape[1]
    surfaces = model.surfaces
    return Active(
        packs=np.arange(count // LANES),
        first=np.append(surfaces.start, surfaces.stop[-1:]) // LANES,
        since=np.full(count // LANES, np.nan),
        eligible=np.array(eligible, np.int64),
        place=nowhere(count),
        selected=np.full(1, np.nan),
        margin=MARGIN * skin,
    )


def empty_boxes(count: int) -> Boxes:
    return Boxes(np.zeros(1, np.int64), np.empty((3, count)), np.empty((3, count)))


def nowhere(count: int) -> np.ndarray:
    """Positions of so many bobs that are not known yet, (2, count)."""
    place = room((2, count))
    place[:] = np.nan
    return place


def with_room(neighbours: Neighbours) -> Neighbours:
    """The same list, or an empty one with more room if it had too little."""
    if neighbours.start[-1] <= neighbours.index.size:
        return neighbours
    index = np.zeros(int(EXTRA_ROOM * neighbours.start[-1]), np.int32)
    return neighbours._replace(index=index, place=nowhere(neighbours.place.shape[1]))


def calculators(
    scene: Scene, depths: list[np.ndarray], starts: np.ndarray
) -> tuple[tuple[Calculator, ...] | None, tuple[Call, ...]]:
    """ASE calculators or None, and their calls, for bobs at `depths`, in columns from `starts`."""
    found: list[Calculator] = []
    calls: list[Call] = []
    for i, interaction in enumerate(scene.interactions):
        live = interaction.calculator
        if live is not None:
            indices = sorted({k for pair in scene.pairs(interaction) for k in pair})
            surfaces = [scene.surfaces[k] for k in indices]
            with inside(f"interaction[{i}]"):
                symbols = elements([name for s in surfaces for name in s.species_of_each.tolist()])
            z = np.concatenate([depths[k] for k in indices])
            counts = [s.count for s in surfaces]
            lengths = scene.periodic.x or 0.0, scene.periodic.z or 0.0
            call = Call(live.calculator, symbols, z, counts, lengths)
            calls.append(call)
            arrays = call.place, call.force, call.energy
            columns = [starts[k] + np.arange(scene.surfaces[k].count) for k in indices]
            found.append(Calculator(call.address, np.concatenate(columns), *arrays))
    return tuple(found) or None, tuple(calls)


def species(scene: Scene, columns: np.ndarray, count: int) -> np.ndarray | None:
    """(count,) index of the species of each bob, in columns (n, members); None if none matters."""
    if all(interaction.species is None for interaction in scene.interactions):
        return None
    names = np.concatenate([surface.species_of_each for surface in scene.surfaces])
    species = room((count,))
    species[columns] = np.searchsorted(scene.species, names)[:, None]
    return species


def is_shared(scene: Scene, contacts: tuple[Contact, ...]) -> bool:
    """Whether a step of a scene takes so long that threads can share it."""
    counts = [surface.count for surface in scene.surfaces]
    pairs = 0
    for contact in contacts:
        for (one, other), row in zip(contact.pairs.tolist(), contact.rows.tolist(), strict=True):
            packs = LISTED_PACKS if row >= 0 else counts[other] // LANES
            pairs += counts[one] * packs
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    return compiled and LANES * pairs >= SHARED_PAIRS


# Where no packs are selected.
ALL_ACTIVE = Active(
    packs=np.empty(0, np.int64),
    first=np.empty(0, np.int64),
    since=np.empty(0),
    eligible=np.empty(0, np.int64),
    place=np.empty((2, 0)),
    selected=np.empty(1),
    margin=0.0,
)
# Of scenes all of whose pairs are visited.
NO_NEIGHBOURS = _no_lists(0)
