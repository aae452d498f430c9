"""The data of a run: time series, the end, error estimates and cost."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any, TypeVar

import numpy as np

from tribo.kernels.status import MEANINGS, Status
from tribo.ledger.ledger import Ledger, Series
from tribo.ledger.quantity import Table
from tribo.loops.saved_state import State
from tribo.model.identity import Identity
from tribo.model.scene import Scene
from tribo.validation import InputError, must_be, number

T = TypeVar("T")


class _ErrorEstimates(dict[str, float | None]):
    """Bounds on errors by quantity, which also take the full name of a surface's quantity."""

    def __init__(self, bounds: Mapping[str, float | None], surfaces: Sequence[str]) -> None:
        super().__init__(bounds)
        self._surfaces = surfaces

    def __missing__(self, name: str) -> float | None:
        surface, _, quantity = name.rpartition(".")
        if surface not in self._surfaces or quantity not in self:
            raise KeyError(name)
        return self[quantity]

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self), self._surfaces)


def itself(value: T) -> T:
    """A value that is known already; a partial of it can be pickled."""
    return value


def stop_of(result: "RunResult") -> str:
    """When a run stopped before its end, and why; empty of one that completed."""
    if result.status == Status.COMPLETED:
        return ""
    return f"the run stopped at t = {result.t[-1]:g}, {result.status}"


def begin_of(result: "RunResult", after: object) -> float:
    """The time at which an average begins; that of None is the scene's ``output.run_in`` [time].

    Raises InputError for another value than a time of the run before its end.
    """
    if after is None:
        return result.scene.output.run_in
    begin = number("after", after, unit="time")
    end = float(result.t[-1])
    if begin >= end:
        problem = f"must be before the end of the run, t = {end:g}, got {begin:g}"
        raise InputError("after", "; ".join(filter(None, [problem, stop_of(result)])))
    return begin


def begin_or_auto(result: "RunResult", after: object) -> float | str:
    """As `begin_of`, also for "auto"."""
    if not isinstance(after, str):
        return begin_of(result, after)
    if after != "auto":
        raise must_be("after", 'a time or "auto"', after)
    return after


def of_all(result: "RunResult", name: str) -> np.ndarray:
    """(times, n) a series of all asperites.  Raises InputError where only its ends are kept."""
    series = [result[surface.name][name] for surface in result.scene.surfaces]
    if len(series[0]) != len(result.t):
        raise InputError("output.samples", "must be fewer, to keep the places of single asperites")
    return np.concatenate(series, axis=1)


@dataclass(frozen=True)
class Cost:
    """Steps, evaluations and times of a run.

    Attributes
    ----------
    steps : int
        Steps of the run that gave the result.
    force_evaluations : int
        Evaluations of all forces, in that run and in those that estimate its error.
    wall_seconds : float
        Time that these runs took [s].
    compile_seconds : float
        Time to compile the time loop, or to load it from disk [s].
    digit_more, digit_fewer : float or None
        Estimated times of a run with an accuracy ten times better or worse [s]; None if unknown.
    """

    steps: int
    force_evaluations: int
    wall_seconds: float
    compile_seconds: float
    digit_more: float | None = None
    digit_fewer: float | None = None


@dataclass(eq=False, kw_only=True)
class RunResult:
    """The result of a run.

    ``result["upper"].theta`` is an array (times, asperites) in the scene's units,
    ``result.system["applied_work"]`` one of (times,).

    Attributes
    ----------
    scene : Scene
        The scene that was run.
    t : ndarray, (times,)
        The recorded times [time].
    ledger : Ledger
        All series; assembled from the samples when first read.
    system : dict
        The series of the system: quantity -> (times,).
    end : dict
        The end state and the cost, as ``tribo run --json`` prints them.
    status : Status
        "completed", or the name of what stopped the run.
    method : str
        The integration method.
    why : str
        The reason for the method; empty if it was given.
    cost : Cost
        Steps, force evaluations and times.
    accuracy : float, dict or None
        The requested accuracy, or one for each observable by name; None where a method
        and a step were given.
    met : bool or None
        Whether every error estimate is within the accuracy; None without estimates.
    notes : tuple of str
        Further remarks and warnings, one sentence each.
    error_estimate : dict
        Quantity -> bound on its error over all surfaces, asperites and times; None if unknown.  It
        takes full names too, as "upper.w1".
    settings : dict
        Method, accuracy, step, and the hash of the state where the run began, if it began at one.
    version : str
        The version of tribo that ran it, with the hash of its sources.
    """

    scene: Scene
    status: Status
    method: str
    why: str
    accuracy: float | Mapping[str, float] | None
    met: bool | None
    notes: tuple[str, ...]
    bounds: Mapping[str, float] = field(repr=False)  # on errors, by name; empty without estimates
    assemble: Callable[[], Ledger] = field(repr=False)  # computes the ledger
    add_up: Callable[[], Cost] = field(repr=False)  # computes the cost
    take_state: Callable[[], State] = field(repr=False)  # computes the state at the end
    settings: Identity = field(repr=False)
    version: str
    # Not a cached_property, whose lock takes a part of the time of a short run.
    _ledger: Ledger | None = field(default=None, init=False, repr=False)

    @property
    def ledger(self) -> Ledger:
        """All series, each computed from the raw samples when it is first read."""
        if self._ledger is None:
            self._ledger = self.assemble()
        return self._ledger

    @cached_property
    def cost(self) -> Cost:
        """Steps, force evaluations and times."""
        return self.add_up()

    @property
    def t(self) -> np.ndarray:
        """The recorded times, (times,)."""
        return self.ledger.t

    @property
    def system(self) -> Table:
        """The series of the system: quantity -> (times,)."""
        return self.ledger.system

    @cached_property
    def error_estimate(self) -> dict[str, float | None]:
        """Quantity -> bound on its error over all surfaces, asperites and times, or None.

        "upper.w1" has a bound of its own where the accuracy asks for one, else that of "w1".
        """
        asked = self.accuracy if isinstance(self.accuracy, Mapping) else ()
        names = [surface.name for surface in self.scene.surfaces]
        bounds = dict.fromkeys([*self.ledger.names, *asked]) | dict(self.bounds)
        return _ErrorEstimates(bounds, names)

    def __getitem__(self, surface: str) -> Series:
        ledger = self.ledger
        try:
            return ledger.of(surface)
        except KeyError:
            names = ", ".join(ledger.surfaces)
            raise KeyError(f"there is no surface {surface!r}; there are {names}") from None

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled or copied: the ledger, the cost and the state, without the runs."""
        return {
            **self.__dict__,
            "assemble": partial(itself, self.ledger),
            "add_up": partial(itself, self.cost),
            "take_state": partial(itself, self.state()),
        }

    def oscillators(self, surface: str) -> np.ndarray:
        """The displacements of the bath oscillators of a surface from their bars.

        The scene's output must ask for the series "oscillators".  Torsional oscillators are not
        among them.

        Returns
        -------
        ndarray, (times, asperites, oscillators, 2)
            Along x and along y [length].

        Raises
        ------
        InputError
            There is no such surface, they were not recorded, or the surface has no such
            oscillators.
        """
        self.scene.index_of(surface)
        found = self.ledger.oscillators
        if surface not in found:
            if "oscillators" in self.scene.output.series:
                raise InputError(surface, "has no bath oscillators that move along x and y")
            raise InputError(
                "output.series", 'does not contain "oscillators"; add it, and run again'
            )
        return found[surface]

    def state(self) -> State:
        """The full state at the end, from which :func:`tribo.simulate` continues."""
        return self.take_state()

    @property
    def shortcoming(self) -> str:
        """The reason why the run missed its request, in one sentence; empty if it did not."""
        if stop := stop_of(self):
            return f"{stop}: {MEANINGS[self.status]}"
        return f"the accuracy is not met: {self.notes[-1]}" if self.met is False else ""
