"""Where every number of a scene stands in the vectors of coordinates and of accounts.

There are two numberings.  Samples have one column for every number.  Kernels compute packs of
asperites, so what a surface has of one kind begins at a multiple of the size of a pack, and the
last pack is filled.
"""

from dataclasses import dataclass

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.kernels import records
from tribo.kernels.accounts import CONTACT, DRIVE, ENDS, POINT, SLIDE, SWING, USER_ENDS
from tribo.kernels.records import BARS
from tribo.model.scene import Scene
from tribo.model.surface import Surface

# How many accounts each group has, of one number an asperite or a lane each.
SIZES = CONTACT, SLIDE, DRIVE, ENDS, USER_ENDS, POINT, POINT, POINT, SWING
GROUPS = dict(zip(records.GROUPS, SIZES, strict=True))
# Coordinates that an asperite may have beside its swing.
COORDINATES = ("dof_phi", "dof_x", "dof_y")


@dataclass(frozen=True)
class Numbering:
    """The slots of all surfaces in one numbering."""

    surfaces: np.ndarray
    core: int  # coordinates of the asperites
    coordinates: int  # all of them, with the baths'
    accounts: int

    @property
    def columns(self) -> int:
        """Number of asperites, with those that fill packs."""
        return int(self.surfaces["stop"][-1])


# Of each group of slots, as "dof_x" or "acc_contact", whether each surface has it.
Wanted = dict[str, list[bool]]


def number(
    scene: Scene,
    surfaces: np.ndarray,
    wanted: Wanted,
    shared: int,
    width: int,
    members: int = 1,
) -> Numbering:
    """Number everything in packs of `width`, behind `shared` accounts that are of no asperite.

    `surfaces` has all but the slots, which are `wanted`; it is copied.  Each asperite stands for so
    many `members`.
    """
    surfaces = surfaces.copy()
    counts = members * np.array([surface.count for surface in scene.surfaces])
    stops = _whole(counts, width).cumsum()
    surfaces["start"] = stops - _whole(counts, width)
    surfaces["stop"] = stops
    surfaces["end"] = surfaces["start"] + counts
    for name, first in (("oscillators", "first_oscillator"), ("torsionals", "first_torsional")):
        surfaces[name] = _whole(surfaces[name], width)
        surfaces[first] = surfaces[name].cumsum() - surfaces[name]
    core = int(stops[-1])
    widths = (stops - surfaces["start"]).tolist()
    for name in COORDINATES:  # after the swings
        surfaces[name], core = _slots(wanted[name], widths, core)
    sizes = counts * (2 * surfaces["oscillators"] + surfaces["torsionals"])
    ends = core + sizes.cumsum()
    surfaces["dof_bath"] = np.where(sizes > 0, ends - sizes, -1)
    accounts = _number_accounts(scene, surfaces, wanted, int(_whole(np.array(shared), width)))
    return Numbering(surfaces, core, int(ends[-1]), accounts)


def _whole(sizes: np.ndarray, width: int) -> np.ndarray:
    """Sizes, rounded up to whole packs."""
    return -(-sizes // width) * width


def _slots(wanted: list[bool], sizes: list[int], first: int) -> tuple[list[int], int]:
    """First slot of each surface, with so many `sizes`, or -1; and the first slot after all."""
    slots = [-1] * len(wanted)
    for k, size in enumerate(sizes):
        if wanted[k]:
            slots[k] = first
            first += size
    return slots, first


def slide(scene: Scene) -> np.ndarray:
    """Whether the centres of mass of each surface can leave their uniform motion."""
    own = scene.surfaces
    return np.array([scene.slides_along_x(s) or scene.slides_along_y(s) for s in own])


def _number_accounts(scene: Scene, surfaces: np.ndarray, wanted: Wanted, stop: int) -> int:
    """Assign the slots of s that asperites have, from `stop` on; returns the number of all."""
    sums = scene.output.ledger == "surfaces"
    size = surfaces["stop"] - surfaces["start"]
    surfaces["account_stride"] = np.minimum(size, LANES) if sums else size
    surfaces["account_mask"] = LANES - 1 if sums else -1
    strides = surfaces["account_stride"].tolist()
    for name, width in GROUPS.items():
        surfaces[name], stop = _slots(wanted[name], [width * each for each in strides], stop)
    return stop


def wanted_slots(scene: Scene, surfaces: np.ndarray) -> Wanted:
    """The coordinates beside the swings, and the groups of accounts, that each surface has.

    Sums over surfaces have accounts for what follows, asperite by asperite, from other accounts:
    the work of drives on arms of different shapes, and the pseudowork of contact on driven bars.
    """
    own = scene.surfaces
    coordinates = {
        "dof_phi": [s.turns_bars for s in own],
        "dof_x": [scene.slides_along_x(s) for s in own],
        "dof_y": [scene.slides_along_y(s) for s in own],
    }
    if scene.output.ledger == "none":
        return coordinates | dict.fromkeys(GROUPS, [False] * len(own))
    sums = scene.output.ledger == "surfaces"
    slides = slide(scene)
    if sums:
        slides |= surfaces["drive"] == BARS
    loaded = surfaces["loaded"].tolist()
    return coordinates | {
        "acc_contact": [True] * len(own),
        "acc_slide": slides.tolist(),
        "acc_drive": [
            s.drive.has_account
            or s.moves_as_one
            or loaded[k] == 1
            or (sums and bool(np.ptp(arm_ratios(s)) > 0.0))
            for k, s in enumerate(own)
        ],
        "acc_ends": [not s.turns_bars and bool((s.each["kappa"] > 0.0).any()) for s in own],
        "acc_user_ends": [s.plugin_at_ends is not None for s in own],
        "acc_internal": [
            bool(
                s.springs or s.elastic or s.bath or s.is_rigid_block or scene.has_contact_within(s)
            )
            for s in own
        ],
        "acc_field": [scene.has_field(s) for s in own],
        "acc_thermal": [s.reservoir("bar") is not None for s in own],
        "acc_swing": [s.reservoir("swing") is not None for s in own],
    }


def give_slots(asperites: np.ndarray, surfaces: np.ndarray, groups: tuple[str, ...]) -> None:
    """Set every asperite's slots of some groups, as "dof_" and "acc_", from its surface's."""
    own = surfaces[asperites["surface"]]
    place = np.arange(asperites.size) - np.searchsorted(asperites["surface"], asperites["surface"])
    asperites["stride"] = own["account_stride"]
    for name in records.ASPERITE.names or ():
        if name.startswith(groups):
            each = 2 * own["oscillators"] + own["torsionals"] if name == "dof_bath" else 1
            asperites[name] = np.where(own[name] >= 0, own[name] + each * place, -1)


def arm_ratios(surface: Surface) -> np.ndarray:
    each = surface.each
    return np.asarray(each["l2"] / each["l1"])


def lanes_of_surfaces(scene: Scene, surfaces: np.ndarray) -> np.ndarray:
    """Asperites that stand for the sums over the lanes of each surface, in place of its own.

    Their works have the levers already; a drive without accounts has that of contact.
    """
    counts = surfaces["account_stride"]
    asperites = np.zeros(int(np.sum(counts)), records.ASPERITE)
    asperites["surface"] = np.repeat(np.arange(len(surfaces)), counts)
    asperites["l1"] = 1.0
    asperites["facing"] = 1.0
    ratios = [arm_ratios(surface)[0] for surface in scene.surfaces]
    asperites["l2"] = np.repeat(np.where(surfaces["acc_drive"] >= 0, 1.0, ratios), counts)
    for name in records.ASPERITE.names or ():
        if name.startswith("dof_"):
            asperites[name] = -1
    give_slots(asperites, surfaces, ("acc_",))
    return asperites


@dataclass(frozen=True)
class Places:
    """Where the kernels have what samples have."""

    columns: np.ndarray  # (n,) of the asperites, in the tables of the kernels
    q: np.ndarray  # (coordinates,)
    s: np.ndarray  # (accounts,)


def spatial_order(bobs: np.ndarray) -> np.ndarray:
    """Places for resting bobs (n, 3) of a surface, so that each pack is compact in space.

    They follow strips in x, each as wide as a square with eight bobs, in alternating directions.
    """
    x = bobs[:, 0]
    z = bobs[:, 2]
    area = float(np.ptp(x) * np.ptp(z))
    strip = np.zeros(len(bobs), np.int64)
    if area > 0.0:
        strip = np.floor((z - np.min(z)) / np.sqrt(LANES * area / len(bobs))).astype(np.int64)
    return np.argsort(np.lexsort((z, np.where(strip % 2 == 0, x, -x), strip)))


def orders_of_bobs(scene: Scene, bobs: list[np.ndarray], compact: bool) -> list[np.ndarray]:
    """The order of each surface's bobs in the tables; where it is `compact`, packs are.

    Lists of neighbours name packs, so they are shorter where packs are compact; lattice springs
    are faster where the bars of a row follow one another.
    """
    return [
        spatial_order(own) if compact and not surface.springs else np.arange(len(own))
        for surface, own in zip(scene.surfaces, bobs, strict=True)
    ]


def places(
    samples: Numbering, kernels: Numbering, shared: np.ndarray, orders: list[np.ndarray]
) -> Places:
    """Where the kernels have what samples have.

    `shared` has the places of accounts of no asperite, `orders` that of each in its surface.
    """
    q = np.empty(samples.coordinates, np.int64)
    s = np.empty(samples.accounts, np.int64)
    s[: shared.size] = shared
    columns = []
    for here, there, order in zip(samples.surfaces, kernels.surfaces, orders, strict=True):
        each = np.arange(order.size)
        columns.append(there["start"] + order)
        for name in ("start", "dof_phi", "dof_x", "dof_y"):
            if here[name] >= 0:
                q[here[name] + each] = there[name] + order
        _place_baths(here, there, order, q)
        each = np.arange(here["account_stride"])
        # Accounts that are sums have lanes in place of asperites.
        place = order if here["account_mask"] == -1 else each
        for name, width in GROUPS.items():
            for k in range(width if here[name] >= 0 else 0):
                stride = there["account_stride"]
                s[here[name] + k * each.size + each] = there[name] + k * stride + place
    return Places(np.concatenate(columns), q, s)


def _place_baths(here: np.void, there: np.void, order: np.ndarray, q: np.ndarray) -> None:
    """Set in `q`, at the slots of a surface's bath oscillators `here`, their slots `there`."""
    mine, theirs = (
        record["dof_bath"] + place[:, None] * (2 * record["oscillators"] + record["torsionals"])
        for record, place in ((here, np.arange(order.size)), (there, order))
    )
    for before, name in ((0, "oscillators"), (1, "oscillators"), (2, "torsionals")):
        n = np.arange(here[name])
        slots = mine + before * here["oscillators"] + n
        q[slots] = theirs + before * there["oscillators"] + n
