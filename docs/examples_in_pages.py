"""The code in the pages is run when they are built, and must print what they say it prints.

A page's ``python`` blocks are one program.  A ``text`` block right after one of them is what that
one prints.  A ``toml`` block is a scene file that must load; if its first line is a comment with
a name, it is written under that name where the program runs.
"""

import contextlib
import io
import os
import re
from pathlib import Path

from tribo import load_scene

BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
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
                if printed.rstrip() != text.rstrip():
                    raise AssertionError(f"{page.name} says\n{text}\nbut its code prints\n{printed}")
                printed = None
            elif language == "toml":
                _load(text, folder)


def _load(text: str, folder: Path) -> None:
    named = NAMED.match(text)
    file = folder / (named[1] if named else "scene.toml")
    file.write_text(text, encoding="utf-8")
    load_scene(file)
