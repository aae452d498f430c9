"""The paper's cases A to E, and every number it prints beside ours.

J. David Brown, *Work Done by Sliding Friction*.  A printed number agrees when ours, at the time
printed, is within half a unit of its last digit.  Where it does not, the row says at which time
that rounds to the printed one, or with which step of the paper's own method, it would.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cache, cached_property
from importlib.resources import files
from typing import Any

import numpy as np

from tribo.model.asperite import Asperite
from tribo.model.drives import Forced, Free
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.model.surface import Surface
from tribo.potentials import Coulomb
from tribo.run.result import Result
from tribo.simulation import simulate

CASES = {
    "A": "forced sliding, repulsive",
    "B": "forced sliding, attractive",
    "C": "free sliding, repulsive",
    "D": "free sliding, attractive",
    "E": "free sliding from rest on a moving table",
}

# The paper does not print when its runs end.  These are the round times at which every number
# that it gives "at the end" agrees; `Run.ends` finds all whole ones.
END = {"A": 40.0, "B": 26.0, "C": 50.0, "D": 50.0, "E": 50.0}

LAST = 60.0  # how far the cases are followed
ACCURACY = 1e-11
SPACING = 0.05  # of the samples among which times are looked for
STEPS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1)  # of the paper's method that are tried


def scene(case: str, attractive: bool = False) -> Scene:
    """A case of the paper to its end time; `attractive` is for E, which has both signs."""
    forced = case in "AB"
    pulls = case in "BD" or (case == "E" and attractive)
    parameters = {
        "A": Asperite(m1=1.0, m2=2.0, kappa=2.0),
        "B": Asperite(m1=5.0, m2=3.0, kappa=1.0),
    }.get(case, Asperite(m1=4.0, m2=8.0, kappa=2.0))
    upper_speed, lower_speed = (0.0, -0.5) if case == "E" else (0.5, 0.0)
    upper = Surface(
        "upper",
        facing="down",
        bob=(-10.0, 0.0),
        velocity=(upper_speed, 0.0),
        drive=Forced() if forced else Free(),
        asperite=parameters,
    )
    lower = Surface(
        "lower",
        facing="up",
        bob=(0.0, -0.3 if pulls else 0.0),
        velocity=(lower_speed, 0.0),
        asperite=parameters,
    )
    potential = Coulomb(-0.2 if pulls else 0.2)
    title = f"{case}: {CASES[case]}"
    return Scene((upper, lower), (Interaction(potential),), END[case], title=title)


@dataclass(frozen=True)
class Row:
    """One printed number and ours."""

    where: str
    t: str
    quantity: str
    printed: str
    computed: float | str | None
    error: float | None
    agrees: bool
    note: str = ""

    def as_json(self) -> dict[str, Any]:
        """The row of ``tribo paper --json``."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}


def published(case: str) -> list[dict[str, str]]:
    """What the paper prints of a case, row by row."""
    text = files("tribo.paper").joinpath("published_values.csv").read_text(encoding="utf-8")
    return [row for row in csv.DictReader(text.splitlines()) if row["case"] == case]


def compare(cases: Iterable[str]) -> dict[str, list[Row]]:
    """Every number printed of the given cases beside ours."""
    return {case: list(_rows(case)) for case in cases}


class Run:
    """A case and its densely sampled result, with what can be read off it at any time."""

    def __init__(self, case: str, result: Result) -> None:
        self.case = case
        self.result = result
        self._splines: dict[str, Any] = {}

    @classmethod
    @cache
    def followed(cls, case: str, attractive: bool = False) -> Run:
        """A case followed far beyond its end."""
        times = np.round(np.arange(0.0, LAST + SPACING / 2, SPACING), 2)
        dense = replace(scene(case, attractive), duration=LAST, output=Output(times=tuple(times)))
        return cls(case, simulate(dense, accuracy=ACCURACY))

    @classmethod
    @cache
    def by_midpoint(cls, case: str, times: tuple[float, ...], step: float) -> Run:
        """A case by the paper's own method, recorded at a few times."""
        short = replace(scene(case), duration=times[-1], output=Output(times=times))
        return cls(case, simulate(short, method="midpoint", step=step))

    def series(self, quantity: str) -> np.ndarray:
        """A printed quantity's series: Theta is the lower asperite's theta."""
        upper = self.result["upper"]
        if quantity == "Theta":
            return self.result["lower"].theta[:, 0]
        if quantity == "wL + wR":
            return (upper.wL + upper.wR)[:, 0]
        if quantity == "w - w_ps":
            return (upper.w - upper.w_ps)[:, 0]
        return upper[_name(quantity)][:, 0]

    def error(self, quantity: str) -> float:
        """The run's own estimate for a quantity, or for all that it is made of."""
        bounds = self.result.error_estimate
        parts = {"Theta": ["theta"], "wL + wR": ["wL", "wR"], "w - w_ps": ["w", "w_ps"]}
        names = parts.get(quantity, [_name(quantity)])
        twice = 2.0 if quantity.startswith("delta x") else 1.0
        return twice * sum(bounds[name] or 0.0 for name in names)

    def at(self, quantity: str, t: float | np.ndarray) -> Any:
        """The quantity at any time; between samples by a spline that is good to 1e-9."""
        from scipy.interpolate import make_interp_spline

        if quantity not in self._splines:
            self._splines[quantity] = make_interp_spline(self.result.t, self.series(quantity), k=7)
        return self._splines[quantity](t)

    def roots(self, values: np.ndarray, near: float) -> float:
        """The time nearest to `near` at which a series changes sign."""
        from scipy.interpolate import make_interp_spline
        from scipy.optimize import brentq

        t = self.result.t
        changes = np.flatnonzero(values[:-1] * values[1:] < 0.0)
        k = int(changes[np.argmin(np.abs(t[changes] - near))])
        spline = make_interp_spline(t, values, k=7)
        return float(brentq(spline, t[k], t[k + 1], xtol=1e-12))

    def slope(self, quantity: str) -> np.ndarray:
        """Time derivative of a series."""
        self.at(quantity, 0.0)
        return np.asarray(self._splines[quantity].derivative()(self.result.t))

    def event(self, name: str, near: float) -> float:
        """The time of something that the paper dates."""
        upper, lower = self.result["upper"], self.result["lower"]
        if name == "time the bobs pass":
            return self.roots((upper.x_bob - lower.x_bob)[:, 0], near)
        if name == "time the centres of mass pass":
            # Off by half a spacing, so that a sample at the very place is no obstacle.
            shift = 0.5 * SPACING * (upper.vx_cm - lower.vx_cm)[0, 0]
            return self.roots((upper.x_cm - lower.x_cm)[:, 0] + shift, near) + 0.5 * SPACING
        quantity = "w" if name.startswith("net work") else "w1"
        return self.roots(self.slope(quantity), near)

    @cached_property
    def ends(self) -> list[int]:
        """The whole times at which every number given "at the end" agrees."""
        rows = [r for r in published(self.case) if r["t"] == "end" and r["quantity"][:4] != "sign"]
        return [
            t
            for t in range(20, int(LAST) + 1)
            if all(_agree(float(self.at(r["quantity"], t)), r["printed"]) for r in rows)
        ]


def _name(quantity: str) -> str:
    """The ledger's name for a quantity as it is printed."""
    names = {"delta e_int": "delta_e_int", "delta k_trans": "delta_k_trans"}
    return names.get(quantity, quantity.removeprefix("delta "))


def _unit(printed: str) -> float:
    """One unit of the last digit printed."""
    exponent = Decimal(printed).as_tuple().exponent
    assert isinstance(exponent, int)
    return float(Decimal(1).scaleb(exponent))


def _agree(computed: float, printed: str) -> bool:
    """Within half a unit of the last digit (and what binary fractions cost)."""
    return abs(computed - float(printed)) <= 0.5 * _unit(printed) * (1.0 + 1e-9)


def _rows(case: str) -> Iterator[Row]:
    run = Run.followed(case)
    printed_rows = published(case)
    for row in printed_rows:
        if row["quantity"] == "sign of w_ps":
            yield _sign_row(run, row)
        elif row["t"] == "":
            yield _event_row(run, row)
        else:
            yield _value_row(run, row, printed_rows)


def _value_row(run: Run, row: dict[str, str], printed_rows: list[dict[str, str]]) -> Row:
    quantity, printed = row["quantity"], row["printed"]
    times = (END[run.case],) if row["t"] == "end" else tuple(map(float, row["t"].split("..")))
    computed = _change(run, quantity, times)
    agrees = _agree(computed, printed)
    notes = [row["note"]] if row["note"] and row["t"] != "end" else []
    if row["t"] == "end":
        others = [t for t in run.ends if t != END[run.case]]
        also = f" (and at {_ranges(others)})" if others else ""
        notes.append(f"end time not printed; at t = {END[run.case]:g}{also} all end values agree")
    if not agrees:
        notes.extend(_why_not(run, quantity, times, printed))
        notes.extend(_own_places(run, row, printed_rows))
    elsewhere = {
        other["printed"]
        for other in printed_rows
        if (other["t"], other["quantity"]) == (row["t"], quantity)
    } - {printed}
    for other in sorted(elsewhere):
        if abs(float(other) - float(printed)) > 0.5 * max(_unit(other), _unit(printed)) * (
            1 + 1e-9
        ):
            notes.append(f"the paper also prints {other} for it")
    return _row(row, computed, run.error(quantity), agrees, notes)


def _own_places(run: Run, row: dict[str, str], printed_rows: list[dict[str, str]]) -> list[str]:
    """What the places and angles printed for the same times make of a displacement."""
    if ".." not in row["t"]:
        return []
    printed = {
        (r["t"], r["quantity"]): float(r["printed"])
        for r in printed_rows
        if ".." not in r["t"] and r["t"] not in ("", "end")
    }
    begin, end = row["t"].split("..")
    speed = run.result.scene.surfaces[0].velocity[0]
    try:
        if run.case in "AB":
            shift = speed * (float(end) - float(begin))
        else:
            shift = printed[end, "x_cm"] - printed[begin, "x_cm"]
        turn = np.sin(printed[end, "theta"]) - np.sin(printed[begin, "theta"])
    except KeyError:
        return []
    each = run.result.scene.surfaces[0].asperite.for_each(1)
    arm = {"delta x_bob": each["l1"][0], "delta x_bar": -each["l2"][0], "delta x_cm": 0.0}
    own = shift + arm[row["quantity"]] * turn
    if _agree(own, row["printed"]):
        return []
    return [f"the places and angles that the paper prints for these times give {own:.4f}"]


def _change(run: Run, quantity: str, times: tuple[float, ...]) -> float:
    """The quantity at one time, or what it changes by between two."""
    values = [float(run.at(quantity, t)) for t in times]
    return values[-1] - values[0] if len(times) == 2 else values[0]


# Within half a unit of a time's last digit: round ones first, then near ones.
_SHIFTS = [
    shift
    for unit, count in ((1e-2, 4), (1e-3, 49), (1e-4, 499))
    for n in range(1, count + 1)
    for shift in (-n * unit, n * unit)
]


def _why_not(run: Run, quantity: str, times: tuple[float, ...], printed: str) -> list[str]:
    """Where a printed number comes from: an unrounded time, or the paper's method's error."""
    notes = []
    for k, t in enumerate(times):
        near = [round(t + shift, 4) for shift in _SHIFTS if t + shift <= LAST]
        moved = run.at(quantity, np.array(near)) - float(run.at(quantity, t))
        sign = 1.0 if k == len(times) - 1 else -1.0
        changed = _change(run, quantity, times) + sign * moved
        hit = next((n for n, c in zip(near, changed, strict=True) if _agree(c, printed)), None)
        if hit is not None:
            notes.append(f"agrees with t = {hit:.10g} in place of {t:g}")
    step = next((h for h in STEPS if _agree(_by_midpoint(run, quantity, times, h), printed)), None)
    if step is not None:
        notes.append(f"agrees with the paper's method at a step of {step:g}")
    return notes or ["no time that rounds to the one printed gives this, nor the paper's method"]


def _by_midpoint(run: Run, quantity: str, times: tuple[float, ...], step: float) -> float:
    """The same number by the paper's own method and a step."""
    coarse = Run.by_midpoint(run.case, times, step)
    values = coarse.series(quantity)[np.searchsorted(coarse.result.t, times)]
    return float(values[-1] - values[0] if len(times) == 2 else values[0])


def _event_row(run: Run, row: dict[str, str]) -> Row:
    printed = row["printed"]
    computed = run.event(row["quantity"], float(printed))
    agrees = _agree(computed, printed)
    notes = []
    if not agrees:
        quantity = row["quantity"].rpartition(" ")[2]
        gap = abs(float(run.at(quantity, float(printed)) - run.at(quantity, computed)))
        scale = run.error(quantity)
        notes.append(
            f"at the printed time {quantity} is still {gap:.4f} from there (known to {scale:.0e}); "
            "forces along y move it from the time the bobs pass"
        )
    return _row(row, computed, 1e-8, agrees, notes)


def _sign_row(run: Run, row: dict[str, str]) -> Row:
    other = Run.followed(run.case, attractive=True)
    end = END[run.case]
    values = [float(r.at("w_ps", end)) for r in (run, other)]
    computed = "+" if min(values) > 0.0 else "-"
    notes = [f"w_ps = {values[0]:.6f} repulsive, {values[1]:.6f} attractive, at t = {end:g}"]
    for moving, still in ((run, "C"), (other, "D")):
        gap = boost_gap(moving, Run.followed(still))
        notes.append(f"{still} boosted gives every quantity again within {gap:.0e}")
    return _row(row, computed, None, computed == row["printed"], notes)


def boost_gap(moving: Run, still: Run) -> float:
    """Largest difference of any quantity of E from C or D seen from the moving frame."""
    u = moving.result.scene.surfaces[0].velocity[0] - still.result.scene.surfaces[0].velocity[0]
    gap = 0.0
    t = moving.result.t[:, None]
    for name in ("upper", "lower"):
        new, old = moving.result[name], still.result[name]
        mass = 12.0
        impulse = mass * (old.vx_cm - old.vx_cm[0])
        expected = {
            key: old[key] for key in ("theta", "omega", "y_cm", "delta_e_int", "w2", "wL", "wR")
        }
        expected |= {"x_cm": old.x_cm + u * t, "vx_cm": old.vx_cm + u}
        if name == "upper":  # f2 has no x component, so that all of the impulse is f1's
            expected |= {key: old[key] + u * impulse for key in ("w1", "w1_ps", "w", "w_ps")}
        else:
            del expected["w2"]
        gap = max(gap, *(float(np.max(np.abs(new[k] - v))) for k, v in expected.items()))
    return gap


def _row(
    row: dict[str, str], computed: float | str, error: float | None, agrees: bool, notes: list[str]
) -> Row:
    return Row(
        row["where"],
        row["t"],
        row["quantity"],
        row["printed"],
        computed,
        error,
        agrees,
        "; ".join(notes),
    )


def _ranges(numbers: list[int]) -> str:
    """Whole numbers as a short list, runs of them as a range."""
    runs: list[list[int]] = []
    for n in numbers:
        if runs and n == runs[-1][-1] + 1:
            runs[-1].append(n)
        else:
            runs.append([n])
    return ", ".join(str(r[0]) if len(r) == 1 else f"{r[0]} to {r[-1]}" for r in runs)


def report(tables: dict[str, list[Row]]) -> str:
    """The tables as text."""
    lines = []
    for case, rows in tables.items():
        agreeing = sum(row.agrees for row in rows)
        lines += [f"{case}  {CASES[case]}: {agreeing} of {len(rows)} printed numbers agree", ""]
        lines.append(
            f"  {'where':<30} {'t':<11} {'quantity':<29} {'printed':>9} "
            f"{'computed':>14} {'error':>8}"
        )
        for row in rows:
            computed = row.computed if isinstance(row.computed, str) else f"{row.computed:.8f}"
            error = "" if row.error is None else f"{row.error:.0e}"
            verdict = "agrees" if row.agrees else "DIFFERS"
            lines.append(
                f"  {row.where:<30} {row.t:<11} {row.quantity:<29} {row.printed:>9} "
                f"{computed:>14} {error:>8}  {verdict}"
            )
            if row.note and (not row.agrees or row.t != "end" or "also prints" in row.note):
                lines.append(f"      {row.note}")
        ends = next((row.note for row in rows if row.t == "end" and "end time" in row.note), "")
        lines += [f"  {ends}" if ends else "", ""]
    total = [row for rows in tables.values() for row in rows]
    lines.append(f"{sum(row.agrees for row in total)} of {len(total)} printed numbers agree.")
    return "\n".join(lines)
