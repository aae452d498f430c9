"""Contact: the forces between the bobs of two surfaces, and among the bobs of one.

The latter are internal forces of the surface.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import literal_unroll

from tribo.kernels.compiled import kernel
from tribo.kernels.neighbours import image, is_partner, partner_species
from tribo.kernels.python_callback import call_at

# Square of a distance below which the squares of its components lose digits to underflow.
SQUARE_IS_SAFE = 1e-280
# With noise, an encounter can matter if at some distance up to the present one, of this many that
# are evenly spaced, the potential energy exceeds this fraction of k_B T.  The first is a sixteenth:
# one in sixteen pairs that pass each other comes closer.
PROBES = 16
NEGLIGIBLE = 0.01


@kernel
def separation(dx, dy, dz):
    """Distance |(dx, dy, dz)|, without underflow."""
    square = dx * dx + dy * dy + dz * dz
    if square > SQUARE_IS_SAFE:
        return math.sqrt(square)
    return math.hypot(math.hypot(dx, dy), dz)


@kernel
def row_of(contact, k, one, other, i, neighbours):
    """First and last + 1 of the candidates for bob i, and whether they are places in the list.

    They are bobs otherwise.  Within one surface they come after i.
    """
    if neighbours is not None:
        if contact.rows[k] >= 0:
            row = contact.rows[k] + i - one.start
            if neighbours.start[row + 1] <= neighbours.index.size:
                return neighbours.start[row], neighbours.start[row + 1], True
    return max(other.start, i + 1), other.stop, False


@kernel
def candidate(neighbours, is_listed, m):
    """Candidate m of a row: a bob."""
    if neighbours is None:
        return m
    return neighbours.index[m] if is_listed else m


@kernel
def add_contact(model, contact, forces, neighbours):
    """Add the forces of one interaction to `forces`, records with fx and fy, one a bob."""
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
            partners = partner_species(model.species, contact.species, i)
            start, stop, is_listed = row_of(contact, k, one, other, i, neighbours)
            for m in range(start, stop):
                j = candidate(neighbours, is_listed, m)
                if not is_partner(model.species, partners, j):
                    continue
                b = bobs[j]
                dx = image(a.x - b.x, box, 0)
                dy = a.y - b.y
                r = separation(dx, dy, image(a.z - b.z, box, 1))
                if r < end:
                    f = potential.force_between(r, a.charge, b.charge) / r
                    fx += f * dx
                    fy += f * dy
                    force = forces[j]
                    force.fx -= f * dx
                    force.fy -= f * dy
            force = forces[i]
            force.fx += fx
            force.fy += fy


@kernel
def contact_forces(model, neighbours):
    """Add the contact force f1 on newly placed bobs, and set the forces within surfaces."""
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
    """Set the forces among the bobs of one surface."""
    if within is not None:
        for i in range(model.inner.shape[0]):
            model.inner[i].fx = 0.0
            model.inner[i].fy = 0.0
        for contact in literal_unroll(within):
            add_contact(model, contact, model.inner, neighbours)


@kernel
def call_calculator(model, calculator):
    """Have a calculator compute forces and energy at the bobs' present positions."""
    row = 0
    for k in range(calculator.surfaces.size):
        s = model.surfaces[calculator.surfaces[k]]
        for i in range(s.start, s.stop):
            calculator.positions[row, 0] = model.bobs[i].x
            calculator.positions[row, 1] = model.bobs[i].y
            row += 1
    call_at(calculator.address)


@kernel
def add_calculated(model, calculators):
    """Add the forces of calculators that are not compiled."""
    if calculators is not None:
        for calculator in calculators:
            call_calculator(model, calculator)
            row = 0
            for k in range(calculator.surfaces.size):
                s = model.surfaces[calculator.surfaces[k]]
                for i in range(s.start, s.stop):
                    b = model.bobs[i]
                    b.fx += calculator.forces[row, 0]
                    b.fy += calculator.forces[row, 1]
                    row += 1


@kernel
def calculated_energy(model, calculators):
    """Energy of the contacts by calculators that are not compiled."""
    energy = 0.0
    if calculators is not None:
        for calculator in calculators:
            call_calculator(model, calculator)
            energy += calculator.energy[0]
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
        partners = partner_species(model.species, contact.species, i)
        start, stop, is_listed = row_of(contact, k, one, other, i, neighbours)
        for m in range(start, stop):
            j = candidate(neighbours, is_listed, m)
            if not is_partner(model.species, partners, j):
                continue
            b = bobs[j]
            dx = image(a.x - b.x, model.box, 0)
            r = separation(dx, a.y - b.y, image(a.z - b.z, model.box, 1))
            if r < end:
                energy += potential.energy_between(r, a.charge, b.charge)
    return energy


@kernel
def contact_energy(model, neighbours):
    """Potential energy of all contacts between surfaces at the bobs' present positions."""
    energy = calculated_energy(model, model.calculators)
    for contact in literal_unroll(model.contacts):
        for k in range(contact.pairs.shape[0]):
            energy += pair_energy(model, contact, k, neighbours)
    return energy


class Encounter(NamedTuple):
    """The next encounters of bobs."""

    rate: float  # largest (relative speed) / (distance to the next change of force) [1 / time]
    closest: float  # smallest distance of a pair [length]
    ignored: float  # largest rate of pairs whose potential cannot matter [1 / time]
    one: int  # the bobs of the fastest of these
    other: int


@kernel
def thermal_energy(model):
    """The largest k_B T of a surface with noise; 0 without noise."""
    energy = 0.0
    for k in range(model.surfaces.shape[0]):
        if model.surfaces[k].gamma > 0.0:
            energy = max(energy, model.surfaces[k].temperature)
    return energy


@kernel
def can_matter(potential, r, charge, other_charge, thermal):
    """Whether a pair at r can come to feel its potential, against the thermal energy."""
    if thermal == 0.0:
        return True
    for k in range(PROBES):
        energy = potential.energy_between((k + 1) / PROBES * r, charge, other_charge)
        if not abs(energy) < NEGLIGIBLE * thermal:
            return True
    return False


@kernel
def encounter_of_contact(model, contact, neighbours, speeds, thermal, found):
    """The encounters found before, or those of one interaction where they come sooner."""
    bobs = model.bobs
    rate, closest, ignored, first, second = found
    potential = contact.potential
    for k in range(contact.pairs.shape[0]):
        one = model.surfaces[contact.pairs[k, 0]]
        other = model.surfaces[contact.pairs[k, 1]]
        for i in range(one.start, one.stop):
            a = bobs[i]
            partners = partner_species(model.species, contact.species, i)
            start, stop, is_listed = row_of(contact, k, one, other, i, neighbours)
            for m in range(start, stop):
                j = candidate(neighbours, is_listed, m)
                if not is_partner(model.species, partners, j):
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
                faster = speed / potential.clearance(r)
                if faster > rate:
                    if can_matter(potential, r, a.charge, b.charge, thermal):
                        rate = faster
                    elif faster > ignored:
                        ignored, first, second = faster, i, j
        if neighbours is not None and contact.rows[k] >= 0:
            rate = max(rate, closing_speed(one, other, speeds) / neighbours.skin)
    return Encounter(rate, closest, ignored, first, second)


@kernel
def next_encounter(model, neighbours, speeds):
    """The next encounters of all pairs.

    A potential's clearance(r) is the distance that a pair at r may move before its force changes.
    Pairs that are not listed are farther apart than the cutoff by what is left of the skin.  With
    thermal noise, pairs whose potential is far below k_B T are counted apart.

    Parameters
    ----------
    model : Model
        The scene, bobs in place.
    neighbours : Neighbours or None
        The list of neighbours.
    speeds : ndarray, (n, 3)
        Velocity of each centre of mass, and the largest speed of the bob about it.

    Returns
    -------
    Encounter
    """
    found = Encounter(0.0, np.inf, 0.0, -1, -1)
    thermal = thermal_energy(model)
    for contact in literal_unroll(model.contacts):
        found = encounter_of_contact(model, contact, neighbours, speeds, thermal, found)
    return encounter_within(model, model.within, neighbours, speeds, thermal, found)


@kernel
def encounter_within(model, within, neighbours, speeds, thermal, found):
    """The same, with the contact within surfaces."""
    if within is not None:
        for contact in literal_unroll(within):
            found = encounter_of_contact(model, contact, neighbours, speeds, thermal, found)
    return found


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
    """An upper bound on the encounter rate that needs no loop over pairs; may be infinite."""
    shortest = min(shortest_feature(model.contacts), shortest_feature(model.within))
    fastest = 0.0
    for k in range(model.surfaces.shape[0]):
        for m in range(k if model.within is None else k + 1):
            fastest = max(fastest, closing_speed(model.surfaces[k], model.surfaces[m], speeds))
    return fastest / shortest if shortest > 0.0 else math.inf


@kernel
def closing_speed(one, other, speeds):
    """Largest speed at which any bob of one surface can approach any of another."""
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
