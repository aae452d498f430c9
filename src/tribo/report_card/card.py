"""A report card: what was checked, how large the errors are, and whether they are acceptable."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tribo.accuracy.scales import EPSILON
from tribo.files import strict_json
from tribo.plotting.style import save
from tribo.report_card.figure import Curves, card_figure

_CONTINUOUS = "make {} there, or declare smoothness() (inside a range: smoothness_within()) = {}"
_AT_END = "let {} end at zero (as .with_cutoff does), correct range(), or declare smoothness() = {}"
# What to change where a check fails.
ADVICE = {
    "finite": "correct the energy there, or declare domain(), the distances for which it is valid",
    "force": "correct force() or energy(), or leave out force(): it follows from energy()",
    "minimum": "correct minimum(), which returns r, U and d2U/dr2, or energy()",
    "jumps of energy": _CONTINUOUS.format("the energy continuous", -1),
    "jumps of force": _CONTINUOUS.format("the force continuous", 0),
    "kinks of force": _CONTINUOUS.format("the slope of the force continuous", 1),
    "energy at the cutoff": _AT_END.format("the energy", -1),
    "force at the cutoff": _AT_END.format("the force", 0),
    "slope at the cutoff": _AT_END.format("the slope of the force", 1),
    "points": "correct this point, or add points around it if U is so narrow there",
    "limits": "let force() vanish where the energy is constant, or declare domain()",
    "third law": "make coupling(one, other) symmetric in the two bobs",
    "charges": "correct energy_between() and force_between(), or acts_between()",
    "arrays": "compute each value from its own r: np.maximum instead of np.max",
    "compiled": "avoid what Python and numba compute differently, as globals that change; "
    "tribo doctor names the folder of compiled code, which can be removed",
    "ase": "compare the parameters and their units, eV and Angstrom, or the calculator's cutoff",
}


@dataclass(frozen=True)
class Check:
    """One line of a report card."""

    name: str
    compared: str  # the quantities that were compared
    value: float  # the error: relative, or a number of distances
    bound: float | None  # largest acceptable error; None where the potential promises nothing
    where: float | None = None  # distance at which the error is largest [length]
    note: str = ""  # an explanation, as of a failure for another reason than the error
    failed: bool = False  # whether the check failed for a reason that `note` gives
    remedy: str = ""  # what to change if it failed; empty for the usual advice

    @classmethod
    def of_worst(
        cls, name: str, compared: str, errors: np.ndarray, bound: float | None, r: np.ndarray
    ) -> Check:
        """The line of the largest error among those at distances `r`."""
        worst = int(np.argmax(errors))
        return cls(name, compared, float(errors[worst]), bound, float(r[worst]))

    @property
    def passed(self) -> bool:
        """Whether the error is within its bound; nan never is."""
        return not self.failed and (self.bound is None or self.value <= self.bound)

    @property
    def advice(self) -> str:
        """What to change if the check failed; empty if it passed."""
        return "" if self.passed else self.remedy or ADVICE[self.name]

    @property
    def grade(self) -> float | None:
        """Decimal digits lost, log10(error / machine epsilon); None if the error is not finite."""
        if not math.isfinite(self.value):
            return None
        return round(max(0.0, math.log10(max(self.value, EPSILON) / EPSILON)), 1)

    @property
    def table(self) -> dict[str, object]:
        """The line as ``tribo check --json`` prints it."""
        return {
            "name": self.name,
            "passed": self.passed,
            "value": self.value,
            "bound": self.bound,
            "grade": self.grade,
            "where": self.where,
            "looked_at": self.compared,
            "says": self.note,
            "advice": self.advice,
        }


@dataclass(frozen=True, eq=False)
class Report:
    """The report card of a potential; ``report["force"]`` is one of its checks."""

    potential: str  # its name and parameters
    title: str  # the same without the file or module of a user's class, for the figure
    checks: tuple[Check, ...]
    curves: Curves  # energy, force and their disagreement, for the figure

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)

    def __getitem__(self, name: str) -> Check:
        checks = {check.name: check for check in self.checks}
        if name not in checks:
            raise KeyError(f"must be one of {', '.join(checks)}, got {name!r}")
        return checks[name]

    def to_json(self) -> str:
        """The card as one JSON object, as ``tribo check --json`` prints it; no number is inf."""
        checks = [check.table for check in self.checks]
        return strict_json({"potential": self.potential, "passed": self.passed, "checks": checks})

    def save_figure(self, path: str | Path) -> Path:
        """Draw energy, force, their disagreement and the cutoff; as :func:`tribo.plotting.save`.

        A red line marks the largest error of each check that failed.
        """
        failed = {
            check.name: check.where
            for check in self.checks
            if not check.passed and check.where is not None
        }
        return save(card_figure(self.curves, self.title, failed), path)

    def __str__(self) -> str:
        """The checks as a table, with advice below those that failed, and the verdict."""
        r = self.curves.r
        width = max(len(check.name) for check in self.checks)
        lines = [f"{self.potential}, from r = {r[0]:.3g} to {r[-1]:.3g}", ""]
        lines.append(f"  {'check':{width}}    error    bound  grade")
        for check in self.checks:
            bound = "none" if check.bound is None else f"{check.bound:.1e}"
            grade = "-" if check.grade is None else f"{check.grade:.1f}"
            numbers = f"  {check.name:{width}}  {check.value:7.1e}  {bound:>7}  {grade:>5}  "
            numbers += "passed  " if check.passed else "FAILED  "
            lines.append(numbers + check.compared)
            margin = " " * len(numbers)
            if not check.passed and check.where is not None:
                lines.append(f"{margin}worst at r = {check.where:.9g}")
            if check.note:
                lines.append(f"{margin}{check.note}")
            if check.advice:
                lines.append(f"{margin}to mend it: {check.advice}")
        failed = ", ".join(check.name for check in self.checks if not check.passed)
        noted = [check.name for check in self.checks if check.bound is None and check.note]
        passed = f"passed: all {len(self.checks)} checks"
        passed += f"; without a bound, see the note: {', '.join(noted)}" if noted else ""
        verdict = f"FAILED: {failed}" if failed else passed
        return "\n".join([*lines, "", verdict])
