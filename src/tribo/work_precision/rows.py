"""Runs of several methods with their errors and costs, and what follows from them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from tribo.integrators.methods import METHODS
from tribo.kernels.status import Status

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Accuracies for which the cheapest run is named.
ACCURACIES = (1e-3, 1e-6, 1e-9, 1e-12)

# The cost on the horizontal axis of a diagram.
CostName = Literal["seconds", "force_evaluations"]


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
    """The fastest of all runs that keep an accuracy, and what one digit more costs.

    Attributes
    ----------
    accuracy : float
        The largest error allowed, in units of the scales.
    method : str or None
        The method's name; None if no run keeps the accuracy.
    setting : float or None
        The level of its tolerances, or its step [time].
    force_evaluations : int or None
        Evaluations of all forces.
    seconds : float or None
        Time of the run.
    digit_more : float or None
        Time of the fastest run that is ten times as accurate, in units of `seconds`; None if there
        is none.
    """

    accuracy: float
    method: str | None = None
    setting: float | None = None
    force_evaluations: int | None = None
    seconds: float | None = None
    digit_more: float | None = None


@dataclass(frozen=True)
class Automatic:
    """The run that tribo chooses by itself.

    Attributes
    ----------
    accuracy : float
        The accuracy that is asked for: that of the scene, or 1e-8.
    method : str
        The method that is chosen.
    error : float
        The error of the run, in units of the scales.
    force_evaluations : int
        Evaluations of all forces.
    seconds : float
        Time of the run.
    """

    accuracy: float
    method: str
    error: float
    force_evaluations: int
    seconds: float


@dataclass(frozen=True)
class WorkPrecision:
    """Runs of several methods, and their errors; ``print`` shows a table.

    Attributes
    ----------
    rows : tuple of Row
        All runs, method by method, from coarse to fine.
    reference : Reference
        The run that they are compared with.
    compile_seconds : dict
        Method -> time to compile it, which is not in the time of its runs.
    automatic : Automatic or None
        The run that tribo chooses; None if it was not made.
    status : str
        "completed", or "Interrupted" if rows are missing.
    """

    rows: tuple[Row, ...]
    reference: Reference
    compile_seconds: dict[str, float]
    automatic: Automatic | None = None
    status: str = str(Status.COMPLETED)

    def to_json(self) -> str:
        """JSON as ``tribo accuracy --json`` prints it."""
        table = asdict(self) | {"cheapest": [asdict(each) for each in self.cheapest]}
        return json.dumps(table, indent=1)

    def best(self, error: float) -> Row | None:
        """The fastest run with at most that error, in units of the scales; None if there is none.

        Parameters
        ----------
        error : float
            Relative to the scales.

        Returns
        -------
        Row or None
        """
        good = [row for row in self.rows if row.error <= error]
        return min(good, key=lambda row: row.seconds, default=None)

    @property
    def cheapest(self) -> list[Cheapest]:
        """The fastest runs that keep 1e-3, 1e-6, 1e-9 and 1e-12, and the costs of a digit more."""
        return [self._cheapest(accuracy) for accuracy in ACCURACIES]

    def _cheapest(self, accuracy: float) -> Cheapest:
        row = self._known_best(accuracy)
        if row is None:
            return Cheapest(accuracy)
        finer = self._known_best(0.1 * accuracy)
        ratio = None if finer is None else finer.seconds / row.seconds
        evaluations = row.force_evaluations
        return Cheapest(accuracy, row.method, row.setting, evaluations, row.seconds, ratio)

    def _known_best(self, accuracy: float) -> Row | None:
        """The fastest run that keeps an accuracy, if the reference can tell."""
        return self.best(accuracy) if self.reference.error <= accuracy else None

    def __str__(self) -> str:
        lines = [
            f"{'method':>15} {'setting':>9} {'error':>9} {'evaluations':>12} "
            f"{'seconds':>10}   front"
        ]
        for row in self.rows:
            lines.append(
                f"{row.method:>15} {row.setting:9.2e} {row.error:9.1e} "
                f"{row.force_evaluations:12d} {row.seconds:10.2e}   {'*' if row.front else ''}"
            )
        compiling = sum(self.compile_seconds.values())
        lines += [
            f"errors are against {self.reference.method}, whose own error is about "
            f"{self.reference.error:.1e}; compiling took {compiling:.1f} s",
            "",
            *(self._in_words(each) for each in self.cheapest),
        ]
        if self.automatic is not None:
            own = self.automatic
            lines.append(
                f"Asked for {_short(own.accuracy)}, tribo takes {own.method}: error "
                f"{own.error:.1e}, {own.force_evaluations} evaluations, {own.seconds:.2g} s."
            )
        if self.status != Status.COMPLETED:
            lines.append("Interrupted: these are the runs that were finished.")
        return "\n".join(lines)

    def _in_words(self, each: Cheapest) -> str:
        """The cheapest run for an accuracy, and the cost of one digit more, in a sentence."""
        asked = f"For {_short(each.accuracy)}"
        if each.method is None:
            if self.reference.error > each.accuracy:
                return f"{asked}: not known, as the reference is less accurate."
            return f"{asked}: no run was accurate enough in the time given."
        what = "level" if METHODS[each.method].adaptive else "step"
        more = "one digit more was not reached"
        if each.digit_more is not None:
            more = f"one digit more takes {each.digit_more:.1f} times as long"
        return (
            f"{asked} the cheapest is {each.method} at the {what} {each.setting:.2g}: "
            f"{each.force_evaluations} evaluations, {each.seconds:.2g} s; {more}."
        )

    def plot(self, cost: CostName = "seconds", ax: Axes | None = None) -> Axes:
        """Draw error against cost.

        Parameters
        ----------
        cost : {"seconds", "force_evaluations"}
            The horizontal axis.
        ax : matplotlib.axes.Axes, optional
            Where to draw; a new figure without it.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from tribo.work_precision.figure import plot

        return plot(self, cost, ax)

    def save_figure(self, path: str | Path) -> Path:
        """Draw error against time and against evaluations.

        Parameters
        ----------
        path : str or Path
            A .png, .pdf or .svg file.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        from tribo.work_precision.figure import save

        return save(self, path)


def _short(accuracy: float) -> str:
    """An accuracy as 1e-3."""
    return f"{accuracy:.0e}".replace("e-0", "e-")


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
