"""Where the members of an ensemble go while they are computed: memory, and a file of frames."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tribo.ensembles.kept_values import KeptValues, Tally
from tribo.loops.frames import INTERVAL, Frames
from tribo.model.identity import Identity

# A frame of members, by the number of the first.
CHUNK = "members"


class Target(NamedTuple):
    """The file of many runs, what it is of, and the frames beside it; None without a file."""

    path: Path | None
    identity: Identity
    frames: Frames | None


class MemberStore:
    """A store of all members: `done` of them, from 0 on.

    Frames take the members once a second, and have those of an earlier call; without frames members
    are in memory.
    """

    def __init__(self, frames: Frames | None) -> None:
        self._frames = frames
        self._waiting: list[KeptValues] = []
        self._written = time.perf_counter()
        self.done = 0
        for arrays in () if frames is None else frames.read():
            assert frames is not None
            frames.name_last((CHUNK, self.done))
            self.done += arrays["status"].size

    def add(self, found: KeptValues) -> None:
        """Take in the next members; they are on disk a second later."""
        self._waiting.append(found)
        self.done += found.status.size
        if self._frames is not None and time.perf_counter() - self._written > INTERVAL:
            self.flush()

    def flush(self) -> None:
        """Write the members that wait, if there is a file."""
        if self._frames is None or not self._waiting:
            return
        found = KeptValues.joined(self._waiting)
        self._frames.append((CHUNK, self.done - found.status.size), found.arrays())
        self._waiting.clear()
        self._written = time.perf_counter()

    def parts(self) -> Iterator[KeptValues]:
        """All members so far, in order."""
        if self._frames is not None:
            self.flush()
            for name in self._frames.names:
                yield KeptValues.of_arrays(self._frames.again(name))
        yield from self._waiting

    def values(self) -> KeptValues:
        """All members so far.  Raises KeyboardInterrupt if there are none."""
        if self.done == 0:
            raise KeyboardInterrupt
        return KeptValues.joined(list(self.parts()))

    def tally(self, common_level: float) -> Tally:
        """Counts of all members so far."""
        tally = Tally()
        for found in self.parts():
            tally.add(found, common_level)
        return tally
