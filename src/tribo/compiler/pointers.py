"""Arrays inside of time loops: pointers with a shape.

numba's arrays have nine numbers or more.  Each function is typed and compiled with all of them,
for every array of every tuple that it takes.  A time loop turns its arrays into pointers once, by
:func:`pointers`; the kernels that it calls take a third of the time to compile, and indices are
not searched for negative ones.  ``x[i]``, ``x[i, j]``, ``x.shape``, and of one dimension ``x[:n]``,
``x[n:]`` and ``x.size`` mean what they mean for arrays; nothing else is there.
"""

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import config, extending, typeof, types

from tribo.compiler.jit import KERNEL
from tribo.compiler.numba_private import NATIVE, cgutils, own_reference, typed_first
from tribo.compiler.plugin_methods import PluginType, plugin_type

if NATIVE:
    from tribo.compiler.tuple_types import KernelTuple

# Tuples of these modules have arrays for kernels; those of plug-ins stay what their authors expect.
OURS = ("tribo.kernels.", "tribo.integrators.", "tribo.lanes.")


class PointerType(types.Type):
    """The type of a C-contiguous array without its owner."""

    def __init__(self, dtype: types.Type, ndim: int) -> None:
        self.dtype = dtype
        self.ndim = ndim
        super().__init__(name=f"Pointer({dtype}, {ndim})")


@extending.register_model(PointerType)
class _Model(extending.models.StructModel):
    def __init__(self, manager, kind) -> None:
        shape = types.UniTuple(types.intp, kind.ndim)
        super().__init__(manager, kind, [("data", types.CPointer(kind.dtype)), ("shape", shape)])


def pointer_type(kind: Any) -> Any:
    """The type of an array or of nested tuples with pointers in place of this package's arrays."""
    if isinstance(kind, types.Array) and kind.layout == "C":
        return PointerType(kind.dtype, kind.ndim)
    if not isinstance(kind, types.BaseTuple):
        return kind
    named = isinstance(kind, types.BaseNamedTuple)
    if named and not kind.instance_class.__module__.startswith(OURS):
        return kind
    members = [pointer_type(each) for each in kind]
    if members == list(kind):
        return kind
    if isinstance(kind, PluginType):
        return plugin_type(kind.instance_class, members)
    return types.BaseTuple.from_types(members, getattr(kind, "instance_class", None))


def type_of_pointers(item: Any) -> Any:
    """The type of nested tuples of arrays with pointers in their place."""
    return pointer_type(typeof(item))


def make_pointer(context, builder, kind: PointerType, data, shape: list) -> Any:
    """The instructions of a pointer of a type with these data and shape."""
    made = cgutils.create_struct_proxy(kind)(context, builder)
    made.data = data
    made.shape = cgutils.pack_array(builder, shape)
    return made._getvalue()


def pointer_to(context, builder, kind, value):
    """The pointer to a C-contiguous array of a type."""
    array = context.make_array(kind)(context, builder, value)
    shape = cgutils.unpack_tuple(builder, array.shape)
    return make_pointer(context, builder, pointer_type(kind), array.data, shape)


def _argument_type(kind: Any) -> Any:
    """The same for an argument of a time loop, which many kernels take as a whole."""
    new = pointer_type(kind)
    if not NATIVE or new == kind or isinstance(new, PluginType):
        return new
    if isinstance(new, types.NamedTuple):
        return KernelTuple(new, new.instance_class)
    return new


def _value_of(context, builder, kind, new, value):
    """The value of type `kind` with pointers instead of arrays, of type `new`."""
    if new == kind:
        return value
    if isinstance(kind, types.Array):
        return pointer_to(context, builder, kind, value)
    members = cgutils.unpack_tuple(builder, value)
    each = zip(kind, new, members, strict=True)
    converted = [_value_of(context, builder, *one) for one in each]
    return context.make_tuple(builder, new, converted)


def _pointers(typing_context, arrays):
    """A tuple of arrays, or of such tuples, with pointers in their place.

    The caller of the kernel that calls this must keep the arrays.
    """

    def build(context, builder, sig, args):
        value = _value_of(context, builder, sig.args[0], sig.return_type, args[0])
        return own_reference(context, builder, sig.return_type, value)  # with arrays of plug-ins

    return types.Tuple([_argument_type(each) for each in arrays])(arrays), build


class CheckedArray(np.ndarray):
    """An array whose slices must lie inside of it, where nothing is compiled.

    A pointer with a negative length, or beyond its array, would read the memory of others.
    """

    def __getitem__(self, at):
        if isinstance(at, slice):
            start = 0 if at.start is None else at.start
            stop = len(self) if at.stop is None else at.stop
            assert 0 <= start <= stop <= len(self), f"[{at.start}:{at.stop}] of {len(self)}"
        return super().__getitem__(at)


def map_arrays(change: Callable[[np.ndarray], np.ndarray], item: Any) -> Any:
    """Nested tuples with every array changed."""
    if isinstance(item, np.ndarray):
        return change(item)
    if isinstance(item, tuple):
        parts = [map_arrays(change, each) for each in item]
        return type(item)(*parts) if hasattr(item, "_fields") else tuple(parts)
    return item


def checked(arrays: Any) -> Any:
    """The same for Python, with checked slices; records stay as they are."""
    return map_arrays(lambda a: a.view(CheckedArray) if type(a) is np.ndarray else a, arrays)


pointers: Any = checked if config.DISABLE_JIT else extending.intrinsic(_pointers)  # type: ignore[attr-defined]


def _part(array: PointerType, at: Any) -> types.Type | None:
    """The type of ``array[at]``; None where it has none."""
    if isinstance(at, types.SliceType):
        return array if array.ndim == 1 and not at.has_step else None
    indices = at.types if isinstance(at, types.BaseTuple) else (at,)
    for index in indices:
        if not isinstance(index, types.Integer) or getattr(index, "literal_value", 0) < 0:
            return None
    if len(indices) > array.ndim:
        return None
    left = array.ndim - len(indices)
    return PointerType(array.dtype, left) if left else array.dtype


@typed_first(operator.getitem)
def _type_of_item(array, at):
    part = _part(array, at) if isinstance(array, PointerType) else None
    return part(array, at) if part else None


@typed_first(operator.setitem)
def _type_of_setting(array, at, value):
    if isinstance(array, PointerType) and _part(array, at) == array.dtype:
        return types.none(array, at, array.dtype)
    return None


def _read(context, builder, kind, value):
    """Data and shape."""
    array = cgutils.create_struct_proxy(kind)(context, builder, value)
    return array.data, cgutils.unpack_tuple(builder, array.shape)


extending.make_attribute_wrapper(PointerType, "shape", "shape")


@extending.overload_attribute(PointerType, "size", jit_options=KERNEL)
def _find_size(array):
    return (lambda array: array.shape[0]) if array.ndim == 1 else None


def _locate(context, builder, kind, value, index_kinds, indices):
    """The address of a part, and its shape."""
    data, shape = _read(context, builder, kind, value)
    place = None
    for index_kind, index in zip(index_kinds, indices, strict=True):
        index = context.cast(builder, index, index_kind, types.intp)
        length = shape[0]
        shape = shape[1:]
        place = index if place is None else builder.add(builder.mul(place, length), index)
    for length in shape:
        place = builder.mul(place, length)
    return builder.gep(data, [place]), shape


def _indices(builder, kind, at):
    if isinstance(kind, types.BaseTuple):
        return kind.types, cgutils.unpack_tuple(builder, at)
    return (kind,), [at]


@extending.lower_builtin(operator.getitem, PointerType, types.Integer)
@extending.lower_builtin(operator.getitem, PointerType, types.BaseTuple)
def _get(context, builder, sig, args):
    array, at = sig.args
    place, shape = _locate(context, builder, array, args[0], *_indices(builder, at, args[1]))
    if isinstance(sig.return_type, PointerType):
        return make_pointer(context, builder, sig.return_type, place, shape)
    return context.unpack_value(builder, array.dtype, place)


@extending.lower_builtin(operator.getitem, PointerType, types.SliceType)
def _slice(context, builder, sig, args):
    data, (length,) = _read(context, builder, sig.args[0], args[0])
    part = context.make_helper(builder, sig.args[1], args[1])
    last = ir.Constant(part.stop.type, 2**63 - 1)
    stop = builder.select(builder.icmp_signed("==", part.stop, last), length, part.stop)
    place = builder.gep(data, [part.start])
    return make_pointer(context, builder, sig.return_type, place, [builder.sub(stop, part.start)])


@extending.lower_builtin(operator.setitem, PointerType, types.Integer, types.Any)
@extending.lower_builtin(operator.setitem, PointerType, types.BaseTuple, types.Any)
def _set(context, builder, sig, args):
    array, at, _ = sig.args
    place, _ = _locate(context, builder, array, args[0], *_indices(builder, at, args[1]))
    context.pack_value(builder, array.dtype, args[2], place)
    return context.get_dummy_value()
