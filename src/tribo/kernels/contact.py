"""Contact: the force that the bobs of one surface exert on the bobs of another."""

import math

import numpy as np
from numba import literal_unroll

from tribo.kernels.compiled import kernel
from tribo.kernels.neighbours import image

SQUARE_IS_SAFE = 1e-280  # below, r^2 loses digits to underflow


@kernel
def separation(dx, dy, dz):
    """Distance |(dx, dy, dz)|, without underflow."""
    square = dx * dx + dy * dy + dz * dz
    if square > SQUARE_IS_SAFE:
        return math.sqrt(square)
    return math.hypot(math.hypot(dx, dy), dz)


@kernel
def row_of(contact, k, one, other, i, neighbours):
    """Where the candidates for bob i begin and end: in the list, or among all of the surface."""
    if neighbours is None:
        return other.start, other.stop
    if contact.rows[k] < 0:
        return other.start, other.stop
    row = contact.rows[k] + i - one.start
    return neighbours.start[row], neighbours.start[row + 1]


@kernel
def candidate(contact, k, m, neighbours):
    """The bob at place m of a row."""
    if neighbours is None:
        return m
    return neighbours.index[m] if contact.rows[k] >= 0 else m


@kernel
def contact_forces(model, neighbours):
    """Fill in the contact force f1 on every bob."""
    bobs = model.bobs
    box = model.box
    for i in range(bobs.shape[0]):
        bobs[i].fx = 0.0
        bobs[i].fy = 0.0
    for contact in literal_unroll(model.contacts):
        potential = contact.potential
        end = potential.range()
        for k in range(contact.pairs.shape[0]):
            one = model.surfaces[contact.pairs[k, 0]]
            other = model.surfaces[contact.pairs[k, 1]]
            for i in range(one.start, one.stop):
                a = bobs[i]
                fx = 0.0
                fy = 0.0
                begin, stop = row_of(contact, k, one, other, i, neighbours)
                for m in range(begin, stop):
                    b = bobs[candidate(contact, k, m, neighbours)]
                    dx = image(a.x - b.x, box, 0)
                    dy = a.y - b.y
                    r = separation(dx, dy, image(a.z - b.z, box, 1))
                    if r < end:
                        f = potential.force_between(r, a.charge, b.charge) / r
                        fx += f * dx
                        fy += f * dy
                        b.fx -= f * dx
                        b.fy -= f * dy
                a.fx += fx
                a.fy += fy


@kernel
def contact_energy(model, neighbours):
    """Potential energy of all contacts at the bobs' present places."""
    bobs = model.bobs
    energy = 0.0
    for contact in literal_unroll(model.contacts):
        potential = contact.potential
        end = potential.range()
        for k in range(contact.pairs.shape[0]):
            one = model.surfaces[contact.pairs[k, 0]]
            other = model.surfaces[contact.pairs[k, 1]]
            for i in range(one.start, one.stop):
                a = bobs[i]
                begin, stop = row_of(contact, k, one, other, i, neighbours)
                for m in range(begin, stop):
                    b = bobs[candidate(contact, k, m, neighbours)]
                    dx = image(a.x - b.x, model.box, 0)
                    r = separation(dx, a.y - b.y, image(a.z - b.z, model.box, 1))
                    if r < end:
                        energy += potential.energy_between(r, a.charge, b.charge)
    return energy


@kernel
def encounter_rate(model, neighbours, speeds):
    """Largest of (relative speed) / (distance to the next change of force) over all pairs.

    `speeds` (n, 3) holds the velocity of each centre of mass and the fastest its pendulum can
    swing the bob about it.  A potential's clearance(r) is how far a pair at r may move before its
    force is another.  Pairs that are not listed are at least the rest of the skin away from
    mattering.  Returns the rate [1 / time] and the smallest distance of a pair.
    """
    bobs = model.bobs
    rate = 0.0
    closest = np.inf
    for contact in literal_unroll(model.contacts):
        potential = contact.potential
        for k in range(contact.pairs.shape[0]):
            one = model.surfaces[contact.pairs[k, 0]]
            other = model.surfaces[contact.pairs[k, 1]]
            for i in range(one.start, one.stop):
                a = bobs[i]
                begin, stop = row_of(contact, k, one, other, i, neighbours)
                for m in range(begin, stop):
                    j = candidate(contact, k, m, neighbours)
                    b = bobs[j]
                    dx = image(a.x - b.x, model.box, 0)
                    r = separation(dx, a.y - b.y, image(a.z - b.z, model.box, 1))
                    speed = (
                        math.hypot(speeds[i, 0] - speeds[j, 0], speeds[i, 1] - speeds[j, 1])
                        + speeds[i, 2]
                        + speeds[j, 2]
                    )
                    closest = min(closest, r)
                    rate = max(rate, speed / potential.clearance(r))
            if neighbours is not None and contact.rows[k] >= 0:
                rate = max(rate, closing_speed(one, other, speeds) / neighbours.skin)
    return rate, closest


@kernel
def widest_rate(model, speeds):
    """A bound on the encounter rate without looking at pairs; infinite where there is none."""
    shortest = np.inf
    for contact in literal_unroll(model.contacts):
        length, _ = contact.potential.feature()
        shortest = min(shortest, length)
    fastest = 0.0
    for k in range(model.surfaces.shape[0]):
        for m in range(k):
            fastest = max(fastest, closing_speed(model.surfaces[k], model.surfaces[m], speeds))
    return fastest / shortest


@kernel
def closing_speed(one, other, speeds):
    """The fastest that any bob of one surface can approach any of another."""
    low_x = math.inf
    low_y = math.inf
    high_x = -math.inf
    high_y = -math.inf
    swing = 0.0
    for surface in (one, other):
        for i in range(surface.start, surface.stop):
            low_x = min(low_x, speeds[i, 0])
            high_x = max(high_x, speeds[i, 0])
            low_y = min(low_y, speeds[i, 1])
            high_y = max(high_y, speeds[i, 1])
            swing = max(swing, speeds[i, 2])
    return math.hypot(high_x - low_x, high_y - low_y) + 2.0 * swing
