"""Tuples of arrays that kernels read from memory: one address instead of hundreds of numbers.

A scene has some sixty arrays.  As a tuple, it would be three hundred numbers, which each call of a
kernel passes on.  :func:`keep` writes where the arrays are, and their shapes, into memory; kernels
are given the address, and read what they need.  This memory does not change while a kernel runs, so
LLVM may read it once.  In kernels, the fields of a tuple that is kept are what they are in a tuple
that :func:`tribo.compiler.pointers.pointers` has converted; tuples in it are kept, too.  Where
nothing is compiled, the tuple is passed on as it is.
"""

import hashlib
import struct
from typing import Any

import numpy as np
from llvmlite import ir
from numba import config, extending, typeof, types

from tribo.compiler.numba_private import AttributeTemplate, cgutils
from tribo.compiler.pointers import PointerType, checked, make_pointer, pointer_type

_WORD = ir.IntType(64)


class KeptType(types.Type):
    """The type of a NamedTuple in memory."""

    def __init__(self, kind: Any) -> None:
        """Find the first word of each field; `kind` is the type of the tuple that is kept."""
        self.kind = kind
        self.places: dict[str, tuple[Any, int]] = {}  # field -> its type, and its first word
        place = 0
        for name, each in zip(kind.fields, kind.types, strict=True):
            self.places[name] = each, place
            place += words_in(each)
        # A short name: it stands wherever LLVM's text names a function that takes such a tuple.
        digest = hashlib.blake2b(str(kind).encode(), digest_size=8).hexdigest()
        super().__init__(name=f"{kind.instance_class.__name__}_{digest}")

    @property
    def mangling_args(self) -> tuple[str, tuple[()]]:
        """The type in the names of functions."""
        return self.name, ()

    def __reduce__(self) -> Any:
        return KeptType, (self.kind,)


@extending.register_model(KeptType)
class _Model(extending.models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _WORD.as_pointer())


class Kept:
    """A tuple that :func:`keep` has written into memory."""

    def __init__(self, item: Any, kind: KeptType, words: np.ndarray) -> None:
        self.item = item  # whose arrays must live as long
        self.kind = kind
        self.words = words
        self.address = words.ctypes.data

    def with_fields_of(self, item: Any) -> "Kept":
        """Another tuple of the same type, where fields that are the same objects are known."""
        words = self.words.copy()
        for new, old, (_, place) in zip(item, self.item, self.kind.places.values(), strict=True):
            if new is not old:
                own = words_of(new)
                words[place : place + len(own)] = own
        return Kept(item, self.kind, words)


def keep(item: Any) -> Any:
    """A tuple as an argument of time loops; as it is if it is none, or nothing is compiled."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return checked(item)
    if not isinstance(item, tuple):
        return item
    return Kept(item, kept_type(item), np.array(words_of(item), np.int64))


def keep_like(known: Any, item: Any) -> Any:
    """The same of a tuple that differs in a few fields from one that is kept."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return checked(item)
    return known.with_fields_of(item)


# Class of a tuple, and which of its fields are absent -> its type, which takes long to find.
_kinds: dict[Any, KeptType] = {}


def kept_type(item: Any) -> KeptType:
    """The type of a tuple that is kept; a class has one for each choice of absent fields."""
    key = type(item), *map(_presence, item)
    if key not in _kinds:  # threads that find the same type at once must all take one of theirs
        _kinds.setdefault(key, KeptType(pointer_type(typeof(item))))
    return _kinds[key]


def _presence(field: Any) -> Any:
    """What tells the types of a field apart; no two are equal, as True and a length of 1 are."""
    if field is None:
        return "absent"
    return len(field) if type(field) is tuple else "present"


@extending.typeof_impl.register(Kept)
def _type_of_kept(value: Kept, context: Any) -> KeptType:
    return value.kind


@extending.unbox(KeptType)
def _unbox(kind: KeptType, item: Any, c: Any) -> Any:
    found = c.pyapi.object_getattr_string(item, "address")
    address = c.pyapi.long_as_longlong(found)
    c.pyapi.decref(found)
    return extending.NativeValue(c.builder.inttoptr(address, _WORD.as_pointer()))


@extending.infer_getattr
class _Fields(AttributeTemplate):
    key = KeptType

    def generic_resolve(self, kept: KeptType, name: str) -> Any:  # type: ignore[override]
        if name not in kept.places:
            return None
        return _type_of_field(kept.places[name][0])


def _type_of_field(kind: Any) -> Any:
    return KeptType(kind) if isinstance(kind, types.BaseNamedTuple) else kind


@extending.lower_getattr_generic(KeptType)
def _field(context: Any, builder: Any, kept: KeptType, value: Any, name: str) -> Any:
    kind, place = kept.places[name]
    if isinstance(kind, types.BaseNamedTuple):
        return builder.gep(value, [ir.Constant(_WORD, place)])
    return read_words(context, builder, kind, value, place)[0]


def words_in(kind: Any) -> int:
    """How many words a value of a type takes."""
    if isinstance(kind, types.BaseTuple):
        return sum(map(words_in, kind))
    if isinstance(kind, (types.Array, PointerType)):
        return 1 + kind.ndim
    return 0 if isinstance(kind, types.NoneType) else 1


def words_of(item: Any) -> list[int]:
    """A number, an array, or nested tuples of them in words of eight bytes.

    An array, which the caller keeps, is its address and its lengths.  Raises TypeError for others.
    """
    if isinstance(item, tuple):
        return [word for each in item for word in words_of(each)]
    if isinstance(item, np.ndarray):
        assert item.flags.c_contiguous
        return [item.ctypes.data, *item.shape]
    if isinstance(item, float):
        return list(struct.unpack("q", struct.pack("d", item)))
    if isinstance(item, (bool, int, np.integer)):
        return [int(item)]
    if item is None:
        return []
    raise TypeError(f"a {type(item).__name__} among the numbers of kernels")


def read_words(context: Any, builder: Any, kind: Any, words: Any, n: int) -> tuple[Any, int]:
    """A value of a type whose words begin with the nth, and the number of the word after it."""
    if isinstance(kind, types.NoneType):
        return context.get_dummy_value(), n
    if isinstance(kind, types.BaseTuple):
        values = []
        for each in kind:  # type: ignore[attr-defined]
            value, n = read_words(context, builder, each, words, n)
            values.append(value)
        return context.make_tuple(builder, kind, values), n
    word = _load(builder, words, n)
    if isinstance(kind, (types.Array, PointerType)):
        shape = [_load(builder, words, n + 1 + axis) for axis in range(kind.ndim)]
        return _array(context, builder, kind, word, shape), n + 1 + kind.ndim
    result = context.get_value_type(kind)
    if isinstance(kind, (types.Boolean, types.Integer)):
        same = result == _WORD
        return (word if same else builder.trunc(word, result)), n + 1
    return builder.bitcast(word, result), n + 1


def _load(builder: Any, words: Any, n: int) -> Any:
    """The nth word, which is the same as long as the kernel runs."""
    word = builder.load(builder.gep(words, [ir.Constant(_WORD, n)]))
    word.set_metadata("invariant.load", builder.module.add_metadata([]))
    return word


def _array(context: Any, builder: Any, kind: Any, address: Any, shape: list[Any]) -> Any:
    """An array, of which somebody else is the owner, or a pointer to it."""
    data = context.get_data_type(kind.dtype).as_pointer()
    if isinstance(kind, PointerType):
        return make_pointer(context, builder, kind, builder.inttoptr(address, data), shape)
    array = context.make_array(kind)(context, builder)
    size = ir.Constant(_WORD, context.get_abi_sizeof(context.get_data_type(kind.dtype)))
    strides = [size]
    items = ir.Constant(_WORD, 1)
    for length in reversed(shape):
        strides.insert(0, builder.mul(strides[0], length))
        items = builder.mul(items, length)
    array.data = builder.inttoptr(address, data)
    array.shape = cgutils.pack_array(builder, shape)
    array.strides = cgutils.pack_array(builder, strides[1:])
    array.itemsize = size
    array.nitems = items
    return array._getvalue()
