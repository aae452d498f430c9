"""Stamps of plug-ins: hashes that differ where code, or the values that it was compiled with, do.

Machine code has the stamp of bytecode and values, by which it is found on disk.  Results have that
of sources and values, which another version of Python can compare.
"""

import hashlib
import sys
from pathlib import Path
from typing import NamedTuple

from tribo.compiler.plugin_methods import frozen_of
from tribo.plugins import classes
from tribo.plugins.sources import is_importable, is_installed, is_own, source_stamp

# Between the stamp of the sources and that of the values.
AND_VALUES = "/"


def code_stamp_of(plugins: list[NamedTuple]) -> str | None:
    """16 hex digits for each plug-in's class that is not this package's, of all that is compiled.

    None if a later process could not compare: a class was typed in, is of a script, or was made by
    a function, or code refers to a value without a hash.
    """
    stamps = [_code_stamp(plugin) for plugin in plugins]
    return None if None in stamps else "".join(map(str, stamps))


def _code_stamp(plugin: NamedTuple) -> str | None:
    """What identifies the code of a plug-in in all processes; None where nothing does."""
    cls = type(plugin)
    inner = code_stamp_of([item for item in plugin if hasattr(item, "_fields")])
    if is_own(cls) or inner is None:
        return inner
    frozen = frozen_of(plugin)
    if not frozen.known or not is_importable(cls):
        return None
    return inner + _hash(f"{cls.__module__}.{cls.__qualname__} {frozen.stamp}".encode())


def version_of(plugins: list[NamedTuple]) -> str:
    """What tells plug-ins apart in this process, also those without a stamp."""
    parts = [(type(part), part) for plugin in plugins for part in classes.parts(plugin)]
    return "".join(frozen_of(part).stamp for cls, part in parts if not is_own(cls))


def stamp_of(plugin: NamedTuple) -> str | None:
    """That of the sources of a plug-in, and of the values with which it is compiled, if any.

    None if a later process could not compare the sources; empty for those of this package.
    """
    sources = source_stamp([plugin])
    values = _values_of(plugin) if sources else []
    return f"{sources}{AND_VALUES}{_hash(' '.join(values).encode())}" if values else sources


def is_same(before: str | None, now: str | None) -> bool:
    """Whether stamps may be of the same code; a stamp without values is compared by the sources."""
    if before is None:
        return True
    if now is not None and AND_VALUES not in before:
        now = now.partition(AND_VALUES)[0]
    return before == now


def is_unchanged(before: str | None, plugin: NamedTuple) -> bool:
    """Whether the code of a plug-in may be that of a stamp, which may be of version 0.2."""
    now = stamp_of(plugin)
    return is_same(before, now) or before == source_stamp([plugin], by_place=True)


def _values_of(plugin: NamedTuple) -> list[str]:
    """Hashes of values, and of the sources of functions of installed packages."""
    found = [each for item in plugin if hasattr(item, "_fields") for each in _values_of(item)]
    if is_own(type(plugin)):
        return found
    frozen = frozen_of(plugin)
    files = [getattr(sys.modules.get(name), "__file__", None) for name in frozen.modules]
    installed = [_hash(Path(file).read_bytes()) for file in files if file and is_installed(file)]
    return [*found, *filter(None, [frozen.values]), *installed]


def _hash(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=8).hexdigest()
