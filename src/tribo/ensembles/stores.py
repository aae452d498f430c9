"""Where the members of an ensemble go while they are computed: memory, and a file of frames."""

import json
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import numpy as np

from tribo.ensembles.kept_values import Kept, KeptValues, Tally, completed, joined
from tribo.ensembles.statistics import Moments
from tribo.loops.frames import Frames, as_bytes
from tribo.validation import InputError

# A frame of members, by the number of the first, and that of all sums.
CHUNK, SUMS = "members", "sums"
# Bytes of all covariances, above which statistics are refused: their sums and those of a block are
# in memory together.
MOST_BYTES = 2**29
# Members that are merged at once, at least: the merge of one costs as much as that of some 1000.
BLOCK = 1024


class Store(ABC):
    """Takes in members, in order from 0 on: `done` of them so far, and their `tally`.

    Frames take them about once a second, and have those of an earlier call; without frames members
    are in memory.  `common_level` is the level of most members; NaN where each has its own.
    """

    def __init__(self, frames: Frames | None, common_level: float = np.nan) -> None:
        self._frames, self._common_level = frames, common_level
        self.done, self.tally = 0, Tally()
        self._waiting: list[Any] = []  # what was taken in, and is not in frames or sums yet
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


class StatisticsStore(Store):
    """Accumulates statistics, no members.  Raises InputError if covariances are too many."""

    def __init__(self, kept: Kept, frames: Frames | None, common_level: float = np.nan) -> None:
        self._kept = kept
        self._merged: Moments | None = None
        columns = sum(map(kept.columns, kept.names))
        if 8 * kept.times * columns**2 > MOST_BYTES:
            raise InputError(
                "statistics",
                f"would keep covariances of {columns} values at {kept.times} times, more "
                "than memory holds; keep fewer quantities or times",
            )
        super().__init__(frames, common_level)

    def _take(self, found: KeptValues) -> None:
        complete = completed(found)
        shape = (np.count_nonzero(complete), self._kept.times, -1)
        parts = [found[name][complete].reshape(shape) for name in self._kept.names]
        self._waiting.append(np.concatenate(parts, axis=2))
        if sum(map(len, self._waiting)) >= BLOCK:
            self._merged, self._waiting = self.moments(), []

    def _take_back(self, arrays: KeptValues) -> None:
        known = json.loads(arrays["known"].tobytes())
        self.done, self.tally = known["done"], Tally(known["tally"])
        self._waiting = [arrays["waiting"]] if "waiting" in arrays else []
        if "mean" in arrays:
            self._merged = Moments(*(arrays[each.name] for each in fields(Moments)))

    def flush(self) -> None:
        """Write all sums, if there is a file."""
        if self._frames is None:
            return
        arrays = {"known": as_bytes(json.dumps({"done": self.done, "tally": self.tally}))}
        if self._waiting:
            arrays["waiting"] = np.concatenate(self._waiting)
        if self._merged is not None:
            arrays |= vars(self._merged)
        self._frames.append(SUMS, arrays)

    def moments(self) -> Moments | None:
        """Those of all complete members so far; None without any."""
        values = np.concatenate(self._waiting) if self._waiting else np.empty(0)
        if not len(values):
            return self._merged
        block = Moments.of(values, self._merged)
        return block if self._merged is None else self._merged.merged(block)
