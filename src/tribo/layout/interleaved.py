"""A scene laid out for eight members of an ensemble: the lanes of a block are one of each."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room, with_spare_lanes
from tribo.compiler.potential_numbers import numbers_of
from tribo.kernels import records
from tribo.kernels.records import Contact, Model, Springs
from tribo.layout import slots
from tribo.layout.force_records import in_blocks
from tribo.layout.layout import Layout
from tribo.layout.loop_memory import with_scratch
from tribo.layout.tables import columns_of_constants


class Interleaved(NamedTuple):
    """Eight members of a scene for the kernels."""

    model: Model
    q: np.ndarray  # (8, coordinates) where the kernels have what y of a sample has, for each member
    # (accounts,) where they have what s has, for the first member; the others follow it.
    s: np.ndarray
    room: tuple[int, int]  # coordinates and accounts of the kernels


def interleaved(layout: Layout, own_numbers: bool = False) -> Interleaved:
    """Lay out eight members, each with arrays of its own for what changes.

    All are alike, or have constants, velocities and numbers of a potential of their own.  The scene
    has neither calculators that are not compiled, nor sums over surfaces as accounts.
    """
    scene, old = layout.scene, layout.model
    surfaces = np.asarray(layout.surfaces).copy()
    shared = _shared_accounts(layout)
    surfaces["acc_block"] *= np.where(surfaces["acc_block"] >= 0, LANES, 1)
    theirs = slots.number(scene, surfaces, LANES * shared, LANES, LANES)
    mine = slots.Numbering(
        np.asarray(layout.surfaces), layout.core, layout.coordinates, layout.accounts
    )
    places = [
        slots.places(
            mine,
            theirs,
            LANES * np.arange(shared) + lane,
            [LANES * np.arange(surface.count) + lane for surface in scene.surfaces],
        )
        for lane in range(LANES)
    ]
    model = with_scratch(old, theirs.columns)._replace(
        surfaces=_with_constants(theirs.surfaces, old).view(np.recarray),
        core=theirs.core,
        constants=_repeated_constants(layout, old.constants),
        pivots=None if old.pivots is None else _repeated_constants(layout, old.pivots),
        each=_repeated(old.each[:, layout.places.columns]),
        species=None if old.species is None else _repeated(old.species[layout.places.columns]),
        contacts=tuple(map(_unlisted, old.contacts)),
        within=None if old.within is None else tuple(map(_unlisted, old.within)),
        springs=None if old.springs is None else _springs(old, theirs.surfaces),
        fields=_fields(old.fields),
        members=room((theirs.columns,)),
        team=None,
    )
    if own_numbers:
        model = _with_own_numbers(model, layout)
    q = np.array([each.q for each in places])
    return Interleaved(model, q, places[0].s, (theirs.coordinates, theirs.accounts))


def _shared_accounts(layout: Layout) -> int:
    """The number of accounts that are of no asperite."""
    fields = [field.account for field in layout.model.fields or ()]
    return int(max([*layout.surfaces.acc_block.tolist(), *fields])) + 1


def _with_own_numbers(model: Model, layout: Layout) -> Model:
    """The model with a column of constants for each asperite, and tables of what may differ."""
    owners, columns = layout.asperites.surface, layout.places.columns
    columns = columns_of_constants(layout.model.surfaces, owners, columns)
    surfaces, pivots = model.surfaces.copy(), layout.model.pivots
    surfaces["first_constants"], surfaces["constants_mask"] = surfaces["start"], -1
    own = room((len(records.OF_MEMBERS), model.each.shape[1]))
    for surface in surfaces:
        for row, name in enumerate(records.OF_MEMBERS):
            own[row, surface["start"] : surface["end"]] = surface[name]
    contacts = model.contacts
    if len(contacts) == 1 and model.within is None:
        numbers = np.array(numbers_of(contacts[0].potential), float)
        if numbers.size:
            table = with_spare_lanes(np.repeat(numbers[:, None], LANES, axis=1))
            contacts = (contacts[0]._replace(numbers=table),)
    return model._replace(
        constants=_repeated(layout.model.constants[:, columns]),
        pivots=None if pivots is None else _repeated(pivots[:, columns]),
        surfaces=surfaces,
        own=own,
        contacts=contacts,
    )


def _repeated(values: np.ndarray) -> np.ndarray:
    """Values with one column an asperite, as often as there are members."""
    return with_spare_lanes(np.repeat(values, LANES, axis=-1))


def _is_alike(surface: Any) -> bool:
    """Whether the asperites of a surface share one block of constants."""
    return bool(surface["constants_mask"] == 0)


def _with_constants(surfaces: np.ndarray, old: Model) -> np.ndarray:
    """Surfaces with the columns of their constants in tables of :func:`_repeated_constants`."""
    first = 0
    for surface, before in zip(surfaces, old.surfaces, strict=True):
        surface["first_constants"], surface["constants_mask"] = first, before["constants_mask"]
        first += LANES if _is_alike(before) else LANES * int(before["end"] - before["start"])
    return surfaces


def _repeated_constants(layout: Layout, table: np.ndarray) -> np.ndarray:
    """A table of constants in which each asperite that has its own column has a block of them."""
    surfaces, owners = layout.model.surfaces, layout.asperites.surface
    columns = columns_of_constants(surfaces, owners, layout.places.columns)
    parts = (
        columns[part][: 1 if _is_alike(surface) else None]
        for surface, part in zip(surfaces, layout.parts.values(), strict=True)
    )
    return _repeated(table[:, np.concatenate(list(parts))])


def _unlisted(contact: Contact) -> Contact:
    """A contact without a list of neighbours."""
    return contact._replace(rows=np.full_like(contact.rows, -1))


def _springs(old: Model, surfaces: np.ndarray) -> Springs:
    """Chains of springs of all members, side by side."""
    chains, tables = np.asarray(old.springs.chains).copy(), []
    for chain in chains:
        own = slice(chain["first"], chain["first"] + chain["count"])
        tables.append(np.repeat(old.springs.table[:, own], LANES, axis=1))
        before, after = old.surfaces[chain["surface"]], surfaces[chain["surface"]]
        for end in ("i", "j"):
            chain[end] = after["start"] + LANES * (chain[end] - before["start"])
        chain["count"] *= LANES
    return in_blocks(chains, np.concatenate(tables, axis=1))


def _fields(fields: tuple[records.FieldOn, ...] | None) -> tuple[records.FieldOn, ...] | None:
    """External fields whose accounts have a lane for each member."""
    if fields is None:
        return None
    return tuple(f._replace(account=LANES * f.account if f.account >= 0 else -1) for f in fields)
