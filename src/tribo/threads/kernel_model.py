"""The model that kernels read, from the tables of a scene."""

from typing import Any

import numpy as np
from numba import config

from tribo.compiler.lanes_memory import room
from tribo.compiler.team import NO_TEAM, Team
from tribo.compiler.units import memory_of
from tribo.kernels import (
    encounters,
    records,
)
from tribo.kernels import model as parts
from tribo.kernels.model import Box, Contacts, Customs, Fields, Model, Tables
from tribo.layout.elastic_body import NO_BODIES

# Tables of the kernels that are written, one column an asperite, and their numbers of rows.  In the
# tables of a layout they are True where a loop needs them.
SCRATCH = {
    **dict.fromkeys(("bobs", "directions", "f1", "drive", "inner", "external", "internal"), 2),
    **dict.fromkeys(("displaced", "friction", "left", "right", "bath_momentum"), 2),
    "turned": 2,
    **dict.fromkeys(("swing_friction", "couples"), 1),
}
NO_SPRINGS = parts.Springs(np.recarray(0, records.CHAIN), np.zeros((3, 0)))


def model_of(tables: Tables, team: Team | None = None, elastic: parts.Elastic = NO_BODIES) -> Model:
    """The model of one loop, with scratch that no other loop writes, and addresses of no units.

    Those that it needs are named by :mod:`tribo.threads.model_units`.
    """
    columns = tables.each.shape[1]
    scratch = {
        name: room((count, columns if getattr(tables, name) is not None else 0))
        for name, count in SCRATCH.items()
    }
    contacts = tables.contacts
    acting = tables.fields or ()
    return Model(
        constants=tables.constants,
        each=tables.each,
        surfaces=tables.surfaces,
        core=tables.core,
        units=_addresses(len(records.UNITS)),
        contacts=_contacts(contacts),
        fields=_fields(acting),
        drives=_customs(tables.drives or ()),
        ends=_customs(tables.ends or ()),
        **scratch,
        found=room((encounters.FOUND,)),
        ledger=tables.ledger is not None,
        sums=tables.sums is not None,
        shared=tables.ledger is not None and _has_shared_accounts(tables.surfaces, acting),
        rigid=bool(np.any(tables.surfaces.drive == records.RIGID)),
        on_bobs=any(scratch[name].size for name in ("inner", "external")),
        on_bars=any(scratch[name].size for name in ("internal", "friction", "left", "right")),
        species=room((0,)) if tables.species is None else tables.species,
        elastic=elastic,
        bodies=bool(np.any(tables.surfaces.elastic > 0)),
        blocks=bool(np.any(tables.surfaces.block > 0)),
        pivots=room((1, 0)) if tables.pivots is None else tables.pivots,
        arms=room((2, 0)) if tables.arms is None else tables.arms,
        box=tables.box or Box(0.0, 0.0),
        springs=tables.springs or NO_SPRINGS,
        bath=room((2, 0)) if tables.bath is None else tables.bath,
        torsional=room((2, 0)) if tables.torsional is None else tables.torsional,
        team=team or NO_TEAM,
        calculators=tables.calculators,
        members=room((0,)) if tables.members is None else tables.members,
        own=room((1, 0)) if tables.own is None else tables.own,
        schedules=_copied(tables.schedules),
    )


def with_own_memory(model: Model) -> Model:
    """The same model, with memory that no other loop writes; but for threads and calculators."""
    used = [name for name in SCRATCH if getattr(model, name).size > 0]
    scratch: Any = {name: room(getattr(model, name).shape) for name in used}
    body = model.elastic
    if model.bodies:
        own = {"grid": room(body.grid.shape), "waves": room(body.waves.shape)}
        body = body._replace(**own, calls=body.calls.copy())
    return model._replace(
        **scratch,
        found=room(model.found.shape),
        units=model.units.copy(),
        surfaces=model.surfaces.copy(),
        schedules=_copied(model.schedules),
        elastic=body,
    )


def _has_shared_accounts(surfaces: Any, fields: tuple[parts.FieldOn, ...]) -> bool:
    """Whether works are kept of surfaces as a whole, of stages, or of moving fields."""
    of_surfaces = np.any(surfaces.acc_block >= 0) or np.any(surfaces.acc_stage >= 0)
    return bool(of_surfaces) or any(each.account >= 0 for each in fields)


def _copied(table: np.ndarray) -> np.ndarray:
    """A table in memory of its own."""
    own = room(table.shape)
    own[:] = table
    return own


def _addresses(count: int) -> np.ndarray:
    """Room for addresses, which are functions where nothing is compiled."""
    compiled = not config.DISABLE_JIT  # type: ignore[attr-defined]
    return np.zeros(count, np.int64 if compiled else object)


def _places(parts: list[np.ndarray]) -> np.ndarray:
    """Where each of some parts of an array begins, and where the last one ends."""
    return np.cumsum([0, *map(len, parts)])


def _contacts(contacts: tuple[parts.Contact, ...]) -> Contacts:
    """The arrays of all contacts; addresses of what is compiled are still zero."""
    count = len(contacts)
    memory, numbers = memory_of(tuple(each.potential for each in contacts))
    for n, each in enumerate(contacts):
        if each.numbers is not None and numbers.dtype != object:
            numbers[n] = each.numbers.ctypes.data
    species = [(-1, -1) if each.species is None else each.species for each in contacts]
    return Contacts(
        forces=_addresses(count),
        pieces=_addresses(count),
        energy=_addresses(count),
        clearances=_addresses(count),
        numbers=numbers,
        memory=memory,
        feature=np.array([float(each.potential.feature()[0]) for each in contacts]),
        within=np.array([1 if each.within else 0 for each in contacts]),
        species=np.array(species, np.int64).reshape(-1, 2),
        first=_places([each.pairs for each in contacts]),
        pairs=np.concatenate([each.pairs for each in contacts]),
        rows=np.concatenate([each.rows for each in contacts]),
    )


def _fields(found: tuple[parts.FieldOn, ...]) -> Fields:
    """The arrays of all fields; addresses of what is compiled are still zero."""
    count = len(found)
    memory, numbers = memory_of(tuple(each.potential for each in found))
    none: list[np.ndarray] = [np.empty(0, np.int64)]
    return Fields(
        forces=_addresses(count),
        energy=_addresses(count),
        power=_addresses(count),
        numbers=numbers,
        memory=memory,
        first=_places([each.surfaces for each in found]),
        surfaces=np.concatenate([*none, *(each.surfaces for each in found)]),
        origin=np.array([each.origin for each in found]).reshape(-1, 2),
        velocity=np.array([each.velocity for each in found]).reshape(-1, 2),
        drift=np.array([each.drift for each in found]).reshape(-1, 2),
        account=np.array([each.account for each in found], np.int64),
        modulation=np.array([each.modulation for each in found], np.int64),
        begun=np.array([each.begun for each in found], float),
    )


def _customs(found: tuple[parts.Custom, ...]) -> Customs:
    """The arrays of plug-ins for bars or ends; addresses are still zero."""
    memory, numbers = memory_of(tuple(each.plugin for each in found))
    return Customs(
        forces=_addresses(len(found)),
        numbers=numbers,
        memory=memory,
        surface=np.array([each.surface for each in found], np.int64),
        origin=np.array([each.origin for each in found], float).reshape(-1, 2),
        velocity=np.array([each.velocity for each in found], float).reshape(-1, 2),
        begun=np.array([each.begun for each in found], float),
    )
