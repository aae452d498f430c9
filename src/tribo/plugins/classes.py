"""Plug-ins: NamedTuples of numbers with methods, from Python or from a user's file.

Potentials, fields, drives and the forces on bars' ends are all of this kind.  numba types a
NamedTuple by its class, finds its methods when a kernel is compiled, and inlines them.
"""

from __future__ import annotations

import linecache
import re
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tribo.plugins import sources
from tribo.plugins.unloaded import Unloaded, left, refuse_code
from tribo.validation import InputError, inside, known_keys, number, short_repr

# How many numbers a method returns; 1 if it is not listed.
RETURN_COUNTS = {
    **dict.fromkeys(("feature", "domain", "force_at", "force_at_time", "force_on_bar"), 2),
    "end_forces": 4,
}


def completed(
    cls: Any,
    bases: tuple[type, ...],
    following: Callable[[dict[str, Any]], dict[str, Any]],
    complete: Callable[[Any], Any],
    make: Callable[[Any], Any],
) -> Any:
    """A class derived from a user's, with the methods that follow from those it defines.

    Nothing is written to `cls`; `bases` have the defaults of all other methods.  The methods that
    are `following` from those that one class defines replace inherited ones.  `complete` makes the
    new class from `cls`, in another process too, and `make` an instance of it from one of `cls`.
    """
    methods: dict[str, Any] = {}
    for ancestor in reversed(cls.__mro__[: cls.__mro__.index(tuple)]):
        public = (name for name in vars(ancestor) if not name.startswith("_"))
        own = {name: vars(ancestor)[name] for name in public if name not in cls._fields}
        methods |= following(own) | own
    names = {name: getattr(cls, name) for name in ("__module__", "__qualname__", "__doc__")}
    pickled = {"made_by": (complete, cls), "__reduce__": lambda self: (make, (cls(*self),))}
    kind: Any = type(bases[0]) if bases else type
    return kind(cls.__name__, (cls, *bases), methods | names | pickled)


def parts(value: Any) -> Iterator[Any]:
    """A plug-in and all plug-ins among its fields, and of those; of anything else, nothing."""
    if hasattr(value, "_fields"):
        yield value
        for item in value:
            yield from parts(item)


def check_class(cls: object, field: str, method: str, otherwise: str = "") -> None:
    """Raise InputError, about `field`, if a class is not a plug-in that has `method`."""
    if cls is Unloaded:
        return
    if isinstance(cls, type) and issubclass(cls, type):
        raise InputError(field, "must be an instance, as Own(1.0), got the class itself")
    name = getattr(cls, "__name__", repr(cls))
    if not (isinstance(cls, type) and issubclass(cls, tuple) and hasattr(cls, "_fields")):
        raise InputError(field, f"{name} must be a NamedTuple whose fields are numbers{otherwise}")
    if not cls._fields:
        problem = f"{name} has no parameters; give it at least one field, {_field_like(cls)}"
        raise InputError(field, problem)
    if not callable(getattr(cls, method.partition("(")[0], None)):
        raise InputError(field, f"{name} has no method {method}")


def _field_like(cls: type) -> str:
    """How a class without fields would declare one, after a number that it has instead."""
    numbers = (
        f"{name}: float = {value!r}"
        for name, value in vars(cls).items()
        if not name.startswith("_") and type(value) in (int, float)
    )
    shown = f"as {next(numbers, 'h: float = 1.0')} in the class"
    return f"{shown} instead of __init__" if "__init__" in vars(cls) else shown


def as_built_in(value: Any) -> Any:
    """The plug-in, of a class of this package if its own derives from that and changes nothing."""
    cls: Any = next(cls for cls in type(value).__mro__ if sources.is_own(cls) or _changes(cls))
    return value if cls is type(value) or _changes(cls) else cls(*value)


def _changes(cls: type) -> bool:
    """Whether a class has names beside those of every class, as far as it is a user's."""
    own = not sources.is_own(cls)
    return own and (cls is tuple or any(not name.startswith("__") for name in vars(cls)))


def with_numbers(value: Any) -> Any:
    """The same plug-in with its fields as finite floats."""
    if isinstance(value, Unloaded):
        return value
    return type(value)(**{key: number(key, item) for key, item in value._asdict().items()})


def instance(cls: Any, parameters: dict[str, Any]) -> Any:
    required = [f for f in cls._fields if f not in cls._field_defaults]
    return cls(**known_keys(parameters, cls._fields, required))


def is_named(name: object) -> bool:
    """Whether a name is that of a class in a file or module, as of `class_named`."""
    in_module = r"[\w.]+:\w+"
    return isinstance(name, str) and (".py:" in name or bool(re.fullmatch(in_module, name)))


def class_named(field: str, name: str, folder: Path) -> type:
    """The class ``file.py:Class`` in `folder`, or ``package.module:Class``.  Raises InputError."""
    refuse_code(field, name)
    place, _, class_name = name.rpartition(":")
    with inside(field):
        if ".py:" in name:
            module = sources.module_in_file(folder / place)
            place = str(module.__file__)
        else:
            module = sources.module_named(place)
    if not hasattr(module, class_name):
        raise InputError(field, f"{place} defines no {class_name}")
    return getattr(module, class_name)


def from_file(
    field: str,
    name: str,
    parameters: dict[str, Any],
    folder: Path,
    method: str | Callable[[Any], str],
) -> Any:
    """The plug-in with `method` that a table names, or an Unloaded for it.  Raises InputError.

    The method may depend on the class.
    """
    stand_in = left(name, parameters)
    if stand_in is not None:
        return stand_in
    cls = class_named(field, name, folder)
    check_class(cls, field, method(cls) if callable(method) else method)
    return instance(cls, parameters)


def name_of(plugin: NamedTuple | Unloaded, built_in: dict[str, type]) -> str:
    """The name of the plug-in's class in a scene file."""
    if isinstance(plugin, Unloaded):
        return plugin.name
    for name, cls in built_in.items():
        if type(plugin) is cls:
            return name
    return f"{sources.place_of(type(plugin))}:{type(plugin).__qualname__}"


def call_method(plugin: object, field: str, method: str, *arguments: object) -> Any:
    """Call a method.  Raises InputError, with the line of the source, if it raises an error."""
    try:
        with np.errstate(all="ignore"):
            return getattr(plugin, method)(*arguments)
    except Exception as error:
        code = getattr(type(plugin), method).__code__
        frames = traceback.extract_tb(error.__traceback__)
        line = next((f.lineno for f in reversed(frames) if f.filename == code.co_filename), None)
        reason = f"{type(error).__name__}: {error}"
        raise InputError(field, located(plugin, method, line, reason)) from None


def returned_numbers(plugin: object, field: str, method: str, *arguments: object) -> Any:
    """Call a method.  Raises InputError unless it returns real numbers, as many as it should."""
    value = call_method(plugin, field, method, *arguments)
    count = RETURN_COUNTS.get(method, 1)
    if count == 1 and type(value) in (int, float):  # nearly always
        return value
    # np.where of numbers is an array without dimensions.
    several = value if isinstance(value, tuple) else (value,)
    items = [x[()] if isinstance(x, np.ndarray) else x for x in several]
    kinds = (int, float, np.integer, np.floating)
    if len(items) != count or not all(isinstance(item, kinds) for item in items):
        expected = "a number is" if count == 1 else f"{count} numbers are"
        reason = f"gives {short_repr(value)} where {expected} wanted"
        raise InputError(field, located(plugin, method, None, reason))
    return value


def located(plugin: object, method: str, line: int | None, reason: str) -> str:
    """One sentence: a line of a method's source, by default its first, and what is wrong there."""
    code = getattr(type(plugin), method).__code__
    line = line or code.co_firstlineno
    text = linecache.getline(code.co_filename, line).strip()
    name = f"{type(plugin).__name__}.{method}"
    return f'{name} fails in line {line} of {code.co_filename}, "{text}": {reason}'
