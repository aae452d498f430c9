"""What time loops ask of a potential at one distance, as units that are called by their address.

Forces are asked for much more often, and have units that compute those of many bobs
(:mod:`tribo.kernels.contact`, :mod:`tribo.pair.potential`).
"""

from tribo.compiler.jit import inlined
from tribo.compiler.lanes import LANES, lane, with_lane
from tribo.compiler.numbers_in_lanes import lane_of, numbers_at_lane
from tribo.compiler.units import call_unit, call_unit_in_lanes, fetched


@inlined
def energy_of(potential, r, one, other, lane):
    """The energy of two charges at a distance, by the potential of a lane if each has its own."""
    own = numbers_at_lane(potential, lane)
    if r < own.range_between(one, other):
        return own.energy_between(r, one, other)
    return 0.0


@inlined
def clearance_of(potential, r, one, other, lane):
    """How far two charges may move from a distance before their force changes [length]."""
    return numbers_at_lane(potential, lane).clearance_between(r, one, other)


@inlined
def clearance_of_each(potential, r, one, other):
    """The same at eight distances; the potential or the charges may be one for each."""
    clear = r
    for i in range(LANES):
        each = clearance_of(potential, lane(r, i), lane_of(one, i), lane_of(other, i), i)
        clear = with_lane(clear, i, each)
    return clear


def energy_unit(potential, r, one, other, lane):
    """The unit of :func:`energy_of`."""
    return energy_of(fetched(potential), r, one, other, lane)


def clearance_unit(potential, r, one, other, lane):
    """The unit of :func:`clearance_of`."""
    return clearance_of(fetched(potential), r, one, other, lane)


def clearances_unit(potential, r, one, other):
    """The unit of :func:`clearance_of_each`."""
    return clearance_of_each(fetched(potential), r, one, other)


@inlined
def energy_at(contacts, n, r, one, other, lane):
    """The energy by the nth interaction."""
    return call_unit(contacts.energy[n], (contacts.numbers[n], r, one, other, lane))


@inlined
def clearances_at(contacts, n, r, one, others):
    """The clearances of a bob from eight others by the nth interaction."""
    return call_unit_in_lanes(contacts.clearances[n], (contacts.numbers[n], r, one, others))
