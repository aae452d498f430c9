"""The paper's numbers beside the computed ones: no row is missing, and the notes are right."""

import csv
from dataclasses import replace
from decimal import Decimal
from importlib.resources import files

import pytest

from tribo import paper
from tribo.paper.comparison import Cause
from tribo.paper.figures import FIGURES
from tribo.paper.published_values import FIGURE_LABELS

# Numbers that agree, of 103; the others come from rounded times, or from the paper's method.
AGREE = 76


@pytest.fixture(scope="module")
def tables():
    """All five cases, compared once."""
    return paper.compare(paper.CASES)


def printed():
    """The file of published values that comes with the package."""
    text = files("tribo").joinpath("paper/published_values.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def test_every_row_is_there(tables):
    """There is a computed row for every row of the file, in its order."""
    keys = ("where", "t", "quantity", "printed")
    for case in "ABCDE":
        rows = [row for row in printed() if row["case"] == case]
        assert paper.published(case) == rows
        expected = [tuple(row[key] for key in keys) for row in rows]
        found = [tuple(getattr(row, key) for key in keys) for row in tables[case]]
        assert found == expected
    assert list(tables) == list("ABCDE")
    assert sum(map(len, tables.values())) == len(printed()) == 103


def test_agreement_is_half_a_unit(tables):
    """Within half a unit of the last digit printed, and not beyond it."""
    for rows in tables.values():
        for row in rows:
            if isinstance(row.computed, str):
                assert row.agrees == (row.computed == row.printed)
                continue
            half = 0.5 * 10.0 ** Decimal(row.printed).as_tuple().exponent
            off = abs(row.computed - float(row.printed))
            assert row.agrees == (off <= half * (1.0 + 1e-9))


def test_agreement(tables):
    """At least AGREE numbers agree, all of case D, and all that are given at the end of a run."""
    rows = [row for table in tables.values() for row in table]
    assert sum(row.agrees for row in rows) >= AGREE
    assert all(row.agrees for row in tables["D"])
    assert all(row.agrees for row in rows if row.t == "end")


def test_a_difference_is_explained(tables):
    """A row that does not agree has a note, and errors are far below the printed digits."""
    for rows in tables.values():
        for row in rows:
            assert row.agrees or row.note
            assert row.error is None or row.error < 1e-7


def test_noted_times_are_right(tables):
    """Where a note says that another time gives the number, it does."""
    runs = {case: paper.Run.extended(case) for case in "AC"}
    found = 0
    for case, run in runs.items():
        for row in tables[case]:
            if ".." in row.t or not row.note.startswith("agrees at "):
                continue
            time = float(row.note.removeprefix("agrees at "))
            half = 0.5 * 10.0 ** Decimal(row.printed).as_tuple().exponent
            assert abs(float(run.at(row.quantity, time)) - float(row.printed)) <= half * 1.000001
            found += 1
    assert found >= 3


@pytest.mark.parametrize(("attractive", "still"), [(False, "C"), (True, "D")])
def test_moving_table_is_a_boost(attractive, still):
    """E is C, or D if attractive, in a moving frame: every quantity, at every time."""
    moving = paper.Run.extended("E", attractive=attractive)
    assert paper.boost_error(moving, paper.Run.extended(still)) < 1e-9


def test_report(tables):
    """The text says what it is, has a line for each row and a total for each case, and fits."""
    text = paper.report(tables)
    lines = text.splitlines()
    assert "tribo computes" in lines[0] and max(map(len, lines)) <= 120
    for case, rows in tables.items():
        agree = sum(row.agrees for row in rows)
        title = f"{case}  {paper.CASES[case]}: {agree} of {len(rows)} printed numbers agree"
        assert title in lines
    differing = [row for rows in tables.values() for row in rows if not row.agrees]
    words = [f"  {row.difference} " in text for row in differing]
    assert len(differing) == 103 - AGREE and all(words)
    assert sum(line.startswith("          agrees at 14.9997 or 23.2003;") for line in lines) == 1


def test_report_numbers_figures(tables):
    """Figures have the numbers that they have in print, which those drawn here have too."""
    text = paper.report(tables)
    assert not [label for label in FIGURE_LABELS if label in text]
    assert "  fig. 3  20.0       theta " in text and "  fig. 11 13.0..25.9 delta x_bob" in text
    assert [figure.name[:5] for figure in FIGURES] == [f"fig{n:02}" for n in range(1, 12)]
    assert len(FIGURE_LABELS) == len(FIGURES)


def test_summary_gives_the_reasons(tables):
    """The first paragraph counts the differences by their causes."""
    differing = [row for rows in tables.values() for row in rows if not row.agrees]
    causes = {cause: sum(row.cause == cause for row in differing) for cause in Cause}
    assert causes == {Cause.TIME: 25, Cause.STEP: 1, Cause.EVENT: 1, Cause.UNKNOWN: 0}
    paragraph = " ".join(paper.report(tables).split("\n\n")[2].split())
    assert paragraph.startswith(
        "76 of 103 printed numbers agree. Why 27 differ, by at most 1.5 %: 25 agree at "
    )
    assert " 1 has the error of the paper's " in paragraph
    assert paragraph.endswith("and so do its conclusions about work and pseudowork.")
    wrong = [replace(row, agrees=False) if row.t == "end" else row for row in tables["D"]]
    assert "conclusions" not in paper.report({"D": wrong})


def test_ends_come_first(tables):
    """The short report has a line for each case, with printed and computed ends, and a sentence."""
    text = paper.short_report(tables)
    lines = text.splitlines()
    cases = [line.split() for line in lines if line[2:5] in {f"{case}  " for case in "ABCDE"}]
    assert [line[0] for line in cases] == list("ABCDE")
    assert all(line[-3] == line[-1] for line in cases)  # "4 of 4"
    assert cases[0][4:8] == ["0.520", "0.519665", "0.520", "0.519665"]
    assert cases[2][4:8] == ["-0.531", "-0.530520", "0.377", "0.377157"]
    assert f"{AGREE} of all 103 printed numbers agree" in text and len(lines) <= 12
    assert max(map(len, lines)) <= 100
    assert paper.report(tables).startswith("\n".join(lines[:8]))


def test_differences_in_words(tables):
    """A shift of time is that to the time of the note: case C's angle at 25.9 is that at 25.87."""
    rows = {(row.t, row.quantity): row for row in tables["C"]}
    assert rows["25.9", "theta"].difference == "0.03 earlier"
    assert rows["", "time of the minimum of w1"].difference == "0.1507 later"
    (step,) = [row for row in tables["A"] if row.cause is Cause.STEP]
    assert step.difference == "step 0.005"
