"""The runs of several methods on a scene: a table, what an accuracy costs, and a figure."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from tribo.kernels.status import Status
from tribo.work_precision import figure
from tribo.work_precision.rows import Cheapest, Reference, Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Errors for which the cheapest run is named, in units of the scales.
GOALS = (1e-3, 1e-6, 1e-9, 1e-12)
# The cost on the horizontal axis of a diagram.
CostName = Literal["seconds", "force_evaluations"]


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
    automatic : mapping
        Accuracy -> the method that tribo chooses for it.
    status : Status
        "completed", or "Interrupted" where an interrupt left out runs.
    """

    rows: tuple[Row, ...]
    reference: Reference
    compile_seconds: dict[str, float]
    automatic: Mapping[float, str] = field(default_factory=dict)
    status: Status = Status.COMPLETED

    def to_json(self) -> str:
        """All runs as one JSON object, as ``tribo accuracy --json`` prints them."""
        table = {
            "rows": [asdict(row) for row in self.rows],
            "reference": asdict(self.reference),
            "compile_seconds": self.compile_seconds,
            "cheapest": [self.cheapest(goal).as_json() for goal in GOALS],
            "status": self.status,
        }
        return json.dumps(table, indent=1)

    def cheapest(self, goal: float) -> Cheapest:
        """The cheapest run for an error, relative to the scales, and what one digit more costs."""
        row, digit_more = self.best(goal), None
        if row is not None:
            finer = self.best(0.1 * goal, row.method)
            if finer is not None:
                digit_more = max(1.0, finer.force_evaluations / row.force_evaluations)
        chosen = self.automatic.get(goal)
        of_chosen = None if chosen is None else self.best(goal, chosen)
        return Cheapest(goal, row, digit_more, chosen, of_chosen)

    @property
    def automatic_rows(self) -> list[Row]:
        """For each goal, the fastest run that reached it by the method that tribo chooses."""
        rows = [self.cheapest(goal).automatic_row for goal in GOALS]
        return [row for row in dict.fromkeys(rows) if row is not None]

    def best(self, error: float, method: str | None = None) -> Row | None:
        """The fastest run with at most that error [scales], by one method if named; else None."""
        good = [row for row in self.rows if row.error <= error and method in (None, row.method)]
        return min(good, key=lambda row: row.seconds, default=None)

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
        lines.append(
            f"errors are against {self.reference.method}, whose own error is about "
            f"{self.reference.error:.1e}; compiling took {sum(self.compile_seconds.values()):.1f} s"
        )
        lines += [str(self.cheapest(goal)) for goal in GOALS]
        if self.status != Status.COMPLETED:
            lines.append(f"{self.status}: the runs up to there")
        return "\n".join(lines)

    def plot(self, cost: CostName = "seconds", ax: Axes | None = None) -> Axes:
        """Draw error against cost, on new axes if none are given."""
        return figure.draw(self.rows, self.reference, self.automatic_rows, cost, ax)

    def save_figure(self, path: str | Path) -> Path:
        """Draw error against time and against evaluations into a .png, .pdf or .svg file."""
        return figure.save(self.rows, self.reference, self.automatic_rows, path)
