"""InputError and the checks of values, before anything is compiled.

Each check returns the value in the form on which the package relies, or raises InputError.
"""

from __future__ import annotations

import dataclasses
import difflib
import math
import os
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeGuard, TypeVar

import numpy as np

Word = TypeVar("Word", bound=str)
Option = TypeVar("Option")

# What a number must be, and whether it is, or each number of an array.
Condition = tuple[str, Callable[[Any], Any]]
# Takes the name of a field and its value, and returns that in the form on which the package relies.
Check = Callable[[str, Any], Any]


class InputError(ValueError):
    """A value that cannot be used: ``field: what is wrong, and which values are valid``.

    Attributes: `field` as a scene file writes it, such as ``surface[0].asperite.m1``, and
    `problem`.
    """

    def __init__(self, field: str, problem: str) -> None:
        self.field = field
        self.problem = problem
        super().__init__(f"{field}: {problem}" if field else problem)

    def under(self, prefix: str) -> InputError:
        """The same error for a field that is part of `prefix`."""
        if not self.field:
            return InputError(prefix, self.problem)
        separator = "" if self.field.startswith("[") else "."
        return InputError(f"{prefix}{separator}{self.field}", self.problem)


def must_be(field: str, wanted: str, value: object) -> InputError:
    """The error of a field whose value is not what is wanted; to be raised."""
    return InputError(field, f"must be {wanted}, got {short_repr(value)}")


def shortened(names: Iterable[object]) -> str:
    """Names with commas between them, as many as a message quotes."""
    words = list(map(str, names))
    count = 0
    length = 0
    for word in words:
        length += len(word) + 2
        if length > 100:
            break
        count += 1
    rest = f", ... ({len(words)} in all)" if count < len(words) else ""
    return ", ".join(words[:count]) + rest


class TriboWarning(UserWarning):
    """A run stopped early or missed its accuracy; its result says so too."""


ANY: Condition = ("must be a number", lambda x: True)
POSITIVE: Condition = ("must be positive", lambda x: x > 0.0)
NOT_NEGATIVE: Condition = ("must not be negative", lambda x: x >= 0.0)
# Largest magnitude of a number: energies, cubes and ratios of two such numbers are finite.
LARGEST_NUMBER = 1e100
# Smallest duration [time]: products of two such numbers are positive.
SHORTEST_DURATION = 1e-100
# Largest number of asperites, samples or oscillators, which fit in memory.
LARGEST_COUNT = 10_000_000
# Largest number of characters of a value that a message quotes.
QUOTED = 80


def short_repr(value: object) -> str:
    """The value as a message quotes it: one line of at most 80 characters."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # an integer of thousands of digits
        return "an integer of too many digits"
    return text if len(text) <= QUOTED else text[: QUOTED - 3] + "..."


def number(field: str, value: object, condition: Condition = ANY, unit: str = "") -> float:
    """One finite number that meets the condition; the message names the unit if one is given."""
    # A float is the most frequent; what is wrong with one is found below.
    ordinary = type(value) is float and -LARGEST_NUMBER <= value <= LARGEST_NUMBER
    if ordinary and (condition is ANY or condition[1](value)):
        return value  # type: ignore[return-value]
    value = scalar(value)
    if isinstance(value, bool) or not isinstance(value, (int, float, np.floating)):
        raise must_be(field, f"a number{_in(unit)}", value)
    if isinstance(value, (float, np.floating)) and not math.isfinite(value):
        raise InputError(field, f"must be a finite number{_in(unit)}, got {value}")
    if not -LARGEST_NUMBER <= value <= LARGEST_NUMBER:
        raise must_be(field, f"at most {LARGEST_NUMBER:g} in magnitude", value)
    if not condition[1](float(value)):
        raise InputError(field, f"{condition[0]}{_in(unit)}, got {value}")
    return float(value)


def _in(unit: str) -> str:
    return f" [{unit}]" if unit else ""


def number_or_array(
    field: str, value: object, condition: Condition = ANY, unit: str = ""
) -> float | np.ndarray:
    """One number for all asperites, or one number per asperite as a read-only array."""
    # A float is the most frequent, for which `is_list` is not needed.
    if type(value) is float or not is_list(value):
        return number(field, value, condition, unit)
    return vector(field, value, condition, unit=unit)


def listed(field: str, value: object, size: int | None = None, unit: str = "") -> Any:
    """A list or an array, of the given size if there is one, whose items are not checked."""
    wanted = "a list of numbers" if size is None else "1 number" if size == 1 else f"{size} numbers"
    if not is_list(value):
        raise must_be(field, f"{wanted}{_in(unit)}", value)
    if size is not None and len(value) != size:
        raise InputError(field, f"must be {wanted}{_in(unit)}, got {len(value)}")
    return value


def vector(
    field: str, value: object, condition: Condition = ANY, size: int | None = None, unit: str = ""
) -> np.ndarray:
    """A read-only array of finite numbers, of the given size if there is one."""
    items = listed(field, value, size, unit)
    if hasattr(items, "__array__"):
        items = np.asarray(items)
    if isinstance(items, np.ndarray) and items.ndim == 1 and items.dtype.kind in "if":
        array = items.astype(float)
        usable = np.abs(array) <= LARGEST_NUMBER
        for k in () if usable.all() else np.flatnonzero(~usable):
            number(f"{field}[{k}]", array[k], ANY, unit)
    else:
        array = np.array([number(f"{field}[{i}]", item, ANY, unit) for i, item in enumerate(items)])
    if condition is not ANY:
        met = np.asarray(condition[1](array))
        if not met.all():
            i = int(met.argmin())
            raise InputError(f"{field}[{i}]", f"{condition[0]}{_in(unit)}, got {float(array[i])}")
    array.flags.writeable = False
    return array


def one(condition: Condition = ANY, unit: str = "") -> Check:
    """The check of a field that is one number."""
    return partial(number, condition=condition, unit=unit)


def count(least: int, most: int | None = None) -> Check:
    """The check of a field that is an integer."""
    return partial(integer, least=least, most=most)


def pair(condition: Condition = ANY, unit: str = "") -> Check:
    """The check of a field that is two numbers, which become a tuple."""
    return lambda field, value: tuple(vector(field, value, condition, 2, unit).tolist())


def fields(item: Any, **checks: Check) -> None:
    """Replace fields of a frozen dataclass by what their checks return; a None by default stays."""
    for name, check in checks.items():
        value = getattr(item, name)
        known = item.__dataclass_fields__[name]
        if value is not None or known.default is not None:
            object.__setattr__(item, name, check(name, value))


def is_list(value: object) -> TypeGuard[Sequence[Any] | np.ndarray]:
    """Whether the value is a list, a tuple or an array, as of numpy or xarray, with an axis."""
    if isinstance(value, (int, float)):
        return False
    if isinstance(value, (tuple, list)):
        return True
    if hasattr(value, "ndim"):
        return bool(value.ndim > 0)
    return isinstance(value, Sequence) and not isinstance(value, (str, bytes))


def scalar(value: object) -> Any:
    """A number of Python for an array without an axis, as of numpy or xarray; others as given."""
    return np.asarray(value).item() if getattr(value, "shape", None) == () else value


def integer(field: str, value: object, least: int, most: int | None = None) -> int:
    """An integer of at least `least`, and at most `most` if that is given."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < least:
        raise must_be(field, f"an integer of at least {least}", value)
    if most is not None and value > most:
        raise must_be(field, f"an integer of at most {most}", value)
    return int(value)


def choice(field: str, value: object, options: Iterable[Word]) -> Word:
    options = list(options)
    for option in options:
        if isinstance(value, str) and value == option:
            return option
    words = " or ".join(f'"{o}"' for o in options)
    raise must_be(field, f"{words}", value)


def one_of(field: str, value: object, options: Iterable[Option]) -> Option:
    """One of some names, or of other values, of which those are equal that are so in JSON."""
    options = list(options)
    for option in options:
        if option == value and isinstance(option, bool) == isinstance(value, bool):
            return option
    raise must_be(field, f"one of {shortened(options)}", value)


def instance(kind: type) -> Check:
    """The check of a field that is an object of a public class."""

    def check(field: str, value: object) -> object:
        if not isinstance(value, kind):
            raise must_be(field, f"a tribo.{kind.__name__}", value)
        with inside(field):
            return as_parent(value, [kind])

    return check


def as_parent(value: Any, kinds: Collection[type]) -> Any:
    """An object of one of some dataclasses, also for one of a subclass that changes nothing.

    Runs and files know the fields and methods of `kinds` alone.  Raises InputError, without a
    field, for subclasses with others.
    """
    cls = type(value)
    if cls in kinds:
        return value
    parent = next((base for base in cls.__mro__ if base in kinds), None)
    if parent is None:
        known = shortened(f"tribo.{kind.__name__}" for kind in kinds)
        raise InputError("", f"must be of {known}, got a {cls.__name__}")
    own = dataclasses.fields(parent)
    names = [each.name for each in own]
    added = [each.name for each in dataclasses.fields(cls) if each.name not in names]
    between = cls.__mro__[: cls.__mro__.index(parent)]
    methods = [name for base in between for name in vars(base) if not name.startswith("__")]
    changed = [name for name in methods if name not in names and hasattr(parent, name)]
    if added or changed:
        raise InputError(
            "",
            f"{cls.__name__} changes {' and '.join(added + changed)} of tribo.{parent.__name__}, "
            f"which runs would not see; give a tribo.{parent.__name__}",
        )
    return parent(**{each.name: getattr(value, each.name) for each in own if each.init})


def boolean(field: str, value: object) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise must_be(field, "true or false", value)
    return bool(value)


def known_keys(
    table: object, allowed: Iterable[str], required: Iterable[str] = ()
) -> dict[str, Any]:
    """A table that has all of the required keys, and no key that is not allowed."""
    if not isinstance(table, Mapping):
        raise must_be("", "a table", table)
    allowed = list(allowed)
    for key in table:
        if key not in allowed:
            near = difflib.get_close_matches(str(key), allowed, n=1)
            hint = f'did you mean "{near[0]}"?' if near else f"known here: {shortened(allowed)}"
            name = key if isinstance(key, str) and key.isprintable() else short_repr(key)
            raise InputError(name, f"is not a known key; {hint}")
    missing = [key for key in required if key not in table]
    if missing:
        others = f"; needed too: {shortened(missing[1:])}" if missing[1:] else ""
        raise InputError(missing[0], f"is missing{others}")
    return dict(table)


def as_path(value: object) -> Path:
    if not isinstance(value, (str, os.PathLike)) or "\0" in os.fspath(value):
        raise must_be("path", "the name of a file", value)
    return Path(value)


class inside:  # noqa: N801 (is used as a function)
    """A context whose InputErrors are about fields that are parts of `prefix`.

    A class, as scenes are checked in many: those of `contextlib.contextmanager` take three times as
    long.
    """

    def __init__(self, prefix: str) -> None:
        self._prefix = prefix

    def __enter__(self) -> None:
        """Nothing is prepared."""

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        if isinstance(error, InputError):
            raise error.under(self._prefix) from None
