"""Decimal commas in text files with columns of numbers, which are refused.

Columns may be separated by commas, so that 0,8 is 0 and 8 where nothing else tells.
"""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from tribo.validation import InputError, short_repr

# A number with a decimal comma, or two whole numbers with a comma between them.
COMMA = re.compile(r"[+-]?\d+(\.\d{3})*,(?P<decimals>\d+)([eEdD][+-]?\d+)?")
# A number without a comma.
PLAIN = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
# Decimals that cannot be a whole number: with a zero in front, or with ten digits and more.
DECIMALS = re.compile(r"0\d+|\d{10,}")


def check_commas(path: Path, lines: Iterable[str]) -> None:
    """Raise InputError about the lines of a file, without comments, if they have decimal commas."""
    found = decimal_comma([line.strip() for line in lines if line.strip()])
    if found is not None:
        raise InputError(
            "file",
            f"{path} must have decimal points, got a decimal comma in the line "
            f"{short_repr(found)}; write 0.5 for 0,5, or a heading for each column if it separates",
        )


def decimal_comma(lines: Sequence[str]) -> str | None:
    """A line with a decimal comma; None if commas may separate columns.

    A comma is a decimal one in "0,8;10,5" and "0,8 10,5", which have other separators.  In a file
    that has no other separators, it is one if some lines have no comma, if the only heading has
    none, or if its decimals cannot be a whole number, as in 0,05.
    """
    for line in lines:
        words = _words(line)
        if any(map(COMMA.fullmatch, words)) and (";" in line or _are_numbers(words)):
            return line
    has_heading = bool(lines) and not any(mark in lines[0] for mark in ",; \t")
    has_heading = has_heading and not PLAIN.fullmatch(lines[0])
    rows = lines[1:] if has_heading else lines
    found = [COMMA.fullmatch(line) for line in rows]
    if not all(match or PLAIN.fullmatch(line) for match, line in zip(found, rows, strict=True)):
        return None
    commas = [match for match in found if match]
    is_mixed = has_heading or len(commas) < len(rows)
    for match in commas:
        if is_mixed or DECIMALS.fullmatch(match["decimals"]):
            return match.string
    return None


def _words(line: str) -> list[str]:
    """What semicolons and blanks separate in a line; blanks beside a comma separate nothing."""
    joined = re.sub(r"\s*,\s*", ",", line.replace('"', ""))
    return [word for word in re.split(r"[;\s]+", joined) if word]


def _are_numbers(words: list[str]) -> bool:
    """Whether words are several numbers, with commas or points."""
    return len(words) > 1 and all(COMMA.fullmatch(w) or PLAIN.fullmatch(w) for w in words)
