"""Contact: the force that the bobs of one surface exert on the bobs of another.

Where a scene asks for it, also the force among the bobs of one surface, which is internal to it.
"""

import math

import numpy as np
from numba import literal_unroll

from tribo.kernels.compiled import kernel
from tribo.kernels.external import call_at
from tribo.kernels.neighbours import image, is_met, may_meet

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
    """Where the candidates for bob i begin and end, and whether in the list or among all bobs.

    Within one surface, those that come after i.
    """
    if neighbours is not None:
        if contact.rows[k] >= 0:
            row = contact.rows[k] + i - one.start
            if neighbours.start[row + 1] <= neighbours.index.size:
                return neighbours.start[row], neighbours.start[row + 1], True
    return max(other.start, i + 1), other.stop, False


@kernel
def candidate(neighbours, is_listed, m):
    """The bob at place m of a row."""
    if neighbours is None:
        return m
    return neighbours.index[m] if is_listed else m


@kernel
def add_contact(model, contact, pushes, neighbours):
    """Add the forces of one interaction to those on the bobs, `pushes`."""
    bobs = model.bobs
    box = model.box
    potential = contact.potential
    end = potential.range()
    for k in range(contact.pairs.shape[0]):
        one = model.surfaces[contact.pairs[k, 0]]
        other = model.surfaces[contact.pairs[k, 1]]
        for i in range(one.start, one.stop):
            a = bobs[i]
            fx = 0.0
            fy = 0.0
            wanted = may_meet(model.species, contact.species, i)
            start, stop, is_listed = row_of(contact, k, one, other, i, neighbours)
            for m in range(start, stop):
                j = candidate(neighbours, is_listed, m)
                if not is_met(model.species, wanted, j):
                    continue
                b = bobs[j]
                dx = image(a.x - b.x, box, 0)
                dy = a.y - b.y
                r = separation(dx, dy, image(a.z - b.z, box, 1))
                if r < end:
                    f = potential.force_between(r, a.charge, b.charge) / r
                    fx += f * dx
                    fy += f * dy
                    push = pushes[j]
                    push.fx -= f * dx
                    push.fy -= f * dy
            push = pushes[i]
            push.fx += fx
            push.fy += fy


@kernel
def contact_forces(model, neighbours):
    """Fill in the contact force f1 on newly placed bobs, and the contact within if there is any."""
    for contact in literal_unroll(model.contacts):
        add_contact(model, contact, model.bobs, neighbours)
    add_calculated(model, model.calculators)
    add_within(model, model.within, neighbours)


@kernel
def force_within(inner, i):
    """Force on bob i from the other bobs of its surface."""
    if inner is None:
        return 0.0, 0.0
    return inner[i].fx, inner[i].fy


@kernel
def add_within(model, within, neighbours):
    """Fill in the forces among the bobs of one surface."""
    if within is not None:
        for i in range(model.inner.shape[0]):
            model.inner[i].fx = 0.0
            model.inner[i].fy = 0.0
        for contact in literal_unroll(within):
            add_contact(model, contact, model.inner, neighbours)


@kernel
def call_outside(model, calculator):
    """Have a calculator fill in its forces and its energy at the bobs' present places."""
    row = 0
    for k in range(calculator.surfaces.size):
        s = model.surfaces[calculator.surfaces[k]]
        for i in range(s.start, s.stop):
            calculator.place[row, 0] = model.bobs[i].x
            calculator.place[row, 1] = model.bobs[i].y
            row += 1
    call_at(calculator.address)


@kernel
def add_calculated(model, calculators):
    """Add the forces that are computed outside of the kernels."""
    if calculators is not None:
        for calculator in calculators:
            call_outside(model, calculator)
            row = 0
            for k in range(calculator.surfaces.size):
                s = model.surfaces[calculator.surfaces[k]]
                for i in range(s.start, s.stop):
                    b = model.bobs[i]
                    b.fx += calculator.push[row, 0]
                    b.fy += calculator.push[row, 1]
                    row += 1


@kernel
def calculated_energy(model, calculators):
    """Energy of the contacts that are computed outside of the kernels."""
    energy = 0.0
    if calculators is not None:
        for calculator in calculators:
            call_outside(model, calculator)
            energy += calculator.held[0]
    return energy


@kernel
def pair_energy(model, contact, k, neighbours):
    """Potential energy of one interaction between one pair of surfaces."""
    bobs = model.bobs
    potential = contact.potential
    end = potential.range()
    one = model.surfaces[contact.pairs[k, 0]]
    other = model.surfaces[contact.pairs[k, 1]]
    energy = 0.0
    for i in range(one.start, one.stop):
        a = bobs[i]
        wanted = may_meet(model.species, contact.species, i)
        start, stop, is_listed = row_of(contact, k, one, other, i, neighbours)
        for m in range(start, stop):
            j = candidate(neighbours, is_listed, m)
            if not is_met(model.species, wanted, j):
                continue
            b = bobs[j]
            dx = image(a.x - b.x, model.box, 0)
            r = separation(dx, a.y - b.y, image(a.z - b.z, model.box, 1))
            if r < end:
                energy += potential.energy_between(r, a.charge, b.charge)
    return energy


@kernel
def contact_energy(model, neighbours):
    """Potential energy of all contacts between surfaces at the bobs' present places."""
    energy = calculated_energy(model, model.calculators)
    for contact in literal_unroll(model.contacts):
        for k in range(contact.pairs.shape[0]):
            energy += pair_energy(model, contact, k, neighbours)
    return energy


@kernel
def encounter_of(model, contact, neighbours, speeds):
    """What `encounter_rate` wants of one interaction."""
    bobs = model.bobs
    rate = 0.0
    closest = np.inf
    potential = contact.potential
    for k in range(contact.pairs.shape[0]):
        one = model.surfaces[contact.pairs[k, 0]]
        other = model.surfaces[contact.pairs[k, 1]]
        for i in range(one.start, one.stop):
            a = bobs[i]
            wanted = may_meet(model.species, contact.species, i)
            start, stop, is_listed = row_of(contact, k, one, other, i, neighbours)
            for m in range(start, stop):
                j = candidate(neighbours, is_listed, m)
                if not is_met(model.species, wanted, j):
                    continue
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
def encounter_rate(model, neighbours, speeds):
    """Largest of (relative speed) / (distance to the next change of force) over all pairs.

    `speeds` (n, 3) holds the velocity of each centre of mass and the fastest its pendulum can
    swing the bob about it.  A potential's clearance(r) is how far a pair at r may move before its
    force is another.  Pairs that are not listed are at least the rest of the skin away from
    mattering.  Returns the rate [1 / time] and the smallest distance of a pair.
    """
    rate = 0.0
    closest = np.inf
    for contact in literal_unroll(model.contacts):
        faster, closer = encounter_of(model, contact, neighbours, speeds)
        rate = max(rate, faster)
        closest = min(closest, closer)
    return encounter_within(model, model.within, neighbours, speeds, rate, closest)


@kernel
def encounter_within(model, within, neighbours, speeds, rate, closest):
    """The same with the contact within surfaces, where there is any."""
    if within is not None:
        for contact in literal_unroll(within):
            faster, closer = encounter_of(model, contact, neighbours, speeds)
            rate = max(rate, faster)
            closest = min(closest, closer)
    return rate, closest


@kernel
def shortest_feature(contacts):
    """The smallest length over which a force changes; infinite without contacts."""
    shortest = np.inf
    if contacts is not None:
        for contact in literal_unroll(contacts):
            length, _ = contact.potential.feature()
            shortest = min(shortest, length)
    return shortest


@kernel
def widest_rate(model, speeds):
    """A bound on the encounter rate without looking at pairs; infinite where there is none."""
    shortest = min(shortest_feature(model.contacts), shortest_feature(model.within))
    fastest = 0.0
    for k in range(model.surfaces.shape[0]):
        for m in range(k if model.within is None else k + 1):
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
