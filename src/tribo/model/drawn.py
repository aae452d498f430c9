"""Parameters of asperites that are drawn from distributions, or read from files of columns.

Both become numbers, one for each asperite, when a surface is made: scenes, files and results have
the numbers.
"""

import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tribo import validation as check
from tribo.decimal_commas import check_commas
from tribo.files import read_file
from tribo.validation import InputError, known_keys, must_be

# Distributions, what their two numbers are, and how they are drawn.
Draw = Callable[[np.random.Generator, float, float, int], np.ndarray]
DISTRIBUTIONS: dict[str, tuple[str, Draw]] = {
    "normal": ("[mean, standard deviation]", lambda rng, a, b, n: rng.normal(a, b, n)),
    "lognormal": (
        "[median, standard deviation of the logarithm]",
        lambda rng, a, b, n: a * np.exp(rng.normal(0.0, b, n)),
    ),
    "uniform": ("[low, high]", lambda rng, a, b, n: rng.uniform(a, b, n)),
}
# The key of a file, and those beside it.
FILE = "file"


def is_distribution(value: object) -> bool:
    """Whether a value is the table of a distribution."""
    return isinstance(value, Mapping) and bool(value) and FILE not in value


def drawn(field: str, table: Mapping[str, Any], name: str, count: int) -> np.ndarray:
    """Numbers for `count` asperites of the surface `name`, as of {normal = [2.0, 0.2], seed = 1}.

    Surfaces and parameters with one seed have draws of their own.
    """
    with check.inside(field):
        given = known_keys(table, (*DISTRIBUTIONS, "seed"))
        seed = check.integer("seed", given.pop("seed", 0), 0)
        if len(given) != 1:
            raise must_be("", f"one of {', '.join(DISTRIBUTIONS)}, and a seed", dict(table))
        ((kind, numbers),) = given.items()
        meaning, draw = DISTRIBUTIONS[kind]
        if not check.is_list(numbers) or len(numbers) != 2:
            raise must_be(kind, meaning, numbers)
        a, b = check.vector(kind, numbers).tolist()
        if kind == "uniform" and b < a:
            raise InputError(kind, f"must be {meaning}, got [{a:g}, {b:g}]")
        if kind != "uniform" and b < 0.0:
            raise InputError(f"{kind}[1]", f"must not be negative, got {b:g}")
        if kind == "lognormal" and a <= 0.0:
            raise InputError("lognormal[0]", f"must be positive, got {a:g}")
    entropy = [seed, zlib.crc32(name.encode()), zlib.crc32(field.encode())]
    return np.asarray(draw(np.random.default_rng(entropy), a, b, count))


def is_column(value: object) -> bool:
    """Whether a value is the table of a column of a file."""
    return isinstance(value, Mapping) and FILE in value


def column(table: Mapping[str, Any], folder: Path) -> list[float]:
    """The numbers of a column, as of {file = "strengths.csv", column = "charge"}.

    A file has a row for each asperite, in the order of the surface; columns are separated by
    commas, semicolons or blanks, and are named by headings in the first row, or numbered from 1.
    Decimals have points; a comma between two whole numbers separates columns, as in 0,5.
    """
    given = known_keys(table, (FILE, "column"))
    path = folder / check.as_path(given[FILE])
    content = read_file(path)
    if b"\0" in content:
        raise InputError(
            FILE,
            f"must be a text file with columns, got {path}, which is not text; "
            '{topography = "scan.npy"} reads heights of other formats',
        )
    text = content.decode("utf-8-sig", errors="replace")
    lines = [line.split("#")[0].strip() for line in text.splitlines()]
    check_commas(path, lines)
    separator = next((mark for mark in (",", ";") if any(mark in line for line in lines)), None)
    rows = [[word.strip().strip('"') for word in line.split(separator)] for line in lines if line]
    if not rows:
        raise InputError(FILE, f"{path} has no rows")
    headings = [] if _is_number(rows[0][0]) else rows.pop(0)
    filled = [k for k, word in enumerate(rows[0], start=1) if word] if rows else []
    if separator and headings and filled and filled[-1] > len(headings):
        raise InputError(
            FILE,
            f"{path} must have a heading for each column, got {len(headings)} headings and "
            f"{len(rows[0])} columns in the first row; decimals need points",
        )
    place = _place(given.get("column"), headings, rows)
    found = []
    for i, row in enumerate(rows):
        if place >= len(row) or not _is_number(row[place]):
            what = row[place] if place < len(row) else "nothing"
            raise InputError(FILE, f"{path}: row {i + 1} must have a number, got {what!r}")
        found.append(float(row[place]))
    return found


def _place(given: object, headings: list[str], rows: list[list[str]]) -> int:
    """The place of a column in each row."""
    if isinstance(given, str):
        return headings.index(check.choice("column", given, headings or [""]))
    width = max(len(headings), *(len(row) for row in rows), 1)
    if given is None:
        if width > 1:
            raise InputError(
                "column",
                f"is missing; the file has {width} columns: the first row is "
                f"{check.shortened(rows[0])}",
            )
        return 0
    return check.integer("column", given, 1, width) - 1


def _is_number(word: str) -> bool:
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False


def with_columns(table: Any, folder: Path) -> Any:
    """A table of asperites with numbers in place of columns of files in a folder."""
    if not isinstance(table, Mapping):
        return table
    found = dict(table)
    for key, value in table.items():
        if is_column(value):
            with check.inside(str(key)):
                found[key] = column(value, folder)
    return found


def with_draws(table: Any, name: str, count: int) -> Any:
    """A table of asperites with numbers in place of distributions, and of columns of files."""
    if not isinstance(table, Mapping):
        return table
    found = with_columns(table, Path())
    drawn_values = {
        key: drawn(str(key), value, name, count)
        for key, value in found.items()
        if is_distribution(value)
    }
    return {**found, **drawn_values}
