"""Levers about the centre of mass, and its velocity: the ledger's view of driven bars.

The equations of motion refer to the centre of mass, or on driven bars to the bar's centre, the
pivot, which moves uniformly.  There the constants are L1 = length, L2 = 0, INERTIA = m1 length^2
and an infinite MASS, and there are no coordinates x and y.  `pivots` has the distance from the
pivot to the centre of mass: l2 on driven bars, 0 elsewhere; empty without driven bars.  So it is
where pendulums hang from bars that are one rigid body, with a finite MASS, and coordinates x and y
of the bars.
"""

from tribo.compiler.jit import inlined
from tribo.compiler.lanes import broadcast
from tribo.compiler.lanes_memory import pack
from tribo.kernels.packs import absent, column_of_constants, constant, vectors
from tribo.kernels.records import L1, L2, MASS


@inlined
def levers(model, pivots, s, i):
    """Distances from the centre of mass to the bob and to the bar, of a pack."""
    bob = constant(model, L1, s, i)
    bar = constant(model, L2, s, i)
    if absent(pivots):
        return bob, bar
    return bob - pivot_lengths(pivots, s, i), bar + pivot_lengths(pivots, s, i)


@inlined
def pivot_lengths(pivots, s, i):
    if absent(pivots):
        return broadcast(0.0)
    return pack(pivots[0], column_of_constants(s, i))


@inlined
def lever_mass(model, s, i):
    """m1 length of a pack of pendulums on rigid bars; 0 of asperites that fill a pack."""
    return constant(model, MASS, s, i) * pivot_lengths(model.pivots, s, i)


@inlined
def velocities_of_centres(model, pivots, s, i, omega, vx, vy):
    """Velocities of the centres of mass of a pack in the surface's first frame, bobs in place."""
    if absent(pivots):  # no bars are driven: they are those of x and y
        return vx, vy
    speed = pivot_lengths(pivots, s, i) * omega
    tx, ty = vectors(model.directions, i)
    return vx + speed * tx, vy + speed * ty
