"""Where many runs go: memory and a file of frames while they are computed, and then their file."""

from __future__ import annotations

import json
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tribo import seals
from tribo.ensembles.kept_values import Kept, KeptValues, Tally, completed, joined
from tribo.ensembles.statistics import Moments
from tribo.files import (
    PART,
    append_netcdf,
    netcdf_attributes,
    netcdf_target,
    replace_netcdf,
    replaced,
    write_netcdf,
)
from tribo.interrupts import Interrupted
from tribo.kernels.status import Status
from tribo.loops.frames import Frames, as_bytes
from tribo.model.identity import Identity, refuse_other
from tribo.model.scene import Scene
from tribo.progress import Shown, reported
from tribo.validation import InputError, as_path, boolean

if TYPE_CHECKING:
    import xarray

# The attribute that says what a file is of.
IDENTITY = "identity"
# A frame of members, by the number of the first, and that of all sums.
CHUNK = "members"
SUMS = "sums"
# Bytes of covariances, above which statistics are refused; two such sums are in memory together.
MOST_BYTES = 2**29
# Members that are merged at once, at least: the merge of one costs as much as that of some 1000.
BLOCK = 1024


class Store(ABC):
    """Takes in members, in order from 0 on: `done` of them so far, and their `tally`.

    Frames take them about once a second, and have those of an earlier call; without frames members
    are in memory.  `common_level` is the level of most members; NaN where each has its own.
    """

    def __init__(self, frames: Frames | None, common_level: float = np.nan) -> None:
        self._frames = frames
        self._common_level = common_level
        self.done = 0
        self.tally = Tally()
        self._waiting: list[Any] = []  # what was taken in, and is not in frames or sums yet
        for _, arrays in () if frames is None else frames.read():
            self.take_back(arrays)

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
    def take_back(self, arrays: KeptValues) -> None:
        """Take in a frame of an earlier call."""

    def _count(self, found: KeptValues) -> None:
        self.done += found["status"].size
        self.tally.take_in(found, self._common_level)


class MemberStore(Store):
    def _take(self, found: KeptValues) -> None:
        self._waiting.append(found)

    def take_back(self, arrays: KeptValues) -> None:
        self._count(arrays)

    def flush(self) -> None:
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
        """Refuse covariances that memory would not hold, and begin with what the frames have."""
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
        """Let the values of complete members wait until there are enough to be merged."""
        complete = completed(found)
        kept = self._kept
        members = int(np.count_nonzero(complete))
        if not members:
            return
        parts = [
            found[name][complete].reshape(members, kept.times, kept.columns(name))
            for name in kept.names
        ]
        self._waiting.append(np.concatenate(parts, axis=2))
        if sum(map(len, self._waiting)) >= BLOCK:
            self._merged = self.moments()
            self._waiting = []

    def take_back(self, arrays: KeptValues) -> None:
        """Take in the state of an earlier call."""
        known = json.loads(arrays["known"].tobytes())
        self.done = known["done"]
        self.tally = Tally(known["tally"])
        self._waiting = [arrays["waiting"]] if "waiting" in arrays else []
        if "mean" in arrays:
            self._merged = Moments(*(arrays[each.name] for each in fields(Moments)))

    def flush(self) -> None:
        if self._frames is not None:
            self._frames.append(SUMS, self.state())

    def state(self) -> KeptValues:
        """All that a later call needs to go on."""
        arrays = {"known": as_bytes(json.dumps({"done": self.done, "tally": self.tally}))}
        if self._waiting:
            arrays["waiting"] = np.concatenate(self._waiting)
        if self._merged is not None:
            arrays |= vars(self._merged)
        return arrays

    def moments(self) -> Moments | None:
        """Those of all complete members so far; None without any."""
        values = np.concatenate(self._waiting) if self._waiting else np.empty(0)
        if not len(values):
            return self._merged
        block = Moments.of(values, self._merged)
        return block if self._merged is None else self._merged.merged(block)


class Target(NamedTuple):
    """The file of many runs, what it is of, and the frames beside it; None without a file."""

    path: Path | None
    identity: Identity  # empty without a file
    frames: Frames | None
    began: float  # when the call did
    scene: str  # its text

    def attributes(self, interrupted: bool, notes: Iterable[str]) -> dict[str, str | float]:
        """Those of the data sets of ensembles and sweeps; text is JSON where it is no word."""
        from tribo import __version__

        return {
            "tribo_version": __version__,
            "numpy_version": np.__version__,
            "scene": self.scene,
            "status": str(Status.INTERRUPTED if interrupted else Status.COMPLETED),
            "notes": json.dumps(list(notes)),
            "seconds": time.perf_counter() - self.began,
        }

    def saved(self, data: xarray.Dataset) -> xarray.Dataset:
        """The data set; if it is complete it is in its file too, in place of the frames."""
        if self.path is not None and data.attrs["status"] == Status.COMPLETED:
            data.attrs[IDENTITY] = json.dumps(self.identity)
            replace_netcdf(self.path, data, seals.sealed)
            assert self.frames is not None
            self.frames.remove()
        return data

    def saved_in_parts(self, parts: Iterable[xarray.Dataset]) -> xarray.Dataset:
        """Members that memory need not hold at once, from their file.  Raises InputError."""
        assert self.path is not None and self.frames is not None
        with replaced(self.path) as new:
            for data in parts:
                _append(new, data.assign_attrs({IDENTITY: json.dumps(self.identity)}))
            seals.seal(new)
        self.frames.remove()
        return opened(self.path, self.identity)


def _append(path: Path, data: xarray.Dataset) -> None:
    """Append members to a file; a part that begins with member 0 replaces the file."""
    first = int(data["member"][0])
    if first == 0:
        bytes_of_text = {"dtype": "S1"}  # a fixed number for each, in place of objects
        encoding = {"status": bytes_of_text}
        write_netcdf(data, path, unlimited_dims=["member"], encoding=encoding)
        return
    append_netcdf(path, data, "member", first)


def in_file(
    out: str | Path | None,
    resume: bool,
    scene: Scene,
    identify: Callable[[], Identity],
    progress: Shown,
    total: int,
    unit: str,
    compute: Callable[[Target, Callable[[float], None] | None], xarray.Dataset],
) -> xarray.Dataset:
    """The data set of many runs of a scene: from a complete file, or computed.

    Only a file needs to tell these runs from others.  Raises InputError, also if the scene has no
    text.
    """
    began = time.perf_counter()
    text = scene.to_toml()
    path = None if out is None else netcdf_target("out", as_path(out))
    if boolean("resume", resume) and path is None:
        raise InputError("resume", "needs out, the file to continue")
    with ExitStack() as stack, reported(progress, total, unit) as report:
        frames = None
        identity = Identity()
        if path is not None:
            identity = identify()
            part = path.with_name(path.name + PART)
            if resume and path.exists() and not part.exists():
                return opened(path, identity)
            frames = stack.enter_context(Frames(part, identity, resume))
        data = compute(Target(path, identity, frames, began, text), report)
    if data.attrs["status"] == Status.INTERRUPTED:
        raise Interrupted(data)
    return data


def opened(path: Path, identity: Identity) -> xarray.Dataset:
    """The data set in a file, read when it is used.  Raises InputError if it is something else."""
    import xarray

    before = _identity_in(path)
    if before is None:
        raise InputError(
            str(path),
            "is damaged, was written again by another program, or is no such file of this version; "
            "start again without resume",
        )
    refuse_other(path, before, json.loads(json.dumps(identity)))
    return xarray.open_dataset(path, engine="netcdf4")


def _identity_in(path: Path) -> Identity | None:
    """What a file is of; None if it has no seal, as its values have no checksums of their own."""
    try:
        with open(path, "rb") as stream:
            if not seals.is_sealed(stream, str(path)):
                return None
    except (OSError, InputError):
        return None
    text = netcdf_attributes(path).get(IDENTITY)
    return None if text is None else json.loads(text)
