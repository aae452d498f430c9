"""Where the members of an ensemble go while they are computed: memory, and a file of frames."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator

import numpy as np

from tribo.ensembles.kept_values import KeptValues, Tally, joined
from tribo.loops.frames import Frames

# A frame of members, by the number of the first.
CHUNK = "members"


class Store(ABC):
    """Takes in members, in order from 0 on: `done` of them so far, and their `tally`.

    Frames take them about once a second, and have those of an earlier call; without frames members
    are in memory.  `common_level` is the level of most members; NaN where each has its own.
    """

    def __init__(self, frames: Frames | None, common_level: float = np.nan) -> None:
        self._frames, self._common_level = frames, common_level
        self.done, self.tally = 0, Tally()
        for _, arrays in () if frames is None else frames.read():
            self._take_back(arrays)

    def add(self, found: KeptValues) -> None:
        """Take in the next members; they are on disk a second later."""
        self._take(found)
        self._count(found)
        if self._frames is not None and self._frames.is_due():
            self.flush()

    @abstractmethod
    def flush(self) -> None:
        """Write what is not on disk yet, if there is a file."""

    @abstractmethod
    def _take(self, found: KeptValues) -> None:
        """Take in the values of members."""

    @abstractmethod
    def _take_back(self, arrays: KeptValues) -> None:
        """Take in a frame of an earlier call."""

    def _count(self, found: KeptValues) -> None:
        self.done += found["status"].size
        self.tally.take_in(found, self._common_level)


class MemberStore(Store):
    """A store that keeps all members."""

    def __init__(self, frames: Frames | None, common_level: float = np.nan) -> None:
        self._waiting: list[KeptValues] = []
        super().__init__(frames, common_level)

    def _take(self, found: KeptValues) -> None:
        self._waiting.append(found)

    def _take_back(self, arrays: KeptValues) -> None:
        self._count(arrays)

    def flush(self) -> None:
        """Write the members that wait, if there is a file."""
        if self._frames is None or not self._waiting:
            return
        found = joined(self._waiting)
        self._frames.append((CHUNK, self.done - found["status"].size), found)
        self._waiting.clear()

    def parts(self) -> Iterator[KeptValues]:
        """All members so far, in order."""
        if self._frames is not None:
            self.flush()
            for name in self._frames.names:
                yield self._frames.again(name)
        yield from self._waiting

    def values(self) -> KeptValues:
        """All members so far.  Raises KeyboardInterrupt if there are none."""
        if self.done == 0:
            raise KeyboardInterrupt
        return joined(list(self.parts()))
