"""Checks at the door: each returns the value in the form that the rest relies on, or complains."""

from __future__ import annotations

import difflib
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

Condition = tuple[str, Callable[[float], bool]]


class InputError(ValueError):
    """A value that cannot be used: ``field: what is wrong, and what would do``."""

    def __init__(self, field: str, problem: str) -> None:
        self.field = field
        self.problem = problem
        super().__init__(f"{field}: {problem}" if field else problem)

    def under(self, prefix: str) -> InputError:
        """The same complaint about a field that lies inside `prefix`."""
        if not self.field:
            return InputError(prefix, self.problem)
        joint = "" if self.field.startswith("[") else "."
        return InputError(f"{prefix}{joint}{self.field}", self.problem)


class TriboWarning(UserWarning):
    """A run stopped early or missed its accuracy; its result says so too."""


ANY: Condition = ("must be a number", lambda x: True)
POSITIVE: Condition = ("must be positive", lambda x: x > 0.0)
NOT_NEGATIVE: Condition = ("must not be negative", lambda x: x >= 0.0)

LARGEST = 1e100  # magnitude of a number: energies, cubes and ratios of two such are finite
MANY = 10_000_000  # asperites, or samples


def shown(value: Any) -> str:
    """What was given, on one line and not too long."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # a whole number of thousands of digits
        return "a number far too long"
    return text if len(text) <= 80 else text[:77] + "..."


def number(field: str, value: Any, condition: Condition = ANY) -> float:
    """One finite number that meets the condition."""
    if type(value) is float and condition is ANY and -LARGEST <= value <= LARGEST:
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise InputError(field, f"must be a number, got {shown(value)}")
    if isinstance(value, (float, np.floating)) and not math.isfinite(value):
        raise InputError(field, f"must be a finite number, got {value}")
    if not -LARGEST <= value <= LARGEST:
        raise InputError(field, f"must be at most {LARGEST:g} in magnitude, got {shown(value)}")
    if not condition[1](float(value)):
        raise InputError(field, f"{condition[0]}, got {value}")
    return float(value)


def number_or_each(field: str, value: Any, condition: Condition = ANY) -> float | np.ndarray:
    """One number for all asperites, or one for each, as a read-only array."""
    if type(value) is float:  # the commonest, and quickly told
        return number(field, value, condition)
    if not is_list(value):
        return number(field, value[()] if isinstance(value, np.ndarray) else value, condition)
    return vector(field, value, condition)


def vector(
    field: str, value: Any, condition: Condition = ANY, size: int | None = None
) -> np.ndarray:
    """A read-only array of finite numbers, of the given size if there is one."""
    if not is_list(value):
        wanted = f"{size} numbers" if size is not None else "a list of numbers"
        raise InputError(field, f"must be {wanted}, got {shown(value)}")
    if size is not None and len(value) != size:
        raise InputError(field, f"must be {size} numbers, got {len(value)}")
    if isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "if":
        array = value.astype(float)
    else:
        array = np.array([number(f"{field}[{i}]", item) for i, item in enumerate(value)])
    for k in np.flatnonzero(~(np.abs(array) <= LARGEST)):
        number(f"{field}[{k}]", array[k])
    if condition is not ANY:
        for i, item in enumerate(array.tolist()):
            if not condition[1](item):
                raise InputError(f"{field}[{i}]", f"{condition[0]}, got {item}")
    array.flags.writeable = False
    return array


def is_list(value: Any) -> bool:
    """Whether the value is a list, a tuple or an array of at least one axis."""
    if isinstance(value, (int, float)):
        return False
    if isinstance(value, np.ndarray):
        return value.ndim > 0
    return isinstance(value, Sequence) and not isinstance(value, (str, bytes))


def whole(field: str, value: Any, least: int, most: int | None = None) -> int:
    """A whole number of at least `least`, and at most `most` if there is one."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < least:
        raise InputError(field, f"must be a whole number of at least {least}, got {shown(value)}")
    if most is not None and value > most:
        raise InputError(field, f"must be a whole number of at most {most}, got {shown(value)}")
    return int(value)


def choice(field: str, value: Any, options: Iterable[str]) -> str:
    """One of the given words."""
    options = list(options)
    if not isinstance(value, str) or value not in options:
        words = " or ".join(f'"{o}"' for o in options)
        raise InputError(field, f"must be {words}, got {shown(value)}")
    return value


def flag(field: str, value: Any) -> bool:
    """True or false."""
    if not isinstance(value, (bool, np.bool_)):
        raise InputError(field, f"must be true or false, got {shown(value)}")
    return bool(value)


def known_keys(table: Any, allowed: Iterable[str], required: Iterable[str] = ()) -> dict[str, Any]:
    """A table with all of the required keys and none that is not allowed."""
    if not isinstance(table, Mapping):
        raise InputError("", f"must be a table, got {shown(table)}")
    allowed = list(allowed)
    for key in table:
        if key not in allowed:
            near = difflib.get_close_matches(str(key), allowed, n=1)
            hint = f'did you mean "{near[0]}"?' if near else f"known here: {', '.join(allowed)}"
            name = key if isinstance(key, str) and key.isprintable() else shown(key)
            raise InputError(name, f"is not a known key; {hint}")
    for key in required:
        if key not in table:
            raise InputError(key, "is missing")
    return dict(table)


def as_path(value: Any) -> Path:
    """A file's place."""
    if not isinstance(value, (str, os.PathLike)) or "\0" in os.fspath(value):
        raise InputError("path", f"must be the name of a file, got {shown(value)}")
    return Path(value)


def inside(prefix: str) -> AbstractContextManager[None]:
    """Complaints from within are about fields that lie inside `prefix`."""

    @contextmanager
    def relabel() -> Any:
        try:
            yield
        except InputError as error:
            raise error.under(prefix) from None

    return relabel()
