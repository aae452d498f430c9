"""Eight numbers in one vector register: nodes of a step, or asperites, side by side.

`Lanes` is a type for kernels.  It has +, -, *, / with itself and with floats, comparisons, whose
result is 1 where they hold and 0 elsewhere, and the functions below; each acts on all eight
numbers.  Formulas of potentials may use sqrt, exp, abs, whole powers, minimum and maximum too.
Where four numbers are enough, `narrow` Lanes have four, whose roots and quotients take half the
time.

With AVX-512 a root takes some 20 cycles and a quotient 16, and neither begins before the last one
ends.  `inverse_root` takes a third of one of them there (FAST_INVERSE_ROOTS).
"""

import functools
import inspect
import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.extending import intrinsic, lower_builtin, models, register_model

from tribo.compiler.numba_private import cgutils, cpu_features, typed_first

LANES = 8
NARROW = 4
_FLOAT = ir.DoubleType()
_INDEX = ir.IntType(32)
_VECTOR = ir.VectorType(_FLOAT, LANES)


class LanesType(types.Type):
    """The type of floats side by side in a register."""

    def __init__(self, count: int) -> None:
        super().__init__(name="Lanes" if count == LANES else "NarrowLanes")
        self.vector = ir.VectorType(_FLOAT, count)


lanes = LanesType(LANES)
narrow_lanes = LanesType(NARROW)


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type) -> None:
        super().__init__(manager, numba_type, numba_type.vector)


def _spread(builder, x, kind=_VECTOR):
    """A number in all lanes; lanes as they are."""
    if x.type == kind:
        return x
    if kind.element == _FLOAT and isinstance(x.type, ir.IntType):
        x = builder.sitofp(x, _FLOAT)
    nothing = ir.Constant(kind, ir.Undefined)
    first = builder.insert_element(nothing, x, ir.Constant(_INDEX, 0))
    zeros = ir.Constant(ir.VectorType(_INDEX, kind.count), [0] * kind.count)
    return builder.shuffle_vector(first, nothing, zeros)


def _lanes_of(args) -> LanesType | None:
    """The type of Lanes among the types of arguments, of which there is one."""
    found = {arg for arg in args if isinstance(arg, LanesType)}
    return found.pop() if len(found) == 1 else None


def _binary(operation, compute) -> None:
    """Give Lanes an operation with Lanes and with numbers."""

    @typed_first(operation)
    def find_type(*args):
        result = _lanes_of(args)
        known = all(isinstance(arg, (LanesType, types.Float, types.Integer)) for arg in args)
        return result(*args) if result and known else None

    def build(context, builder, sig, args):
        vector = sig.return_type.vector
        one, other = (_spread(builder, arg, vector) for arg in args)
        return compute(builder, one, other, isinstance(sig.args[0], LanesType))

    numbers = (types.Float, types.Integer)
    pairs: list[tuple[Any, Any]] = [(LanesType, LanesType)]
    pairs += [(LanesType, kind) for kind in numbers] + [(kind, LanesType) for kind in numbers]
    for pair in pairs:
        lower_builtin(operation, *pair)(build)


def _arithmetic(instruction: str, builder, one, other, of_lanes):
    flags = ["contract"]
    if instruction == "fdiv" and not of_lanes:
        flags += ["arcp", "reassoc"]  # 1 / (1 / x) becomes x: see `root_and_inverse`
    return getattr(builder, instruction)(one, other, flags=flags)


def _comparison(symbol: str, builder, one, other, of_lanes):
    return builder.uitofp(builder.fcmp_ordered(symbol, one, other), one.type)


for _name, _instruction in {"add": "fadd", "sub": "fsub", "mul": "fmul", "truediv": "fdiv"}.items():
    _binary(getattr(operator, _name), functools.partial(_arithmetic, _instruction))
for _name, _symbol in {"lt": "<", "le": "<=", "gt": ">", "ge": ">="}.items():
    _binary(getattr(operator, _name), functools.partial(_comparison, _symbol))


def in_kernels(python) -> Any:
    """numba's intrinsic; where it does not compile, a function of Python on arrays of eight."""
    return (lambda find: python) if config.DISABLE_JIT else intrinsic  # type: ignore[attr-defined]


def instruction(signature, python=None) -> Any:
    """Make a function for kernels of one that builds the instructions of its result.

    `signature` returns the types of result and arguments from those that are given; None where
    there is no such function.  `python` is as in :func:`in_kernels`.
    """

    def make(build):
        """A function of kernels from one that emits instructions, with its name and docstring."""

        def function(typing_context, *kinds):
            def code(context, builder, sig, args):
                result = build(builder, *args)
                return context.get_dummy_value() if result is None else result

            found = signature(*kinds)
            return None if found is None else (found, code)

        function.__signature__ = inspect.signature(build)  # type: ignore[attr-defined]
        return in_kernels(python)(
            functools.update_wrapper(function, build, ("__name__", "__doc__"))
        )

    return make


@typed_first(operator.neg)
def _type_of_negative(x):
    return x(x) if isinstance(x, LanesType) else None


@lower_builtin(operator.neg, LanesType)
def _negative(context, builder, sig, args):
    return builder.fneg(args[0])


def _llvm(builder, name: str, result, arguments: list, fast=()):
    kind = ir.FunctionType(result, [argument.type for argument in arguments])
    count = arguments[-1].type.count
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{count}f64")
    return builder.call(function, arguments, fastmath=fast)


def _of_each(name: str, python) -> Any:
    """A function of LLVM, of each number."""
    return instruction(lambda x: x(x), python)(lambda builder, x: _llvm(builder, name, x.type, [x]))


sqrt = _of_each("sqrt", np.sqrt)
absolute = _of_each("fabs", np.abs)
floor = _of_each("floor", np.floor)


# Whether code is compiled for a processor that estimates inverse roots of doubles.
_WITH_ESTIMATES = {"+avx512f", "+avx512vl"} <= cpu_features()
FAST_INVERSE_ROOTS = _WITH_ESTIMATES and not config.DISABLE_JIT  # type: ignore[attr-defined]
# (1 - x)^(-1/2) = 1 + x (1/2 + x (3/8 + ...)), from the last term on.
_OF_INVERSE_ROOT = (5 / 16, 3 / 8, 1 / 2)


@instruction(lambda x: x(x))
def inverse_root(builder, x):
    """1 / sqrt(x) with an error below 1.2 ulp; nan for 0 and inf.

    Only where FAST_INVERSE_ROOTS.  The estimate y has an error of 2^-14; with d = 1 - x y^2 the
    value is y (1 - d)^(-1/2).
    """
    count = x.type.count
    mask = ir.IntType(8)
    kind = ir.FunctionType(x.type, [x.type, x.type, mask])
    name = f"llvm.x86.avx512.rsqrt14.pd.{64 * count}"
    estimate = cgutils.get_or_insert_function(builder.module, kind, name)
    y = builder.call(estimate, [x, ir.Constant(x.type, [0.0] * count), mask(-1)])

    def fused(one, other, constant):
        if isinstance(constant, float):
            constant = ir.Constant(x.type, [constant] * count)
        return _llvm(builder, "fma", x.type, [one, other, constant])

    d = fused(builder.fneg(builder.fmul(x, y)), y, 1.0)
    terms = ir.Constant(x.type, [_OF_INVERSE_ROOT[0]] * count)
    for constant in _OF_INVERSE_ROOT[1:]:
        terms = fused(terms, d, constant)
    return fused(builder.fmul(y, d), terms, y)


@instruction(lambda x: types.float64(x), lambda x: float(np.sum(x)))
def sum_of_lanes(builder, x):
    """Sum of the numbers, in any order."""
    start = ir.Constant(_FLOAT, -0.0)
    return _llvm(builder, "vector.reduce.fadd", _FLOAT, [start, x], ("reassoc",))


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


@instruction(lambda xs: lanes(xs), lambda xs: np.array([np.sum(x) for x in xs]))
def sums_of_lanes(builder, xs):
    """Sums of eight Lanes: that of the first in lane 0, and so on."""
    left = cgutils.unpack_tuple(builder, xs, LANES)
    for one, other in _ROUNDS:
        pairs = zip(left[::2], left[1::2], strict=True)
        left = [
            builder.fadd(builder.shuffle_vector(a, b, one), builder.shuffle_vector(a, b, other))
            for a, b in pairs
        ]
    return left[0]


@instruction(lambda x: types.float64(lanes), lambda x: float(np.max(x)))
def maximum(builder, x):
    """The largest of the eight numbers, none of which may be nan."""
    for half in (4, 2, 1):
        swap = [(i + half) % LANES for i in range(LANES)]
        mask = ir.Constant(ir.VectorType(_INDEX, LANES), swap)
        other = builder.shuffle_vector(x, x, mask)
        x = builder.select(builder.fcmp_ordered(">", x, other), x, other)
    return builder.extract_element(x, ir.Constant(_INDEX, 0))


@in_kernels(lambda x, y, one, other: np.where(x < y, one, other))
def where_less(typing_context, x, y, one, other):
    """`one` in the lanes where x < y, `other` elsewhere; each is Lanes or a float."""

    def build(context, builder, sig, args):
        x, y, one, other = (_spread(builder, arg, sig.return_type.vector) for arg in args)
        return builder.select(builder.fcmp_ordered("<", x, y), one, other)

    found = _lanes_of((x, y, one, other))
    return (found(x, y, one, other), build) if found else None


@instruction(lambda x: lanes(x if x == lanes else types.float64), lambda x: np.full(LANES, x))
def broadcast(builder, x):
    """The same number in every lane; Lanes as they are."""
    return _spread(builder, x)


@instruction(lambda x, number: x(x, types.float64), lambda x, number: np.full(len(x), number))
def spread_like(builder, x, number):
    """The same number in every lane that x has."""
    return _spread(builder, number, x.type)


@instruction(lambda x: narrow_lanes(lanes), lambda x: x[:NARROW])
def narrow(builder, x):
    """The first four of eight numbers."""
    kept = ir.Constant(ir.VectorType(_INDEX, NARROW), list(range(NARROW)))
    return builder.shuffle_vector(x, ir.Constant(_VECTOR, ir.Undefined), kept)


@instruction(lambda x: lanes(narrow_lanes), lambda x: np.append(x, np.zeros(NARROW)))
def widen(builder, x):
    """Four numbers and four zeros."""
    places = ir.Constant(ir.VectorType(_INDEX, LANES), list(range(LANES)))
    zeros = ir.Constant(narrow_lanes.vector, [0.0] * NARROW)
    return builder.shuffle_vector(x, zeros, places)


@instruction(lambda x, i: types.float64(x, types.intp), lambda x, i: float(x[i]))
def lane(builder, x, i):
    return builder.extract_element(x, builder.trunc(i, _INDEX))


@instruction(
    lambda x, i, value: x(x, types.intp, types.float64),
    lambda x, i, value: np.where(np.arange(x.size) == i, value, x),
)
def with_lane(builder, x, i, value):
    """The Lanes x with another number in lane i."""
    if isinstance(i, ir.Constant):
        return builder.insert_element(x, value, builder.trunc(i, _INDEX))
    # To insert at a place that is not known, LLVM stores the register, and loads it again before
    # the processor has written the number.
    kind = ir.VectorType(i.type, x.type.count)
    numbers = ir.Constant(kind, list(range(x.type.count)))
    here = builder.icmp_signed("==", _spread(builder, i, kind), numbers)
    return builder.select(here, _spread(builder, value, x.type), x)


def _are_between(low, high, x):
    """Where numba does not compile: which lanes are from `low` to `high`, that excluded."""
    numbers = np.arange(x.size)
    return (low <= numbers) & (numbers < high)


@instruction(
    lambda low, high, x, other: x(types.intp, types.intp, x, types.float64),
    lambda low, high, x, other: np.where(_are_between(low, high, x), x, other),
)
def between_lanes(builder, low, high, x, other):
    """`x` in the lanes from `low` to `high`, that excluded; `other`, a float, elsewhere."""
    wanted = _between(builder, low, high, x.type.count)
    return builder.select(wanted, x, _spread(builder, other, x.type))


def _between(builder, low, high, count):
    """The mask of the lanes from `low` to `high`, that excluded."""
    kind = ir.VectorType(_INDEX, count)
    low, high = (_spread(builder, builder.trunc(n, _INDEX), kind) for n in (low, high))
    numbers = ir.Constant(kind, list(range(count)))
    begun = builder.icmp_signed("<=", low, numbers)
    return builder.and_(begun, builder.icmp_signed("<", numbers, high))


@instruction(
    lambda low, high, x, limit: types.boolean(types.intp, types.intp, x, types.float64),
    lambda low, high, x, limit: bool(np.any(x[_are_between(low, high, x)] <= limit)),
)
def any_below(builder, low, high, x, limit):
    """Whether x <= limit in any lane from `low` to `high`, that excluded."""
    wanted = _between(builder, low, high, x.type.count)
    limit = _spread(builder, limit, x.type)
    below = builder.and_(wanted, builder.fcmp_ordered("<=", x, limit))
    bits = ir.IntType(x.type.count)
    return builder.icmp_unsigned("!=", builder.bitcast(below, bits), ir.Constant(bits, 0))


@in_kernels(lambda condition, usual, kernel, args: kernel(usual, *args) if condition else usual)
def seldom(typing_context, condition, usual, kernel, arguments):
    """`usual`, or kernel(usual, *arguments) where a condition holds that hardly ever does.

    The compiler keeps registers free of the call, as it does not after an ``if``.
    """
    called = typing_context.resolve_function_type(kernel, (usual, *arguments), {})

    def build(context, builder, sig, args):
        """Call the kernel in a branch that is marked as unlikely."""
        condition, usual, _, arguments = args
        result = cgutils.alloca_once_value(builder, usual)
        with cgutils.if_unlikely(builder, condition):
            call = context.get_function(kernel, called)
            context.add_linking_libs(getattr(call, "libs", ()))
            members = cgutils.unpack_tuple(builder, arguments)
            builder.store(call(builder, [usual, *members]), result)
        return builder.load(result)

    return usual(condition, usual, kernel, arguments), build


@instruction(lambda x: x(x), np.exp2)
def power_of_two(builder, x):
    """2^x for whole numbers from -1022 to 1023."""
    # Beyond 2^52 the spacing of floating-point numbers is 1, so the last bits are x.
    count = x.type.count
    integers = ir.VectorType(ir.IntType(64), count)
    bits = builder.fadd(x, ir.Constant(x.type, [1.5 * 2.0**52] * count))
    bits = builder.bitcast(bits, integers)
    bits = builder.add(bits, ir.Constant(integers, [1023] * count))
    bits = builder.shl(bits, ir.Constant(integers, [52] * count))
    return builder.bitcast(bits, x.type)
