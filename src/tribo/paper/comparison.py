"""Every number that the paper prints beside the computed one.

A printed number agrees when the computed one, at the printed time, is within half a unit of its
last digit.  Where it does not agree, the row says at which time that rounds to the printed one, or
with which step of the paper's own method, it does.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import groupby

import numpy as np

from tribo.paper.cases import END, LAST, Run
from tribo.paper.published_values import agrees, published, unit

# Steps at which the paper's method is compared with its numbers [time].
STEPS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1)
# Fields of a row that only the closing paragraph needs; the keys of the JSON are a contract.
NOT_IN_JSON = ("cause", "difference", "unlike_its_own")


class Cause(StrEnum):
    """Why a printed number differs from the computed one."""

    TIME = "time"  # it is the number of another time that rounds to the printed one
    STEP = "step"  # it is what the paper's own method gives with a step
    EVENT = "event"  # it is the time of another event
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Row:
    """A printed number and the computed one.

    Attributes
    ----------
    where : str
        Figure, table or section of the paper.
    t : str
        Time as printed: a time, two times with ".." between them, "end", or empty.
    quantity, printed : str
        What the number is of, and the number, as printed.
    computed : float or str or None
        The computed number, or the sign as "+" or "-".
    error : float or None
        Error estimate of the computed number.
    agrees : bool
        Whether they agree to half a unit of the last digit printed.
    note : str
        Remarks, and where they disagree an explanation.
    cause : Cause or None
        Why they disagree; None where they agree.
    difference : str
        The cause in two words, as "0.03 earlier" or "step 0.005"; empty where they agree.
    unlike_its_own : bool
        Whether it differs from what the paper's own positions and angles at its times give.
    """

    where: str
    t: str
    quantity: str
    printed: str
    computed: float | str | None
    error: float | None
    agrees: bool
    note: str = ""
    cause: Cause | None = None
    difference: str = ""
    unlike_its_own: bool = False

    def as_json(self) -> dict[str, object]:
        """The row of ``tribo paper --json``."""
        return {name: value for name, value in vars(self).items() if name not in NOT_IN_JSON}


def compare(cases: Iterable[str]) -> dict[str, list[Row]]:
    """Compute every printed number of the given cases.

    Parameters
    ----------
    cases : iterable of str
        Of "A" to "E".

    Returns
    -------
    dict of str to list of Row
        The rows of each case, in the order of the file of printed numbers.
    """
    return {case: list(_rows(case)) for case in cases}


def _rows(case: str) -> Iterator[Row]:
    """The rows of one case, by what the paper prints: a sign, the time of an event, or a value."""
    run = Run.extended(case)
    printed_rows = published(case)
    for row in printed_rows:
        if row["quantity"] == "sign of w_ps":
            yield _sign_row(run, row)
        elif row["t"] == "":
            yield _event_row(run, row)
        else:
            yield _value_row(run, row, printed_rows)


def _value_row(run: Run, row: dict[str, str], printed_rows: list[dict[str, str]]) -> Row:
    """The row of a printed value: whether it agrees, and if it does not, what explains it."""
    quantity = row["quantity"]
    printed = row["printed"]
    times = (END[run.case],) if row["t"] == "end" else tuple(map(float, row["t"].split("..")))
    computed = _change(run.at(quantity, np.array(times)))
    agreeing = agrees(computed, printed)
    notes = [row["note"]] if row["note"] and row["t"] != "end" else []
    if row["t"] == "end":
        others = [t for t in run.ends if t != END[run.case]]
        also = f" (and at {_ranges(others)})" if others else ""
        notes.append(f"end time not printed; at t = {END[run.case]:g}{also} all end values agree")
    cause = None
    difference = ""
    own = None
    if not agreeing:
        cause, difference, explanations = _explanations(run, quantity, times, computed, printed)
        own = _from_positions(run, row, printed_rows)
        notes += explanations + ([] if own is None else [f"the paper's positions give {own:.4f}"])
    same = (r["printed"] for r in printed_rows if (r["t"], r["quantity"]) == (row["t"], quantity))
    for other in sorted({*same} - {printed}):
        if abs(float(other) - float(printed)) > 0.5 * max(unit(other), unit(printed)) * (1 + 1e-9):
            notes.append(f"the paper also prints {other} for it")
    found = computed, run.error(quantity), agreeing, "; ".join(notes)
    return Row(*_printed(row), *found, cause, difference, unlike_its_own=own is not None)


def _from_positions(
    run: Run, row: dict[str, str], printed_rows: list[dict[str, str]]
) -> float | None:
    """The displacement by positions and angles printed for the same times, if it differs."""
    if ".." not in row["t"]:
        return None
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
        return None
    each = run.result.scene.surfaces[0].asperite.for_each(1)
    arm = {"delta x_bob": each["l1"][0], "delta x_bar": -each["l2"][0], "delta x_cm": 0.0}
    own = shift + arm[row["quantity"]] * turn
    return None if agrees(own, row["printed"]) else own


def _change(values: np.ndarray) -> float:
    """The value at one time, or the change between two."""
    return float(values[-1] - values[0] if len(values) == 2 else values[0])


def _shifts() -> Iterator[float]:
    """Differences of a time within half a unit of its last printed digit, round ones first."""
    for size, count in ((1e-2, 4), (1e-3, 49), (1e-4, 499)):
        for n in range(1, count + 1):
            yield -n * size
            yield n * size


def _explanations(
    run: Run, quantity: str, times: tuple[float, ...], computed: float, printed: str
) -> tuple[Cause, str, list[str]]:
    """Why a printed number differs: a time before rounding, or the error of the method."""
    found = []
    shifts = []
    for k, t in enumerate(times):
        near = [round(t + shift, 4) for shift in _shifts() if t + shift <= LAST]
        moved = run.at(quantity, np.array(near)) - float(run.at(quantity, t))
        sign = 1.0 if k == len(times) - 1 else -1.0
        changed = computed + sign * moved
        hit = next((n for n, c in zip(near, changed, strict=True) if agrees(c, printed)), None)
        if hit is not None:
            found.append(f"{hit:.10g}")
            shifts.append(hit - t)
    step = next((h for h in STEPS if agrees(_by_midpoint(run, quantity, times, h), printed)), None)
    notes = [f"agrees at {' or '.join(found)}"] if found else []
    if step is not None:
        notes.append(f"agrees with the paper's method at a step of {step:g}")
    if found:
        shift = min(shifts, key=abs)
        return Cause.TIME, _moved(shift), notes
    if step is not None:
        return Cause.STEP, f"step {step:g}", notes
    notes = ["neither another time nor the paper's method gives this number"]
    return Cause.UNKNOWN, "unexplained", notes


def _moved(shift: float) -> str:
    """A difference of times in words, as "0.03 earlier"."""
    return f"{abs(shift):.4g} {'later' if shift > 0.0 else 'earlier'}"


def _by_midpoint(run: Run, quantity: str, times: tuple[float, ...], step: float) -> float:
    """The same number by the paper's own method with a step."""
    coarse = Run.by_midpoint(run.case, times, step)
    return _change(coarse.series(quantity)[np.searchsorted(coarse.result.t, times)])


def _event_row(run: Run, row: dict[str, str]) -> Row:
    """The row of the printed time of an event, such as the extremum of a quantity."""
    printed = row["printed"]
    computed = run.event(row["quantity"], float(printed))
    if agrees(computed, printed):
        return Row(*_printed(row), computed, 1e-8, True)
    quantity = row["quantity"].rpartition(" ")[2]
    gap = abs(float(run.at(quantity, float(printed)) - run.at(quantity, computed)))
    note = (
        f"at the printed time {quantity} differs by {gap:.4f} (error {run.error(quantity):.0e}) "
        "from its extremum, which forces along y separate from the time the bobs pass"
    )
    difference = _moved(computed - float(printed))
    return Row(*_printed(row), computed, 1e-8, False, note, Cause.EVENT, difference)


def _sign_row(run: Run, row: dict[str, str]) -> Row:
    """The row of the sign of a pseudowork, which two runs and their boosted twins confirm."""
    other = Run.extended(run.case, attractive=True)
    end = END[run.case]
    values = [float(r.at("w_ps", end)) for r in (run, other)]
    computed = "+" if min(values) > 0.0 else "-"
    notes = [f"w_ps = {values[0]:.6f} repulsive, {values[1]:.6f} attractive, at t = {end:g}"]
    for moving, still in ((run, "C"), (other, "D")):
        error = boost_error(moving, Run.extended(still))
        notes.append(f"{still} boosted agrees in every quantity within {error:.0e}")
    return Row(*_printed(row), computed, None, computed == row["printed"], "; ".join(notes))


def boost_error(moving: Run, still: Run) -> float:
    """Largest difference of any quantity of case E from case C or D in a moving frame."""
    u = moving.result.scene.surfaces[0].velocity[0] - still.result.scene.surfaces[0].velocity[0]
    mass = still.result.scene.surfaces[0].asperite.for_each(1)["mass"][0]
    largest = 0.0
    t = moving.result.t[:, None]
    for name in ("upper", "lower"):
        new = moving.result[name]
        old = still.result[name]
        impulse = mass * (old.vx_cm - old.vx_cm[0])
        same = ("theta", "omega", "y_cm", "delta_e_int", "w2", "wL", "wR")
        expected = {key: old[key] for key in same}
        expected |= {"x_cm": old.x_cm + u * t, "vx_cm": old.vx_cm + u}
        if name == "upper":  # f2 has no x component: all of the impulse is that of f1
            expected |= {key: old[key] + u * impulse for key in ("w1", "w1_ps", "w", "w_ps")}
        else:
            del expected["w2"]
        largest = max(largest, *(float(np.max(np.abs(new[k] - v))) for k, v in expected.items()))
    return largest


def _printed(row: dict[str, str]) -> tuple[str, str, str, str]:
    return row["where"], row["t"], row["quantity"], row["printed"]


def _ranges(numbers: list[int]) -> str:
    """Whole numbers as text, consecutive ones as a range."""
    texts = []
    # Consecutive numbers grow as their places in the list do.
    for _, group in groupby(enumerate(numbers), lambda item: item[1] - item[0]):
        consecutive = [number for _, number in group]
        if len(consecutive) == 1:
            texts.append(str(consecutive[0]))
        else:
            texts.append(f"{consecutive[0]} to {consecutive[-1]}")
    return ", ".join(texts)
