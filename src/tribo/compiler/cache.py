"""Machine code on disk: used if it is whole and for the same arguments, else compiled again.

numba trusts the content of its files, and numbers them by an index that two processes can write at
the same time.  Here each combination of argument types has a file of its own, which holds these
types, and a checksum.
"""

import hashlib
import io
import pickle
import uuid
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numba

from tribo.compiler.numba_private import caching, pickled, rtsys
from tribo.system import replace

# Bytes of the checksum that a file begins with.
CHECKSUM = 32


class KernelCache(caching.FunctionCache):
    """Compiled forms of one function on disk.  Raises RuntimeError without a writable folder."""

    _cache_file: Any

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        self._cache_file = CodeFiles(self._cache_file)

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Load machine code, without what is needed to compile some.

        numba prepares for compilation first: it imports its implementations of numpy, and
        scipy.linalg, which takes as long as `import numba`.  Machine code calls functions of numba
        that manage memory and no others of these.
        """
        rtsys.initialize(target)
        return self._load_overload(signature, target)

    def has_file(self, signature: Any, target: Any) -> bool:
        """Whether there is a file for these types, which may not be whole."""
        return self._cache_file.path(self._index_key(signature, target.codegen())).exists()

    def _save_overload(self, signature: Any, data: Any) -> None:
        with suppress(OSError):  # the code is in memory; another process compiles it again
            super()._save_overload(signature, data)


class CodeFiles:
    """The files of one function, in place of numba's `IndexDataCacheFile`."""

    def __init__(self, files: caching.IndexDataCacheFile) -> None:
        self._folder = Path(files._cache_path)
        self._name = files._index_name.removesuffix(".nbi")
        self._made_by = (numba.__version__, files._source_stamp)

    def load(self, key: Any) -> Any:
        """The code for the argument types in `key`; None if there is none that is whole."""
        parts = whole_parts(self.path(key))
        try:
            if next(parts, None) != (self._made_by, key):
                return None
            return next(parts)
        except Exception:  # a class that it names is no longer there
            return None

    def save(self, key: Any, data: Any) -> None:
        """Write the code for the argument types in `key`.  Raises OSError."""
        content = pickled((self._made_by, key)) + pickled(data)
        path = self.path(key)
        new = path.with_name(f"{path.name}.{uuid.uuid4().hex}")
        try:
            new.write_bytes(_checksum(content) + content)
            replace(new, path)
        finally:
            new.unlink(missing_ok=True)

    def path(self, key: Any) -> Path:
        """The file for the argument types in `key`."""
        return self._folder / f"{self._name}.{_checksum(repr(key).encode()).hex()[:16]}.nbc"


def whole_parts(path: Path) -> Iterator[Any]:
    """What was written to a file, one after another; nothing if it is not whole."""
    try:
        content = path.read_bytes()
    except OSError:
        return
    if _checksum(content[CHECKSUM:]) != content[:CHECKSUM]:
        return
    stream = io.BytesIO(content[CHECKSUM:])
    while stream.tell() < len(content) - CHECKSUM:
        yield pickle.load(stream)


def _checksum(content: bytes) -> bytes:
    return hashlib.blake2b(content, digest_size=CHECKSUM).digest()
