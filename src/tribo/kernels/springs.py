"""Lattice springs: f = -k (stretch) on the bars, and their energy.

The stretch is (r2_i - r2_j) - (r2_i - r2_j)_rest.  Springs stand in chains, each between bars
i + n and j + n, of which eight are computed at once; columns that fill the last pack of a chain
have springs without stiffness.
"""

from tribo.compiler.jit import apart, inlined
from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import add_pack, pack
from tribo.kernels.packs import sum_at
from tribo.kernels.records import REST_X, REST_Y, STIFFNESS, X, Y


@inlined
def stretches(displaced, axis, rest, i, j):
    """One component of the stretches of springs between bars from i and from j on."""
    return pack(displaced[axis], i) - pack(displaced[axis], j) + rest


@inlined
def add_to_bars(model, springs, chain, axis, row_of_rest, first, sign):
    """Add one component of a chain's forces, times `sign`, to the bars from `first` on."""
    forces = model.internal[axis]
    for m in range(0, chain.count, LANES):
        stiffness = sign * pack(springs.table[STIFFNESS], chain.first + m)
        rest = pack(springs.table[row_of_rest], chain.first + m)
        stretch = stretches(model.displaced, axis, rest, chain.i + m, chain.j + m)
        add_pack(forces, first + m, stiffness * stretch)


@inlined
def spring_forces(model, springs):
    """Add the forces of all springs on the bars.

    Those on the first bars of all springs of a chain come before those on the second, so that no
    element is read just after it was written as part of another pack.
    """
    for k in range(springs.chains.shape[0]):
        chain = springs.chains[k]
        add_to_bars(model, springs, chain, X, REST_X, chain.i, -1.0)
        add_to_bars(model, springs, chain, Y, REST_Y, chain.i, -1.0)
        add_to_bars(model, springs, chain, X, REST_X, chain.j, 1.0)
        add_to_bars(model, springs, chain, Y, REST_Y, chain.j, 1.0)


@apart
def spring_energies(model, springs, stored, slot, lane):
    """Add the energy of each surface's springs to (surfaces, slots) `stored`."""
    for k in range(springs.chains.shape[0]):
        chain = springs.chains[k]
        for m in range(0, chain.count, LANES):
            i = chain.i + m
            j = chain.j + m
            rest_x = pack(springs.table[REST_X], chain.first + m)
            rest_y = pack(springs.table[REST_Y], chain.first + m)
            x = stretches(model.displaced, X, rest_x, i, j)
            y = stretches(model.displaced, Y, rest_y, i, j)
            stiffness = pack(springs.table[STIFFNESS], chain.first + m)
            energies = 0.5 * stiffness * (x * x + y * y)
            stored[chain.surface, slot] += sum_at(lane, energies)
