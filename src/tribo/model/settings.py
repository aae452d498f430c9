"""Settings that a scene file may hold beside the physics: times to record, accuracy and method."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tribo import validation as check
from tribo.validation import InputError, inside, is_list, must_be

# The smallest accuracy: round-off grows to about this in a run.
FINEST = 1e-13
# The largest accuracy: above it an error estimate means little.
COARSEST = 0.1
# Of what the works and pseudoworks are kept.
LEDGERS = ("asperites", "surfaces", "none")
# Groups of further series that are reported on request.
SERIES = ("forces", "energies", "contacts", "own", "oscillators")


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
        Further series: "forces" on every asperite, "energies" of every kind, numbers of "contacts",
        "own" for those of :class:`tribo.Quantity`, and displacements of all bath "oscillators".
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
        run_in = check.one(check.NOT_NEGATIVE, "time")
        check.fields(self, run_in=run_in, series=_series, keep=names_of_quantities, times=_times)
        if self.keep is not None and "oscillators" in self.series:
            raise InputError("series", '"oscillators" cannot go with keep, which omits them')
        check.integer("samples", self.samples, 2, check.LARGEST_COUNT)
        check.choice("ledger", self.ledger, LEDGERS)


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
        check.boolean("allow_unresolved", self.allow_unresolved)
        check.fields(self, max_evaluations=check.one(check.POSITIVE), accuracy=check_accuracy)
        if self.method is not None and (not isinstance(self.method, str) or not self.method):
            raise must_be("method", "the name of a method", self.method)
        check.fields(self, step=check.one(check.POSITIVE, "time"))
        if self.step is not None and self.accuracy is not None:
            raise InputError("accuracy", "cannot go with a step; give one or the other")


def _series(field: str, value: object) -> tuple[str, ...]:
    """A list of groups of series, each once."""
    if not is_list(value):
        raise must_be(field, f"a list of words, as {json.dumps(SERIES)}", value)
    given = [check.choice(f"{field}[{i}]", word, SERIES) for i, word in enumerate(value)]
    return tuple(word for word in SERIES if word in given)


def names_of_quantities(field: str, value: object) -> tuple[str, ...]:
    """The names of quantities that are kept, each once."""
    if not is_list(value) or len(value) == 0:
        raise must_be(field, 'a list of quantities, as ["upper.W", "upper.x_cm"]', value)
    for i, name in enumerate(value):
        if not isinstance(name, str):
            raise must_be(f"{field}[{i}]", 'the name of a quantity, as "upper.W"', name)
    return tuple(dict.fromkeys(value))


def _times(field: str, value: object) -> tuple[float, ...]:
    times = check.vector(field, value, unit="time")
    if times.size == 0 or np.any(np.diff(times) <= 0.0) or times[0] < 0.0:
        raise must_be(field, "increasing, from 0 or later [time]", value)
    return tuple(times.tolist())


def check_accuracy(field: str, value: object) -> float | dict[str, float]:
    """An accuracy within the range that is possible, or one for each observable."""
    if not isinstance(value, Mapping):
        return _accuracy(field, value)
    if not value:
        raise must_be(field, "a number, or a table of at least one observable", value)
    with inside(field):
        return {str(name): _accuracy(str(name), item) for name, item in value.items()}


def _accuracy(field: str, value: object) -> float:
    accuracy = check.number(field, value, check.POSITIVE)
    if not FINEST <= accuracy <= COARSEST:
        raise must_be(field, f"from {FINEST:g} to {COARSEST:g}", value)
    return accuracy
