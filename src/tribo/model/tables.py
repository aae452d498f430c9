"""Dataclasses of scenes: equality by value, and tables of scene files."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any, TypeVar

import numpy as np

from tribo.model.schedule import Schedule
from tribo.validation import Check, InputError, as_parent, known_keys

Kind = TypeVar("Kind")
# Values that TOML has as they are.
SAME_IN_TOML = (float, str, bool, int)


class ComparedByValue:
    """A frozen dataclass that equals another of its class whose fields have the same values."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and _plain(self) == _plain(other)

    def __hash__(self) -> int:
        return hash(_plain(self))


def _plain(value: Any) -> Any:
    """The value with tuples in place of arrays, lists, tables and dataclasses."""
    if isinstance(value, np.ndarray):
        return value.shape, tuple(value.ravel().tolist())
    if is_dataclass(value):
        own = tuple(_plain(getattr(value, each.name)) for each in fields(value))
        return type(value), own
    if isinstance(value, dict):
        return tuple(sorted((key, _plain(item)) for key, item in value.items()))
    if isinstance(value, (tuple, list)):  # named tuples of two classes may have the same values
        kind = type(value) if hasattr(value, "_fields") else tuple
        return kind, tuple(_plain(item) for item in value)
    return value


def from_table(kind: type[Kind], value: object, required: Iterable[str] = ()) -> Kind:
    """A dataclass from its table in a scene file, or one that was made before."""
    if isinstance(value, kind):
        return as_parent(value, [kind])  # type: ignore[no-any-return]
    return kind(**known_keys(value, field_names(kind), required))


def part(read: Callable[[Any], object]) -> Check:
    """The check of a field that `read` makes from a table, a word, or another object."""

    def check(field: str, value: object) -> object:
        try:
            return read(value)
        except InputError as error:
            raise error.under(field) from None

    return check


def changed(item: Kind, values: Mapping[str, Any]) -> Kind:
    """A dataclass with other values.  Raises InputError for names that it does not have."""
    return replace(item, **known_keys(values, field_names(type(item))))  # type: ignore[type-var]


def table_of(item: Any) -> dict[str, Any]:
    """The fields of a dataclass that are not None, as values of TOML."""
    values = {name: getattr(item, name) for name in field_names(type(item))}
    return {
        name: value if type(value) in SAME_IN_TOML else _of_toml(value)
        for name, value in values.items()
        if value is not None
    }


def _of_toml(value: Any) -> Any:
    """A value as TOML has it: arrays and tuples as lists, schedules and dataclasses as tables."""
    if type(value) in SAME_IN_TOML:
        return value
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Schedule):
        return value.as_table()
    if isinstance(value, tuple) and not hasattr(value, "_fields"):
        return [_of_toml(item) for item in value]
    return table_of(value) if is_dataclass(value) else value


def _field_names(kind: Any) -> tuple[str, ...]:
    """The fields of a class of dataclasses, of which tables and keyword arguments have the keys."""
    return tuple(each.name for each in fields(kind))


field_names: Callable[[Any], tuple[str, ...]] = cache(_field_names)
