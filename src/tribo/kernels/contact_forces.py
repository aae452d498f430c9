"""All contact forces, by one thread or shared by several.

Threads share the rows of each pair of surfaces.  The rows are divided into chunks, whose number
depends on the scene alone.  A chunk sets the forces on its own bobs, and writes the reactions to a
table of its own.  The tables are then added in the order of the chunks.
"""

from tribo.compiler import team as teams
from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import LANES, broadcast
from tribo.compiler.units import call_unit, fetched
from tribo.kernels import packs
from tribo.kernels.contact import (
    acting,
    add_calculated,
    add_rows,
    pack_of,
    row_of,
    table_of,
)
from tribo.kernels.records import SHARE_CONTACTS


@inlined
def contact_forces(model, neighbours):
    """Add the contact force f1 on newly placed bobs, and set the forces within surfaces."""
    packs.clear(model.inner)
    add_contacts(model, model.team, neighbours)
    add_calculated(model, model.calculators)


@inlined
def add_contacts(model, team, neighbours):
    contacts = model.contacts
    if team.counters.size == 0:
        for n in range(contacts.forces.size):
            call_unit(contacts.forces[n], (model, neighbours, contacts.numbers[n], n))
    else:
        call_unit(model.units[SHARE_CONTACTS], (model, neighbours))


def share_contacts(model, neighbours):
    """Add the forces of all interactions together with assistants, pair by pair of surfaces."""
    contacts = model.contacts
    team = model.team
    for n in range(contacts.pieces.size):
        for k in range(contacts.first[n], contacts.first[n + 1]):
            team.counters[teams.INTERACTION] = n
            team.counters[teams.PAIR] = k
            share_phase(model, team, neighbours, teams.CONTACT, team.reach.shape[0])
            share_phase(model, team, neighbours, teams.REACTIONS, team.tiles.shape[0])
    return 0.0


@apart
def share_phase(model, team, neighbours, phase, pieces):
    """Compute all pieces of a phase of contact, together with assistants."""
    piece = teams.begin_phase(team, phase, pieces)
    while piece >= 0:
        contact_piece(model, team, neighbours, piece)
        piece = teams.continue_phase(team)


@apart
def contact_piece(model, team, neighbours, piece):
    """A chunk of rows of one pair of surfaces, or a tile of the sum of their reactions."""
    contacts = model.contacts
    n = team.counters[teams.INTERACTION]
    if team.counters[teams.PHASE] == teams.CONTACT:
        call_unit(contacts.pieces[n], (model, neighbours, contacts.numbers[n], n, piece))
    else:
        add_reactions(model, team, contacts.pairs, table_of(model, n), piece)


def contact_piece_unit(model, neighbours, potential, n, piece):
    """Do a chunk of rows of the nth interaction in the present pair of surfaces."""
    contact = acting(model, n, fetched(potential), model.box, model.species)
    add_chunk(model, model.team, contact, table_of(model, n), neighbours, piece)
    return 0.0


def open_contact_piece_unit(model, neighbours, potential, n, piece):
    """The same without a periodic box and without species."""
    contact = acting(model, n, fetched(potential), None, None)
    add_chunk(model, model.team, contact, table_of(model, n), neighbours, piece)
    return 0.0


@apart
def add_reactions(model, team, pairs, table, piece):
    """Add a tile of the reactions to all chunks of a pair of surfaces."""
    k = team.counters[teams.PAIR]
    if team.tiles[piece, 0] == pairs[k, 1]:
        s = model.surfaces[team.tiles[piece, 0]]
        first = s.start // LANES
        last = s.stop // LANES
        begin, end = teams.part_of(first, last, team.tiles[piece, 1], team.tiles[piece, 2])
        # The reactions to all chunks, in their order.
        for chunk in range(team.reach.shape[0]):
            low = max(LANES * begin, team.reach[chunk, 0])
            high = min(LANES * end, team.reach[chunk, 1])
            for i in range(low, high, LANES):
                packs.add_vectors(table, i, *packs.vectors(team.reactions[chunk], i))


@inlined
def add_chunk(model, team, contact, table, neighbours, chunk):
    """Add the forces on the bobs of a chunk of rows, and set the table of the reactions."""
    k = team.counters[teams.PAIR]
    own = contact.pairs[k, 0]
    one = model.surfaces[own]
    active = packs.active_of(neighbours)
    first, last = packs.active_range(active, one, own)
    begin, end = teams.part_of(first, last, chunk, team.reach.shape[0])
    low, high = reach_of_rows(model, contact, k, begin, end, neighbours)
    team.reach[chunk, 0] = low
    team.reach[chunk, 1] = high
    reactions = team.reactions[chunk]
    for i in range(low, high, LANES):
        packs.set_vectors(reactions, i, broadcast(0.0), broadcast(0.0))
    add_rows(model, contact, k, begin, end, table, reactions, neighbours)


@kernel
def reach_of_rows(model, contact, k, begin, end, neighbours):
    """The first and the last + 1 of the columns of all candidates of some active packs of rows."""
    one = model.surfaces[contact.pairs[k, 0]]
    other = model.surfaces[contact.pairs[k, 1]]
    low, high = other.stop, other.start
    active = packs.active_of(neighbours)
    for n in range(begin, end):
        column = packs.column_of(active, n)
        for i in range(column, min(column + LANES, one.end)):
            first, last, is_listed = row_of(contact, k, other, i, one.start, neighbours)
            if first < last:
                low = min(low, pack_of(neighbours, is_listed, first))
                high = max(high, pack_of(neighbours, is_listed, last - 1) + LANES)
    return low, high
