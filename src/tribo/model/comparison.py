"""Equality by value for dataclasses whose fields may be arrays."""

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np


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
