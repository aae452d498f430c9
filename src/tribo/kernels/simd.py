"""Eight numbers in one vector register: the nodes of a step side by side.

`Lanes` is a type for kernels.  It has +, -, *, / with itself and with floats, and the functions
below; each acts on all eight numbers.
"""

import math
import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, overload, register_model

from tribo.kernels.compiled import inlined, kernel

LANES = 8
_FLOAT, _INDEX = ir.DoubleType(), ir.IntType(32)
_VECTOR = ir.VectorType(_FLOAT, LANES)


class LanesType(types.Type):
    """The type of eight floats in a register."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


lanes = LanesType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type) -> None:
        super().__init__(manager, numba_type, _VECTOR)


def _spread(builder, x):
    """A float in all eight lanes; lanes as they are."""
    if x.type == _VECTOR:
        return x
    nothing = ir.Constant(_VECTOR, ir.Undefined)
    first = builder.insert_element(nothing, x, ir.Constant(_INDEX, 0))
    zeros = ir.Constant(ir.VectorType(_INDEX, LANES), [0] * LANES)
    return builder.shuffle_vector(first, nothing, zeros)


def _arithmetic(operation, instruction: str) -> None:
    @infer_global(operation)
    class Typing(AbstractTemplate):
        def generic(self, args, kws):
            known = all(isinstance(arg, (LanesType, types.Float)) for arg in args)
            return signature(lanes, *args) if known and lanes in args else None

    def build(context, builder, sig, args):
        one, other = (_spread(builder, arg) for arg in args)
        return getattr(builder, instruction)(one, other, flags=("contract",))

    for pair in ((LanesType, LanesType), (LanesType, types.Float), (types.Float, LanesType)):
        lower_builtin(operation, *pair)(build)


for _operation, _instruction in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _arithmetic(_operation, _instruction)


def _llvm(builder, name: str, result, arguments: list, fast=()):
    kind = ir.FunctionType(result, [argument.type for argument in arguments])
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{LANES}f64")
    return builder.call(function, arguments, fastmath=fast)


@intrinsic
def sqrt(typing_context, x):
    """Square roots."""

    def build(context, builder, sig, args):
        return _llvm(builder, "sqrt", _VECTOR, list(args))

    return lanes(lanes), build


@intrinsic
def absolute(typing_context, x):
    """Absolute values."""

    def build(context, builder, sig, args):
        return _llvm(builder, "fabs", _VECTOR, list(args))

    return lanes(lanes), build


@intrinsic
def sum_of_lanes(typing_context, x):
    """Sum of the eight numbers, in any order."""

    def build(context, builder, sig, args):
        start = ir.Constant(_FLOAT, -0.0)
        return _llvm(builder, "vector.reduce.fadd", _FLOAT, [start, args[0]], ("reassoc",))

    return types.float64(lanes), build


def _paired(one: list[int], other: list[int]) -> tuple[Any, Any]:
    kind = ir.VectorType(_INDEX, LANES)
    return ir.Constant(kind, one), ir.Constant(kind, other)


# Eight registers are summed in three rounds.  Each adds lanes of two registers, those of the first
# counted from 0 and those of the second from 8.  In the end lane i has the sum of register i.
_ROUNDS = (
    _paired([0, 8, 2, 10, 4, 12, 6, 14], [1, 9, 3, 11, 5, 13, 7, 15]),
    _paired([0, 1, 8, 9, 4, 5, 12, 13], [2, 3, 10, 11, 6, 7, 14, 15]),
    _paired([0, 1, 2, 3, 8, 9, 10, 11], [4, 5, 6, 7, 12, 13, 14, 15]),
)


@intrinsic
def sums_of_lanes(typing_context, xs):
    """Sums of eight Lanes: that of the first in lane 0, and so on."""

    def build(context, builder, sig, args):
        left = cgutils.unpack_tuple(builder, args[0], LANES)
        for one, other in _ROUNDS:
            pairs = zip(left[::2], left[1::2], strict=True)
            left = [
                builder.fadd(builder.shuffle_vector(a, b, one), builder.shuffle_vector(a, b, other))
                for a, b in pairs
            ]
        return left[0]

    return lanes(xs), build


@intrinsic
def maximum(typing_context, x):
    """The largest of the eight numbers, none of which may be nan."""

    def build(context, builder, sig, args):
        x = args[0]
        for half in (4, 2, 1):
            swap = [(i + half) % LANES for i in range(LANES)]
            mask = ir.Constant(ir.VectorType(_INDEX, LANES), swap)
            other = builder.shuffle_vector(x, x, mask)
            x = builder.select(builder.fcmp_ordered(">", x, other), x, other)
        return builder.extract_element(x, ir.Constant(_INDEX, 0))

    return types.float64(lanes), build


@intrinsic
def where_less(typing_context, x, y, one, other):
    """`one` in the lanes where x < y, `other` elsewhere."""

    def build(context, builder, sig, args):
        x, y, one, other = (_spread(builder, arg) for arg in args)
        return builder.select(builder.fcmp_ordered("<", x, y), one, other)

    return lanes(x, y, one, other), build


@intrinsic
def broadcast(typing_context, x):
    """The same number in every lane."""

    def build(context, builder, sig, args):
        return _spread(builder, args[0])

    return lanes(types.float64), build


@intrinsic
def lane(typing_context, x, i):
    """The number in lane i."""

    def build(context, builder, sig, args):
        return builder.extract_element(args[0], builder.trunc(args[1], _INDEX))

    return types.float64(lanes, types.intp), build


@intrinsic
def with_lane(typing_context, x, i, value):
    """The Lanes x with another number in lane i."""

    def build(context, builder, sig, args):
        return builder.insert_element(args[0], args[2], builder.trunc(args[1], _INDEX))

    return lanes(lanes, types.intp, types.float64), build


class RowsType(types.Type):
    """The type of the rows of an array (n, 8), a pointer without a reference to the array."""

    def __init__(self) -> None:
        super().__init__(name="Rows")


rows = RowsType()


@register_model(RowsType)
class _RowsModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type) -> None:
        super().__init__(manager, numba_type, _FLOAT.as_pointer())


@intrinsic
def rows_of(typing_context, array):
    """The rows of a C-contiguous array (n, 8): ``rows[k, i]`` is the number in row k, lane i.

    Passing an array to a function counts a reference, which takes longer than a step's arithmetic.
    """

    def build(context, builder, sig, args):
        return context.make_array(sig.args[0])(context, builder, args[0]).data

    good = isinstance(array, types.Array) and array.ndim == 2 and array.layout == "C"
    return (rows(array), build) if good else None


def _element(builder, data, row, i=None):
    place = builder.mul(row, ir.Constant(row.type, LANES))
    return builder.gep(data, [place if i is None else builder.add(place, i)])


@intrinsic
def _get(typing_context, data, row, i):
    def build(context, builder, sig, args):
        return builder.load(_element(builder, *args))

    return types.float64(rows, types.intp, types.intp), build


@intrinsic
def _set(typing_context, data, row, i, value):
    def build(context, builder, sig, args):
        builder.store(args[3], _element(builder, *args[:3]))
        return context.get_dummy_value()

    return types.void(rows, types.intp, types.intp, types.float64), build


@overload(operator.getitem)
def _getitem(data, at):
    if isinstance(data, RowsType):
        return lambda data, at: _get(data, at[0], at[1])
    return None


@overload(operator.setitem)
def _setitem(data, at, value):
    if isinstance(data, RowsType):
        return lambda data, at, value: _set(data, at[0], at[1], value)
    return None


@intrinsic
def load(typing_context, data, row):
    """Row `row` of Rows."""

    def build(context, builder, sig, args):
        place = builder.bitcast(_element(builder, *args), _VECTOR.as_pointer())
        return builder.load(place, align=8)

    return lanes(rows, types.intp), build


@intrinsic
def store(typing_context, data, row, x):
    """Write to row `row` of Rows."""

    def build(context, builder, sig, args):
        place = builder.bitcast(_element(builder, *args[:2]), _VECTOR.as_pointer())
        builder.store(args[2], place, align=8)
        return context.get_dummy_value()

    return types.void(rows, types.intp, lanes), build


# Adding and subtracting this rounds a float below 2^51 to an integer.
ROUNDING = 1.5 * 2.0**52

# pi / 2 as a sum of three numbers, from fdlibm (Sun Microsystems 1993).  The first two have 33
# significant bits, so that their products with an integer below MOST_QUARTERS are exact, with or
# without fused multiply-add; the third is rounded, and what is missing is below 1e-36.
QUARTER_TURN = 1.57079632673412561417e00
QUARTER_TURN_MIDDLE = 6.07710050630396597660e-11
QUARTER_TURN_LOW = 2.02226624879595063154e-21

# Number of quarter turns below which products with a number of 33 bits are exact: 53 - 33 bits.
MOST_QUARTERS = 2.0**20


@inlined
def sine_cosine(x):
    """Sine and cosine of eight angles.

    Absolute errors are below 2.3e-16 for every finite angle, with and without fused multiply-add.
    The largest angle decides for all eight whether they need a reduction, and which one.

    Parameters
    ----------
    x : Lanes
        Angles [rad].

    Returns
    -------
    sin, cos : Lanes
    """
    largest = maximum(absolute(x))
    if largest < 0.5 * QUARTER_TURN:  # as most swings are
        return near_zero(x)
    if largest < MOST_QUARTERS * QUARTER_TURN:
        return reduced(x)
    return lane_by_lane(x)


@kernel
def lane_by_lane(x):
    """Sine and cosine by the C library, for angles beyond a million quarter turns."""
    sin = x
    cos = x
    for i in range(LANES):
        sin = with_lane(sin, i, math.sin(lane(x, i)))
        cos = with_lane(cos, i, math.cos(lane(x, i)))
    return sin, cos


@inlined
def reduced(x):
    """Sine and cosine from those of x less the nearest multiple of pi/2.

    The reduction is Cody and Waite's (Software Manual for the Elementary Functions, 1980).
    """
    quarters = (x * 0.6366197723675814 + ROUNDING) - ROUNDING
    rest = (x - quarters * QUARTER_TURN) - quarters * QUARTER_TURN_MIDDLE
    sin, cos = near_zero(rest - quarters * QUARTER_TURN_LOW)
    quadrant = quarters - 4.0 * ((quarters * 0.25 - 0.375 + ROUNDING) - ROUNDING)  # 0, 1, 2 or 3
    even = absolute(absolute(quadrant - 2.0) - 1.0)  # 1 in quadrants 0 and 2, else 0
    one = where_less(even, 0.5, cos, sin)
    other = where_less(even, 0.5, sin, cos)
    one = where_less(quadrant, 1.5, one, 0.0 - one)
    other = where_less(absolute(quadrant - 1.5), 1.0, 0.0 - other, other)
    return one, other


@inlined
def near_zero(r):
    """sin r and cos r by polynomials of the least largest error on (-pi/4, pi/4).

    K. C. Ng's, of fdlibm (Sun Microsystems 1993), whose coefficients these are.
    """
    z = r * r
    z2 = z * z
    z4 = z2 * z2
    sin = (
        (-1.66666666666666324348e-01 + z * 8.33333333332248946124e-03)
        + z2 * (-1.98412698298579493134e-04 + z * 2.75573137070700676789e-06)
        + z4 * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    )
    sin = r + r * z * sin
    cos = (
        (4.16666666666666019037e-02 - z * 1.38888888888741095749e-03)
        + z2 * (2.48015872894767294178e-05 - z * 2.75573143513906633035e-07)
        + z4 * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11)
    )
    return sin, (1.0 - 0.5 * z) + z2 * cos
