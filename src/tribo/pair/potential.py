"""The potential of two asperites: as it is, or behind units that are called by their address.

The loops that Python calls have units, so they are compiled once for all potentials; the program of
a page, which is compiled for one potential, contains its formulas.
"""

from typing import Any, NamedTuple

from numba.extending import overload

from tribo.compiler.jit import OVERLOAD, inlined
from tribo.compiler.lanes import (
    FAST_INVERSE_ROOTS,
    LANES,
    inverse_root,
    sqrt,
    where_less,
)
from tribo.compiler.units import call_unit, call_unit_in_lanes, fetched
from tribo.kernels.potential_in_lanes import force_in_lanes, range_in_lanes
from tribo.kernels.potential_units import clearance_of, clearance_of_each, energy_of


class PotentialUnits(NamedTuple):
    """Addresses of the units of a potential, or of one for each lane, and of its numbers."""

    force: int
    clearance: int  # the unit of `clearances_of` in lanes
    energy: int
    numbers: int


@inlined
def with_numbers(units, numbers):
    """The units with the address of other numbers."""
    return PotentialUnits(units.force, units.clearance, units.energy, numbers)


@inlined
def root_and_inverse(square):
    if FAST_INVERSE_ROOTS:
        inverse = inverse_root(square)
        return 1.0 / inverse, inverse
    r = sqrt(square)
    return r, r * (1.0 / square)  # the quotient need not wait for the root


def force_over_distance(potential, square, one, other):
    """Force over distance of two charges at eight distances, whose squares are given.

    It is 0 from the potential's range on.
    """
    r, inverse = root_and_inverse(square)
    cutoff = range_in_lanes(potential, one, other)
    f = force_in_lanes(potential, r, cutoff, one, other, 0, LANES) * inverse
    return where_less(square, cutoff * cutoff, f, 0.0)


def clearances_of(potential, r, one, other):
    """Clearances at eight distances; the potential or the charges may be one for each."""
    return clearance_of_each(potential, r, one, other)


def _called_force(units, square, one, other):
    return call_unit_in_lanes(units.force, (units.numbers, square, one, other))


def _called_clearances(units, r, one, other):
    return call_unit_in_lanes(units.clearance, (units.numbers, r, one, other))


def energy_between(potential, r, one, other, lane):
    """The energy of two charges at a distance, by the potential of a lane if each has its own."""
    return energy_of(potential, r, one, other, lane)


def _called_energy(units, r, one, other, lane):
    return call_unit(units.energy, (units.numbers, r, one, other, lane))


def clearance_between(potential, r, one, other):
    """How far two charges may move from a distance before their force changes [length]."""
    return clearance_of(potential, r, one, other, 0)


def _called_clearance(units, r, one, other):
    return call_unit(units.clearance, (units.numbers, r, one, other, 0))


def _chosen(potential: Any, inside: Any, called: Any) -> Any:
    """The formula, or the call of its unit."""
    behind = getattr(potential, "instance_class", None) is PotentialUnits
    return called if behind else inside


@overload(force_over_distance, **OVERLOAD)
def _force_over_distance(potential, square, one, other):
    return _chosen(potential, force_over_distance, _called_force)


@overload(clearance_between, **OVERLOAD)
def _clearance_between(potential, r, one, other):
    return _chosen(potential, clearance_between, _called_clearance)


@overload(clearances_of, **OVERLOAD)
def _clearances_of(potential, r, one, other):
    return _chosen(potential, clearances_of, _called_clearances)


@overload(energy_between, **OVERLOAD)
def _energy_between(potential, r, one, other, lane):
    return _chosen(potential, energy_between, _called_energy)


def force_unit(potential, square, one, other):
    """The unit of :func:`force_over_distance`."""
    return force_over_distance(fetched(potential), square, one, other)
