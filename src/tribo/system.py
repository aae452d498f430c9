"""What differs between operating systems: locks, open files, pipes of signals, cores."""

from __future__ import annotations

import os
import time

# As in `typing`, whose import would delay the answer to an interrupt.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from pathlib import Path
    from typing import BinaryIO

WINDOWS = os.name == "nt"
# Whether a file can be replaced or removed while a process has it open.
OPEN_FILES_CAN_BE_REPLACED = not WINDOWS
# The C function, without arguments, that lets another thread have the core.
YIELD = "SwitchToThread" if WINDOWS else "sched_yield"
# The byte that is locked on Windows, where others cannot read what is locked: behind every content.
LOCKED_BYTE = 2**42
# Seconds in which other programs of Windows, such as scanners, close a file that is to be replaced.
PATIENCE = 1.0
# Seconds between two attempts.
PAUSE = 0.02
# Bytes in the name of a file, where the system does not tell.
LONGEST_NAME = 255


def lock(file: BinaryIO) -> None:
    """Lock a file until it is closed or the process ends; BlockingIOError if it is locked."""
    if not WINDOWS:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return
    import msvcrt

    place = file.tell()
    file.seek(LOCKED_BYTE)
    try:
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined, unused-ignore]
    except PermissionError as error:
        raise BlockingIOError(*error.args) from None
    finally:
        file.seek(place)


def replace(new: Path, path: Path) -> None:
    """Give a new file the name of another, which it replaces at once or never.  Raises OSError."""
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return os.replace(new, path)
        except PermissionError:
            if OPEN_FILES_CAN_BE_REPLACED or time.monotonic() > end:
                raise
        time.sleep(PAUSE)


def pipe_of_signals() -> tuple[int, int]:
    """The reading and the writing end of a pipe for `signal.set_wakeup_fd`."""
    reader, writer = os.pipe()
    if not WINDOWS:  # Python 3.11 cannot do it there, and does not ask for it
        os.set_blocking(writer, False)
    return reader, writer


# The environment variable with the number of threads of a run.
THREADS_VARIABLE = "TRIBO_THREADS"


def allowed_cores() -> int:
    """Number of cores that this process may use, at most as many as TRIBO_THREADS says."""
    text = os.environ.get(THREADS_VARIABLE, "").strip()
    return min(available_cores(), int(text)) if text.isdecimal() else available_cores()


def available_cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):  # not on macOS and Windows
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def longest_name(folder: Path) -> int:
    """Bytes that the name of a file in a folder can have."""
    return LONGEST_NAME if WINDOWS else os.pathconf(folder, "PC_NAME_MAX")
