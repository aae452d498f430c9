"""The comparison with the paper's numbers as text."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Iterator

from tribo.paper.cases import CASES
from tribo.paper.comparison import AT, BY_METHOD, FROM_POSITIONS, Row

# Characters of a line: they fit a page of the documents too.
WIDTH = 100
# The numbers of the figures in the paper, by their labels in its source.
FIGURES = {
    "Elec20thru26": 3,
    "ForcedRepulsiveFig": 5,
    "ForcedAttractiveFig": 7,
    "FreeAttractiveFig": 9,
    "FreeAttractiveFigNewFrame": 11,
}
TITLE = 'What J. D. Brown prints in "Work Done by Sliding Friction", and what tribo computes for it'
# What the columns mean, by their names.
LEGEND = {
    "where": "figure of the paper, or its text",
    "t": 'time as printed; two times: the change between them; "end": the end of the run',
    "theta": "angle of the upper pendulum; Theta: of the lower one",
    "x_cm": "x of the centre of mass of the upper asperite; x_bob, x_bar: of its bob and its bar",
    "w1": "work of friction; w2: of the drive; wL, wR: on the ends of the bar; _ps: pseudowork",
    "agrees": "the computed number is within half a unit of the last digit printed",
    "DIFFERS": 'it is not; "agrees at t" names a time that rounds to the printed one and gives it',
    "error": "bound on the error of the computed number",
}


def report(tables: dict[str, list[Row]]) -> str:
    """The tables of `compare` as text, as ``tribo paper`` prints them."""
    lines = [TITLE, ""]
    for name, meaning in LEGEND.items():
        lines += _wrapped(f"{name:<8} {meaning}", "  ", 11)
    for case, rows in tables.items():
        agreeing = sum(row.agrees for row in rows)
        lines += ["", f"{case}  {CASES[case]}: {agreeing} of {len(rows)} printed numbers agree", ""]
        lines.append(_line("where", "t", "quantity", "printed", "computed", "", "error"))
        for row in rows:
            lines += _row(row)
        ends = next((row.note for row in rows if row.t == "end" and "end time" in row.note), "")
        lines += _wrapped(ends, "  ", 2)
    total = [row for rows in tables.values() for row in rows]
    agreeing = sum(row.agrees for row in total)
    lines += ["", f"{agreeing} of {len(total)} printed numbers agree."]
    if agreeing < len(total):
        lines += ["", *textwrap.wrap(" ".join(_reasons(total)), WIDTH)]
    return "\n".join(lines)


def place(where: str) -> str:
    """A place in the paper, with the number of a figure in place of its label."""
    return re.sub(r"fig\. (\w+)", lambda found: f"fig. {FIGURES[found[1]]}", where)


def _line(*cells: str) -> str:
    where, t, quantity, printed, computed, verdict, error = cells
    text = (
        f"  {where:<7} {t:<10} {quantity:<29} {printed:>9} {computed:>12}  {verdict:<7} {error:>6}"
    )
    return text.rstrip()


def _row(row: Row) -> Iterator[str]:
    """The lines of a printed number."""
    computed = row.computed if isinstance(row.computed, str) else f"{row.computed:.8f}"
    error = "" if row.error is None else f"{row.error:.0e}"
    verdict = "agrees" if row.agrees else "DIFFERS"
    yield _line(place(row.where), row.t, row.quantity, row.printed, computed, verdict, error)
    if row.note and (not row.agrees or row.t != "end" or "also prints" in row.note):
        yield from _wrapped(row.note, " " * 10, 10)


def _wrapped(text: str, start: str, indent: int) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=start, subsequent_indent=" " * indent)


def _reasons(rows: Iterable[Row]) -> Iterator[str]:
    """Why some numbers differ, in sentences."""
    rows = list(rows)
    different = [row for row in rows if not row.agrees]
    by_time = [row for row in different if AT in row.note]
    by_method = [row for row in different if row not in by_time and BY_METHOD in row.note]
    largest = max(_relative_difference(row) for row in different)
    yield (
        f"Why {len(different)} of {len(rows)} numbers differ, by at most {100.0 * largest:.1f} %:"
    )
    if by_time:
        yield (
            f"{_count(len(by_time))} printed for a time that is itself rounded, and a time that "
            "rounds to the printed one gives the printed number."
        )
    if any(row.t.endswith("25.9") or row.t.startswith("25.9") for row in by_time):
        yield (
            'Most of these are "at 25.9", when the bobs of case C pass: they pass at 25.8716, and '
            "the numbers are those of 25.87."
        )
    unfit = sum(FROM_POSITIONS in row.note for row in by_time)
    if unfit:
        yield (
            f"{unfit} of them do not follow from the angles and positions that the paper prints "
            "for the same times."
        )
    if by_method:
        yield (
            f"{_count(len(by_method))} within the error of the paper's second-order method at "
            "a step that it may have had."
        )
    rest = [row for row in different if row not in by_time and row not in by_method]
    if any("minimum of w1" in row.quantity for row in rest):
        yield (
            "In case C the minimum of w1 is dated with the passing of the bobs, but comes later, "
            "since the upper bob is then still on its way down."
        )
    if all(row.agrees for row in rows if row.t == "end"):
        yield (
            "Every work and energy that is printed for the end of a run agrees, and with them the "
            "paper's conclusions."
        )


def _count(number: int) -> str:
    return "One is" if number == 1 else f"{number} are"


def _relative_difference(row: Row) -> float:
    printed = float(row.printed)
    assert isinstance(row.computed, float)
    return abs(row.computed - printed) / abs(printed)
