"""Seals of NetCDF files: checksums behind their content, compared before a library parses it.

HDF5 ignores what follows the content of a file, and programs that write a file again leave the seal
out.  A file with a seal is therefore as tribo wrote it, or damaged.  Any other, as of version 0.2,
is first read in a process of its own, since the HDF5 library may run without end in a damaged file.
"""

import hashlib
import io
import struct
import subprocess
import sys
from pathlib import Path
from typing import BinaryIO

from tribo.validation import InputError

# What a seal begins with.
MAGIC = b"\r\n\x1atribo seal\r\n"
# Magic, length of the content, and its checksum.
SEAL = struct.Struct("<15sQ32s")
# The program that first reads a file; imported here, it would load the HDF5 library.
FIRST_READ = Path(__file__).with_name("first_read.py").resolve()
# Bytes that are read at once.
BLOCK = 2**20
# Most processor time of a first read without its bytes [s]; a file of 370 kB with 170 variables
# takes 0.1 s.
SECONDS = 0.3
# Bytes that a first read reads in a second of processor time, at least.
SPEED = 1.5e6
# Seconds in which a busy machine starts a first read.
START = 30.0
# Ratio of time to processor time on a busy machine.
BUSY = 20.0


def sealed(content: bytes) -> bytes:
    """The content of a file, with a seal behind it."""
    return content + _seal(io.BytesIO(content), len(content))


def seal(path: Path) -> None:
    """Add a seal to a file.  Raises OSError."""
    with open(path, "r+b") as file:
        size = file.seek(0, io.SEEK_END)
        mark = _seal(file, size)
        file.seek(size)
        file.write(mark)


def is_sealed(file: BinaryIO, name: str) -> bool:
    """Whether an open file has a seal.  Raises InputError if it is not that of its content."""
    size = file.seek(0, io.SEEK_END) - SEAL.size
    file.seek(max(size, 0))
    mark = file.read()
    if not mark.startswith(MAGIC):
        return False
    if mark != _seal(file, size):
        raise damaged(name)
    return True


def check(path: Path) -> None:
    """Compare a file with its seal, or else read it in another process.

    Raises InputError if it is damaged, and OSError.
    """
    with open(path, "rb") as file:
        known = is_sealed(file, str(path))
    if not known:
        check_readable(path)


def check_readable(path: Path) -> None:
    """Read all of a file in another process.  Raises InputError if that does not end well."""
    seconds = SECONDS + path.stat().st_size / SPEED
    command = [sys.executable, "-P", str(FIRST_READ), str(path.absolute()), str(seconds)]
    try:
        nothing = subprocess.DEVNULL
        subprocess.run(
            command,
            check=True,
            timeout=START + BUSY * seconds,
            stdin=nothing,
            stdout=nothing,
            stderr=nothing,
        )
    except subprocess.SubprocessError:
        raise damaged(str(path)) from None


def damaged(name: str, part: str = "it") -> InputError:
    return InputError(
        name,
        f"cannot be read: {part} is damaged, or the file is no result that this version of "
        "tribo has written (xarray.open_dataset reads data sets of ensembles and sweeps)",
    )


def _seal(file: BinaryIO, size: int) -> bytes:
    """The seal of the first bytes of an open file."""
    digest = hashlib.blake2b(digest_size=32)
    file.seek(0)
    left = size
    while left > 0 and (part := file.read(min(BLOCK, left))):
        digest.update(part)
        left -= len(part)
    return SEAL.pack(MAGIC, size, digest.digest())
