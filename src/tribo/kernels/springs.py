"""Lattice springs: f = -k (stretch) on the bars, and their energy.

The stretch is (r2_i - r2_j) - (r2_i - r2_j)_rest.  Springs stand in chains, each between bars
i + n and j + n, of which eight are computed at once.
"""

from tribo.kernels.blocks import sum_of_block
from tribo.kernels.compiled import kernel
from tribo.kernels.records import ALONG_X, ALONG_Y, REST_X, REST_Y, STIFFNESS
from tribo.kernels.simd import LANES
from tribo.kernels.simd_arrays import part, set_part


@kernel
def stretches(displaced, axis, rest, i, j, n):
    """One component of the stretches of springs between bars from i and from j on."""
    return part(displaced[axis], i, n) - part(displaced[axis], j, n) + rest


@kernel
def add_along(model, axis, i, j, n, stiffness, rest):
    """Add one component of the forces of springs between bars from i and from j on."""
    force = stiffness * stretches(model.displaced, axis, rest, i, j, n)
    row = model.internal[axis]
    set_part(row, i, n, part(row, i, n) - force)
    set_part(row, j, n, part(row, j, n) + force)


@kernel
def spring_forces(model, springs):
    """Add the forces of all springs on the bars."""
    if springs is not None:
        for k in range(springs.chains.shape[0]):
            chain = springs.chains[k]
            for m in range(0, chain.count, LANES):
                n = min(LANES, chain.count - m)
                stiffness = part(springs.table[STIFFNESS], chain.first + m, n)
                x = part(springs.table[REST_X], chain.first + m, n)
                y = part(springs.table[REST_Y], chain.first + m, n)
                add_along(model, ALONG_X, chain.i + m, chain.j + m, n, stiffness, x)
                add_along(model, ALONG_Y, chain.i + m, chain.j + m, n, stiffness, y)


@kernel
def spring_energies(model, springs, stored):
    """Add the energy of each surface's springs to (surfaces,) `stored`."""
    if springs is not None:
        for k in range(springs.chains.shape[0]):
            chain = springs.chains[k]
            for m in range(0, chain.count, LANES):
                n = min(LANES, chain.count - m)
                i = chain.i + m
                j = chain.j + m
                rest_x = part(springs.table[REST_X], chain.first + m, n)
                rest_y = part(springs.table[REST_Y], chain.first + m, n)
                x = stretches(model.displaced, ALONG_X, rest_x, i, j, n)
                y = stretches(model.displaced, ALONG_Y, rest_y, i, j, n)
                stiffness = part(springs.table[STIFFNESS], chain.first + m, n)
                stored[chain.surface] += sum_of_block(n, 0.5 * stiffness * (x * x + y * y))
