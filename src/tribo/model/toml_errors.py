"""What to do about text that is not TOML: the parser names a place, this the line and its mend."""

import re

from tribo.validation import short_repr

# Where the parser says that it failed.
PLACE = re.compile(r"\(at line (\d+), column \d+\)")
# What a value or a line contains that is not TOML, and what to write; the first that fits counts.
MENDS = (
    (r"[\u2018-\u201f\u00ab\u00bb]", 'write straight quotes, as "coulomb"'),
    (r"[\u2010-\u2015\u2212]", "write the minus as a hyphen, -"),
    (r"^\[[^\]]*\]?$", "close the brackets of a heading, as [output] and [[surface]]"),
    (r"^(//|%)", "begin a comment with #"),
    (r"^[^=]*$", "write KEY = VALUE"),
    (r"=.*[\w\"\]]\s+[\w.]+\s*=", "write each key in a line of its own"),
    (r"=\s*[+-]?[\d.]*\d,\d+\s*$", "write decimals with a point, as 0.5"),
    (r";\s*$", "leave out the semicolon at the end"),
    (r"(?<![\w.])\.\d", "write a digit before the point, as 0.5"),
    (r"\d\.(?![\d.])", "write a digit after the point, as 1.0"),
    (r"(?i)=\s*(true|false|inf|nan)\s*$", "write true, false, inf and nan in small letters"),
    (
        r"=\s*[+-]?\d[\d.]*([eE][+-]?\d+)?\s*[^\W\d_]+\S*\s*$",
        "write the number without its unit",
    ),
    (r"=\s*[^\W\d]\S*\s*$", 'write words in quotes, as "coulomb"'),
    (r"=\s*$", "write a value behind ="),
)
# Tables of which a scene file may have several.
SEVERAL = ("surface", "field", "interaction")


def toml_problem(error: Exception, text: str) -> str:
    """The problem of a text that the parser refused: its message, the line, and what to write."""
    problem = f"is not valid TOML: {error}"
    place = PLACE.search(str(error))
    lines = text.split("\n")
    if place is None or not 0 < int(place[1]) <= len(lines):
        return problem
    line = lines[int(place[1]) - 1].strip()
    mend = _mend(line)
    if "overwrite" in str(error):
        mend = "write each key once"
        if line.startswith("[["):
            mend = f"write {line} for the first too"
    return f"{problem}; the line is {short_repr(line)}" + (f"; {mend}" if mend else "")


def _mend(line: str) -> str:
    """What to write instead of a line, or "" if that is not known."""
    header = re.fullmatch(r"\[\s*([\w.]+)\s*\]", _without_comment(line))
    if header is not None and header[1] in SEVERAL:
        return f"write [[{header[1]}]] for each {header[1]}"
    if header is not None:
        return "write each table once"
    without_words = re.sub(r'"[^"]*"', '""', _without_comment(line))
    found = (mend for pattern, mend in MENDS if re.search(pattern, without_words))
    return next(found, "")


def _without_comment(line: str) -> str:
    return re.sub(r"\s*#.*", "", line) if line.count('"') % 2 == 0 else line
