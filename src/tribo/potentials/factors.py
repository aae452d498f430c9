"""Fields of which an energy is a multiple, found by a call of the energy with objects for numbers.

This serves functions whose source cannot be read, as those that were typed in or made by a program,
and those of several statements.
"""

from __future__ import annotations

from types import FunctionType
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin


class Multiple(NDArrayOperatorsMixin):
    """A number of which nothing is known but that it is zero where any of its `factors` is."""

    def __init__(self, factors: frozenset[str] = frozenset()) -> None:
        self.factors = factors

    def __array_ufunc__(self, function: Any, method: str, *given: Any, **options: Any) -> Multiple:
        """What a function of numbers returns; most functions of zero may be anything."""
        if method != "__call__" or options:
            raise TypeError
        first, *others = [getattr(each, "factors", frozenset()) for each in given]
        if function in (np.negative, np.positive, np.divide):
            return Multiple(first)
        if function is np.multiply:
            return Multiple(first.union(*others))
        if function in (np.add, np.subtract):
            return Multiple(first.intersection(*others))
        return Multiple()

    def __bool__(self) -> bool:
        """Comparisons have no answer."""
        raise TypeError


class Fields:
    """Stands for an instance: each of its attributes is a number."""

    def __getattr__(self, name: str) -> Multiple:
        return Multiple(frozenset((name,)))


def factors_by_call(energy: FunctionType) -> tuple[str, ...]:
    """The fields of which energy(self, r) is a multiple; none if that cannot be told."""
    try:
        return tuple(sorted(energy(Fields(), Multiple()).factors))
    except Exception:  # of the user's code, with other objects than it expects
        return ()
