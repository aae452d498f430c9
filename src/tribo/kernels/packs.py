"""Packs: eight neighbouring asperites of one surface, in the lanes of registers.

A pack is (s, i): the surface's record, and the column of its first asperite.  Columns that fill
the last pack of a surface have asperites without forces, which never move.

Members of an ensemble can be computed side by side instead: then the lanes of every pack are one
asperite of eight members, and nothing acts between lanes.  `lane` is ONE_RUN where there is one.
"""

from typing import NamedTuple

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import LANES, broadcast, sum_of_lanes
from tribo.compiler.lanes_memory import pack, set_pack
from tribo.compiler.numbers_in_lanes import lane_of
from tribo.kernels.records import X, Y

# In place of the lane of a member, where there is one run.
ONE_RUN = -1


@inlined
def active_of(neighbours):
    """The active packs; there are none where all are."""
    return neighbours.active


@inlined
def absent(table):
    """Whether a table has no columns, since its effect is absent."""
    return table.shape[1] == 0


@inlined
def active_range(active, s, k):
    """The range of the active packs of surface k, whose record is s; all without `active`."""
    if active is None:
        return s.start // LANES, s.stop // LANES
    if active.packs.size == 0:
        return s.start // LANES, s.stop // LANES
    return active.first[k], active.first[k + 1]


class Piece(NamedTuple):
    """Some of the active packs of a surface, from the first one up to another."""

    surface: int  # its index
    begin: int
    end: int


@inlined
def active_piece(model, active, k):
    """All active packs of surface k."""
    begin, end = active_range(active, model.surfaces[k], k)
    return Piece(k, begin, end)


@inlined
def column_of(active, n):
    """First column of the nth active pack."""
    if active is None:
        return LANES * n
    if active.packs.size == 0:
        return LANES * n
    return LANES * active.packs[n]


@inlined
def column_range(s, lane):
    """The range of the columns of a surface, or of a member of an ensemble in a lane."""
    if lane == ONE_RUN:
        return s.start, s.end, 1
    return s.start + lane, s.end, LANES


@inlined
def columns_at(m, lane):
    """The first and the last + 1 of the columns of a pack from m on, or of a member's one."""
    if lane == ONE_RUN:
        return m, m + LANES
    return m + lane, m + lane + 1


@inlined
def sum_at(lane, x):
    """The sum over the asperites of a pack: over all lanes, or of a member's one."""
    if lane == ONE_RUN:
        return sum_of_lanes(x)
    return lane_of(x, lane)


@inlined
def totals(members, x):
    """The sum over all lanes, in each of them; where the lanes are `members`, x of each."""
    if members.size == 0:
        return broadcast(sum_of_lanes(x))
    return x


@inlined
def own_number(own, row, number, i):
    """A number of a surface, or those of a pack whose lanes are members that differ in it."""
    if absent(own):
        return broadcast(number)
    return pack(own[row], i)


@inlined
def column_of_constants(s, i):
    """Column of the constants of a pack, or of one asperite: the same for all that are alike.

    The constants of a million asperites do not fit into the caches, those of one pack do.
    """
    return s.first_constants + ((i - s.start) & s.constants_mask)


@inlined
def keeps_velocity(s):
    """Whether the centres of mass of a surface, or its driven bars, move uniformly."""
    return s.dof_x < 0 and s.dof_y < 0


@inlined
def coordinates(slot, s, i, q):
    """Coordinates or velocities of a pack, whose surface has them from `slot` on; 0 without."""
    if slot >= 0:
        return pack(q, slot + i - s.start)
    return broadcast(0.0)


@inlined
def set_coordinates(slot, s, i, q, x):
    """Set coordinates, velocities or accelerations of a pack, if its surface has them."""
    if slot >= 0:
        set_pack(q, slot + i - s.start, x)


@inlined
def all_coordinates(s, i, q):
    """All coordinates or velocities of a pack, q'' too: swing, bar's angle, x and y; 0 without."""
    angles = pack(q, i), coordinates(s.dof_phi, s, i, q)
    return *angles, coordinates(s.dof_x, s, i, q), coordinates(s.dof_y, s, i, q)


@inlined
def set_all(s, i, q, values):
    """Set all coordinates, velocities or accelerations that a pack has."""
    swing, phi, x, y = values
    set_pack(q, i, swing)
    set_coordinates(s.dof_phi, s, i, q, phi)
    set_coordinates(s.dof_x, s, i, q, x)
    set_coordinates(s.dof_y, s, i, q, y)


@inlined
def vectors(table, i):
    """x and y of a pack of a table of vectors."""
    return pack(table[X], i), pack(table[Y], i)


@inlined
def vectors_if_any(table, i):
    """The same; -0, which changes no sum, where the table's effect is absent."""
    if absent(table):
        return broadcast(-0.0), broadcast(-0.0)
    return vectors(table, i)


@inlined
def set_vectors(table, i, x, y):
    set_pack(table[X], i, x)
    set_pack(table[Y], i, y)


@inlined
def add_vectors(table, i, x, y):
    set_vectors(table, i, *plus(vectors(table, i), (x, y)))


@inlined
def plus(one, other):
    return one[0] + other[0], one[1] + other[1]


@inlined
def plus_if_any(x, table, i):
    """Vectors and those of a pack of a table, if its effect is present."""
    if absent(table):
        return x
    return plus(x, vectors(table, i))


@inlined
def constant(model, row, s, i):
    return pack(model.constants[row], column_of_constants(s, i))


@inlined
def halves(y):
    """Coordinates and velocities, of which a state consists."""
    n = y.size // 2
    return y[:n], y[n:]


@kernel
def clear(table):
    """Set every element of a table to zero."""
    for k in range(table.shape[0]):
        row = table[k]
        for m in range(row.size):
            row[m] = 0.0
