"""Contact: the forces between the bobs of two surfaces, and among the bobs of one.

The latter are internal forces of the surface.
"""

import math

from numba import literal_unroll

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
from tribo.compiler.lanes_memory import add_block, block, set_block
from tribo.compiler.numbers_in_lanes import potential_of
from tribo.compiler.python_callback import call_at
from tribo.kernels import blocks
from tribo.kernels.neighbours import image, is_partner, partner_species
from tribo.kernels.potential_in_lanes import force_in_lanes, range_in_lanes
from tribo.kernels.records import CHARGE, FX, FY, X, Y, Z

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
def inverses_one_by_one(inverse, square, dx, dy, dz, low, high):
    """Inverses of distances with those from `low` to `high` computed without underflow."""
    for i in range(low, high):
        if not lane(square, i) > SQUARE_IS_SAFE:
            r = separation(lane(dx, i), lane(dy, i), lane(dz, i))
            inverse = with_lane(inverse, i, 1.0 / r)
    return inverse


@kernel
def separations_one_by_one(r, square, dx, dy, dz, low, high):
    """The distances r with those from `low` to `high` computed without underflow."""
    for i in range(low, high):
        if not lane(square, i) > SQUARE_IS_SAFE:
            r = with_lane(r, i, separation(lane(dx, i), lane(dy, i), lane(dz, i)))
    return r


@inlined
def separations(square, dx, dy, dz, low, high):
    """Distances and their inverses, of which those from `low` to `high` are wanted."""
    underflows = any_below(low, high, square, SQUARE_IS_SAFE)
    vectors = square, dx, dy, dz, low, high
    if FAST_INVERSE_ROOTS:
        inverse = seldom(underflows, inverse_root(square), inverses_one_by_one, vectors)
        return 1.0 / inverse, inverse
    r = seldom(underflows, sqrt(square), separations_one_by_one, vectors)
    return r, 1.0 / r


@kernel
def row_of(contact, k, other, i, first, neighbours):
    """First and last + 1 of the blocks of candidates for bob i, and whether a list names them.

    `first` is the first bob of the pair's first surface.
    """
    if neighbours is not None:
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
def block_of(neighbours, is_listed, n):
    """The first bob of the nth block of candidates."""
    if neighbours is None:
        return LANES * n
    return LANES * (neighbours.index[n] if is_listed else n)


@inlined
def without_others(force, species, partners, m):
    """Forces where a block of bobs is of a species by `partner_species`, 0 elsewhere."""
    if species is None:
        return force
    if partners == -1:
        return force
    away = absolute(block(species, m) - float(partners))
    return where_less(away, 0.5, force, 0.0)


@inlined
def differences(model, x, y, i, m):
    """Vectors to bob i, or to eight bobs at its depth, at x and y, from a block of bobs.

    They are from the nearest images.
    """
    zs = model.each[Z]
    dx = image(x - block(model.bobs[X], m), model.box, 0)
    dz = image(zs[i] - block(zs, m), model.box, 1)
    return dx, y - block(model.bobs[Y], m), dz


@inlined
def over_distances(potential, square, dx, dy, dz, charge, others, low, high):
    """Forces over distances of the pairs from `low` to `high`, 0 elsewhere."""
    r, inverse = separations(square, dx, dy, dz, low, high)
    end = range_in_lanes(potential)
    f = force_in_lanes(potential, r, end, charge, others, low, high)
    return between_lanes(low, high, where_less(square, end * end, f * inverse, 0.0), 0.0)


@inlined
def block_over_distances(potential, dx, dy, dz, charge, others, low, high):
    """The same of eight pairs; of four where these have all that are wanted."""
    square = dx * dx + dy * dy + dz * dz  # for both, which could round its sums differently
    if high <= NARROW:
        near = narrow(square), narrow(dx), narrow(dy), narrow(dz)
        return widen(over_distances(potential, *near, charge, narrow(others), low, high))
    return over_distances(potential, square, dx, dy, dz, charge, others, low, high)


@inlined
def add_block_forces(model, contact, fx, fy, i, m, low, high):
    """Add the forces of bob i on those from `low` to `high` of a block of bobs.

    Returns the forces on bob i.
    """
    charges = model.each[CHARGE]
    dx, dy, dz = differences(model, model.bobs[X, i], model.bobs[Y, i], i, m)
    others = block(charges, m)
    f = block_over_distances(contact.potential, dx, dy, dz, charges[i], others, low, high)
    f = without_others(f, model.species, partner_species(model.species, contact.species, i), m)
    set_block(fx, m, block(fx, m) - f * dx)
    set_block(fy, m, block(fy, m) - f * dy)
    return f * dx, f * dy


@inlined
def add_row(model, contact, fx, fy, i, other, row, neighbours):
    """Add the forces of bob i on the candidates of its row to the rows fx and fy of a table.

    Returns the force of the candidates on bob i.
    """
    sum_x = broadcast(0.0)
    sum_y = broadcast(0.0)
    start = first_candidate(other, i)
    first, last, is_listed = row
    for n in range(first, last):
        m = block_of(neighbours, is_listed, n)
        low = max(0, start - m)
        high = min(LANES, other.end - m)
        x, y = add_block_forces(model, contact, fx, fy, i, m, low, high)
        sum_x = sum_x + x
        sum_y = sum_y + y
    return sum_of_lanes(sum_x), sum_of_lanes(sum_y)


@inlined
def add_rows(model, contact, k, begin, end, fx, fy, back_x, back_y, neighbours):
    """Add the forces of the kth pair of surfaces on the active blocks of the first in a range.

    `fx` and `fy` are rows of a table with one column a bob, `back_x` and `back_y` those for the
    reactions.
    """
    one = model.surfaces[contact.pairs[k, 0]]
    other = model.surfaces[contact.pairs[k, 1]]
    active = blocks.active_of(neighbours)
    for n in range(begin, end):
        first = blocks.column_of(active, n)
        # Numbers that are stored one by one delay the next load of the block.
        own_x = broadcast(0.0)
        own_y = broadcast(0.0)
        for i in range(first, min(first + LANES, one.end)):
            row = row_of(contact, k, other, i, one.start, neighbours)
            x, y = add_row(model, contact, back_x, back_y, i, other, row, neighbours)
            own_x = with_lane(own_x, i - first, x)
            own_y = with_lane(own_y, i - first, y)
        add_block(fx, first, own_x)
        add_block(fy, first, own_y)


@inlined
def add_contact(model, members, contact, fx, fy, neighbours):
    """Add the forces of one interaction to the rows fx and fy of a table, one column a bob."""
    for k in range(contact.pairs.shape[0]):
        if members is not None:
            add_lane_by_lane(model, contact, k, fx, fy)
            continue
        own = contact.pairs[k, 0]
        one = model.surfaces[own]
        active = blocks.active_of(neighbours)
        begin, end = blocks.first_block(active, one, own), blocks.last_block(active, one, own)
        add_rows(model, contact, k, begin, end, fx, fy, fx, fy, neighbours)


@inlined
def add_lane_by_lane(model, contact, k, fx, fy):
    """Add the forces of the kth pair of surfaces, where each lane is a member of an ensemble."""
    one = model.surfaces[contact.pairs[k, 0]]
    other = model.surfaces[contact.pairs[k, 1]]
    charges = model.each[CHARGE]
    potential = potential_of(contact, None)
    for i in range(one.start, one.stop, LANES):
        partners = partner_species(model.species, contact.species, i)
        x, y, own = block(model.bobs[X], i), block(model.bobs[Y], i), block(charges, i)
        own_x = broadcast(0.0)
        own_y = broadcast(0.0)
        for m in range(max(other.start, i + LANES), other.stop, LANES):
            if is_partner(model.species, partners, m):
                dx, dy, dz = differences(model, x, y, i, m)
                square = dx * dx + dy * dy + dz * dz
                others = block(charges, m)
                f = over_distances(potential, square, dx, dy, dz, own, others, 0, LANES)
                add_block(fx, m, 0.0 - f * dx)
                add_block(fy, m, 0.0 - f * dy)
                own_x = own_x + f * dx
                own_y = own_y + f * dy
        add_block(fx, i, own_x)
        add_block(fy, i, own_y)


@kernel
def call_calculator(model, calculator):
    """Have a calculator compute forces and energy at the bobs' present positions."""
    row = 0
    for k in range(calculator.surfaces.size):
        s = model.surfaces[calculator.surfaces[k]]
        for i in range(s.start, s.end):
            calculator.positions[row, 0] = model.bobs[X, i]
            calculator.positions[row, 1] = model.bobs[Y, i]
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
                for i in range(s.start, s.end):
                    model.bobs[FX, i] += calculator.forces[row, 0]
                    model.bobs[FY, i] += calculator.forces[row, 1]
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
def distance_of(model, i, j):
    """Distance of bob i from the nearest image of bob j."""
    b = model.bobs
    z = model.each[Z]
    dx = image(b[X, i] - b[X, j], model.box, 0)
    return separation(dx, b[Y, i] - b[Y, j], image(z[i] - z[j], model.box, 1))


@kernel
def pair_energy(model, contact, k, neighbours, lane):
    """Potential energy of one interaction between one pair of surfaces, for `lane` of one run."""
    charges = model.each[CHARGE]
    potential = potential_of(contact, lane)
    end = potential.range()
    one = model.surfaces[contact.pairs[k, 0]]
    other = model.surfaces[contact.pairs[k, 1]]
    energy = 0.0
    for i in range(blocks.first_column(one, lane), one.end, blocks.stride_of(lane)):
        partners = partner_species(model.species, contact.species, i)
        start = first_candidate(other, i)
        first, last, is_listed = row_of(contact, k, other, i, one.start, neighbours)
        for n in range(first, last):
            low, high = blocks.columns_at(block_of(neighbours, is_listed, n), lane)
            for j in range(max(start, low), min(high, other.end)):
                if not is_partner(model.species, partners, j):
                    continue
                r = distance_of(model, i, j)
                if r < end:
                    energy += potential.energy_between(r, charges[i], charges[j])
    return energy


@kernel
def contact_energy(model, neighbours, lane):
    """Potential energy of all contacts between surfaces at the bobs' present positions."""
    energy = calculated_energy(model, model.calculators)
    for contact in literal_unroll(model.contacts):
        for k in range(contact.pairs.shape[0]):
            energy += pair_energy(model, contact, k, neighbours, lane)
    return energy
