"""What compilation freezes: the code of functions, and the values that they take from elsewhere.

numba makes constants of the globals, closures and default arguments of a function, and of those of
all functions that it calls.  Machine code is therefore that of these values too, wherever they come
from: a number in a module, an array that was read from a file, the environment.

:func:`frozen_in` follows a class of plug-ins through the bytecode of its methods, and hashes what
it finds.  Bytecode is what numba compiles; a file may have been edited since it was imported.
What belongs to numba, numpy, Python or this package is known by its name: other versions of these
make other machine code anyway.
"""

import builtins
import dis
import enum
import functools
import hashlib
import sys
from collections.abc import Container, Iterable, Iterator
from contextlib import suppress
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple

import numpy as np
from numba import types

from tribo.compiler.numba_private import overloads_of

# Packages whose functions and classes are known by their names.
KNOWN = ("builtins", "cmath", "llvmlite", "math", "numba", "numpy", "operator", "tribo")
# Values that their text describes whole.
PLAIN = (type(None), type(Ellipsis), bool, int, float, complex, str, bytes, range, slice)
# Instructions between a name and its attributes that do nothing to them.
IDLE = ("PUSH_NULL", "CACHE", "EXTENDED_ARG", "NOP", "PRECALL", "RESUME")
# Objects without a hash.  Each is kept, so that no other gets its address.
_unknown: dict[int, object] = {}


class Frozen(NamedTuple):
    """What compilation freezes of a class.  The same in any process, as far as it is `known`."""

    stamp: str  # hash of code and values [16 hex digits]
    values: str  # that of the values alone, which other versions of Python share; "" without any
    known: bool  # whether everything has a hash; an object without one is taken by its address
    modules: tuple[str, ...]  # of the functions
    classes: tuple[Any, ...]  # classes of plug-ins among the values


def frozen_in(cls: Any, methods: Container[str]) -> Frozen:
    """What compilation freezes of a class of plug-ins, with the compiled ones of its `methods`."""
    walk = _Walk(methods)
    walk.add_class(cls)
    return Frozen(
        _hash("\n".join(sorted(walk.code | walk.values))),
        _hash("\n".join(sorted(walk.values))) if walk.values else "",
        walk.known,
        tuple(sorted(walk.modules)),
        tuple(walk.classes.values()),
    )


def module_of(function: FunctionType) -> str:
    """The module whose globals a function sees, wherever it says that it comes from."""
    return str(function.__globals__.get("__name__", ""))


def is_known(module: str | None) -> bool:
    """Whether the functions of a module are known by their names."""
    return (module or "").partition(".")[0] in KNOWN


class _Walk:
    """Collects code and values, each a line of text that says where it is."""

    def __init__(self, methods: Container[str]) -> None:
        self.code: set[str] = set()
        self.values: set[str] = set()
        self.known = True
        self.modules: set[str] = set()
        self.classes: dict[int, Any] = {}
        self._methods = methods
        self._functions: dict[int, FunctionType] = {}

    def add_class(self, cls: Any) -> None:
        """A class of named tuples, with its methods, and its defaults, which calls may omit."""
        if id(cls) in self.classes:
            return
        self.classes[id(cls)] = cls
        self.code.add(f"class {cls.__qualname__} {' '.join(cls._fields)}")
        self._add_value(f"{cls.__qualname__} defaults", cls._field_defaults)
        for name in dir(cls):
            method = getattr(cls, name) if name in self._methods else None
            if isinstance(method, FunctionType):
                self.code.add(f"{cls.__qualname__}.{name} is {method.__qualname__}")
                self.add_function(method)

    def add_function(self, function: FunctionType) -> None:
        """A function with all that it refers to."""
        module = module_of(function)
        if is_known(module):
            self.code.add(f"function {function.__module__}.{function.__qualname__}")
            return
        if id(function) in self._functions:
            return
        self._functions[id(function)] = function
        self.modules.add(module)
        # Plug-ins that were loaded from files have modules named by hashes.
        place = f"{'' if module.startswith('tribo_plugin_') else module}.{function.__qualname__}"
        self.code.add(f"{place} {_hash(_text_of(function.__code__))}")
        self._add_value(f"{place} defaults", function.__defaults__)
        self._add_value(f"{place} keyword defaults", function.__kwdefaults__)
        for name, value in references(function):
            self._add_value(f"{place} {name}", value)

    def _add_value(self, place: str, value: Any) -> None:
        """A value that some code refers to, under the name of its place."""
        if self._add_code(place, value):
            return
        text = self._text(place, value)
        if text:
            self.values.add(f"{place} {text}")

    def _add_code(self, place: str, value: Any) -> bool:
        """A function, a class, a module or a type; whether the value is one."""
        compiled = python_function(value)
        if isinstance(value, FunctionType):
            self._add_called(place, value)
        elif compiled is not None:
            options = getattr(value, "targetoptions", {})
            self.code.add(f"{place} {type(value).__name__} {sorted(options.items(), key=str)}")
            self.add_function(compiled)
        elif isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
            self._add_tuple_class(place, value)
        elif isinstance(value, ModuleType):
            self.code.add(f"{place} module {value.__name__}")
        elif _is_of_package(value):
            self.code.add(f"{place} {_name(value)}")
        else:
            return False
        return True

    def _add_called(self, place: str, function: FunctionType) -> None:
        """A function of Python, which numba knows if somebody has registered it."""
        self.code.add(f"{place} function")
        self.add_function(function)
        if not is_known(module_of(function)) and not is_as_written(function):
            self.known = False

    def _add_tuple_class(self, place: str, cls: Any) -> None:
        if is_known(cls.__module__):
            self.code.add(f"{place} class {cls.__module__}.{cls.__qualname__}")
        else:
            self.add_class(cls)

    def _text(self, place: str, value: Any) -> str:
        """A text that tells a value from others; "" for one that is no data."""
        if type(value) in PLAIN:
            return f"{type(value).__name__} {value!r}"
        if isinstance(value, np.generic):
            return f"{value.dtype.str} {value.tobytes().hex()}"
        if isinstance(value, np.ndarray) and not value.dtype.hasobject:
            return f"array {value.dtype.descr} {value.shape} {_hash(value.tobytes())}"
        if isinstance(value, enum.Enum):
            return f"{type(value).__qualname__}.{value.name} {self._text(place, value.value)}"
        if isinstance(value, tuple) and hasattr(value, "_fields"):
            self._add_tuple_class(place, type(value))
            return f"{type(value).__qualname__} {self._texts(place, value)}"
        if type(value) in (tuple, list):
            return f"{type(value).__name__} {self._texts(place, value)}"
        if type(value) in (set, frozenset):
            return f"set {sorted(self._texts(place, value))}"
        if type(value) is dict:
            both = self._texts(place, value), self._texts(place, value.values())
            return f"dict {sorted(zip(*both, strict=True))}"
        if not self._add_code(place, value):
            self.known = False
            _unknown[id(value)] = value
            self.code.add(f"{place} {type(value).__name__} at {id(value)}")
        return ""

    def _texts(self, place: str, values: Iterable[Any]) -> list[str]:
        return [self._text(f"{place}[{i}]", each) for i, each in enumerate(values)]


def references(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """The values of globals and closures to which a function refers, ``module.name`` too."""
    closure = closure_of(function)
    for name, *attributes in names_in(function.__code__):
        for scope in (closure, function.__globals__, vars(builtins)):
            if name in scope:
                yield _followed(name, scope[name], attributes)
                break


def closure_of(function: FunctionType) -> dict[str, Any]:
    """The values of a function's closure by name, without those that are not assigned yet."""
    found = {}
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        with suppress(ValueError):
            found[name] = cell.cell_contents
    return found


def _followed(name: str, value: Any, attributes: list[str]) -> tuple[str, Any]:
    """A value and its name; of a module or a class, that of an attribute as far as there is one."""
    for attribute in attributes:
        inside = isinstance(value, (ModuleType, type))
        if not inside or not hasattr(value, attribute):
            break
        name = f"{name}.{attribute}"
        value = getattr(value, attribute)
    return name, value


@functools.cache
def names_in(code: CodeType) -> tuple[tuple[str, ...], ...]:
    """Names that code does not define, each with the attributes that it reads one after another.

    ``np.linalg.norm`` is ("np", "linalg", "norm").
    """
    chains: list[list[str]] = []
    reading = False
    for each in dis.get_instructions(code):
        if each.opname in ("LOAD_GLOBAL", "LOAD_NAME", "LOAD_DEREF", "LOAD_CLASSDEREF"):
            chains.append([each.argval])
            reading = True
        elif each.opname in ("LOAD_ATTR", "LOAD_METHOD") and reading:
            chains[-1].append(each.argval)
        elif each.opname not in IDLE:
            reading = False
    found = [tuple(chain) for chain in chains]
    for part in code.co_consts:
        if isinstance(part, CodeType):
            found += names_in(part)
    return tuple(dict.fromkeys(found))


def python_function(value: Any) -> FunctionType | None:
    """The function that a dispatcher of numba compiles; None for all else."""
    function = getattr(value, "py_func", None)
    return function if isinstance(function, FunctionType) else None


def is_as_written(function: FunctionType) -> bool:
    """Whether numba compiles the own code of a function of Python, where it is called."""
    registered = overloads_of(function)
    if registered is None:
        return False
    for each in registered:
        cells = getattr(each, "__closure__", None) or ()
        if not any(cell.cell_contents is function for cell in cells):
            return False
    return True


def _is_of_package(value: Any) -> bool:
    """Whether a value is a function, a class or a type of a package that is known."""
    if isinstance(value, types.Type):
        return True
    if isinstance(value, np.ufunc):
        return getattr(np, value.__name__, None) is value
    if not isinstance(value, (type, BuiltinFunctionType)) and not callable(value):
        return False
    module = getattr(value, "__module__", None)
    if not is_known(module):
        return False
    found: Any = sys.modules.get(str(module))
    for name in getattr(value, "__qualname__", getattr(value, "__name__", "")).split("."):
        found = getattr(found, name, None)
    return found is value


def _name(value: Any) -> str:
    if isinstance(value, types.Type):
        return f"type {value}"
    return f"{type(value).__name__} {getattr(value, '__module__', '')}.{value.__name__}"


@functools.cache
def _text_of(code: CodeType) -> str:
    """All of a function's code but its places in a file."""
    constants = [
        _text_of(each) if isinstance(each, CodeType) else _constant(each) for each in code.co_consts
    ]
    names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    counts = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags)
    return f"{code.co_code.hex()} {constants} {names} {counts}"


def _constant(value: Any) -> str:
    """The text of a constant in code; the order of a set differs between processes."""
    if isinstance(value, frozenset):
        return str(sorted(map(_constant, value)))
    return f"{type(value).__name__} {value!r}"


def _hash(text: str | bytes) -> str:
    content = text.encode() if isinstance(text, str) else text
    return hashlib.blake2b(content, digest_size=8).hexdigest()
