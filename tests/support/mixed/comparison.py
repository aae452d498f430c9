"""Comparison of runs with the second solution, and the findings of a scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import tribo
from support.mixed import solver
from support.mixed.solver import SYSTEM, CostlyError, Start

# The worst one that occurs is the verdict on a scene.
VERDICTS = ("right", "noted", "refused", "stopped", "slow", "silent", "crash")
# Accuracy of the runs, and what the second solution may be wrong by, relative to the largest value.
ACCURACY = 1e-5
UNSURE = 1e-5
ROUNDING = 1e-8
# Quantities that the second solution has, by where a run has them.
ASPERITES = (
    *("theta", "omega", "phi", "nu", "x_cm", "y_cm", "vx_cm", "vy_cm", "x_bob", "y_bob"),
    *("w1", "w2", "wL", "wR", "w_int", "w_field", "w_T", "heat", "w", "w_ps", "w1_ps", "w2_ps"),
    *("w_field_ps", "w_T_ps", "delta_k_trans", "delta_e_int"),
)
BLOCKS = ("W", "W_ps", "delta_K", "delta_E_int")
WHOLE = ("contact_energy", "total_energy_change", "applied_work")
FORCES = tuple(
    f"{name}_{axis}" for name in ("f1", "f2", "f_field", "f_within", "f_T") for axis in "xy"
)
# Largest difference of a recorded force, relative to the largest one.
FORCE = 1e-3


@dataclass
class Findings:
    """What a scene showed.

    Attributes
    ----------
    seed : int
    kind : str
        The structure.
    checks : list of str
        What was compared.
    found : list of (verdict, check, text)
    """

    seed: int
    kind: str
    checks: list[str] = field(default_factory=list)
    found: list[tuple[str, str, str]] = field(default_factory=list)

    def add(self, verdict: str, check: str, text: str) -> None:
        """Another finding."""
        self.found.append((verdict, check, text))

    @property
    def verdict(self) -> str:
        """The worst one."""
        return max((each[0] for each in self.found), key=VERDICTS.index, default="right")

    def as_table(self) -> dict[str, Any]:
        """For `--json`."""
        return {
            "seed": self.seed,
            "kind": self.kind,
            "verdict": self.verdict,
            "checks": self.checks,
            "found": [list(each) for each in self.found],
        }


def changes(name: str) -> bool:
    """Whether a quantity counts from the start of a run."""
    counted = name.startswith(("delta_", "w", "W")) or name in ("heat", *WHOLE[1:])
    return counted


def differences(
    result: tribo.Result, truth: dict, bounds: dict[str, float | None], since: int = 0
) -> list[tuple[float, str, float, float]]:
    """(excess, quantity, difference, allowed) of all quantities, from the worst on.

    `since` is the sample from which works and changes of both count.
    """
    found = []
    groups = {each.name: result[each.name] for each in result.scene.surfaces}
    groups[SYSTEM] = result.system
    for group, series in groups.items():
        names = WHOLE if group == SYSTEM else (*ASPERITES, *BLOCKS, *FORCES)
        table = truth[group]
        for name in names:
            if name not in series or name not in table:
                continue
            ours = np.asarray(series[name])
            theirs = table[name]
            if changes(name):
                ours = ours - ours[since]
                theirs = theirs - theirs[0]
            gap = np.abs(ours - theirs)
            if name in FORCES:
                largest = max(np.max(np.abs(table[other])) for other in FORCES if other in table)
                allowed = FORCE * max(float(largest), 0.01)
            else:
                scale = max(1.0, float(np.max(np.abs(theirs))))
                allowed = (bounds.get(name) or 0.0) + UNSURE * scale + ROUNDING
            worst = float(np.max(gap)) if np.all(np.isfinite(gap)) else np.inf
            found.append((worst / allowed, f"{group}.{name}", worst, allowed))
    return sorted(found, reverse=True)


def compare(
    findings: Findings,
    check: str,
    result: tribo.Result,
    table: dict,
    start: Start | None = None,
    bounds: dict[str, float | None] | None = None,
) -> bool:
    """Add a finding if a run differs from the second solution; whether it agrees."""
    findings.checks.append(check)
    if result.status != "completed":
        findings.add("stopped", check, str(result.status))
        return False
    try:
        truth = solver.solve(table, result.t, start)
        bounds = dict(result.error_estimate) if bounds is None else bounds
        worst = differences(result, truth, bounds)
        if worst[0][0] > 1.0:
            truth = solver.solve(table, result.t, start, tolerance=0.01 * solver.TOLERANCE)
            worst = differences(result, truth, bounds)
    except CostlyError as problem:
        findings.add("slow", check, str(problem))
        return False
    excess, name, gap, allowed = worst[0]
    if excess <= 1.0:
        return True
    verdict = "noted" if doubted(result.notes) else "silent"
    findings.add(verdict, check, f"{name} differs by {gap:.3g}, allowed {allowed:.1g}")
    return False


def is_refused(run: Callable[[], object]) -> bool:
    """Whether a call is refused with one sentence."""
    try:
        run()
    except tribo.InputError as problem:
        return len(str(problem).splitlines()) == 1
    return False


# Words of notes that say that numbers may be off.
DOUBTS = ("exceed", "out of reach", "does not close", "doubt", "heat: by")


def doubted(notes: tuple[str, ...]) -> bool:
    """Whether notes say that numbers may be off."""
    return any(word in note for note in notes for word in DOUBTS)


def same(findings: Findings, check: str, one: Any, other: Any, allowed: float, what: str) -> None:
    """Add a finding if two values are further apart than allowed."""
    one = np.asarray(one, float)
    other = np.asarray(other, float)
    if one.shape != other.shape:
        findings.add("silent", check, f"{what}: shape {one.shape} for {other.shape}")
        return
    both = np.isnan(one) & np.isnan(other)
    gap = np.max(np.where(both, 0.0, np.abs(one - other)), initial=0.0)
    if not gap <= allowed:
        found = f"{what}: {_short(one)} for {_short(other)}, allowed {allowed:.1g}"
        findings.add("silent", check, found)


def _short(values: np.ndarray) -> str:
    return np.array2string(values.ravel()[:4], precision=6, separator=", ")
