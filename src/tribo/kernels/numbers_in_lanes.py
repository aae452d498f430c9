"""NamedTuples of numbers whose numbers are Lanes: scenes that differ, side by side."""

from typing import Any

from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.extending import intrinsic

from tribo.kernels.simd import _INDEX, lanes
from tribo.kernels.simd_arrays import row_at


def _is_plain(kind: Any, number: types.Type) -> bool:
    numbers: tuple[types.Type, ...] = getattr(kind, "types", ())
    return bool(numbers) and all(each == number for each in numbers)


@intrinsic
def numbers_in_lanes(typing_context, shared, table, rows, first):
    """A NamedTuple of floats with rows of Rows, from `first` on, as its numbers.

    Without a `table` of numbers, and where there are others than floats, it is `shared` as it is.
    """
    if isinstance(table, types.NoneType) or not _is_plain(shared, types.float64):
        return shared(shared, table, rows, first), lambda context, builder, sig, args: args[0]
    count = len(shared.types)

    def build(context, builder, sig, args):
        places = [builder.add(args[3], ir.Constant(args[3].type, k)) for k in range(count)]
        values = [row_at(builder, args[2], place) for place in places]
        return context.make_tuple(builder, sig.return_type, values)

    in_lanes = types.NamedUniTuple(lanes, count, shared.instance_class)
    return in_lanes(shared, table, rows, first), build


@intrinsic
def numbers_at_lane(typing_context, each, i):
    """The floats of a NamedTuple of Lanes in lane i; one of floats as it is."""
    if not _is_plain(each, lanes):
        return each(each, i), lambda context, builder, sig, args: args[0]

    def build(context, builder, sig, args):
        place = builder.trunc(args[1], _INDEX)
        numbers = cgutils.unpack_tuple(builder, args[0])
        values = [builder.extract_element(number, place) for number in numbers]
        return context.make_tuple(builder, sig.return_type, values)

    floats = types.NamedUniTuple(types.float64, len(each.types), each.instance_class)
    return floats(each, types.intp), build


if config.DISABLE_JIT:  # type: ignore[attr-defined]
    from tribo.kernels.simd_uncompiled import numbers_at_lane  # noqa: F401
