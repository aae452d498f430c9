"""The finished points of a sweep in FILE.part, one line of JSON each, behind a line on the sweep.

Lines are written one by one, so that an interrupted program leaves at most one line
unfinished, which is dropped when the sweep goes on.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from tribo.files import not_written, replace_file
from tribo.run.identity import plain_table, plugin_stamps, version
from tribo.run.journal import PART
from tribo.sweeps.grid import Grid
from tribo.sweeps.points import Found, Members
from tribo.validation import InputError


def identity_of(grid: Grid, names: Sequence[str], group: Members | None) -> str:
    """A hash of all that the numbers of a sweep depend on."""
    scene = grid.scene_before
    everything = {
        "version": version(),
        "scene": plain_table(scene),
        "plugins": plugin_stamps(scene),
        "values": grid.values,
        "names": list(names),
        "members": group and [group.number, group.seed, group.drawn(scene)],
    }
    text = json.dumps(everything, sort_keys=True)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


class Record:
    """The finished points of a sweep, in memory and in a file if there is one.

    Parameters
    ----------
    path : Path or None
        The file of the complete data set.
    identity : str
        Of the sweep.
    resume : bool
        Whether to take in the points that FILE.part has.

    Attributes
    ----------
    found : dict
        Number of a point -> what was found there.

    Raises
    ------
    InputError
        FILE.part is of another sweep, or cannot be written.
    """

    def __init__(self, path: Path | None, identity: str, resume: bool) -> None:
        self.found: dict[int, Found] = {}
        self._part = None if path is None else path.with_name(path.name + PART)
        if self._part is None:
            return
        lines = [json.dumps({"sweep": identity})]
        try:
            if resume and self._part.exists():
                lines += self._read(self._part, identity)
            replace_file(self._part, "".join(f"{line}\n" for line in lines).encode())
        except OSError as error:
            raise not_written(self._part, error) from None

    def _read(self, part: Path, identity: str) -> list[str]:
        """Take in the points of a file; their lines."""
        lines = part.read_bytes().decode("utf-8", "replace").split("\n")[:-1]
        if not lines or lines[0] != json.dumps({"sweep": identity}):
            raise InputError(
                str(part),
                "is of another sweep, or of another version of tribo; remove it, or give the scene "
                "and the options with which it began",
            )
        for line in lines[1:]:
            entry = json.loads(line)
            index = entry.pop("point")
            self.found[index] = Found(**entry)
        return lines[1:]

    def add(self, index: int, found: Found) -> None:
        """Keep what was found at a point."""
        self.found[index] = found
        if self._part is None:
            return
        try:
            with open(self._part, "a", encoding="utf-8") as file:
                file.write(json.dumps({"point": index, **asdict(found)}) + "\n")
        except OSError as error:
            raise not_written(self._part, error) from None

    def remove(self) -> None:
        """Remove the file, whose points the complete data set has."""
        if self._part is not None:
            self._part.unlink(missing_ok=True)
