"""Lanes in memory: eight neighbours of an array.

Packs begin at multiples of eight in arrays that begin at a multiple of their size, so that no
pack lies in two cache lines.  A few, of springs, do not, and reach beyond the end of an array:
:func:`room` makes arrays for both.
"""

import math
import threading

import numpy as np
from llvmlite import ir
from numba import types

from tribo.compiler.jit import inlined
from tribo.compiler.lanes import _VECTOR, LANES, in_kernels, lanes
from tribo.compiler.numba_private import cgutils
from tribo.compiler.pointers import PointerType, make_pointer

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
    """A C-contiguous array of zeros that begins with a cache line, with room for a pack after."""
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
    copy = room(values.shape)
    copy[...] = values
    return copy


@in_kernels(lambda array: array)
def rows_of(typing_context, array):
    """A pointer to a C-contiguous array (..., 8), whose rows the compiler knows to have 8 numbers.

    Their addresses are then constants.
    """

    def build(context, builder, sig, args):
        made = context.make_array(sig.args[0])(context, builder, args[0])
        *shape, last = cgutils.unpack_tuple(builder, made.shape)
        shape.append(ir.Constant(last.type, LANES))
        return make_pointer(context, builder, sig.return_type, made.data, shape)

    return PointerType(array.dtype, array.ndim)(array), build


def _is_row(array) -> bool:
    arrays = types.Array, PointerType
    return isinstance(array, arrays) and array.ndim == 1 and array.dtype == types.float64


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
def pack(typing_context, array, i):
    """Eight elements from place i of a contiguous array on."""

    def build(context, builder, sig, args):
        return builder.load(_address(context, builder, sig.args[0], *args), align=8)

    return (lanes(array, types.intp), build) if _is_row(array) else None


@in_kernels(_set_eight)
def set_pack(typing_context, array, i, x):
    """Set eight elements from place i of a contiguous array on."""

    def build(context, builder, sig, args):
        builder.store(args[2], _address(context, builder, sig.args[0], *args[:2]), align=8)
        return context.get_dummy_value()

    return (types.void(array, types.intp, lanes), build) if _is_row(array) else None


@in_kernels(lambda array, i: array.ctypes.data + array.itemsize * i)
def address_at(typing_context, array, i):
    """The address of element i of a contiguous array."""

    def build(context, builder, sig, args):
        place = element(context, builder, sig.args[0], *args)
        return builder.ptrtoint(place, context.get_value_type(types.int64))

    return (types.int64(array, types.intp), build) if _is_row(array) else None


@inlined
def load(rows, row):
    """Eight numbers of an array (n, 8)."""
    return pack(rows[row], 0)


@inlined
def store(rows, row, x):
    """Set eight numbers of an array (n, 8)."""
    set_pack(rows[row], 0, x)


@inlined
def add_pack(array, i, x):
    """Add to eight elements from place i of a contiguous array on."""
    set_pack(array, i, pack(array, i) + x)
