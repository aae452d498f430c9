"""The code in the pages is run when they are built, and must print what they say it prints.

A page's ``python`` blocks are one program.  A ``text`` block right after one of them is what that
one prints, but for the last digit of a number and the size of what is round-off (below 1e-9).
A ``toml`` block is a scene file that must load; if its first line is a comment with
a name, it is written under that name where the program runs.
"""

import contextlib
import io
import os
import re
from pathlib import Path

from tribo import load_scene

BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"(-?\d+(?:\.\d+)?(?:e[-+]\d+)?)")
ROUND_OFF = 1e-9
NAMED = re.compile(r"# (\S+\.toml)$", re.MULTILINE)


def run(page: Path, folder: Path) -> None:
    """Run a page's program in a folder; raise if anything is not as the page says."""
    names: dict[str, object] = {"__name__": "__main__"}
    printed = None
    with contextlib.chdir(folder):
        os.environ.setdefault("MPLBACKEND", "Agg")
        for language, text in BLOCK.findall(page.read_text(encoding="utf-8")):
            if language == "python":
                with contextlib.redirect_stdout(io.StringIO()) as out:
                    exec(compile(text, str(page), "exec"), names)
                printed = out.getvalue()
            elif language == "text" and printed is not None:
                if not _same(printed.rstrip(), text.rstrip()):
                    raise AssertionError(f"{page.name} says\n{text}but its code prints\n{printed}")
                printed = None
            elif language == "toml":
                _load(text, folder)


def _same(printed: str, said: str) -> bool:
    """Whether two texts are the same, and their numbers nearly so."""
    one, other = NUMBER.split(printed), NUMBER.split(said)
    return one[::2] == other[::2] and all(map(_near, one[1::2], other[1::2]))


def _near(one: str, other: str) -> bool:
    a, b = float(one), float(other)
    unit = 10.0 ** -len(other.partition("e")[0].partition(".")[2])
    return abs(a - b) <= 1.1 * unit * ("." in other) or max(abs(a), abs(b)) < ROUND_OFF


def _load(text: str, folder: Path) -> None:
    named = NAMED.match(text)
    file = folder / (named[1] if named else "scene.toml")
    file.write_text(text, encoding="utf-8")
    load_scene(file)
