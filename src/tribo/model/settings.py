"""Settings that a scene file may hold beside the physics: times to record, accuracy and method."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tribo.validation import (
    LARGEST_COUNT,
    NOT_NEGATIVE,
    POSITIVE,
    InputError,
    boolean,
    choice,
    inside,
    integer,
    is_list,
    must_be,
    number,
    vector,
)

# Range of accuracies.  Round-off grows to about the first in a run; above the second an error
# estimate means little.
FINEST, COARSEST = 1e-13, 0.1
# Of what the works and pseudoworks are kept.
LEDGERS = ("asperites", "surfaces", "none")
# Groups of further series that are reported on request.
SERIES = ("forces", "energies", "oscillators")


@dataclass(frozen=True)
class Output:
    """The times and quantities that a run records.

    Attributes
    ----------
    samples : int
        Number of evenly spaced samples, at least 2.
    times : list of float, optional
        Increasing times instead of `samples` [time]; start and end of the run are always added.
    ledger : str
        "asperites" keeps works and pseudoworks of each asperite, "surfaces" their sums over each
        surface, and "none" none of them. A run does not compute works that it does not keep.
    series : tuple of str
        Further series: "forces" on every asperite, "energies" of every kind, and displacements of
        all bath "oscillators".
    keep : tuple of str, optional
        The only quantities to record, as "upper.W" or "contact_energy"; None for all.
    run_in : float
        Time at which averages over time begin, such as that of the friction force [time].

    Raises
    ------
    InputError
        If `samples` is too small or too large, `times` do not increase, `ledger` or `series` are
        none of these words, `keep` is no list of names, or `run_in` is negative.
    """

    samples: int = 401
    times: Sequence[float] | None = None
    ledger: str = "asperites"
    series: tuple[str, ...] = ()
    keep: Sequence[str] | None = None
    run_in: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "run_in", number("run_in", self.run_in, NOT_NEGATIVE, "time"))
        object.__setattr__(self, "series", _words("series", self.series, SERIES))
        if self.keep is not None:
            object.__setattr__(self, "keep", _names(self.keep))
            if "oscillators" in self.series:
                raise InputError("series", '"oscillators" cannot go with keep, which omits them')
        integer("samples", self.samples, 2, LARGEST_COUNT)
        choice("ledger", self.ledger, LEDGERS)
        if self.times is not None:
            times = vector("times", self.times, unit="time")
            if times.size == 0 or np.any(np.diff(times) <= 0.0) or times[0] < 0.0:
                raise must_be("times", "increasing, from 0 or later [time]", self.times)
            object.__setattr__(self, "times", tuple(times.tolist()))


@dataclass(frozen=True)
class Numerics:
    """The numerical settings of a scene file; arguments of :func:`tribo.simulate` override them.

    Attributes
    ----------
    accuracy : float or dict, optional
        Largest relative error of every quantity, from 1e-13 to 0.1; or one for each observable,
        as ``{"upper.W": 1e-3}``.
    method : str, optional
        Name of a method.
    step : float, optional
        Length of equal steps [time], instead of `accuracy`.
    allow_unresolved : bool
        Whether a step of a splitting method may be too long to resolve the fastest pendulum or
        spring.
    max_evaluations : float, optional
        Evaluations of all forces that a run with an accuracy may take before it stops as
        `NoProgress`; by default 2e8 over the number of asperites, and at least 1e7.

    Raises
    ------
    InputError
        If a value is out of range, or both `accuracy` and `step` are given.
    """

    accuracy: float | dict[str, float] | None = None
    method: str | None = None
    step: float | None = None
    allow_unresolved: bool = False
    max_evaluations: float | None = None

    def __post_init__(self) -> None:
        boolean("allow_unresolved", self.allow_unresolved)
        if self.max_evaluations is not None:
            number("max_evaluations", self.max_evaluations, POSITIVE)
        if self.accuracy is not None:
            object.__setattr__(self, "accuracy", check_accuracy(self.accuracy))
        if self.method is not None and (not isinstance(self.method, str) or not self.method):
            raise must_be("method", "the name of a method", self.method)
        if self.step is not None:
            number("step", self.step, POSITIVE, "time")
            if self.accuracy is not None:
                raise InputError("accuracy", "cannot go with a step; give one or the other")


def _words(field: str, value: object, words: Sequence[str]) -> tuple[str, ...]:
    """A list of words, each once."""
    if not is_list(value):
        raise must_be(field, f"a list of words, as {json.dumps(words)}", value)
    given = [choice(f"{field}[{i}]", word, words) for i, word in enumerate(value)]
    return tuple(word for word in words if word in given)


def _names(value: object) -> tuple[str, ...]:
    """The names of quantities that are kept, each once."""
    if not is_list(value) or len(value) == 0:
        raise must_be("keep", 'a list of quantities, as ["upper.W", "upper.x_cm"]', value)
    for i, name in enumerate(value):
        if not isinstance(name, str):
            raise must_be(f"keep[{i}]", 'the name of a quantity, as "upper.W"', name)
    return tuple(dict.fromkeys(value))


def check_accuracy(value: object) -> float | dict[str, float]:
    """An accuracy within the range that is possible, or one for each observable."""
    if isinstance(value, Mapping):
        if not value:
            raise must_be("accuracy", "a number, or a table of at least one observable", value)
        with inside("accuracy"):
            return {str(name): _accuracy(str(name), item) for name, item in value.items()}
    return _accuracy("accuracy", value)


def _accuracy(field: str, value: object) -> float:
    accuracy = number(field, value, POSITIVE)
    if not FINEST <= accuracy <= COARSEST:
        raise must_be(field, f"from {FINEST:g} to {COARSEST:g}", value)
    return accuracy
