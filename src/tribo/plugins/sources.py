"""Where classes of the user's own come from, and a stamp that changes when their sources do."""

from __future__ import annotations

import ast
import hashlib
import importlib
import importlib.util
import inspect
import linecache
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from tribo.validation import InputError

_LOADED: dict[str, bytes] = {}  # the sources of modules that were loaded here, as they were then


def module_in_file(path: Path) -> ModuleType:
    """The module in a file; a complaint without a field if there is none, or it fails."""
    try:
        path = path.resolve()
    except (OSError, ValueError):
        raise InputError("", f"must name a file, got {str(path)!r}") from None
    try:
        return load(path.read_bytes(), str(path))
    except FileNotFoundError:
        raise InputError("", f"there is no file {path}") from None
    except (Exception, SystemExit) as error:
        raise InputError("", f"{path} cannot be loaded ({type(error).__name__}: {error})") from None


def module_named(name: str) -> ModuleType:
    """The module of that name, as an import statement would find it; complaints as above."""
    try:
        return importlib.import_module(name)
    except (Exception, SystemExit) as error:
        reason = f"{type(error).__name__}: {error}"
        raise InputError("", f'the module "{name}" cannot be loaded ({reason})') from None


def load(source: bytes, place: str) -> ModuleType:
    """The module that a source makes, under a name of its own by which the disk cache finds it.

    `place` is what its lines are said to be of: a file, or a made-up name in angle brackets.
    """
    label = hashlib.blake2b(place.encode() + source, digest_size=8).hexdigest()
    name = f"tribo_plugin_{label}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_loader(name, None, origin=place)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    module.__file__ = place
    sys.modules[name] = module
    try:
        exec(compile(source, place, "exec", dont_inherit=True), module.__dict__)
    except BaseException:
        del sys.modules[name]
        raise
    _LOADED[name] = source
    if place.startswith("<"):
        lines = source.decode().splitlines(keepends=True)
        linecache.cache[place] = (len(source), None, lines, place)
    return module


def place_of(cls: type) -> str:
    """The file that a class is loaded from, or the module where that is the way to it."""
    known = hasattr(sys.modules.get(cls.__module__), "__file__")
    file = inspect.getfile(cls) if known else None
    if file is None or cls.__module__.count(".") or file.startswith(sys.prefix):
        return cls.__module__
    return file


def stamp(plugins: list[Any]) -> str | None:
    """Hash of the sources that plug-ins' classes come from; empty if all are this package's.

    None where a class has no source that a later process could compare with its own: one that was
    typed in, defined in a script that is run, or made by a function.
    """
    stamps = [_stamp(plugin) for plugin in plugins]
    return None if None in stamps else "".join(map(str, stamps))


def _stamp(plugin: Any) -> str | None:
    cls = type(plugin)
    inner = stamp([item for item in plugin if hasattr(item, "_fields")])
    if is_own(cls) or inner is None:
        return inner
    sources: dict[str, bytes] = {}
    if cls.__module__ != "__main__" and "<locals>" not in cls.__qualname__:
        _collect(sys.modules.get(cls.__module__), cls.__module__, sources)
    if not sources:
        return None
    digest = hashlib.blake2b(f"{cls.__module__}.{cls.__qualname__}".encode(), digest_size=8)
    for name in sorted(sources):
        digest.update(sources[name])
    return inner + digest.hexdigest()


def is_own(cls: type) -> bool:
    """Whether a class is this package's."""
    return cls.__module__.startswith("tribo.")


def _collect(module: ModuleType | None, root: str, sources: dict[str, bytes]) -> None:
    """The source of the module `root`, and of all of the user's own that it imports from.

    Installed packages are left out, but for the one that `root` is in.
    """
    name = getattr(module, "__name__", "")
    place = getattr(module, "__file__", None)
    if module is None or place is None or name in sources or name.split(".")[0] == "tribo":
        return
    installed = place.startswith((sys.prefix, sys.base_prefix))
    if installed and name.split(".")[0] != root.split(".")[0]:
        return
    try:
        sources[name] = _LOADED[name] if name in _LOADED else Path(place).read_bytes()
        tree = ast.parse(sources[name])
    except (OSError, ValueError, SyntaxError):
        return
    for imported in _imports(tree, module.__package__ or ""):
        _collect(sys.modules.get(imported), root, sources)


def _imports(tree: ast.AST, package: str) -> list[str]:
    """Full names of the modules that a source imports, and of what it imports from them."""
    names = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            start = "." * node.level + (node.module or "")
            try:
                base = importlib.util.resolve_name(start, package)
            except ImportError:
                continue
            names += [base, *(f"{base}.{alias.name}" for alias in node.names)]
    return names
