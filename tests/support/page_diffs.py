"""Diffs that pages of the developers' section show, applied to a copy of the package's sources."""

import re
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FILE = re.compile(r"^--- (\S+)\n\+\+\+ b/(\S+)\n", re.MULTILINE)
HUNK = re.compile(r"^@@ .*\n", re.MULTILINE)


def hunks(page):
    """The file of each hunk of the diffs on a page, and its text before and after."""
    text = (ROOT / "docs" / "developers" / f"{page}.md").read_text(encoding="utf-8")
    found = []
    for block in re.findall(r"^```text\n(--- .*?)^```$", text, re.MULTILINE | re.DOTALL):
        _, *parts = FILE.split(block)
        for before, file, body in zip(parts[::3], parts[1::3], parts[2::3], strict=True):
            for hunk in HUNK.split(body)[1:]:
                lines = hunk.splitlines(keepends=True)
                old = "".join(_text(line) for line in lines if line[0] != "+")
                new = "".join(_text(line) for line in lines if line[0] != "-")
                found.append((file, before == "/dev/null", old, new))
    return found


def applied(page, folder, reverse=False):
    """A copy of the sources in a folder with the diffs of a page; `reverse` takes them back.

    The text before each hunk must be in its file once.
    """
    shutil.copytree(ROOT / "src", folder / "src")
    return changed(page, folder, reverse)


def changed(page, folder, reverse=False):
    """The same in a folder that has a copy of the sources."""
    for file, is_new, old, new in hunks(page):
        path = folder / file
        if is_new and reverse:
            path.unlink()
        elif is_new:
            assert not path.exists()
            path.write_text(new, encoding="utf-8")
        else:
            before, after = (new, old) if reverse else (old, new)
            text = path.read_text(encoding="utf-8")
            assert text.count(before) == 1, (file, before)
            path.write_text(text.replace(before, after), encoding="utf-8")
    return folder / "src"


def files(page):
    """The files that the diffs of a page change."""
    return {file for file, *_ in hunks(page)}


def _text(line):
    """The line without its mark; an empty one has none."""
    return line if line == "\n" else line[1:]
