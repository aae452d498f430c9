"""The table of cases on the page shows the scenes of the cases."""

import re
from pathlib import Path

import pytest

from tribo import paper

PAGE = Path(__file__).resolve().parents[2] / "docs" / "explanation" / "paper.md"


def column(case):
    """The drive of a case in the table, and the numbers in the rows below the contact."""
    table = PAGE.read_text(encoding="utf-8").partition("| | A | B | C | D | E |")[2]
    rows = [line.split("|")[1:-1] for line in table.partition("\n\n")[0].splitlines()[2:]]
    cells = [row["ABCDE".index(case) + 1].replace("\N{MINUS SIGN}", "-").strip() for row in rows]
    numbers = [[float(x) for x in re.findall(r"-?\d+(?:\.\d+)?", cell)] for cell in cells]
    assert cells[0] == f'`scene("{case}")`'
    return cells[1], numbers[3:]


def values(scene):
    """The same of a scene, in the order of the rows."""
    upper, lower = scene.surfaces
    assert upper.asperite == lower.asperite
    assert upper.bob[0] - lower.bob[0] == -10.0 and type(lower.drive).__name__ == "Forced"
    one = upper.asperite
    return type(upper.drive).__name__.lower(), [
        [scene.interactions[0].potential.strength],
        [upper.bob[1] - lower.bob[1]],
        [one.m1, one.m2],
        [one.kappa],
        [one.length, one.bar_length],
        [upper.velocity[0]],
        [lower.velocity[0]],
        [scene.duration],
    ]


@pytest.mark.parametrize("case", "ABCDE")
def test_table_of_cases(case):
    """Every number of the table; case E has two signs of the force."""
    drive, expected = values(paper.scene(case))
    if case == "E":
        attracted = values(paper.scene("E", attractive=True))[1]
        expected = [a if a == b else a + b for a, b in zip(expected, attracted, strict=True)]
    assert column(case) == (drive, expected)
