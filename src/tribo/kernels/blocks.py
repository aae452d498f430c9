"""Blocks: up to eight neighbouring asperites of one surface, in the lanes of registers.

A block is (s, i, n): the surface's record, the first asperite, and their number.
"""

from tribo.kernels.compiled import inlined, kernel
from tribo.kernels.records import ALONG_X, ALONG_Y
from tribo.kernels.simd import LANES, broadcast, first_lanes, sum_of_lanes
from tribo.kernels.simd_arrays import part, set_part
from tribo.kernels.simd_functions import sine_cosine


@kernel
def block_size(s, i):
    """Number of asperites in the block of surface s that begins with asperite i."""
    return min(LANES, s.stop - i)


@kernel
def coordinates(slot, s, i, n, q):
    """Coordinates or velocities of a block, whose surface has them from `slot` on; 0 without."""
    if slot >= 0:
        return part(q, slot + i - s.start, n)
    return broadcast(0.0)


@kernel
def vectors(table, i, n):
    """x and y of a block of a table of vectors; without a table -0, which changes no sum."""
    if table is None:
        return broadcast(-0.0), broadcast(-0.0)
    return part(table[ALONG_X], i, n), part(table[ALONG_Y], i, n)


@kernel
def set_vectors(table, i, n, x, y):
    """Set x and y of a block of a table of vectors."""
    set_part(table[ALONG_X], i, n, x)
    set_part(table[ALONG_Y], i, n, y)


@kernel
def vector(table, i):
    """x and y of one asperite; 0 without a table."""
    if table is None:
        return 0.0, 0.0
    return table[ALONG_X, i], table[ALONG_Y, i]


@kernel
def clear(table):
    """Set every element of a table to zero, if there is a table."""
    if table is not None:
        for k in range(table.shape[0]):
            row = table[k]
            for m in range(row.size):
                row[m] = 0.0


@inlined
def directions(n, angles):
    """Sines and cosines of a block's angles; what stands beyond it could be slow to reduce."""
    return sine_cosine(first_lanes(n, angles, 0.0))


@kernel
def sum_of_block(n, x):
    """Sum over the asperites of a block."""
    return sum_of_lanes(first_lanes(n, x, 0.0))
