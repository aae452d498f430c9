"""The card itself: what was checked, how large the error is, and whether that will do."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.run.result import without_nan

EPSILON = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Check:
    """One line of the card."""

    name: str
    looked_at: str  # what was compared with what
    value: float  # the error found: relative, but for a count of distances
    bound: float | None  # the largest that will do; None where nothing is promised
    where: float | None = None  # the distance at which the error is largest [length]
    says: str = ""  # what else is to be known of it
    failed: bool = False  # for a reason other than the value, which `says` gives

    @property
    def passed(self) -> bool:
        """Whether the value is within its bound; what is not a number never is."""
        return not self.failed and (self.bound is None or self.value <= self.bound)

    @property
    def grade(self) -> float | None:
        """log10(error / machine epsilon): decimal digits lost; None for what is no number."""
        if not math.isfinite(self.value):
            return None
        return round(max(0.0, math.log10(max(self.value, EPSILON) / EPSILON)), 1)

    @property
    def table(self) -> dict[str, Any]:
        """The line as ``tribo check --json`` prints it."""
        return {
            "name": self.name,
            "passed": self.passed,
            "value": self.value,
            "bound": self.bound,
            "grade": self.grade,
            "where": self.where,
            "looked_at": self.looked_at,
            "says": self.says,
        }


@dataclass(frozen=True, eq=False)
class Curves:
    """What the figure shows: everything at the distances r, (n,)."""

    r: np.ndarray  # [length]
    energy: np.ndarray  # [energy]
    force: np.ndarray  # [energy / length]
    disagreement: np.ndarray  # of force and -dU/dr, relative to the scale around
    uncertainty: np.ndarray  # of -dU/dr by differences, relative to the same
    bound: float  # of the disagreement
    cutoff: float  # infinite where there is none [length]
    length: float  # of the minimum, or another distance that is typical


@dataclass(frozen=True, eq=False)
class Report:
    """A potential's report card."""

    potential: str  # its name and parameters
    checks: tuple[Check, ...]
    curves: Curves

    @property
    def passed(self) -> bool:
        """Whether all checks passed."""
        return all(check.passed for check in self.checks)

    def __getitem__(self, name: str) -> Check:
        for check in self.checks:
            if check.name == name:
                return check
        names = ", ".join(check.name for check in self.checks)
        raise KeyError(f"there is no check {name!r}; there are {names}")

    def to_json(self) -> str:
        """The card as strict JSON: what is not a number is null."""
        table = {
            "potential": self.potential,
            "passed": self.passed,
            "checks": [check.table for check in self.checks],
        }
        return json.dumps(without_nan(table), indent=1, allow_nan=False)

    def save_figure(self, path: Any) -> None:
        """Draw energy, force, their disagreement and the cutoff into a PNG, PDF or SVG file."""
        from tribo.report_card.figure import save

        save(self, path)

    def __str__(self) -> str:
        r = self.curves.r
        width = max(len(check.name) for check in self.checks)
        lines = [f"{self.potential}, from r = {r[0]:.3g} to {r[-1]:.3g}", ""]
        lines.append(f"  {'check':{width}}    error    bound  grade")
        for check in self.checks:
            bound = "none" if check.bound is None else f"{check.bound:.1e}"
            grade = "-" if check.grade is None else f"{check.grade:.1f}"
            verdict = "passed" if check.passed else "FAILED"
            numbers = f"  {check.name:{width}}  {check.value:7.1e}  {bound:>7}  {grade:>5}  "
            lines.append(f"{numbers}{verdict}  {check.looked_at}")
            margin = " " * len(f"{numbers}{verdict}  ")
            if not check.passed and check.where is not None:
                lines.append(f"{margin}worst at r = {check.where:.9g}")
            if check.says:
                lines.append(f"{margin}{check.says}")
        return "\n".join([*lines, "", self._verdict()])

    def _verdict(self) -> str:
        failed = [check.name for check in self.checks if not check.passed]
        if failed:
            return f"FAILED: {', '.join(failed)}"
        return f"passed: all {len(self.checks)} checks"
