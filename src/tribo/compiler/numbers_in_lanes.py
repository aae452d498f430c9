"""NamedTuples whose numbers differ between scenes: Lanes side by side."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import overload

from tribo.compiler.jit import OVERLOAD
from tribo.compiler.lanes import _INDEX, LANES, in_kernels, lane, lanes, maximum, sum_of_lanes
from tribo.compiler.lanes_functions import for_lanes
from tribo.compiler.lanes_memory import element
from tribo.compiler.numba_private import cgutils, own_reference
from tribo.compiler.plugin_methods import like


def _is_plain(kind: Any, number: types.Type) -> bool:
    numbers: tuple[types.Type, ...] = getattr(kind, "types", ())
    return bool(numbers) and all(each == number for each in numbers)


def _as_it_is(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    """The first argument."""
    return own_reference(context, builder, sig.return_type, args[0])


@in_kernels(lambda shared, table, array, first: shared)
def numbers_in_lanes(typing_context, shared, table, array, first):
    """One like `shared` of Lanes, in rows of an array from `first` on.

    `shared` itself without a `table`, or if it is not of floats.
    """
    if isinstance(table, types.NoneType) or not _is_plain(shared, types.float64):
        return shared(shared, table, array, first), _as_it_is
    found = like(shared, lanes)

    def build(context, builder, sig, args):
        """Load the Lanes of all fields, one behind the other."""
        step = ir.Constant(args[3].type, LANES)
        place = builder.mul(args[3], step)
        pointer = context.get_value_type(lanes).as_pointer()
        values = []
        for _ in shared.types:
            address = element(context, builder, sig.args[2], args[2], place)
            values.append(builder.load(builder.bitcast(address, pointer), align=8))
            place = builder.add(place, step)
        return context.make_tuple(builder, found, values)

    return found(shared, table, array, types.intp), build


@in_kernels(lambda each, i: each)
def numbers_at_lane(typing_context, each, i):
    """The floats of a NamedTuple of Lanes in lane i; as it is without one, and one of floats."""
    if isinstance(i, types.NoneType) or not _is_plain(each, lanes):
        return each(each, i), _as_it_is

    def build(context, builder, sig, args):
        place = builder.trunc(args[1], _INDEX)
        numbers = cgutils.unpack_tuple(builder, args[0])
        values = [builder.extract_element(number, place) for number in numbers]
        return context.make_tuple(builder, sig.return_type, values)

    floats = like(each, types.float64)
    return floats(each, types.intp), build


def numbers_of(potential: Any) -> Sequence[float]:
    """The numbers of a potential, a row of a table; empty where it has others than floats."""
    fields = potential if isinstance(potential, tuple) else ()
    return tuple(fields) if all(isinstance(value, float) for value in fields) else ()


def lane_of(x, i):
    """Number i of Lanes, counted from any pack; a float as it is."""
    return x[i % LANES] if isinstance(x, np.ndarray) else x  # where numba does not compile


for_lanes(lane_of, lambda x, i: lane(x, i & (LANES - 1)), lambda x, i: x)


def _of_all_lanes(function: Any) -> Any:
    """Let kernels call a function of all lanes of one run; it leaves those of members alone."""

    @overload(function, **OVERLOAD)
    def find(h, x):
        return (lambda h, x: x) if h == lanes else function

    return function


@_of_all_lanes
def sum_of_runs(h, x):
    """The sum over all lanes for one run; x itself where each lane has a step `h` of its own."""
    return sum_of_lanes(x)


@_of_all_lanes
def largest_of_runs(h, x):
    """The largest of all lanes for one run; x itself where each lane has a step of its own."""
    return maximum(x)
