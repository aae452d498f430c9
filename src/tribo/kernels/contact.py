"""Contact: the forces between the bobs of two surfaces, and among the bobs of one.

The latter are internal forces of the surface.
"""

import math

from tribo.compiler.jit import inlined, kernel
from tribo.compiler.lanes import (
    FAST_INVERSE_ROOTS,
    LANES,
    NARROW,
    absolute,
    any_below,
    between_lanes,
    broadcast,
    inverse_root,
    lane,
    narrow,
    seldom,
    sqrt,
    sum_of_lanes,
    where_less,
    widen,
    with_lane,
)
from tribo.compiler.lanes_memory import pack
from tribo.compiler.python_callback import call_at
from tribo.compiler.units import fetched
from tribo.kernels import packs
from tribo.kernels.model import Acting
from tribo.kernels.neighbours import image, is_partner, partner_species
from tribo.kernels.potential_in_lanes import force_in_lanes, range_of_all_in_lanes
from tribo.kernels.potential_units import energy_at
from tribo.kernels.records import CHARGE, X, Y, Z

# Square of a distance below which the squares of its components lose digits to underflow.
SQUARE_IS_SAFE = 1e-280


@kernel
def separation(dx, dy, dz):
    """Distance |(dx, dy, dz)|, without underflow."""
    square = dx * dx + dy * dy + dz * dz
    if square > SQUARE_IS_SAFE:
        return math.sqrt(square)
    return math.hypot(math.hypot(dx, dy), dz)


@kernel
def one_by_one(found, square, dx, dy, dz, low, high):
    """Distances, or their inverses, with those from `low` to `high` computed without underflow."""
    for i in range(low, high):
        if not lane(square, i) > SQUARE_IS_SAFE:
            r = separation(lane(dx, i), lane(dy, i), lane(dz, i))
            found = with_lane(found, i, 1.0 / r if FAST_INVERSE_ROOTS else r)
    return found


@inlined
def separations(square, dx, dy, dz, low, high):
    """Distances and their inverses, of which those from `low` to `high` are wanted."""
    underflows = any_below(low, high, square, SQUARE_IS_SAFE)
    vectors = square, dx, dy, dz, low, high
    if FAST_INVERSE_ROOTS:
        inverse = seldom(underflows, inverse_root(square), one_by_one, vectors)
        return 1.0 / inverse, inverse
    r = seldom(underflows, sqrt(square), one_by_one, vectors)
    return r, 1.0 / r


@kernel
def row_of(contact, k, other, i, first, neighbours):
    """First and last + 1 of the packs of candidates for bob i, and whether a list names them.

    `first` is the first bob of the pair's first surface.
    """
    if contact.rows[k] >= 0:
        row = contact.rows[k] + i - first
        if neighbours.start[row + 1] <= neighbours.index.size:
            return neighbours.start[row], neighbours.start[row + 1], True
    return first_candidate(other, i) // LANES, (other.end + LANES - 1) // LANES, False


@kernel
def first_candidate(other, i):
    """The first bob of a surface that bob i is paired with; within one surface, the one after i."""
    return max(other.start, i + 1)


@kernel
def pack_of(neighbours, is_listed, n):
    """The first bob of the nth pack of candidates."""
    return LANES * (neighbours.index[n] if is_listed else n)


@inlined
def of_partners(x, species, kinds, i, m, other):
    """`x` where a pack of bobs is of a kind that bob i acts on, the number `other` elsewhere."""
    if species is None:
        return x
    partners = partner_species(species, kinds, i)
    if partners == -1:
        return x
    away = absolute(pack(species, m) - float(partners))
    return where_less(away, 0.5, x, other)


@inlined
def differences(model, box, x, y, i, m):
    """Vectors from the nearest images of a pack of bobs to bob i, or to eight at its depth."""
    zs = model.each[Z]
    dx = image(x - pack(model.bobs[X], m), box, 0)
    dz = image(zs[i] - pack(zs, m), box, 1)
    return dx, y - pack(model.bobs[Y], m), dz


@inlined
def over_distances(potential, square, separation, charge, others, low, high):
    """Forces over distances of the pairs from `low` to `high`, 0 elsewhere.

    `separation` (dx, dy, dz) of each pair, whose square is `square`.
    """
    r, inverse = separations(square, *separation, low, high)
    end = range_of_all_in_lanes(potential)
    f = force_in_lanes(potential, r, end, charge, others, low, high)
    return between_lanes(low, high, where_less(square, end * end, f * inverse, 0.0), 0.0)


@inlined
def pack_over_distances(potential, dx, dy, dz, charge, others, low, high):
    """The same of eight pairs; of four where these have all that are wanted."""
    square = dx * dx + dy * dy + dz * dz  # for both, which could round its sums differently
    if high <= NARROW:
        few = narrow(dx), narrow(dy), narrow(dz)
        return widen(
            over_distances(potential, narrow(square), few, charge, narrow(others), low, high)
        )
    return over_distances(potential, square, (dx, dy, dz), charge, others, low, high)


@inlined
def add_pack_forces(model, contact, table, i, m, low, high):
    """Add the forces of bob i on some lanes of a pack of bobs; returns the forces on bob i."""
    charges = model.each[CHARGE]
    dx, dy, dz = differences(model, contact.box, model.bobs[X, i], model.bobs[Y, i], i, m)
    others = pack(charges, m)
    f = pack_over_distances(contact.potential, dx, dy, dz, charges[i], others, low, high)
    f = of_partners(f, contact.species, contact.kinds, i, m, 0.0)
    x, y = packs.vectors(table, m)
    packs.set_vectors(table, m, x - f * dx, y - f * dy)
    return f * dx, f * dy


@inlined
def add_row(model, contact, table, i, other, row, neighbours):
    """Add the forces of bob i on the candidates of its row; returns the force on bob i."""
    sum_x = broadcast(0.0)
    sum_y = broadcast(0.0)
    start = first_candidate(other, i)
    first, last, is_listed = row
    for n in range(first, last):
        m = pack_of(neighbours, is_listed, n)
        low = max(0, start - m)
        high = min(LANES, other.end - m)
        x, y = add_pack_forces(model, contact, table, i, m, low, high)
        sum_x = sum_x + x
        sum_y = sum_y + y
    return sum_of_lanes(sum_x), sum_of_lanes(sum_y)


@inlined
def add_rows(model, contact, k, begin, end, table, reactions, neighbours):
    """Add the forces of the kth pair of surfaces on the active packs of the first in a range."""
    one = model.surfaces[contact.pairs[k, 0]]
    other = model.surfaces[contact.pairs[k, 1]]
    active = packs.active_of(neighbours)
    for n in range(begin, end):
        first = packs.column_of(active, n)
        # Numbers that are stored one by one delay the next load of the pack.
        own_x = broadcast(0.0)
        own_y = broadcast(0.0)
        for i in range(first, min(first + LANES, one.end)):
            row = row_of(contact, k, other, i, one.start, neighbours)
            x, y = add_row(model, contact, reactions, i, other, row, neighbours)
            own_x = with_lane(own_x, i - first, x)
            own_y = with_lane(own_y, i - first, y)
        packs.add_vectors(table, first, own_x, own_y)


@inlined
def acting(model, n, potential, box, species):
    """The nth interaction, with its potential, or None where that is not needed."""
    contacts = model.contacts
    pairs = contacts.first[n], contacts.first[n + 1], contacts.pairs, contacts.rows
    return Acting(potential, box, species, contacts.species[n], *pairs)


@inlined
def table_of(model, n):
    """Where the forces of the nth interaction are added: f1, or those within one surface."""
    if model.contacts.within[n] == 1:
        return model.inner
    return model.f1


def contact_forces_unit(model, neighbours, potential, n):
    """Add the forces of the nth interaction."""
    contact = acting(model, n, fetched(potential), model.box, model.species)
    add_contact(model, neighbours, contact, table_of(model, n))
    return 0.0


def open_contact_forces_unit(model, neighbours, potential, n):
    """The same without a periodic box and without species, whose tests each pack would pay for."""
    contact = acting(model, n, fetched(potential), None, None)
    add_contact(model, neighbours, contact, table_of(model, n))
    return 0.0


@inlined
def add_contact(model, neighbours, contact, table):
    """Add the forces of an interaction on the active packs of all its pairs of surfaces."""
    active = packs.active_of(neighbours)
    for k in range(contact.first, contact.stop):
        own = contact.pairs[k, 0]
        begin, end = packs.active_range(active, model.surfaces[own], own)
        add_rows(model, contact, k, begin, end, table, table, neighbours)


def contact_forces_of_members_unit(model, neighbours, potential, n):
    """The same where each lane is a member of an ensemble; no neighbours are listed."""
    contact = acting(model, n, fetched(potential), model.box, model.species)
    table = table_of(model, n)
    for k in range(contact.first, contact.stop):
        add_lane_by_lane(model, contact, k, table)
    return 0.0


@inlined
def add_lane_by_lane(model, contact, k, table):
    """Add the forces of the kth pair of surfaces, where each lane is a member of an ensemble."""
    one = model.surfaces[contact.pairs[k, 0]]
    other = model.surfaces[contact.pairs[k, 1]]
    charges = model.each[CHARGE]
    for i in range(one.start, one.stop, LANES):
        partners = partner_species(contact.species, contact.kinds, i)
        x = pack(model.bobs[X], i)
        y = pack(model.bobs[Y], i)
        own = pack(charges, i)
        own_x = broadcast(0.0)
        own_y = broadcast(0.0)
        for m in range(max(other.start, i + LANES), other.stop, LANES):
            if is_partner(contact.species, partners, m):
                separation = differences(model, contact.box, x, y, i, m)
                dx, dy, dz = separation
                square = dx * dx + dy * dy + dz * dz
                others = pack(charges, m)
                f = over_distances(contact.potential, square, separation, own, others, 0, LANES)
                packs.add_vectors(table, m, 0.0 - f * dx, 0.0 - f * dy)
                own_x = own_x + f * dx
                own_y = own_y + f * dy
        packs.add_vectors(table, i, own_x, own_y)


@kernel
def call_calculator(model, calculator):
    """Have a calculator compute forces and energy at the bobs' present positions."""
    for row in range(calculator.columns.size):
        calculator.positions[row, 0] = model.bobs[X, calculator.columns[row]]
        calculator.positions[row, 1] = model.bobs[Y, calculator.columns[row]]
    call_at(calculator.address)


@kernel
def add_calculated(model, calculators):
    """Add the forces on bobs that calculators compute."""
    if calculators is not None:
        for calculator in calculators:
            call_calculator(model, calculator)
            for row in range(calculator.columns.size):
                model.f1[X, calculator.columns[row]] += calculator.forces[row, 0]
                model.f1[Y, calculator.columns[row]] += calculator.forces[row, 1]


@kernel
def calculated_energy(model, calculators):
    """The energy of bobs that calculators compute."""
    energy = 0.0
    if calculators is not None:
        for calculator in calculators:
            call_calculator(model, calculator)
            energy += calculator.energy[0]
    return energy


@kernel
def distance_of(model, i, j):
    """Distance of bob i from the nearest image of bob j."""
    b = model.bobs
    z = model.each[Z]
    dx = image(b[X, i] - b[X, j], model.box, 0)
    return separation(dx, b[Y, i] - b[Y, j], image(z[i] - z[j], model.box, 1))


@kernel
def energy_of_pair(model, neighbours, n, k, lane):
    """Energy of the nth interaction in the kth pair of surfaces, for `lane` of one member."""
    contact = acting(model, n, None, model.box, model.species)
    charges = model.each[CHARGE]
    one = model.surfaces[contact.pairs[k, 0]]
    other = model.surfaces[contact.pairs[k, 1]]
    energy = 0.0
    for i in range(*packs.column_range(one, lane)):
        partners = partner_species(contact.species, contact.kinds, i)
        start = first_candidate(other, i)
        first, last, is_listed = row_of(contact, k, other, i, one.start, neighbours)
        for place in range(first, last):
            low, high = packs.columns_at(pack_of(neighbours, is_listed, place), lane)
            for j in range(max(start, low), min(high, other.end)):
                if is_partner(contact.species, partners, j):
                    r = distance_of(model, i, j)
                    energy += energy_at(model.contacts, n, r, charges[i], charges[j], lane)
    return energy


@kernel
def contact_energy(model, neighbours, lane):
    """Potential energy of all contacts between surfaces at the bobs' present positions."""
    contacts = model.contacts
    energy = calculated_energy(model, model.calculators)
    for n in range(contacts.energy.size):
        if contacts.within[n] == 0:
            for k in range(contacts.first[n], contacts.first[n + 1]):
                energy += energy_of_pair(model, neighbours, n, k, lane)
    return energy
