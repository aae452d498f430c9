"""Stamps of this package's sources: other sources make other machine code, and other results."""

import functools
import hashlib
from pathlib import Path

# Sources that machine code is made of: those of kernels, methods and potentials, and of the field
# that is built in.
COMPILED = ("compiler", "kernels", "integrators", "lanes", "pair", "potentials", "model/fields.py")


def is_stamped(module: str) -> bool:
    """Whether the sources of a module, by its full name, are in :func:`code_stamp`."""
    places = [f"tribo.{place.removesuffix('.py').replace('/', '.')}" for place in COMPILED]
    return any(module == place or module.startswith(f"{place}.") for place in places)


@functools.cache
def code_stamp() -> str:
    """Hash of the sources of this package that are compiled [16 hex digits]."""
    return stamp_of(COMPILED)


@functools.cache
def package_stamp() -> str:
    """Hash of all sources of this package [16 hex digits]."""
    return stamp_of((".",))


def stamp_of(places: tuple[str, ...]) -> str:
    """Hash of the sources of this package in some folders and files [16 hex digits]."""
    digest = hashlib.blake2b(digest_size=8)
    root = Path(__file__).resolve().parents[1]
    paths = set()
    for place in places:
        if place.endswith(".py"):
            paths.add(root / place)
        for kind in ("*.py", "*.json"):
            paths.update((root / place).rglob(kind))
    for path in sorted(path for path in paths if path.parent.name != "__pycache__"):
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()
