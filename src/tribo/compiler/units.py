"""Units: functions that are compiled by themselves and called by their address.

What a plug-in takes part in, such as the contact of one class of potentials, is a unit.  The time
loops know it by a number only, the address of its machine code, so they are compiled once for all
plug-ins, and a new plug-in costs the time of its own units.  A unit is called once for a surface or
a pair of surfaces, so that the call takes no time that can be measured.

The numbers of a plug-in stand in memory, too, and a unit is given their address; :func:`fetched`
makes a plug-in of it.  Where nothing is compiled, a unit is a function of Python, its own address,
and takes a plug-in as it is.
"""

from collections.abc import Callable
from contextlib import suppress
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import cfunc, config, extending, types

from tribo.compiler.jit import NUMPY_ERRORS, UNCOUNTED, named, remove_stale, undisturbed
from tribo.compiler.kept import read_words, words_of
from tribo.compiler.lanes import lanes
from tribo.compiler.lanes_memory import room
from tribo.compiler.numba_private import NATIVE, cgutils
from tribo.compiler.plugin_methods import like
from tribo.compiler.pointers import pointer_to
from tribo.compiler.source_stamps import code_stamp
from tribo.compiler.unit_errors import watch

if NATIVE:
    from tribo.compiler.cache import KernelCache
    from tribo.compiler.linking import unit_of

_WORD = ir.IntType(64)


class AddressType(types.Type):
    """The type of an address of something of another type."""

    def __init__(self, kind: types.Type, name: str) -> None:
        self.kind = kind
        super().__init__(name=f"{name}({kind})")


class WordsType(AddressType):
    """The address of a plug-in's numbers, as :func:`words_of` writes them."""

    def __init__(self, kind: types.Type) -> None:
        super().__init__(kind, "Words")


class WordsInLanesType(AddressType):
    """The address of the numbers of eight plug-ins of one class, those of each field together."""

    def __init__(self, kind: types.Type) -> None:
        super().__init__(kind, "WordsInLanes")


@extending.register_model(WordsType)
@extending.register_model(WordsInLanesType)
class _Model(extending.models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _WORD)


def _fetched(typing_context, address):
    """What is at an address; other values as they are."""
    if isinstance(address, WordsType):
        return address.kind(address), _load_words
    if isinstance(address, WordsInLanesType):
        return like(address.kind, lanes)(address), _load_words_in_lanes
    return address(address), lambda context, builder, sig, args: args[0]


def _load_words(context, builder, sig, args):
    words = builder.inttoptr(args[0], _WORD.as_pointer())
    return read_words(context, builder, sig.return_type, words, 0)[0]


def _load_words_in_lanes(context, builder, sig, args):
    vector = context.get_value_type(lanes)
    first = builder.inttoptr(args[0], vector.as_pointer())
    count = len(sig.return_type.types)
    places = [builder.gep(first, [ir.Constant(_WORD, n)]) for n in range(count)]
    values = [builder.load(place, align=8) for place in places]
    return context.make_tuple(builder, sig.return_type, values)


def _call_unit(typing_context, address, arguments):
    """Call a unit, which returns a float."""
    return types.float64(types.int64, arguments), _call


def _call_unit_in_lanes(typing_context, address, arguments):
    """Call a unit, which returns Lanes."""
    return lanes(types.int64, arguments), _call


def _call(context, builder, sig, args):
    """The call of the address, with arrays as pointers and literals as their types."""
    values = cgutils.unpack_tuple(builder, args[1])
    passed = []
    for kind, value in zip(sig.args[1], values, strict=True):
        if isinstance(kind, types.Literal):
            value = context.cast(builder, value, kind, types.unliteral(kind))
        elif isinstance(kind, types.Array):
            value = pointer_to(context, builder, kind, value)
        passed.append(value)
    result = context.get_value_type(sig.return_type)
    function = ir.FunctionType(result, [value.type for value in passed])
    return builder.call(builder.inttoptr(args[0], function.as_pointer()), passed)


def _call_python(unit: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    return unit(*arguments)


if config.DISABLE_JIT:  # type: ignore[attr-defined]
    fetched: Any = lambda item: item  # noqa: E731
    call_unit: Any = _call_python
    call_unit_in_lanes: Any = _call_python
else:
    fetched = extending.intrinsic(_fetched)
    call_unit = extending.intrinsic(_call_unit)
    call_unit_in_lanes = extending.intrinsic(_call_unit_in_lanes)


def memory_of(plugins: tuple[Any, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The words of some plug-ins in an array, and the address of each; these where not compiled."""
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        addresses = np.empty(len(plugins), object)
        for n, plugin in enumerate(plugins):
            addresses[n] = plugin
        return np.empty(0), addresses
    words = [words_of(plugin) for plugin in plugins]
    memory = room((sum(map(len, words)),))
    memory.view(np.int64)[:] = [word for each in words for word in each]
    first = np.cumsum([0, *map(len, words[:-1])]) if words else np.empty(0, np.int64)
    return memory, memory.ctypes.data + 8 * np.asarray(first, np.int64)


# Function, types of its arguments, and version -> the unit; its machine code must not be freed.
_units: dict[Any, Any] = {}


def address_of(
    function: FunctionType,
    kinds: tuple[Any, ...],
    stamp: str | None,
    version: str,
    returns: types.Type = types.float64,
) -> Any:
    """The address of a unit for arguments of these types, compiled or loaded at its first use.

    `stamp` is the hash of what a plug-in is compiled from; "" for code of this package alone, whose
    units raise no errors.  With None nothing is kept on disk.
    `version` tells plug-ins without a stamp apart.  Raises numba's errors.
    """
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return function
    if stamp != "":
        watch()
    key = function, kinds, version
    if key not in _units:
        with undisturbed():
            _units[key] = _compiled(function, returns(*kinds), stamp)
    return _units[key].address


class UnitJob(NamedTuple):
    """A unit to compile: what :func:`address_of` takes."""

    function: Any
    kinds: tuple[Any, ...]
    stamp: str | None = ""
    version: str = ""
    returns: types.Type = types.float64

    def address(self) -> Any:
        """The address of the unit.  Raises numba's errors."""
        return address_of(*self)

    def is_missing(self) -> bool:
        """Whether it could be on disk, and is neither there nor in memory."""
        if config.DISABLE_JIT or not NATIVE:  # type: ignore[attr-defined]
            return False
        if self.stamp is None or (self.function, self.kinds, self.version) in _units:
            return False
        unit = _made(self.function, self.returns(*self.kinds), self.stamp)
        target = unit._targetdescr.target_context
        return isinstance(unit._cache, KernelCache) and not unit._cache.has_file(unit._sig, target)

    def is_shared(self) -> bool:
        """Whether other processes know its classes, which are those of this package alone."""
        return self.version == ""

    def compile(self) -> None:
        """Compile it, or load it from disk."""
        self.address()


def unit_codes() -> dict[int, tuple[str, Any]]:
    """Address -> what tells a unit apart in all processes, and the unit, of all that were made."""
    return {
        unit.address: (f"{function.__name__}({', '.join(map(str, kinds))})", unit)
        for (function, kinds, _), unit in _units.items()
    }


def _compiled(function: FunctionType, sig: Any, stamp: str | None) -> Any:
    """The unit for a signature, from disk where `stamp` tells its version."""
    if not NATIVE:
        clone = function if stamp is None else named(function, f"{code_stamp()}_{stamp}_plain")
        return cfunc(sig, cache=stamp is not None, **NUMPY_ERRORS)(clone)
    unit = _made(function, sig, stamp)
    if stamp is not None:
        remove_stale(function)
    unit.compile()
    return unit


def _made(function: FunctionType, sig: Any, stamp: str | None) -> Any:
    """The unit before it is compiled or loaded."""
    clone = function if stamp is None else named(function, f"{code_stamp()}_{stamp}")
    unit = unit_of(clone, sig.args, sig.return_type, {**NUMPY_ERRORS, **UNCOUNTED})
    if stamp is not None:
        # With no folder that can be written, each process compiles.
        with suppress(RuntimeError):
            unit._cache = KernelCache(clone)
    return unit
