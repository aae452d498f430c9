"""How soon bobs meet: rates of encounters, by which steps are bounded."""

import math
from typing import NamedTuple

import numpy as np

from tribo.compiler.jit import apart, inlined, kernel
from tribo.compiler.lanes import between_lanes, broadcast, maximum, sqrt, where_less
from tribo.compiler.lanes import lane as one_lane
from tribo.compiler.lanes_memory import pack
from tribo.compiler.units import call_unit
from tribo.kernels import packs
from tribo.kernels import records as rows
from tribo.kernels.contact import (
    acting,
    differences,
    first_candidate,
    of_partners,
    pack_of,
    row_of,
    separations,
)
from tribo.kernels.potential_units import clearances_at, energy_at
from tribo.kernels.records import CHARGE, OWN_SWING_TEMPERATURE, OWN_TEMPERATURE, X, Y

# Distances, evenly spaced up to the present one, at which the energy of an encounter is looked at.
# The first is a sixteenth: one in sixteen pairs that pass each other comes closer.
PROBES = 16
# With noise, an encounter matters if at one of them the energy exceeds this fraction of k_B T.
NEGLIGIBLE = 0.01


class Encounter(NamedTuple):
    rate: float  # largest (relative speed) / (distance to the next change of force) [1 / time]
    closest: float  # smallest distance of a pair between which a force acts [length]
    clearance: float  # smallest distance that a pair may move before its force changes [length]
    ignored: float  # largest rate of pairs whose potential cannot matter [1 / time]
    one: int  # the bobs of the fastest of these
    other: int


# The numbers of an encounter in the scratch of a model, in which units find it, and behind them
# the thermal energy, below 0 where no surface has a reservoir.
RATE, CLOSEST, CLEARANCE, IGNORED, ONE, OTHER, THERMAL, FOUND = range(8)


@kernel
def thermal_energy(model, own, lane):
    """The largest k_B T of a surface with noise; -1 where no surface has a reservoir."""
    if packs.absent(model.friction) and packs.absent(model.swing_friction):
        return -1.0
    energy = 0.0
    for k in range(model.surfaces.shape[0]):
        s = model.surfaces[k]
        if s.gamma + s.swing_gamma > 0.0:
            bar = s.temperature
            swing = s.swing_temperature
            if not packs.absent(own):
                bar = 0.0
                swing = 0.0
                for i in range(*packs.column_range(s, lane)):
                    bar = max(bar, own[OWN_TEMPERATURE, i])
                    swing = max(swing, own[OWN_SWING_TEMPERATURE, i])
            energy = max(energy, bar, swing)
    return energy


@kernel
def can_matter(contacts, n, r, charge, other_charge, lane, thermal):
    """Whether a pair at r can come to feel the nth interaction, against the thermal energy."""
    if thermal <= 0.0:
        return True
    for k in range(PROBES):
        place = (k + 1) / PROBES * r
        energy = energy_at(contacts, n, place, charge, other_charge, lane)
        if not abs(energy) < NEGLIGIBLE * thermal:
            return True
    return False


@inlined
def distances_of(model, i, m, low, high):
    """Distances of bob i from a pack of bobs, of which those from `low` to `high` are wanted."""
    difference = differences(model, model.box, model.bobs[X, i], model.bobs[Y, i], i, m)
    dx, dy, dz = difference
    square = dx * dx + dy * dy + dz * dz
    return separations(square, *difference, low, high)[0]


@inlined
def speeds_towards(speeds, i, m):
    """Largest speeds at which bob i and each of a pack of bobs can approach each other."""
    vx = speeds[0, i] - pack(speeds[0], m)
    vy = speeds[1, i] - pack(speeds[1], m)
    return sqrt(vx * vx + vy * vy) + speeds[2, i] + pack(speeds[2], m)


@kernel
def find_fastest(model, n, i, m, low, high, r, rates, found, lane):
    """Let the pairs of bob i and some of a pack replace slower ones that were found before."""
    charges = model.each[CHARGE]
    thermal = found[THERMAL]
    for k in range(low, high):
        rate = one_lane(rates, k)
        if rate > found[RATE]:
            j = m + k
            own = one_lane(r, k)
            if can_matter(model.contacts, n, own, charges[i], charges[j], lane, thermal):
                found[RATE] = rate
            elif rate > found[IGNORED]:
                found[IGNORED] = rate
                found[ONE] = i
                found[OTHER] = j


@kernel
def encounter_of_contact(model, n, neighbours, speeds, found, lane):
    """Let encounters of the nth interaction replace those found before that come later."""
    contact = acting(model, n, None, model.box, model.species)
    charges = model.each[CHARGE]
    closest = broadcast(found[CLOSEST])
    clearance = broadcast(found[CLEARANCE])
    for k in range(contact.first, contact.stop):
        one = model.surfaces[contact.pairs[k, 0]]
        other = model.surfaces[contact.pairs[k, 1]]
        for i in range(*packs.column_range(one, lane)):
            start = first_candidate(other, i)
            first, last, is_listed = row_of(contact, k, other, i, one.start, neighbours)
            for place in range(first, last):
                m = pack_of(neighbours, is_listed, place)
                begin, end = packs.columns_at(m, lane)
                low = max(start, begin) - m
                high = min(end, other.end) - m
                r = distances_of(model, i, m, low, high)
                own = clearances_at(model.contacts, n, r, charges[i], pack(charges, m))
                own = of_partners(own, contact.species, contact.kinds, i, m, math.inf)
                own = between_lanes(low, high, own, math.inf)
                closest = lower(closest, where_less(own, math.inf, r, math.inf))
                clearance = lower(clearance, own)
                rates = speeds_towards(speeds, i, m) / own
                rates = where_less(-1.0, rates, rates, 0.0)  # 0 where it is nan
                if maximum(rates) > found[RATE]:
                    find_fastest(model, n, i, m, low, high, r, rates, found, lane)
        if contact.rows[k] >= 0:
            pair = contact.pairs[k, 0], contact.pairs[k, 1]
            speed = closing_speed(model, neighbours.active, pair, speeds)
            found[RATE] = max(found[RATE], speed / neighbours.skin)
            clearance = lower(clearance, broadcast(neighbours.skin))
    found[CLOSEST] = -maximum(-closest)
    found[CLEARANCE] = -maximum(-clearance)


@inlined
def lower(x, y):
    """The smaller of the numbers in each lane; those of x where one of y is nan."""
    return where_less(y, x, y, x)


@kernel
def next_encounter(model, neighbours, speeds, lane):
    """The next encounters of all pairs, or of one member of an ensemble; bobs in place."""
    call_unit(model.units[rows.ENCOUNTERS], (model, neighbours, speeds, lane))
    found = model.found
    one = int(found[ONE])
    other = int(found[OTHER])
    return Encounter(found[RATE], found[CLOSEST], found[CLEARANCE], found[IGNORED], one, other)


def encounters_unit(model, neighbours, speeds, lane):
    """The unit of :func:`next_encounter`, which leaves what it finds in the model.

    A potential's clearance_between(r, one, other) is the distance that a pair of charges at r may
    move before its force changes; where there is no force there is no encounter.  Pairs that are
    not listed are farther apart than the cutoff by what is left of the skin.  With thermal noise,
    pairs whose potential is far below k_B T are counted apart.  `speeds` (3, n) has the velocity of
    each centre of mass, and the largest speed of the bob about it.
    """
    found = model.found
    found[RATE] = 0.0
    found[CLOSEST] = np.inf
    found[CLEARANCE] = np.inf
    found[IGNORED] = 0.0
    found[ONE] = -1.0
    found[OTHER] = -1.0
    found[THERMAL] = thermal_energy(model, model.own, lane)
    for n in range(model.contacts.clearances.size):
        encounter_of_contact(model, n, neighbours, speeds, found, lane)
    return 0.0


@apart
def fastest_approach(model, active, speeds):
    """Largest speed at which two bobs that have a contact can approach each other."""
    fastest = 0.0
    for k in range(model.surfaces.shape[0]):
        for m in range(k if packs.absent(model.inner) else k + 1):
            fastest = max(fastest, closing_speed(model, active, (k, m), speeds))
    return fastest


@kernel
def least_clearance(model, clearance):
    """The smallest clearance of any pair, from a lower bound; no less than the shortest feature."""
    shortest = np.inf
    for n in range(model.contacts.feature.size):
        shortest = min(shortest, model.contacts.feature[n])
    return max(clearance, shortest)


@apart
def closing_speed(model, active, pair, speeds):
    """Largest speed at which any active bob of one surface can approach any of another."""
    low_x = broadcast(math.inf)
    low_y = broadcast(math.inf)
    high_x = broadcast(-math.inf)
    high_y = broadcast(-math.inf)
    swing = broadcast(0.0)
    for m in range(2):
        k = pair[m]
        s = model.surfaces[k]
        for place in range(*packs.active_range(active, s, k)):
            i = packs.column_of(active, place)
            n = s.end - i
            x = pack(speeds[0], i)
            y = pack(speeds[1], i)
            low_x = np.minimum(low_x, between_lanes(0, n, x, math.inf))
            high_x = np.maximum(high_x, between_lanes(0, n, x, -math.inf))
            low_y = np.minimum(low_y, between_lanes(0, n, y, math.inf))
            high_y = np.maximum(high_y, between_lanes(0, n, y, -math.inf))
            swing = np.maximum(swing, between_lanes(0, n, pack(speeds[2], i), 0.0))
    if maximum(high_x) == -math.inf:  # no pack is active
        return 0.0
    x = maximum(high_x) + maximum(-low_x)
    y = maximum(high_y) + maximum(-low_y)
    return math.sqrt(x * x + y * y) + 2.0 * maximum(swing)
