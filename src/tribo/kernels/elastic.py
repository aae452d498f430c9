"""Elastic bodies: forces between the bars of a grid on a half-space or a layer, and their energy.

Those of few bars are sums over all pairs.  Those of many bars come from Fourier transforms, which
compiled code calls; see `layout.elastic_body`.
"""

from tribo.compiler.jit import apart
from tribo.compiler.lanes import LANES, broadcast, sum_of_lanes
from tribo.compiler.lanes_memory import block
from tribo.compiler.python_callback import call_at
from tribo.kernels.blocks import add_vectors, vectors
from tribo.kernels.records import X, Y

# Places of the addresses in `Model.elastic`.
FORCES, ENERGIES = range(2)
# Places in a row of `Model.elastic_pairs`, whose numbers are those of a block of bars.
XX, XY, YX, YY = range(0, 4 * LANES, LANES)


@apart
def forces_of_pairs(model, s, i):
    """Forces on the block of bars at i by the displacements of all bars of its surface."""
    x = broadcast(0.0)
    y = broadcast(0.0)
    row = s.elastic_row + (i - s.start) // LANES * (s.end - s.start)
    for j in range(s.start, s.end):
        along = model.displaced[X, j]
        upward = model.displaced[Y, j]
        pairs = model.elastic_pairs[row]
        x = x - (block(pairs, XX) * along + block(pairs, XY) * upward)
        y = y - (block(pairs, YX) * along + block(pairs, YY) * upward)
        row += 1
    return x, y


@apart
def elastic_forces(model):
    """Add the forces of elastic bodies on the bars, whose displacements are in place."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.elastic_row > 0:
            sum_x = 0.0
            sum_y = 0.0
            for i in range(s.start, s.stop, LANES):
                add_vectors(model.internal, i, *forces_of_pairs(model, s, i))
            for j in range(s.start, s.end):
                sum_x += model.displaced[X, j]
                sum_y += model.displaced[Y, j]
            s.ax = sum_x / (s.end - s.start)
            s.ay = sum_y / (s.end - s.start)
    if model.elastic.size > 0:
        call_at(model.elastic[FORCES])


@apart
def elastic_energies(model, stored, slot):
    """Add the energies of elastic bodies to (surfaces, slots) `stored`."""
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.elastic_row > 0:
            for i in range(s.start, s.stop, LANES):
                x, y = forces_of_pairs(model, s, i)
                along, upward = vectors(model.displaced, i)
                stored[k, slot] -= 0.5 * sum_of_lanes(x * along + y * upward)
    if model.elastic.size > 0:
        call_at(model.elastic[ENERGIES])
        for k in range(model.surfaces.shape[0]):
            stored[k, slot] += model.elastic_energy[k]
