"""Elastic bodies: forces between the bars of a grid on a half-space or a layer, and their energy.

Those of few bars are sums over all pairs.  Those of many bars come from Fourier transforms, which
compiled code calls; see `layout.elastic_body`.  Only scenes with such bodies compile these units.
"""

from tribo.compiler.jit import apart, inlined
from tribo.compiler.lanes import LANES, broadcast, sum_of_lanes
from tribo.compiler.lanes_memory import pack
from tribo.compiler.python_callback import call_at
from tribo.kernels.packs import add_vectors, vectors
from tribo.kernels.records import PAIRS, WAVES, X, Y

# Places of the addresses in `Elastic.calls`.
FORWARD, BACKWARD = range(2)
# Places in a row of `Elastic.pairs`, whose numbers are those of a pack of bars; and the rows of
# `Elastic.shares`.
XX, XY, YX, YY = range(0, 4 * LANES, LANES)
SHARE_XX, SHARE_XY, SHARE_YX, SHARE_YY = range(4)


@inlined
def shares_of_bars(shares, i, x, y):
    """The force on a pack of bars, of which each would take (x, y) if all took the same."""
    along = pack(shares[SHARE_XX], i) * x + pack(shares[SHARE_XY], i) * y
    return along, pack(shares[SHARE_YX], i) * x + pack(shares[SHARE_YY], i) * y


@apart
def set_place(model, s):
    """Set the displacement of the body of a block, at which its drive acts."""
    shares = model.elastic.shares
    x = broadcast(0.0)
    y = broadcast(0.0)
    for i in range(s.start, s.stop, LANES):
        along, upward = vectors(model.displaced, i)
        x = x + pack(shares[SHARE_XX], i) * along + pack(shares[SHARE_YX], i) * upward
        y = y + pack(shares[SHARE_XY], i) * along + pack(shares[SHARE_YY], i) * upward
    s.ax = sum_of_lanes(x) / (s.end - s.start)
    s.ay = sum_of_lanes(y) / (s.end - s.start)


@apart
def forces_of_pairs(model, s, i):
    """Forces on the pack of bars at i by the displacements of all bars of its surface."""
    x = broadcast(0.0)
    y = broadcast(0.0)
    row = s.elastic_row + (i - s.start) // LANES * (s.end - s.start)
    for j in range(s.start, s.end):
        along = model.displaced[X, j]
        upward = model.displaced[Y, j]
        pairs = model.elastic.pairs[row]
        x = x - (pack(pairs, XX) * along + pack(pairs, XY) * upward)
        y = y - (pack(pairs, YX) * along + pack(pairs, YY) * upward)
        row += 1
    return x, y


@apart
def stretch_grids(model):
    """Put K times the displacements of bars into the grids."""
    grid = model.elastic.grid
    columns = model.elastic.columns
    for n in range(columns.size):
        grid[X, n] = model.displaced[X, columns[n]]
        grid[Y, n] = model.displaced[Y, columns[n]]
    call_at(model.elastic.calls[FORWARD])
    multiply_waves(model.elastic.waves, model.elastic.stiffness)
    call_at(model.elastic.calls[BACKWARD])


@apart
def multiply_waves(waves, stiffness):
    """Multiply each wave by its matrix, K_xx, i K_xy, -i K_xy, K_yy."""
    for n in range(stiffness.shape[1]):
        real = 2 * n
        imaginary = real + 1
        xx = stiffness[0, n]
        yy = stiffness[1, n]
        xy = stiffness[2, n]
        x, x_i = waves[X, real], waves[X, imaginary]
        y, y_i = waves[Y, real], waves[Y, imaginary]
        waves[X, real] = xx * x - xy * y_i
        waves[X, imaginary] = xx * x_i + xy * y
        waves[Y, real] = yy * y + xy * x_i
        waves[Y, imaginary] = yy * y_i - xy * x


def elastic_forces(model):
    """Add the forces of elastic bodies on the bars, whose displacements are in place."""
    columns = model.elastic.columns
    if columns.size > 0:
        stretch_grids(model)
        for n in range(columns.size):
            model.internal[X, columns[n]] -= model.elastic.grid[X, n]
            model.internal[Y, columns[n]] -= model.elastic.grid[Y, n]
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.elastic == PAIRS:
            for i in range(s.start, s.stop, LANES):
                add_vectors(model.internal, i, *forces_of_pairs(model, s, i))
        if s.elastic_block > 0:
            set_place(model, s)
    return 0.0


def elastic_energies(model, stored, slot):
    """Add the energies of elastic bodies to (surfaces, slots) `stored`."""
    grid = model.elastic.grid
    columns = model.elastic.columns
    if columns.size > 0:
        stretch_grids(model)
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.elastic == WAVES:
            twice = 0.0
            for n in range(s.elastic_row, s.elastic_row + (s.end - s.start)):
                i = columns[n]
                twice += model.displaced[X, i] * grid[X, n] + model.displaced[Y, i] * grid[Y, n]
            stored[k, slot] += 0.5 * twice
        if s.elastic == PAIRS:
            for i in range(s.start, s.stop, LANES):
                x, y = forces_of_pairs(model, s, i)
                along, upward = vectors(model.displaced, i)
                stored[k, slot] -= 0.5 * sum_of_lanes(x * along + y * upward)
    return 0.0
