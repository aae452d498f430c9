"""The finished points of a sweep in FILE.part, one line of JSON each, behind a line on the sweep.

Lines are written one by one, so that an interrupted program leaves at most one line
unfinished, which is dropped when the sweep goes on.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import BinaryIO, Self

from tribo.files import locked, not_written, replace_file
from tribo.loops.journal import PART
from tribo.model.identity import plain_table, plugin_stamps, version
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
    """The finished points of a sweep, in memory and in a file if there is one; a context manager.

    The file is locked for this sweep alone while it lasts.

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
        FILE.part is of another sweep, is damaged, cannot be written, or another sweep writes it.
    """

    def __init__(self, path: Path | None, identity: str, resume: bool) -> None:
        self.found: dict[int, Found] = {}
        self._file: BinaryIO | None = None
        self._part = None if path is None else path.with_name(path.name + PART)
        if self._part is None:
            return
        lines = [json.dumps({"sweep": identity})]
        with nullcontext() if not self._part.exists() else locked(self._part):
            if resume and self._part.exists():
                lines += self._read(self._part, identity)
            replace_file(self._part, "".join(f"{line}\n" for line in lines).encode())
            self._file = locked(self._part)
        self._file.seek(0, os.SEEK_END)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if self._file is not None:
            self._file.close()

    def _read(self, part: Path, identity: str) -> list[str]:
        """Take in the points of a file; their lines."""
        lines = part.read_bytes().decode("utf-8", "replace").split("\n")[:-1]
        if not lines or lines[0] != json.dumps({"sweep": identity}):
            raise InputError(
                str(part),
                "is of another sweep, or of another version of tribo; remove it, or give the scene "
                "and the options with which it began",
            )
        for number, line in enumerate(lines[1:], 2):
            try:
                entry = json.loads(line)
                index = int(entry.pop("point"))
                self.found[index] = Found(**entry)
            except (ValueError, KeyError, TypeError, AttributeError):
                raise InputError(
                    str(part), f"is damaged in line {number}; remove that line, to run its point"
                ) from None
        return lines[1:]

    def add(self, index: int, found: Found) -> None:
        """Keep what was found at a point."""
        self.found[index] = found
        if self._part is None or self._file is None:
            return
        try:
            self._file.write((json.dumps({"point": index, **asdict(found)}) + "\n").encode())
            self._file.flush()
        except OSError as error:
            raise not_written(self._part, error) from None

    def remove(self) -> None:
        """Remove the file, whose points the complete data set has."""
        if self._part is not None:
            self.__exit__()  # an open file cannot be removed on Windows
            self._part.unlink(missing_ok=True)
