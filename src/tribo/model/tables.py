"""Dataclasses as tables of scene files, and back."""

from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from tribo.validation import known_keys

Kind = TypeVar("Kind")


def from_table(kind: type[Kind], value: object, required: Iterable[str] = ()) -> Kind:
    """A dataclass from its table in a scene file, or one that was made before."""
    if isinstance(value, kind):
        return value
    return kind(**known_keys(value, _names(kind), required))


def changed(item: Kind, values: Mapping[str, Any]) -> Kind:
    """A dataclass with other values.  Raises InputError for names that it does not have."""
    return replace(item, **known_keys(values, _names(item)))  # type: ignore[type-var]


def table_of(item: Any) -> dict[str, Any]:
    """The fields of a dataclass that are not None, as values of TOML."""
    table = {}
    for name in _names(item):
        value = getattr(item, name)
        if isinstance(value, np.ndarray):
            value = value.tolist()
        elif isinstance(value, tuple):
            value = [list(item) if isinstance(item, tuple) else item for item in value]
        if value is not None:
            table[name] = value
    return table


def _names(kind: Any) -> list[str]:
    return [each.name for each in fields(kind)]
