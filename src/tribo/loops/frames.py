"""Append-only files of frames: what runs, ensembles and sweeps have computed, while they go on.

A frame is the length of its content, a checksum of both, and arrays in the format of numpy.savez,
one of which is its name: what Python writes for a text, a number, or tuples of these.
They follow the word `MAGIC`, and the first says what is computed.  A frame that was not completed,
or is damaged, ends the file: what follows is computed again.  A frame may replace an earlier one of
the same name; the file is written again without those, once they take more room than the others.
"""

import hashlib
import io
import json
import os
import struct
import time
from ast import literal_eval
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO, Self

import numpy as np

from tribo.files import NEW, checked_target, lock, not_written
from tribo.model.identity import Identity, refuse_other
from tribo.system import OPEN_FILES_CAN_BE_REPLACED, replace
from tribo.validation import InputError

Arrays = dict[str, np.ndarray]

# The first bytes of a file.
MAGIC = b"tribo\r\n\x1a"
# Length of the content, and checksum of both.
HEADER = struct.Struct("<Q16s")
# Seconds between two writes: what a kill may cost.
INTERVAL = 1.0
# The same, in units of the time that the last write took.
RELATIVE_INTERVAL = 20.0
# Bytes of frames that later ones have replaced, after which the file is written again without.
MOST_REPLACED = 2**26
# The name of the first frame, and of its array.
IDENTITY = "identity"
# Of the array with the name of a frame.
NAME = "frame"


class Frames:
    """A file of frames, of this process alone; a context manager.

    With `resume` it keeps the frames that the file has; else the first new frame replaces them.
    Raises InputError if the file is of another computation, cannot be read, or is in use.
    """

    def __init__(self, path: Path, identity: Identity, resume: bool) -> None:
        """Open the file, new or to resume.  Raises InputError if it is of another run."""
        self.path = checked_target(str(path), path)
        self._identity: Identity = json.loads(json.dumps(identity))
        self._end = len(MAGIC)  # of the frames
        # Offset and size of the frames that are needed, by their names.
        self._places: dict[object, tuple[int, int]] = {}
        self._due_from = time.perf_counter()
        self._took = 0.0  # to write all frames since then
        self._file = self._open()
        if resume:
            try:
                self._check_identity()
            except BaseException:
                self._file.close()
                raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        """Close the file, and remove one without any content."""
        if os.fstat(self._file.fileno()).st_size == 0:
            self.remove()
        self._file.close()

    def remove(self) -> None:
        """Remove the file, as the result is complete."""
        if not OPEN_FILES_CAN_BE_REPLACED:
            self._file.close()
        self.path.unlink(missing_ok=True)

    def read(self) -> Iterator[tuple[Any, Arrays]]:
        """The frames behind the first up to one that is not complete, each with its name."""
        while IDENTITY in self._places and (frame := self._next_frame()) is not None:
            yield frame

    def again(self, name: object) -> Arrays:
        """The content of a frame that was read or written before.  Raises InputError."""
        offset, size = self._places[name]
        frame = self._frame_at(offset)
        if frame is None:
            raise InputError(str(self.path), f"is damaged within {size} bytes from byte {offset}")
        return frame[1]

    @property
    def names(self) -> list[object]:
        """Of all frames but the first, in their order."""
        return [name for name in self._places if name != IDENTITY]

    def forget(self, names: Iterable[object]) -> None:
        for name in names:
            self._places.pop(name, None)

    def is_due(self) -> bool:
        """Whether it is time to write what was reached; the next time is counted from then."""
        now = time.perf_counter()
        due = now - self._due_from > max(INTERVAL, RELATIVE_INTERVAL * self._took)
        if due:
            self._due_from = now
            self._took = 0.0
        return due

    def append(self, name: object, arrays: Arrays) -> None:
        """Write a frame, which replaces the last one of the same name.  Raises InputError."""
        began = time.perf_counter()
        if IDENTITY not in self._places:
            self._write(IDENTITY, {IDENTITY: as_bytes(json.dumps(self._identity))})
        self._write(name, arrays)
        needed = sum(size for _, size in self._places.values())
        replaced = self._end - needed
        if OPEN_FILES_CAN_BE_REPLACED and replaced > max(MOST_REPLACED, needed):
            self._compact()
        self._took += time.perf_counter() - began

    def _open(self) -> BinaryIO:
        """Open the file, for this process alone; it is created if there is none."""
        while True:
            try:
                self.path.touch()
                file = open(self.path, "r+b", buffering=0)  # noqa: SIM115
            except OSError as error:
                raise not_written(self.path, error) from None
            lock(file, self.path)
            if self.path.exists() and os.path.samestat(os.fstat(file.fileno()), self.path.stat()):
                return file
            file.close()  # another process has removed it before this one had the lock

    def _check_identity(self) -> None:
        """Read the first frame.  Raises InputError about a file of something else."""
        self._file.seek(0)
        if not MAGIC.startswith(self._file.read(len(MAGIC))):
            raise InputError(str(self.path), "is no such file; start again without resume")
        first = self._next_frame()
        if first is not None:  # else the file was left before its first frame was complete
            refuse_other(self.path, json.loads(first[1][IDENTITY].tobytes()), self._identity)

    def _write(self, name: object, arrays: Arrays) -> None:
        """Write a frame behind the others, over the rest of one that was not completed."""
        content = io.BytesIO()
        np.savez(content, **arrays, **{NAME: as_bytes(repr(name))})  # type: ignore[arg-type]
        header = _header(content.getvalue())
        magic = b"" if self._places else MAGIC  # before the first frame
        frame = memoryview(magic + header + content.getvalue())
        begin = self._end - len(magic)
        try:
            self._file.seek(begin)
            written = 0
            while written < len(frame):
                written += self._file.write(frame[written:])
            self._file.truncate()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise not_written(self.path, error) from None
        self._places.pop(name, None)  # the order is that of the file
        self._places[name] = (self._end, begin + len(frame) - self._end)
        self._end = begin + len(frame)

    def _next_frame(self) -> tuple[Any, Arrays] | None:
        """The next frame, which replaces one of its name; None at the end of those complete."""
        frame = self._frame_at(self._end)
        begin = self._end
        if frame is not None:
            self._end = self._file.tell()
            self._places.pop(frame[0], None)  # the order is that of the file
            self._places[frame[0]] = (begin, self._end - begin)
        return frame

    def _frame_at(self, offset: int) -> tuple[Any, Arrays] | None:
        """The name and the content of a frame; None if it is not complete."""
        self._file.seek(offset)
        header = self._file.read(HEADER.size)
        if len(header) < HEADER.size:
            return None
        size = HEADER.unpack(header)[0]
        if size > os.fstat(self._file.fileno()).st_size:
            return None
        content = self._file.read(size)
        if _header(content) != header:
            return None
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            arrays = dict(file)
        name = arrays.pop(NAME, None)
        return None if name is None else (literal_eval(name.tobytes().decode()), arrays)

    def _compact(self) -> None:
        """Write the file again, without the frames that others have replaced."""
        new = self.path.with_name(self.path.name + NEW)
        places = {}
        end = len(MAGIC)
        try:
            file = open(new, "w+b", buffering=0)  # noqa: SIM115
            lock(file, new)  # before it has the name that others look for
            file.write(MAGIC)
            for name, (offset, size) in self._places.items():
                self._file.seek(offset)
                content = memoryview(self._file.read(size))
                while content:
                    content = content[file.write(content) :]
                places[name] = (end, size)
                end += size
            os.fsync(file.fileno())
            replace(new, self.path)
        except OSError as error:
            new.unlink(missing_ok=True)
            raise not_written(self.path, error) from None
        self._file.close()
        self._file = file
        self._places = places
        self._end = end


def _header(content: bytes) -> bytes:
    size = struct.pack("<Q", len(content))
    return HEADER.pack(len(content), hashlib.blake2b(size + content, digest_size=16).digest())


def as_bytes(text: str | bytes) -> np.ndarray:
    """A text, as an array that a frame can have."""
    return np.frombuffer(text.encode() if isinstance(text, str) else text, np.uint8)
