"""Journals: what the integrations of a run reached, on disk while the run goes on.

A journal is a file of frames.  Each is the length of its content, a checksum of both, and arrays in
the format of numpy.savez.  The first frame says what is run.  A run is the same sequence of
integrations each time; each has frames of samples and of its time loop's memory.  A run that
resumes takes completed integrations from the journal and continues the last one.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import struct
import time
from dataclasses import dataclass, field, fields
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

import numpy as np

from tribo.files import NEW, checked_target, not_written
from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import Status
from tribo.ledger.samples import Samples
from tribo.ledger.sinks import StreamedLedger
from tribo.loops.integrate import Columns, Memory, Setting, TimeLoop
from tribo.loops.state import below
from tribo.model.identity import Identity, refuse_other
from tribo.system import OPEN_FILES_CAN_BE_REPLACED, lock, replace
from tribo.validation import InputError

Arrays = dict[str, np.ndarray]

# What follows the name of a file in the name of its journal.
PART = ".part"
# Length of the content, and checksum of both.
HEADER = struct.Struct("<Q16s")
# Seconds between two frames with the memory of a time loop: what a kill may cost.
INTERVAL = 1.0
# The same, in units of the time that the last such frame took.
RELATIVE_INTERVAL = 20.0
# Bytes of frames that later ones have replaced, after which the file is written again without.
MOST_REPLACED = 2**26


@dataclass
class Kept:
    """What a journal has of one integration."""

    key: bytes
    samples: list[Columns] = field(default_factory=list)
    # Of a streamed run, in place of samples: by the number of portions up to there.
    portions: dict[int, Arrays] = field(default_factory=dict)
    memory: Memory | None = None
    status: Status | None = None


class Journal:
    """The journal of a run; a context manager.

    Parameters
    ----------
    path : Path
        The file.
    identity : dict
        What is run; see :func:`tribo.model.identity.identity_of`.
    resume : bool
        Whether to continue what the file has, if there is one; else it is replaced by the first
        integration.

    Raises
    ------
    InputError
        The file is of another run, or cannot be read, or another process writes it.
    """

    def __init__(self, path: Path, identity: Identity, resume: bool) -> None:
        self.path = checked_target(str(path), path)
        self._identity = identity
        self._kept: list[Kept] = []
        self._number = 0  # of integrations that were begun or repeated
        self._file: BinaryIO | None = None
        self._end = 0  # of the frames
        # Offset and size of the frames that are needed; the key of one that a later one replaces.
        self._frames: dict[object, tuple[int, int]] = {}
        if resume and self.path.exists():
            self._open()
            self._read()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let other processes write the file."""
        if self._file is not None:
            self._file.close()

    def remove(self) -> None:
        """Remove the file, as the result is complete."""
        self.close()  # an open file cannot be removed on Windows
        self.path.unlink(missing_ok=True)

    def integration(self, key: bytes) -> Entry:
        """The next integration of the run; `key` identifies its settings.

        Raises InputError if the one in the journal has other settings, or the file cannot be
        written.
        """
        number = self._number
        self._number += 1
        if self._file is None:
            self._open()
        if self._end == 0:
            self._append("identity", {"identity": _bytes(json.dumps(self._identity))})
        if number == len(self._kept):
            self._kept.append(Kept(key))
            self._append(("key", number), {"number": np.array(number), "key": _bytes(key)})
        elif self._kept[number].key != key:
            raise InputError(
                str(self.path), "is of a run with other settings; start again without --resume"
            )
        return Entry(self, number, self._kept[number])

    def write(self, number: int, name: object, arrays: Arrays) -> None:
        """Append a frame of an integration; it replaces the last one of the same name.

        Raises InputError.
        """
        self._append((name, number), {"number": np.array(number)} | arrays)
        needed = sum(size for _, size in self._frames.values())
        if self._end - needed > max(MOST_REPLACED, needed):
            self._compact()

    def _open(self) -> None:
        """Open the file, for this process alone."""
        try:
            self.path.touch()
            self._file = open(self.path, "r+b", buffering=0)  # noqa: SIM115
            lock(self._file)
        except BlockingIOError:
            raise InputError(str(self.path), "is being written by another process") from None
        except OSError as error:
            raise not_written(self.path, error) from None

    def _append(self, name: object, arrays: Arrays) -> None:
        """Write a frame behind the others, over the rest of one that was not completed."""
        assert self._file is not None
        content = io.BytesIO()
        np.savez(content, **arrays)  # type: ignore[arg-type]
        frame = memoryview(_header(content.getvalue()) + content.getvalue())
        try:
            self._file.seek(self._end)
            written = 0
            while written < len(frame):
                written += self._file.write(frame[written:])
            self._file.truncate()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise not_written(self.path, error) from None
        self._frames[name] = (self._end, len(frame))
        self._end += len(frame)

    def _read(self) -> None:
        """Take in all frames up to one that was not completed."""
        assert self._file is not None
        identity = self._next_frame()
        if identity is None or "identity" not in identity:
            return  # stopped before its first frame was complete
        before = json.loads(identity["identity"].tobytes())
        refuse_other(self.path, before, json.loads(json.dumps(self._identity)))
        self._frames["identity"] = (0, self._end)
        start = self._end
        while (arrays := self._next_frame()) is not None:
            number = int(arrays["number"])
            if "key" in arrays:
                self._kept.append(Kept(arrays["key"].tobytes()))
            name = _take_in(self._kept[number], arrays)
            self._frames[name, number] = (start, self._end - start)
            start = self._end

    def _next_frame(self) -> Arrays | None:
        """The content of the next frame; None at the end, or where one is not complete."""
        assert self._file is not None
        self._file.seek(self._end)
        header = self._file.read(HEADER.size)
        if len(header) < HEADER.size:
            return None
        size = HEADER.unpack(header)[0]
        if size > os.fstat(self._file.fileno()).st_size:
            return None
        content = self._file.read(size)
        if _header(content) != header:
            return None
        self._end += HEADER.size + size
        with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
            return dict(arrays)

    def _compact(self) -> None:
        """Write the file again, without the frames that others have replaced."""
        assert self._file is not None
        old, frames = self._file, self._frames
        new = self.path.with_name(self.path.name + NEW)
        places, end = {}, 0
        try:
            with open(new, "wb") as file:
                for name, (offset, size) in frames.items():
                    old.seek(offset)
                    file.write(old.read(size))
                    places[name] = (end, size)
                    end += size
                file.flush()
                os.fsync(file.fileno())
            if not OPEN_FILES_CAN_BE_REPLACED:
                old.close()
            replace(new, self.path)
        except OSError as error:
            new.unlink(missing_ok=True)
            raise not_written(self.path, error) from None
        self._open()
        old.close()
        self._frames, self._end = places, end


class Entry:
    """One integration in a journal; :class:`tribo.loops.integrate.Checkpoints`."""

    def __init__(self, journal: Journal, number: int, kept: Kept) -> None:
        self._journal = journal
        self._number = number
        self._kept = kept
        self._done = 0  # samples that the journal has, or portions of a streamed run
        self._took = 0.0
        self._last = time.perf_counter()

    def restore(self, loop: TimeLoop, columns: Columns) -> Status | None:
        """Fill in what the journal has, if anything; the status of an integration that ended."""
        if self._kept.memory is None:
            return None
        for part in self._kept.samples:
            stop = self._done + len(part[0])
            for column, values in zip(columns, part, strict=True):
                column[self._done : stop] = values
            self._done = stop
        self._kept.samples = []
        loop.restore(self._kept.memory)
        return self._kept.status

    def due(self) -> bool:
        """Whether it is time to keep what was reached."""
        waited = time.perf_counter() - self._last
        return waited > max(INTERVAL, RELATIVE_INTERVAL * self._took)

    def keep(self, loop: TimeLoop, columns: Columns, status: Status | None) -> None:
        """Write the samples so far and the memory, and the status if the integration ended."""
        began = time.perf_counter()
        done = int(loop.clocks["sample"][0])
        if done > self._done:
            rows = {f"column_{k}": c[self._done : done] for k, c in enumerate(columns)}
            self._journal.write(self._number, ("samples", self._done), rows)
            self._done = done
        memory = {f"memory_{name}": array for name, array in loop.memory().items()}
        memory["status"] = _bytes(str(status or ""))
        self._journal.write(self._number, "memory", memory)
        self._last = time.perf_counter()
        self._took = self._last - began

    def restore_portions(
        self, loop: TimeLoop, streamed: StreamedLedger
    ) -> tuple[int, Samples | None]:
        """The same for a streamed run: the portions that were kept, and the last samples held."""
        memory = self._kept.memory
        if memory is None:
            return 0, None
        self._done = int(memory["portions"])
        chain, last = [], self._done  # a kill may have left portions without the memory after them
        while last > 0:
            chain.append(self._kept.portions[last])
            last = int(chain[-1]["first"])
        for arrays in reversed(chain):
            streamed.take_back(arrays)
        self._kept.portions = {}
        loop.restore(below("loop_", memory))
        return self._done, Samples(**below("held_", memory))

    def keep_portions(
        self, loop: TimeLoop, streamed: StreamedLedger, number: int, held: Samples
    ) -> None:
        """Write what a streamed run has taken in since the last call, after so many portions."""
        began = time.perf_counter()
        new = streamed.new_arrays() | {"first": np.array(self._done)}
        new = {f"portion_{name}": array for name, array in new.items()}
        new["portions"] = np.array(number)
        self._journal.write(self._number, ("portions", number), new)
        self._done = number
        memory = {f"memory_loop_{name}": array for name, array in loop.memory().items()}
        memory |= {f"memory_held_{each.name}": getattr(held, each.name) for each in fields(held)}
        memory |= {"memory_portions": np.array(number), "status": _bytes("")}
        self._journal.write(self._number, "memory", memory)
        self._last = time.perf_counter()
        self._took = self._last - began


def _take_in(kept: Kept, arrays: Arrays) -> object:
    """Add a frame to what is kept of its integration; returns the frame's name."""
    if "key" in arrays:
        return "key"
    if "status" in arrays:
        kept.memory = below("memory_", arrays)
        status = arrays["status"].tobytes().decode()
        kept.status = Status(status) if status else None
        return "memory"
    if "portions" in arrays:
        number = int(arrays["portions"])
        kept.portions[number] = below("portion_", arrays)
        return "portions", number
    columns = below("column_", arrays)
    name = ("samples", sum(len(part[0]) for part in kept.samples))
    kept.samples.append(tuple(columns[str(k)] for k in range(len(columns))))
    return name


def _header(content: bytes) -> bytes:
    """The header of a frame with that content."""
    size = struct.pack("<Q", len(content))
    return HEADER.pack(len(content), hashlib.blake2b(size + content, digest_size=16).digest())


def _bytes(text: str | bytes) -> np.ndarray:
    return np.frombuffer(text.encode() if isinstance(text, str) else text, np.uint8)


def key_of(setting: Setting, times: np.ndarray, start: np.ndarray) -> bytes:
    """What tells one integration of a scene from another."""
    digest = hashlib.blake2b(digest_size=16)
    for item in (*(setting if isinstance(setting, Tolerance) else (setting,)), times, start):
        digest.update(np.asarray(item, float).tobytes())
    return digest.digest()
