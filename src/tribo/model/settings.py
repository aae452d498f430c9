"""Settings that travel with a scene and are not its physics: what to record, and how to compute."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.validation import MANY, POSITIVE, InputError, inside, number, shown, vector, whole


@dataclass(frozen=True)
class Output:
    """When to record: evenly spaced samples, both ends included, or given times."""

    samples: int = 401
    times: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        whole("samples", self.samples, 2, MANY)
        if self.times is not None:
            times = vector("times", self.times)
            if times.size == 0 or np.any(np.diff(times) <= 0.0) or times[0] < 0.0:
                raise InputError("times", "must increase from 0 or later")
            object.__setattr__(self, "times", tuple(times.tolist()))


@dataclass(frozen=True)
class Numerics:
    """How to compute, as a file may say it; :func:`tribo.simulate` has the last word."""

    accuracy: float | dict[str, float] | None = None  # of everything, or of observables by name
    method: str | None = None
    step: float | None = None

    def __post_init__(self) -> None:
        if self.accuracy is not None:
            object.__setattr__(self, "accuracy", check_accuracy(self.accuracy))
        if self.method is not None and (not isinstance(self.method, str) or not self.method):
            raise InputError("method", f"must be a method's name, got {shown(self.method)}")
        if self.step is not None:
            number("step", self.step, POSITIVE)
            if self.accuracy is not None:
                raise InputError("accuracy", "cannot go with a step; give one or the other")


def check_accuracy(value: Any) -> float | dict[str, float]:
    """An accuracy that double precision can hold out, or one for each observable."""
    if isinstance(value, Mapping):
        if not value:
            raise InputError("accuracy", "must be a number, or name at least one observable")
        with inside("accuracy"):
            return {str(name): _accuracy(str(name), item) for name, item in value.items()}
    return _accuracy("accuracy", value)


def _accuracy(field: str, value: Any) -> float:
    accuracy = number(field, value, POSITIVE)
    if not 1e-13 <= accuracy <= 0.1:
        raise InputError(field, f"must be from 1e-13 to 0.1, got {value}")
    return accuracy
