"""Contact: the force that the bobs of one surface exert on the bobs of another."""

import math

import numpy as np
from numba import literal_unroll

from tribo.kernels.compiled import kernel

SQUARE_IS_SAFE = 1e-280  # below, r^2 loses digits to underflow


@kernel
def separation(dx, dy, dz):
    """Distance |(dx, dy, dz)|, without underflow."""
    square = dx * dx + dy * dy + dz * dz
    if square > SQUARE_IS_SAFE:
        return math.sqrt(square)
    return math.hypot(math.hypot(dx, dy), dz)


@kernel
def contact_forces(contacts, surfaces, bobs):
    """Fill in the contact force f1 on every bob, all pairs of interacting surfaces."""
    for i in range(bobs.shape[0]):
        bobs[i].fx = 0.0
        bobs[i].fy = 0.0
    for contact in literal_unroll(contacts):
        potential = contact.potential
        for k in range(contact.pairs.shape[0]):
            one = surfaces[contact.pairs[k, 0]]
            other = surfaces[contact.pairs[k, 1]]
            for i in range(one.start, one.stop):
                a = bobs[i]
                fx = 0.0
                fy = 0.0
                for j in range(other.start, other.stop):
                    b = bobs[j]
                    dx = a.x - b.x
                    dy = a.y - b.y
                    r = separation(dx, dy, a.z - b.z)
                    f = potential.coupling(a.charge, b.charge) * potential.force(r) / r
                    fx += f * dx
                    fy += f * dy
                    b.fx -= f * dx
                    b.fy -= f * dy
                a.fx += fx
                a.fy += fy


@kernel
def contact_energy(contacts, surfaces, bobs):
    """Potential energy of all contacts at the bobs' present places."""
    energy = 0.0
    for contact in literal_unroll(contacts):
        potential = contact.potential
        for k in range(contact.pairs.shape[0]):
            one = surfaces[contact.pairs[k, 0]]
            other = surfaces[contact.pairs[k, 1]]
            for i in range(one.start, one.stop):
                a = bobs[i]
                for j in range(other.start, other.stop):
                    b = bobs[j]
                    r = separation(a.x - b.x, a.y - b.y, a.z - b.z)
                    energy += potential.coupling(a.charge, b.charge) * potential.energy(r)
    return energy


@kernel
def encounter_rate(contacts, surfaces, bobs, speeds):
    """Largest of (relative speed) / (distance to the next change of force) over all pairs.

    `speeds` (n, 3) holds the velocity of each centre of mass and the fastest its pendulum can
    swing the bob about it.  A potential's feature() is the length over which its force changes,
    and the distance out to which it does so.  Returns the rate [1 / time] and the smallest
    distance of a pair.
    """
    rate = 0.0
    closest = np.inf
    for contact in literal_unroll(contacts):
        length, reach = contact.potential.feature()
        for k in range(contact.pairs.shape[0]):
            one = surfaces[contact.pairs[k, 0]]
            other = surfaces[contact.pairs[k, 1]]
            for i in range(one.start, one.stop):
                a = bobs[i]
                for j in range(other.start, other.stop):
                    b = bobs[j]
                    r = separation(a.x - b.x, a.y - b.y, a.z - b.z)
                    speed = (
                        math.hypot(speeds[i, 0] - speeds[j, 0], speeds[i, 1] - speeds[j, 1])
                        + speeds[i, 2]
                        + speeds[j, 2]
                    )
                    closest = min(closest, r)
                    rate = max(rate, speed / max(length, r - reach))
    return rate, closest
