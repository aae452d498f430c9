"""The table of printed and computed numbers as text, and why some of them differ."""

import textwrap
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from tribo.paper.cases import CASES
from tribo.paper.comparison import Cause, Row
from tribo.paper.published_values import place

# Longest line [characters].
WIDTH = 100
TITLE = (
    'Numbers printed in J. David Brown, "Work Done by Sliding Friction", and those that tribo '
    "computes"
)
HEAD = """\
  t             time as printed; two times for a change between them
  agrees        within half a unit of the last digit printed, at the time printed
  0.03 earlier  it agrees 0.03 before the time printed (the nearer of two), which rounds to that;
                or the time of an event, which is so much earlier than printed
  step 0.005    it agrees with the paper's own method at that step
  error         bound on the error of the computed number
  theta, Theta  angles of the upper and of the lower pendulum; all else is of the upper asperite
  w1, w2, w     works of friction, of the drive and of all forces; wL, wR: on the bar's ends;
                with _ps, pseudoworks
"""
COLUMNS = (
    f"  {'where':<7} {'t':<10} {'quantity':<28} {'printed':>8} {'computed':>12}  {'':<15} error"
)
# The quantities of `ends`: net work and internal energy of the upper asperite.
ENDS = ("w", "delta e_int")


def report(tables: Mapping[str, Sequence[Row]]) -> str:
    """The tables of `compare` as text, as ``tribo paper --all`` prints them.

    Parameters
    ----------
    tables : mapping of str to list of Row
        The rows of each case.

    Returns
    -------
    str
        Lines of at most 100 characters: the ends of the cases, a paragraph on the numbers that
        differ, and a line or more for each number.
    """
    lines = [*_ends(tables), "", textwrap.fill(summary(tables), WIDTH), "", HEAD]
    for case, rows in tables.items():
        agreeing = sum(row.agrees for row in rows)
        lines += [f"{case}  {CASES[case]}: {agreeing} of {len(rows)} printed numbers agree", ""]
        lines.append(COLUMNS)
        for row in rows:
            lines += _lines(row)
        end = next((row.note for row in rows if row.t == "end" and "end time" in row.note), "")
        lines += [f"  {end}", ""] if end else [""]
    return "\n".join(lines).rstrip()


def short_report(tables: Mapping[str, Sequence[Row]]) -> str:
    """The ends of the cases as text, a line for each, and how many of all numbers agree.

    ``tribo paper`` prints this.

    Parameters
    ----------
    tables : mapping of str to list of Row
        The rows of each case, from `compare`.

    Returns
    -------
    str
        Lines of at most 100 characters.
    """
    rows = [row for table in tables.values() for row in table]
    differing = [row for row in rows if not row.agrees]
    lines = _ends(tables)
    if differing:
        count = f"{len(rows) - len(differing)} of all {len(rows)} printed numbers agree"
        off = 100.0 * max(map(_relative_difference, differing))
        text = (
            f"{count}, and {len(differing)} differ, by at most {off:.1f} %, most of them because "
        )
        text += "the times printed are rounded; tribo paper --all explains each."
        lines += ["", textwrap.fill(text, WIDTH)]
    return "\n".join(lines)


def _ends(tables: Mapping[str, Sequence[Row]]) -> list[str]:
    """The title, and a table of the ends of the cases."""
    heads = f"  {'at the end':<44}{'net work':^21}{'internal energy':^21}numbers"
    columns = f"  {'of case':<44}{2 * ' printed   computed  '}that agree"
    return [TITLE, "", heads, columns, *(_end(case, rows) for case, rows in tables.items())]


def _end(case: str, rows: Sequence[Row]) -> str:
    """The line of a case in the table of ends; in words where the paper prints only a sign."""
    ends = [row for row in rows if row.t == "end"]
    found = {row.quantity: row for row in ends}
    cells = ""
    for quantity in ENDS:
        row = found.get(quantity)
        cells += " " * 21 if row is None else f"{row.printed:>8} {row.computed:>10.6f}  "
    if not cells.strip():
        words = (f"{row.quantity} is {row.printed}, computed {row.computed}" for row in ends)
        cells = f"  {', '.join(words)}"
    agreeing = sum(row.agrees for row in ends)
    return f"  {case}  {CASES[case]:<41}{cells:<42}{agreeing} of {len(ends)}"


def _lines(row: Row) -> Iterator[str]:
    """The lines of a row: its values and verdict, and its note where it says more."""
    computed = row.computed if isinstance(row.computed, str) else f"{row.computed:.8f}"
    error = "" if row.error is None else f"{row.error:.0e}"
    verdict = "agrees" if row.agrees else row.difference or "differs"
    line = (
        f"  {place(row.where):<7} {row.t:<10} {row.quantity:<28} {row.printed:>8} "
        f"{computed:>12}  {verdict:<15} {error}"
    )
    yield line.rstrip()
    if row.note and (not row.agrees or row.t != "end" or "also prints" in row.note):
        indent = " " * 10
        yield textwrap.fill(row.note, WIDTH, initial_indent=indent, subsequent_indent=indent)


def summary(tables: Mapping[str, Sequence[Row]]) -> str:
    """How many numbers differ, and why, as a paragraph."""
    rows = [row for table in tables.values() for row in table]
    differing = [row for row in rows if not row.agrees]
    agreeing = len(rows) - len(differing)
    sentences = [f"{agreeing} of {len(rows)} printed numbers agree."]
    if differing:
        off = max(map(_relative_difference, differing))
        sentences.append(f"Why {len(differing)} differ, by at most {100.0 * off:.1f} %:")
        causes = Counter(row.cause or Cause.UNKNOWN for row in differing)
        sentences += [MEANINGS[cause].format(causes[cause]) for cause in Cause if causes[cause]]
    unlike = sum(row.unlike_its_own for row in differing)
    if unlike:
        sentences.append(
            f"{unlike} of them are displacements that also differ from what the paper's own "
            "positions and angles at the same times give."
        )
    ends = [row for row in rows if row.t == "end"]
    if ends and all(row.agrees for row in ends):
        sentences.append(
            "All numbers that the paper prints for the end of a run agree, and so do its "
            "conclusions about work and pseudowork."
        )
    return " ".join(sentences)


def _relative_difference(row: Row) -> float:
    """The difference of a computed number from the printed one, in units of that."""
    if not isinstance(row.computed, float) or float(row.printed) == 0.0:
        return 0.0
    return abs(row.computed / float(row.printed) - 1.0)


# What each cause of a difference means, after the count of the numbers that differ by it.
MEANINGS = {
    Cause.TIME: "{} agree at another time that rounds to the time printed. (In case C, for "
    "instance, the bobs pass at t = 25.8716, which is printed as 25.9.)",
    Cause.STEP: "{} has the error of the paper's second-order method, at a step that is given.",
    Cause.EVENT: "{} is the time of another event: in case C the work of friction is least at "
    "t = 26.05, a little after the bobs pass.",
    Cause.UNKNOWN: "{} are not explained.",
}
