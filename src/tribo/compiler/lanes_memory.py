"""Lanes in memory: eight neighbours of an array.

Blocks begin at multiples of eight in arrays that begin at a multiple of their size, so that no
block lies in two cache lines.  A few, of springs, do not, and reach beyond the end of an array:
:func:`room` makes arrays for both.
"""

import math
import operator
import threading

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import models, overload, register_model

from tribo.compiler.jit import OVERLOAD, inlined
from tribo.compiler.lanes import _FLOAT, _VECTOR, LANES, in_kernels, instruction, lanes
from tribo.compiler.numba_private import cgutils
from tribo.compiler.pointers import PointerType

# Small arrays are parts of arrays of this size [floats], so that they stand side by side; those of
# a few asperites fit into one.  A load waits for an earlier store to an address with the same last
# twelve bits.  Where those were left to chance, a step of three asperites on three took 132 ns in
# one process and 170 ns in another.
SHARED_SIZE = 8192

# The largest array that is such a part [floats]: larger ones have all such addresses anyway.
LARGEST_PART = 1024

# What is left of the last of these arrays of each thread.
_own = threading.local()


def room(shape: tuple[int, ...]) -> np.ndarray:
    """A C-contiguous array of zeros that begins with a cache line, with room for a block after."""
    size = math.prod(shape)
    return _floats(LANES * (size // LANES + 2))[:size].reshape(shape)


def _floats(size: int) -> np.ndarray:
    """So many zeros, a multiple of eight, that begin with a cache line."""
    if size > LARGEST_PART:
        return _aligned(size)
    left = getattr(_own, "left", None)
    if left is None or size > left.size:
        left = _aligned(SHARED_SIZE)
    _own.left = left[size:]
    return left[:size]


def _aligned(size: int) -> np.ndarray:
    array = np.zeros(size + LANES)
    first = -(array.ctypes.data // 8) % LANES
    return array[first : first + size]


def with_spare_lanes(values: np.ndarray) -> np.ndarray:
    """A copy of an array, with room."""
    copy = room(values.shape)
    copy[...] = values
    return copy


class RowsType(types.Type):
    """The type of the rows of an array (n, 8), a pointer without a reference to the array."""

    def __init__(self) -> None:
        super().__init__(name="Rows")


rows = RowsType()


@register_model(RowsType)
class _RowsModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type) -> None:
        super().__init__(manager, numba_type, _FLOAT.as_pointer())


@in_kernels(lambda array: array)
def rows_of(typing_context, array):
    """The rows of a C-contiguous array (n, 8): ``rows[k, i]`` is the number in row k, lane i.

    Passing an array to a function counts a reference, which takes longer than a step's arithmetic.
    """

    def build(context, builder, sig, args):
        return _data(context, builder, sig.args[0], args[0])

    is_array = isinstance(array, types.Array) and array.layout == "C"
    good = (is_array or isinstance(array, PointerType)) and array.ndim == 2
    return (rows(array), build) if good else None


def _element(builder, data, row, i=None):
    place = builder.mul(row, ir.Constant(row.type, LANES))
    return builder.gep(data, [place if i is None else builder.add(place, i)])


@instruction(lambda data, row, i: types.float64(rows, types.intp, types.intp))
def _get(builder, data, row, i):
    return builder.load(_element(builder, data, row, i))


@instruction(lambda data, row, i, value: types.void(rows, types.intp, types.intp, types.float64))
def _set(builder, data, row, i, value):
    builder.store(value, _element(builder, data, row, i))


@overload(operator.getitem, **OVERLOAD)
def _getitem(data, at):
    if isinstance(data, RowsType):
        return lambda data, at: _get(data, at[0], at[1])
    return None


@overload(operator.setitem, **OVERLOAD)
def _setitem(data, at, value):
    if isinstance(data, RowsType):
        return lambda data, at, value: _set(data, at[0], at[1], value)
    return None


def row_at(builder, data, row):
    """The instructions that load a row of Rows."""
    place = builder.bitcast(_element(builder, data, row), _VECTOR.as_pointer())
    return builder.load(place, align=8)


@instruction(lambda data, row: lanes(rows, types.intp), lambda data, row: data[row].copy())
def load(builder, data, row):
    """Row `row` of Rows."""
    return row_at(builder, data, row)


@instruction(
    lambda data, row, x: types.void(rows, types.intp, lanes),
    lambda data, row, x: np.copyto(data[row], x),
)
def store(builder, data, row, x):
    """Write to row `row` of Rows."""
    place = builder.bitcast(_element(builder, data, row), _VECTOR.as_pointer())
    builder.store(x, place, align=8)


def _is_row(array, dtype=types.float64) -> bool:
    arrays = types.Array, PointerType
    return isinstance(array, arrays) and array.ndim == 1 and array.dtype == dtype


def _data(context, builder, kind, array):
    if isinstance(kind, PointerType):
        return cgutils.create_struct_proxy(kind)(context, builder, array).data
    return context.make_array(kind)(context, builder, array).data


def element(context, builder, kind, array, i):
    """The address of element i of an array of one dimension, for intrinsics."""
    return builder.gep(_data(context, builder, kind, array), [i])


def _address(context, builder, kind, array, i):
    return builder.bitcast(element(context, builder, kind, array, i), _VECTOR.as_pointer())


def _eight_of(array, i):
    """Where numba does not compile: the elements that an array has, and zeros beyond."""
    return np.append(array[i : min(i + LANES, array.size)], np.zeros(LANES))[:LANES]


def _set_eight(array, i, x):
    own = array[i : min(i + LANES, array.size)]
    own[:] = x[: own.size]


@in_kernels(_eight_of)
def block(typing_context, array, i):
    """Eight elements from place i of a contiguous array on."""

    def build(context, builder, sig, args):
        return builder.load(_address(context, builder, sig.args[0], *args), align=8)

    return (lanes(array, types.intp), build) if _is_row(array) else None


@in_kernels(_set_eight)
def set_block(typing_context, array, i, x):
    """Set eight elements from place i of a contiguous array on."""

    def build(context, builder, sig, args):
        builder.store(args[2], _address(context, builder, sig.args[0], *args[:2]), align=8)
        return context.get_dummy_value()

    return (types.void(array, types.intp, lanes), build) if _is_row(array) else None


@inlined
def add_block(array, i, x):
    """Add to eight elements from place i of a contiguous array on."""
    set_block(array, i, block(array, i) + x)
