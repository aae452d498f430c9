"""The rows of a work-precision diagram: one run each, their reference, and the cheapest."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from tribo.integrators import methods


@dataclass(frozen=True)
class Row:
    """One run of one method.

    Attributes
    ----------
    method : str
        The method's name.
    setting : float
        The level of its tolerances, or its step [time].
    error : float
        The largest error of all observables, in units of their scales.
    force_evaluations : int
        Evaluations of all forces.
    seconds : float
        Time of the run.
    front : bool
        Whether no other run is both faster and more accurate.
    """

    method: str
    setting: float
    error: float
    force_evaluations: int
    seconds: float
    front: bool = False


@dataclass(frozen=True)
class Reference:
    """The run that others are compared with.

    Attributes
    ----------
    method : str
        The method's name.
    error : float
        An estimate of its own error, in units of the scales.
    seconds : float
        Time of the run.
    """

    method: str
    error: float
    seconds: float


@dataclass(frozen=True)
class Cheapest:
    """The cheapest run for an error, and what one digit more costs.

    Attributes
    ----------
    goal : float
        The largest error wanted, in units of the scales.
    row : Row or None
        The fastest run with at most that error; None if there is none.
    digit_more : float or None
        Evaluations by the same method for a tenth of the error, in units of those of `row`; None if
        it had no such run.
    automatic : str or None
        The method that tribo chooses for this accuracy; None if that is not known.
    automatic_row : Row or None
        The fastest run with at most that error by this method.
    """

    goal: float
    row: Row | None
    digit_more: float | None
    automatic: str | None
    automatic_row: Row | None

    def as_json(self) -> dict[str, object]:
        """An item of ``cheapest`` in the output of ``tribo accuracy --json``."""
        keys, chosen = ("method", "setting", "force_evaluations", "seconds"), self.automatic_row
        return {
            "error": self.goal,
            **{key: getattr(self.row, key, None) for key in keys},
            "digit_more": self.digit_more,
            "automatic_method": self.automatic,
            "automatic_seconds": None if chosen is None else chosen.seconds,
        }

    def __str__(self) -> str:
        if self.row is None:
            return f"error {self.goal:.0e}: no run reached it"
        row = self.row
        kind = "level" if methods.METHODS[row.method].adaptive else "step"
        return (
            f"error {self.goal:.0e}: {row.method} at {kind} {row.setting:.2g} is the cheapest, "
            f"{row.force_evaluations} evaluations, {row.seconds:.2g} s; {self._digit()}"
            f"{self._choice()}"
        )

    def _digit(self) -> str:
        if self.digit_more is None:
            return "one digit more was not reached"
        if self.digit_more == 1.0:
            return "one digit more is free"
        return f"one digit more takes {self.digit_more:.2f} times as many"

    def _choice(self) -> str:
        if self.automatic is None:
            return ""
        if self.row is not None and self.automatic == self.row.method:
            return "; tribo chooses it too"
        chosen = self.automatic_row
        seconds = "" if chosen is None else f", {chosen.seconds:.2g} s"
        return f"; tribo chooses {self.automatic}{seconds}"


def with_front(rows: list[Row], floor: float) -> Iterator[Row]:
    """The rows, with those marked that no other is at least as fast and as accurate as.

    Errors below `floor`, the reference's own, count as equal.
    """
    errors = [max(row.error, floor) for row in rows]
    for row, error in zip(rows, errors, strict=True):
        beaten = any(
            (other.seconds, theirs) != (row.seconds, error)
            and other.seconds <= row.seconds
            and theirs <= error
            for other, theirs in zip(rows, errors, strict=True)
        )
        yield replace(row, front=not beaten)
