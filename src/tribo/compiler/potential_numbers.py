"""Potentials with numbers from a table, for scenes that differ in them."""

from collections.abc import Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


def has_plain_numbers(potential: Any) -> bool:
    """Whether a potential consists of floats alone, of which a table has columns."""
    fields = potential if isinstance(potential, tuple) else ()
    return bool(fields) and all(isinstance(value, float) for value in fields)


def numbers_of(potential: Any) -> Sequence[float]:
    """A row of a table for `with_numbers`; empty where the potential is no plain numbers."""
    return tuple(potential) if has_plain_numbers(potential) else ()


@intrinsic
def with_numbers(typing_context, potential, table, row):
    """The potential with the numbers in a row of a table, where it consists of numbers alone."""
    columns = potential.types
    plain = bool(columns) and all(each == types.float64 for each in columns)

    def build(context, builder, sig, args):
        value, array, index = args
        if not plain:
            return value
        data = context.make_array(sig.args[1])(context, builder, array).data
        first = builder.mul(index, ir.Constant(index.type, len(columns)))
        for k in range(len(columns)):
            place = builder.gep(data, [builder.add(first, ir.Constant(index.type, k))])
            value = builder.insert_value(value, builder.load(place), k)
        return value

    return potential(potential, table, types.intp), build
