"""Blocks: eight neighbouring asperites of one surface, in the lanes of registers.

A block is (s, i): the surface's record, and the column of its first asperite.  Columns that fill
the last block of a surface have asperites without forces, which never move.
"""

from tribo.kernels.compiled import inlined, kernel
from tribo.kernels.records import ALONG_X, ALONG_Y, BARS
from tribo.kernels.simd import LANES, broadcast
from tribo.kernels.simd_arrays import block, set_block


@inlined
def active_of(neighbours):
    """The active blocks; None where all are."""
    if neighbours is None:
        return None
    return neighbours.active


@inlined
def selected_at(active):
    """When the active blocks were selected; 0 where all are active."""
    if active is None:
        return 0.0
    return active.selected[0]


@inlined
def first_block(active, s, k):
    """Place of the first active block of surface k, whose record is s; all are without `active`."""
    if active is None:
        return s.start // LANES
    return active.first[k]


@inlined
def last_block(active, s, k):
    """Place of its last active block, plus one."""
    if active is None:
        return s.stop // LANES
    return active.first[k + 1]


@inlined
def column_of(active, n):
    """First column of the nth active block."""
    if active is None:
        return LANES * n
    return LANES * active.blocks[n]


@inlined
def column_of_constants(s, i):
    """Column of the constants of a block, or of one asperite: the same for all that are alike.

    The constants of a million asperites do not fit into the caches, those of one block do.
    """
    return s.first_constants + ((i - s.start) & s.constants_mask)


@inlined
def keeps_velocity(s):
    """Whether the centres of mass of a surface, or its driven bars, move uniformly."""
    return s.drive == BARS or (s.dof_x < 0 and s.dof_y < 0)


@inlined
def coordinates(slot, s, i, q):
    """Coordinates or velocities of a block, whose surface has them from `slot` on; 0 without."""
    if slot >= 0:
        return block(q, slot + i - s.start)
    return broadcast(0.0)


@inlined
def set_coordinates(slot, s, i, q, x):
    """Set coordinates, velocities or accelerations of a block, if its surface has them."""
    if slot >= 0:
        set_block(q, slot + i - s.start, x)


@inlined
def all_coordinates(s, i, q):
    """All coordinates or velocities of a block, q'' too: swing, bar's angle, x and y; 0 without."""
    angles = block(q, i), coordinates(s.dof_phi, s, i, q)
    return *angles, coordinates(s.dof_x, s, i, q), coordinates(s.dof_y, s, i, q)


@inlined
def set_all(s, i, q, values):
    """Set all coordinates, velocities or accelerations that a block has."""
    swing, phi, x, y = values
    set_block(q, i, swing)
    set_coordinates(s.dof_phi, s, i, q, phi)
    set_coordinates(s.dof_x, s, i, q, x)
    set_coordinates(s.dof_y, s, i, q, y)


@inlined
def vectors(table, i):
    """x and y of a block of a table of vectors; without a table -0, which changes no sum."""
    if table is None:
        return broadcast(-0.0), broadcast(-0.0)
    return block(table[ALONG_X], i), block(table[ALONG_Y], i)


@inlined
def set_vectors(table, i, x, y):
    """Set x and y of a block of a table of vectors."""
    set_block(table[ALONG_X], i, x)
    set_block(table[ALONG_Y], i, y)


@inlined
def numbers(table, i):
    """A block of a table of one row; without a table -0, which changes no sum."""
    if table is None:
        return broadcast(-0.0)
    return block(table[0], i)


@inlined
def is_fixed(fixed, s):
    """Whether the asperites of a surface are rigid; `fixed` is None where none are."""
    if fixed is None:
        return False
    return s.fixed == 1


@kernel
def clear(table):
    """Set every element of a table to zero, if there is a table."""
    if table is not None:
        for k in range(table.shape[0]):
            row = table[k]
            for m in range(row.size):
                row[m] = 0.0
