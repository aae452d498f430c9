"""The file of a page: style, scripts and contents in one HTML document."""

from __future__ import annotations

import re
from html import escape
from importlib.resources import files
from pathlib import Path

from tribo.files import replace_file, strict_json
from tribo.results.run_result import RunResult
from tribo.validation import as_path
from tribo.viewer.contents import contents

# The scripts, in the order in which they need one another.
SCRIPTS = ("run.js", "drawing.js", "curves.js", "player.js")


def write_page(result: RunResult, path: str | Path, bath: bool = False) -> Path:
    """Write a page that plays a run.

    Parameters
    ----------
    result : RunResult
    path : str or Path
        The file, which is replaced if it exists.
    bath : bool
        Whether bath oscillators are drawn.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        The file cannot be written, or the result has no places to draw, or none of the bath
        oscillators that are asked for.
    """
    path = as_path(path)
    replace_file(path, document(result, bath).encode())
    return path


def document(result: RunResult, bath: bool = False) -> str:
    """The page as text."""
    parts = files("tribo.viewer").joinpath("parts")

    def part(name: str) -> str:
        return parts.joinpath(name).read_text(encoding="utf-8")

    held = contents(result, bath)
    # "<" would end the script that holds the data; JSON may write it as an escape.
    data = strict_json(held, None).replace("<", "\\u003c")
    filled = {
        "TITLE": escape(held["title"]),
        "STYLE": part("style.css"),
        "DATA": data,
        "SCRIPT": "\n".join(part(name) for name in SCRIPTS),
    }
    return re.sub(r"\[\[(\w+)\]\]", lambda found: filled[found[1]], part("page.html"))
