"""The force of a potential at eight distances: all together where its formula allows.

A formula of + - * / sqrt exp, whole powers, minimum and maximum compiles for Lanes as it stands.
With any other operation, or with a branch, the distances are taken one after another.
"""

import functools
from typing import Any

from numba import TypingError, config, njit, types
from numba.extending import overload

import tribo.compiler.lanes_functions  # noqa: F401  # exp and others of Lanes, for formulas
from tribo.compiler.jit import OVERLOAD, OWNING_KERNEL
from tribo.compiler.lanes import LANES, broadcast, lane, lanes, spread_like, with_lane
from tribo.compiler.numbers_in_lanes import lane_of, numbers_at_lane


def is_vectorized(potential_type: Any) -> bool:
    """Whether a potential's formula compiles for Lanes.

    Raises NumbaError if it does not compile for another reason than an operation that Lanes lack.
    """
    return _formula_in_lanes(potential_type, types.float64) is not None


@functools.cache
def _formula_in_lanes(potential_type: Any, charge: Any) -> Any:
    """The force between charges of one bob or of eight, compiled; None if Lanes lack an operation.

    Raises NumbaError if it does not compile for another reason.
    """
    compiled = njit(**OWNING_KERNEL)(potential_type.formulas["force_between"])
    try:
        compiled.compile((potential_type, lanes, charge, lanes))
    except TypingError as error:
        if lanes.name not in str(error):
            raise
        return None
    return compiled


def force_in_lanes(potential, r, end, charge, others, low, high):
    """Force of a potential, or of one for each lane, at some of eight distances.

    Only lanes from `low` up to `high` are wanted; elsewhere, and from the distance `end` on, where
    the force is zero, the result has no meaning.
    """
    return potential.force_between(r, charge, others)


@overload(force_in_lanes, **OVERLOAD)
def _force_in_lanes(potential, r, end, charge, others, low, high):
    formula = _formula_in_lanes(potential, lanes if lanes in potential.types else charge)
    if formula is None:
        return _one_by_one

    def all_together(potential, r, end, charge, others, low, high):
        return formula(potential, r, charge, others)

    return all_together


def _one_by_one(potential, r, end, charge, others, low, high):
    force = spread_like(r, 0.0)
    for i in range(low, high):
        if lane(r, i) < lane_of(end, i):
            own = numbers_at_lane(potential, i)
            value = own.force_between(lane(r, i), lane_of(charge, i), lane_of(others, i))
            force = with_lane(force, i, value)
    return force


def range_in_lanes(potential, one, other):
    """The distance from which the force of two charges is zero; Lanes where its numbers are.

    Of Lanes it is that of the potential for any charges.
    """
    return potential.range_between(one, other)


@overload(range_in_lanes, **OVERLOAD)
def _range_in_lanes(potential, one, other):
    if lanes in (*potential.types, one, other):
        return lambda potential, one, other: range_of_all_in_lanes(potential)
    return range_in_lanes


def range_of_all_in_lanes(potential):
    """The distance from which the force of all charges is zero; Lanes where its numbers are."""
    return potential.range_of_all()


@overload(range_of_all_in_lanes, **OVERLOAD)
def _range_of_all_in_lanes(potential):
    return _ranges if lanes in potential.types else range_of_all_in_lanes


def _ranges(potential):
    ranges = broadcast(0.0)
    for i in range(LANES):
        ranges = with_lane(ranges, i, numbers_at_lane(potential, i).range_of_all())
    return ranges


if config.DISABLE_JIT:  # type: ignore[attr-defined]
    force_in_lanes = _one_by_one
