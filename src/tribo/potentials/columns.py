"""Columns of numbers in text files: two of them, of distances and energies.

Numbers are separated by commas, semicolons, blanks or tabs, and have decimal points; exponents may
begin with D, as Fortran writes them.  Empty lines, and what follows #, are skipped.  One line of
headings may come before the numbers.  A file of LAMMPS's ``pair_style table`` has sections: a
keyword, a line "N n ..." and n rows of index, distance, energy and force.
"""

import re
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tribo.decimal_commas import check_commas
from tribo.files import read_file
from tribo.validation import InputError, is_list, must_be, shortened

# Headings of the columns, in small letters, without what follows in parentheses or brackets.
HEADINGS = (("r", "distance"), ("energy", "u", "e", "v"))
# The columns of LAMMPS's rows with distances and energies.
OF_LAMMPS = (2, 3)


class Line(NamedTuple):
    """A line of a file that is not empty."""

    number: int  # from 1
    text: str
    words: list[str]


def read_columns(path: Path, columns: object, section: object) -> tuple[list[float], list[float]]:
    """Distances and energies in a file.  Raises InputError."""
    lines = _lines(path)
    sections = _sections(path, lines)
    headings: list[str] = []
    if sections:
        if section is None and len(sections) == 1:
            section = next(iter(sections))
        if not isinstance(section, str) or section not in sections:
            known = shortened(f'"{name}"' for name in sections)
            raise must_be("section", f"one of those of {path}: {known}", section)
        lines = sections[section]
        columns = OF_LAMMPS if columns is None else columns
    elif section is not None:
        raise InputError("section", f"cannot be given, as {path} has no sections")
    elif lines and not any(map(_is_number, lines[0].words)):
        headings = lines[0].words
        _check_headings(path, lines)
        lines = lines[1:]
    count = len(lines[0].words) if lines else 2
    places = _places(path, columns, headings, count)
    numbers = [_numbers(path, line, max(count, 2)) for line in lines]
    return [row[places[0]] for row in numbers], [row[places[1]] for row in numbers]


def _lines(path: Path) -> list[Line]:
    """The lines of a text file that contain words, which commas, semicolons or blanks separate."""
    try:
        text = read_file(path).decode("utf-8-sig")  # Excel begins with a mark
    except UnicodeDecodeError:
        raise InputError("file", f"{path} cannot be read: it is not a text file in UTF-8") from None
    except InputError as error:
        raise InputError("file", f"{path} {error.problem}") from None
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = re.split(r"\s*[,;]\s*|\s+", line.partition("#")[0].strip())
        if words != [""]:
            found.append(Line(number, line.strip(), words))
    check_commas(path, (line.text.partition("#")[0] for line in found))
    return found


def _sections(path: Path, lines: list[Line]) -> dict[str, list[Line]]:
    """The rows of each section by its keyword; none if the file is not one of LAMMPS."""
    found: dict[str, list[Line]] = {}
    while len(lines) > 1 and lines[1].words[0] == "N" and lines[1].words[1:2] != []:
        size = lines[1].words[1]
        if not size.isdecimal() or len(lines) < 2 + int(size):
            raise InputError(
                "file", f"{path} must have as many rows as N in line {lines[1].number} says"
            )
        found[lines[0].words[0]] = lines[2 : 2 + int(size)]
        lines = lines[2 + int(size) :]
    if found and lines:
        raise InputError(
            "file", f"{path} has a row beyond N of its section in line {lines[0].number}"
        )
    return found


def _check_headings(path: Path, lines: list[Line]) -> None:
    """Refuse rows with more numbers than the headings above them.  Raises InputError.

    Headings may contain blanks, so that commas or semicolons have to separate them.
    """
    headings = lines[0]
    if re.search("[,;]", headings.text) and any(
        len(line.words) > len(headings.words) for line in lines[1:2]
    ):
        raise InputError(
            "file",
            f"{path} must have a heading for each column, got {len(headings.words)} headings and "
            f'{len(lines[1].words)} columns in "{lines[1].text}"; decimals need points',
        )


def _places(path: Path, columns: object, headings: list[str], count: int) -> list[int]:
    """The numbers, from 0, of the columns of distances and energies."""
    if columns is None:
        names = [re.sub(r"[(\[].*", "", heading).lower() for heading in headings]
        found = [_positions(names, known) for known in HEADINGS]
        if len(names) == count and all(len(each) == 1 for each in found):
            return [each[0] for each in found]
        if count == 2:
            return [0, 1]
        raise InputError(
            "columns",
            f"is missing: {path} has {count} columns; give the numbers or headings of those of "
            "distances and energies, as [1, 2]",
        )
    if not is_list(columns) or len(columns) != 2:
        raise must_be("columns", "two numbers or headings of columns", columns)
    return [_place(f"columns[{k}]", each, headings, count) for k, each in enumerate(columns)]


def _positions(names: list[str], known: Collection[str]) -> list[int]:
    """Where headings stand that are known for a column."""
    return [k for k, name in enumerate(names) if name in known]


def _place(field: str, column: object, headings: list[str], count: int) -> int:
    if isinstance(column, str) and headings.count(column) == 1:
        return headings.index(column)
    if isinstance(column, (int, np.integer)) and 1 <= column <= count:
        return int(column) - 1
    known = f", or one of {shortened(headings)}" if headings else ""
    raise must_be(field, f"a number from 1 to {count}{known}", column)


def _numbers(path: Path, line: Line, count: int) -> list[float]:
    if len(line.words) == count and all(map(_is_number, line.words)):
        return list(map(_float, line.words))
    wanted = "two" if count == 2 else str(count)
    raise InputError(
        "file",
        f'{path} must have {wanted} numbers in each line, got "{line.text}" in line {line.number}',
    )


def _float(word: str) -> float:
    """A number; 1.5D+03 is one of Fortran's."""
    return float(re.sub(r"(?<=[\d.])[dD](?=[+-]?\d)", "e", word))


def _is_number(word: str) -> bool:
    try:
        _float(word)
    except ValueError:
        return False
    return True
