"""All contact forces, by one thread or shared by several.

Threads share the rows of each pair of surfaces.  The rows are divided into chunks, whose number
depends on the scene alone.  A chunk sets the forces on its own bobs, and writes the reactions to a
table of its own.  The tables are then added in the order of the chunks.
"""

from numba import literal_unroll

from tribo.compiler import team as teams
from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import LANES, broadcast
from tribo.compiler.lanes_memory import add_block, block, set_block
from tribo.kernels.blocks import active_of, clear, column_of, first_block, last_block
from tribo.kernels.contact import add_calculated, add_contact, add_rows, block_of, row_of
from tribo.kernels.records import ALONG_X, ALONG_Y, FX, FY


@inlined
def contact_forces(model, neighbours):
    """Add the contact force f1 on newly placed bobs, and set the forces within surfaces."""
    add_across(model, model.team, neighbours)
    add_calculated(model, model.calculators)
    add_within(model, model.within, model.team, neighbours)


@inlined
def add_across(model, team, neighbours):
    """Add the forces between surfaces."""
    if team is None:
        fx, fy = model.bobs[FX], model.bobs[FY]
        for contact in literal_unroll(model.contacts):
            add_contact(model, model.members, contact, fx, fy, neighbours)
    else:
        share_contacts(model, team, model.contacts, 0, neighbours)


@kernel
def add_within(model, within, team, neighbours):
    """Set the forces among the bobs of one surface."""
    if within is not None:
        clear(model.inner)
        if team is None:
            fx, fy = model.inner[ALONG_X], model.inner[ALONG_Y]
            for contact in literal_unroll(within):
                add_contact(model, model.members, contact, fx, fy, neighbours)
        else:
            share_contacts(model, team, within, len(model.contacts), neighbours)


@kernel
def share_contacts(model, team, contacts, first, neighbours):
    """Add the forces of interactions, the first of which has the number `first`."""
    number = first
    for contact in literal_unroll(contacts):
        for k in range(contact.pairs.shape[0]):
            team.counters[teams.INTERACTION] = number
            team.counters[teams.PAIR] = k
            share_phase(model, team, neighbours, teams.CONTACT, team.reach.shape[0])
            share_phase(model, team, neighbours, teams.REACTIONS, team.tiles.shape[0])
        number += 1


@kernel
def share_phase(model, team, neighbours, phase, pieces):
    """Compute all pieces of a phase of contact, together with assistants."""
    piece = teams.begin_phase(team, phase, pieces)
    while piece >= 0:
        contact_piece(model, team, neighbours, piece)
        piece = teams.continue_phase(team)


@kernel
def contact_piece(model, team, neighbours, piece):
    """Compute a piece of the present phase of contact."""
    number = 0
    for contact in literal_unroll(model.contacts):
        if number == team.counters[teams.INTERACTION]:
            fx, fy = model.bobs[FX], model.bobs[FY]
            piece_of_contact(model, team, contact, fx, fy, neighbours, piece)
        number += 1
    piece_within(model, model.within, team, number, neighbours, piece)


@kernel
def piece_within(model, within, team, number, neighbours, piece):
    """The same within surfaces."""
    if within is not None:
        for contact in literal_unroll(within):
            if number == team.counters[teams.INTERACTION]:
                fx, fy = model.inner[ALONG_X], model.inner[ALONG_Y]
                piece_of_contact(model, team, contact, fx, fy, neighbours, piece)
            number += 1


@inlined
def piece_of_contact(model, team, contact, fx, fy, neighbours, piece):
    """A chunk of rows of one pair of surfaces, or a tile of the sum of their reactions."""
    k = team.counters[teams.PAIR]
    if team.counters[teams.PHASE] == teams.CONTACT:
        add_chunk(model, team, contact, k, fx, fy, neighbours, piece)
    elif team.tiles[piece, 0] == contact.pairs[k, 1]:
        s = model.surfaces[team.tiles[piece, 0]]
        blocks = s.start // LANES, s.stop // LANES
        begin, end = teams.part_of(blocks[0], blocks[1], team.tiles[piece, 1], team.tiles[piece, 2])
        add_reactions(team, fx, fy, LANES * begin, LANES * end)


@inlined
def add_chunk(model, team, contact, k, fx, fy, neighbours, chunk):
    """Add the forces on the bobs of a chunk of rows, and set the table of the reactions."""
    own = contact.pairs[k, 0]
    one = model.surfaces[own]
    active = active_of(neighbours)
    first, last = first_block(active, one, own), last_block(active, one, own)
    begin, end = teams.part_of(first, last, chunk, team.reach.shape[0])
    low, high = reach_of_rows(model, contact, k, begin, end, neighbours)
    team.reach[chunk, 0] = low
    team.reach[chunk, 1] = high
    back_x = team.reactions[2 * chunk]
    back_y = team.reactions[2 * chunk + 1]
    for i in range(low, high, LANES):
        set_block(back_x, i, broadcast(0.0))
        set_block(back_y, i, broadcast(0.0))
    add_rows(model, contact, k, begin, end, fx, fy, back_x, back_y, neighbours)


@kernel
def reach_of_rows(model, contact, k, begin, end, neighbours):
    """The first and the last + 1 of the columns of all candidates of some active blocks of rows."""
    one = model.surfaces[contact.pairs[k, 0]]
    other = model.surfaces[contact.pairs[k, 1]]
    low, high = other.stop, other.start
    active = active_of(neighbours)
    for n in range(begin, end):
        column = column_of(active, n)
        for i in range(column, min(column + LANES, one.end)):
            first, last, is_listed = row_of(contact, k, other, i, one.start, neighbours)
            if first < last:
                low = min(low, block_of(neighbours, is_listed, first))
                high = max(high, block_of(neighbours, is_listed, last - 1) + LANES)
    return low, high


@inlined
def add_reactions(team, fx, fy, first, last):
    """Add the reactions to all chunks, in their order, to the columns from `first` to `last`."""
    for chunk in range(team.reach.shape[0]):
        low = max(first, team.reach[chunk, 0])
        high = min(last, team.reach[chunk, 1])
        for i in range(low, high, LANES):
            add_block(fx, i, block(team.reactions[2 * chunk], i))
            add_block(fy, i, block(team.reactions[2 * chunk + 1], i))
