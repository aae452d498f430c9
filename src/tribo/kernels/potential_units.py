"""What time loops ask of a potential at one distance, as units that are called by their address.

Forces are asked for much more often, and have units that compute those of many bobs
(:mod:`tribo.kernels.contact`, :mod:`tribo.pair.potential`).
"""

from tribo.compiler.jit import inlined
from tribo.compiler.numbers_in_lanes import numbers_at_lane
from tribo.compiler.units import call_unit, fetched


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


def energy_unit(potential, r, one, other, lane):
    """The unit of :func:`energy_of`."""
    return energy_of(fetched(potential), r, one, other, lane)


def clearance_unit(potential, r, one, other, lane):
    """The unit of :func:`clearance_of`."""
    return clearance_of(fetched(potential), r, one, other, lane)


@inlined
def energy_at(contacts, n, r, one, other, lane):
    """The energy by the nth interaction."""
    return call_unit(contacts.energy[n], (contacts.numbers[n], r, one, other, lane))


@inlined
def clearance_at(contacts, n, r, one, other, lane):
    """The clearance by the nth interaction."""
    return call_unit(contacts.clearance[n], (contacts.numbers[n], r, one, other, lane))
