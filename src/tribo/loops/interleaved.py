"""A scene laid out for eight members of an ensemble: the lanes of a pack are one of each."""

from typing import NamedTuple

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room, with_spare_lanes
from tribo.compiler.numbers_in_lanes import numbers_of
from tribo.kernels import records
from tribo.kernels.model import Contact, FieldOn, Model, Tables
from tribo.kernels.records import CHARGE, X_START, Y_START
from tribo.layout import slots
from tribo.layout.layout import Layout
from tribo.layout.scene_records import MemberNumbers
from tribo.layout.tables import constants_of, fill_own, model_tables
from tribo.model.scene import Scene
from tribo.threads.kernel_model import model_of
from tribo.threads.model_units import fulfil, units_of
from tribo.threads.writable_memory import together

# Tables with a column for each asperite of each member, and what says where these stand.
OF_COLUMNS = ("surfaces", "core", "constants", "pivots", "each", "species", "springs", "own")


class Interleaved(NamedTuple):
    """Eight members of a scene for the kernels."""

    model: Model
    q: np.ndarray  # (8, coordinates) where the kernels have what y of a sample has, for each member
    # (accounts,) where they have what s has, for the first member; the others follow it.
    s: np.ndarray
    room: tuple[int, int]  # coordinates and accounts of the kernels
    # Numbers in which members differ, tables of `model` in one array, and where each lane has its
    # own there, (8, numbers).
    memory: np.ndarray
    numbers: np.ndarray


def interleaved(layout: Layout, own_numbers: bool = False) -> Interleaved:
    """Lay out eight members of a scene without calculators or sums, alike or with `own_numbers`."""
    scene = layout.scene
    old = layout.model
    mine = np.asarray(layout.surfaces)
    # Accounts that are of no asperite come first.
    own = mine["acc_block"].tolist() + mine["acc_stage"].tolist()
    shared = max([-1, *own, *layout.accounts_of_fields]) + 1
    surfaces = mine.copy()
    for name in ("acc_block", "acc_stage"):
        surfaces[name] *= np.where(surfaces[name] >= 0, LANES, 1)
    wanted = slots.wanted_slots(scene, surfaces)
    theirs = slots.number(scene, surfaces, wanted, LANES * shared, LANES, LANES)
    numbering = slots.Numbering(mine, layout.core, layout.coordinates, layout.accounts)
    places = []
    for lane in range(LANES):
        of_all = LANES * np.arange(shared) + lane
        of_surfaces = [LANES * np.arange(surface.count) + lane for surface in scene.surfaces]
        places.append(slots.places(numbering, theirs, of_all, of_surfaces))
    columns = np.stack([each.columns for each in places], axis=1)
    asperites = np.asarray(layout.asperites)
    tables = model_tables(scene, asperites, layout.depths, theirs, columns, own_numbers)
    eight = old._replace(
        **{name: getattr(tables, name) for name in OF_COLUMNS},
        contacts=tuple(map(_unlisted, old.contacts)),
        fields=tuple(map(_with_accounts_of_lanes, old.fields or ())) or None,
        members=room((theirs.columns,)),
        team=None,
    )
    memory = np.empty(0)
    numbers = np.empty((LANES, 0), np.int64)
    if own_numbers:
        eight, memory, numbers = _in_one_array(scene, _with_own_numbers(eight))
    model = model_of(eight)
    fulfil(units_of(scene, eight, model, listed=False))
    q = np.array([each.q for each in places])
    size = theirs.coordinates, theirs.accounts
    return Interleaved(model, q, places[0].s, size, memory, numbers)


def _with_own_numbers(model: Tables) -> Tables:
    """The model with tables of what may differ beside the constants of asperites."""
    own = room((len(records.OF_MEMBERS), model.each.shape[1]))
    fill_own(own, model.surfaces)
    contacts = model.contacts
    if len(contacts) == 1 and model.inner is None:
        numbers = np.array(numbers_of(contacts[0].potential), float)
        if numbers.size:
            table = with_spare_lanes(np.repeat(numbers[:, None], LANES, axis=1))
            contacts = (contacts[0]._replace(numbers=table),)
    return model._replace(own=own, contacts=contacts)


def _in_one_array(scene: Scene, model: Tables) -> tuple[Tables, np.ndarray, np.ndarray]:
    """The model with all numbers in which members differ in one array, and their places in it."""
    of_contacts = tuple(contact.numbers for contact in model.contacts)
    tables = model.constants, model.each, model.own, of_contacts
    (constants, each, own, of_contacts), memory = together(tables)

    def places(table: np.ndarray) -> np.ndarray:
        first = (table.ctypes.data - memory.ctypes.data) // table.itemsize
        return first + np.arange(table.size).reshape(table.shape)

    columns = LANES * np.arange(scene.count) + np.arange(LANES)[:, None]
    of_asperites = places(constants), places(each)[[X_START, Y_START, CHARGE]], places(own)
    found = [table[:, columns].swapaxes(0, 1).reshape(LANES, -1) for table in of_asperites]
    found += [places(table).T for table in of_contacts if table is not None]
    contacts = zip(model.contacts, of_contacts, strict=True)
    model = model._replace(
        constants=constants,
        each=each,
        own=own,
        contacts=tuple(contact._replace(numbers=table) for contact, table in contacts),
    )
    return model, memory, np.concatenate(found, axis=1)


def rows_of_numbers(scene: Scene, numbers: MemberNumbers) -> np.ndarray:
    """The numbers of members, in the order of `Interleaved.numbers`, (members, numbers)."""
    a = numbers.asperites
    constants = constants_of(scene, a.ravel()).reshape(-1, *a.shape)
    y = a["y"] + a["facing"] * a["pivot"]
    others = np.stack([a["x"], y, numbers.charges])
    of_surfaces = np.moveaxis(numbers.of_surfaces[:, a["surface"][0]], 2, 0)
    tables = np.concatenate([constants, others, of_surfaces]).swapaxes(0, 1)
    rows = np.concatenate([tables.reshape(len(a), -1), numbers.potential], axis=1)
    return np.ascontiguousarray(rows)  # those of one asperite come by columns


def _unlisted(contact: Contact) -> Contact:
    """A contact without a list of neighbours."""
    return contact._replace(rows=np.full_like(contact.rows, -1))


def _with_accounts_of_lanes(field: FieldOn) -> FieldOn:
    """An external field whose account, if it has one, has a lane for each member."""
    return field._replace(account=LANES * field.account if field.account >= 0 else -1)
