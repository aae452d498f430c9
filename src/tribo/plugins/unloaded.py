"""Plug-ins whose code is not loaded: in results that are only opened, and where code is refused."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from enum import Enum
from pathlib import Path
from typing import Any

from tribo.validation import InputError


class Code(Enum):
    """What becomes of code that a scene file names."""

    LOAD = "it is loaded"
    LEAVE = "it is left where it is, and an Unloaded stands for it"
    REFUSE = "it is refused"


_POLICY: ContextVar[Code] = ContextVar("code", default=Code.LOAD)


class Unloaded:
    """A plug-in of a scene that was opened without loading its code; running the scene loads it.

    `name` is ``file.py:Class``, ``package.module:Class``, or a potential that is made of such;
    `parameters` are the other keys of its table in a scene file.  `stamp` is the hash of its
    sources when they last ran, None if unknown; `folder` is that of the result.
    """

    def __init__(self, name: str, parameters: dict[str, Any]) -> None:
        self.name = name
        self.parameters = parameters
        self.stamp: str | None = None
        self.folder = Path()

    def _asdict(self) -> dict[str, Any]:
        return self.parameters

    def range(self) -> float:
        return float(self.parameters.get("cutoff", math.inf))

    def smoothness(self) -> float:
        """Unknown, and assumed infinite."""
        return math.inf


@contextmanager
def code(policy: Code) -> Iterator[None]:
    """Decide what becomes of code that scene files name."""
    token = _POLICY.set(policy)
    try:
        yield
    finally:
        _POLICY.reset(token)


def left(name: str, parameters: dict[str, Any]) -> Unloaded | None:
    """What stands for a plug-in or a potential made of some; None where code is loaded."""
    leaves = _POLICY.get() is Code.LEAVE and names_code([name, parameters])
    return Unloaded(name, parameters) if leaves else None


def names_code(value: object) -> bool:
    """Whether any text in a table names a class in a file or a module."""
    if isinstance(value, dict):
        return any(map(names_code, value.values()))
    if isinstance(value, list):
        return any(map(names_code, value))
    return isinstance(value, str) and ":" in value


def refuse_code(field: str, name: str) -> None:
    """Raise InputError where code is refused."""
    if _POLICY.get() is Code.REFUSE:
        raise InputError(field, f"names code, {name}, which --no-plugins refuses")
