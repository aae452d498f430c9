"""The sources of plug-ins: modules in files, and a hash that changes when the sources do."""

import ast
import functools
import hashlib
import importlib
import importlib.util
import inspect
import linecache
import os
import sys
import sysconfig
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from types import FunctionType, ModuleType
from typing import NamedTuple

from tribo.validation import InputError

# Folders of installed packages, in any environment.
INSTALLED = frozenset(("site-packages", "dist-packages"))
# Sources of the modules that were loaded here, as they were when they were loaded.
_LOADED: dict[str, bytes] = {}
# Modules that each of them found in the folder of its file, by their names.
_BESIDE: dict[str, dict[str, ModuleType]] = {}
# Sources of files that another process has sent, by their paths there.
_SENT: ContextVar[Mapping[str, bytes]] = ContextVar("sent", default={})  # noqa: B039


def module_in_file(path: Path) -> ModuleType:
    """Load the module in a file.  Raises InputError without a field."""
    try:
        path = path.resolve()
    except (OSError, ValueError):
        raise InputError("", f"must name a file, got {str(path)!r}") from None
    try:
        source = _SENT.get().get(str(path)) or path.read_bytes()
    except FileNotFoundError:
        raise InputError("", f"there is no file {path}") from None
    except OSError as error:
        raise InputError("", f"{path} cannot be read ({error.strerror or error})") from None
    try:
        return load(source, str(path))
    except (Exception, SystemExit) as error:
        raise InputError("", f"{path} cannot be loaded ({type(error).__name__}: {error})") from None


def module_named(name: str) -> ModuleType:
    """Import a module by its name.  Raises InputError without a field."""
    try:
        return importlib.import_module(name)
    except (Exception, SystemExit) as error:
        reason = f"{type(error).__name__}: {error}"
        raise InputError("", f'the module "{name}" cannot be loaded ({reason})') from None


def load(source: bytes, place: str) -> ModuleType:
    """Load a module from source, named by its hash for the disk cache; messages call it `place`."""
    label = hashlib.blake2b(place.encode() + source, digest_size=8).hexdigest()
    name = f"tribo_plugin_{label}"
    if name in sys.modules:
        return sys.modules[name]
    # Messages and derivatives of formulas read this source, also where the file is another one now,
    # or was when an earlier version of it was loaded.
    lines = importlib.util.decode_source(source).splitlines(keepends=True)
    linecache.cache[place] = (len(source), None, lines, place)
    spec = importlib.util.spec_from_loader(name, None, origin=place)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    module.__file__ = place
    sys.modules[name] = module
    try:
        with _importing_beside(Path(place).parent, name):
            exec(compile(source, place, "exec", dont_inherit=True), module.__dict__)
    except BaseException:
        del sys.modules[name]
        raise
    _LOADED[name] = source
    return module


def loaded_in(pickle: bytes) -> list[tuple[bytes, str]]:
    """What :func:`load` needs in another process before it reads a pickle: sources and places."""
    modules = [name for name in _LOADED if name.encode() in pickle]
    return [(_LOADED[name], str(sys.modules[name].__file__)) for name in modules]


@contextmanager
def _importing_beside(folder: Path, name: str) -> Iterator[None]:
    """Let the plug-in `name` import the files of its folder, as a script there can.

    Modules of the same names from folders of other plug-ins are set aside meanwhile.
    """

    def beside() -> dict[str, ModuleType]:
        modules = dict(sys.modules)
        heads = {each: modules.get(each.partition(".")[0]) for each in modules}
        return {each: modules[each] for each, head in heads.items() if _lies_in(head, folder)}

    names = {path.stem for path in folder.glob("*.py")}
    names |= {path.parent.name for path in folder.glob("*/__init__.py")}
    ours = beside()
    others = {
        each: module
        for each, module in dict(sys.modules).items()
        if each.partition(".")[0] in names and each not in ours and _is_of_a_user(module)
    }
    for each in others:
        del sys.modules[each]
    importlib.invalidate_caches()
    sys.path.insert(0, str(folder))
    try:
        yield
        _BESIDE[name] = beside()
    finally:
        sys.path.remove(str(folder))
        sys.modules.update(others)


def _lies_in(module: ModuleType | None, folder: Path) -> bool:
    """Whether a module is a file of a folder, or a package in it."""
    file = getattr(module, "__file__", None)
    if not file:
        return False
    # Not by Path, which takes 30 us for each of a thousand modules.
    own = os.path.dirname(os.path.normpath(str(file)))
    return str(folder) in (own or ".", os.path.dirname(own) or ".")


def _is_of_a_user(module: ModuleType) -> bool:
    file = getattr(module, "__file__", None)
    return bool(file) and not is_installed(str(file))


@contextmanager
def sent(sources: Mapping[str, bytes]) -> Iterator[None]:
    """Load the plug-ins in files from sources that another process has sent."""
    token = _SENT.set(sources)
    try:
        yield
    finally:
        _SENT.reset(token)


def to_send(classes: Iterable[type]) -> dict[str, bytes]:
    """The sources of classes that scene files name by a file, for a process that lacks it."""
    files = {place_of(cls): cls.__module__ for cls in classes if not is_own(cls)}
    return {
        file: _LOADED.get(module) or Path(file).read_bytes()
        for file, module in files.items()
        if file != module and not file.startswith("<")
    }


def place_of(cls: type) -> str:
    """The file that a class comes from, or its module if it is installed or in a package."""
    known = hasattr(sys.modules.get(cls.__module__), "__file__")
    file = inspect.getfile(cls) if known else None
    if file is None or cls.__module__.count("."):
        return cls.__module__
    loaded = cls.__module__ in _LOADED  # from this file, and its module has a name of no use
    return cls.__module__ if is_installed(file) and not loaded else file


def is_installed(file: str) -> bool:
    """Whether a file belongs to an installed package, or to Python itself.

    A project may lie in the folder of its environment, or beside it.
    """
    path = Path(file)
    libraries = {sysconfig.get_path(name) for name in ("stdlib", "platstdlib")}
    inside = any(path.is_relative_to(each) for each in libraries if each)
    return inside or not INSTALLED.isdisjoint(path.parts)


def is_importable(cls: type) -> bool:
    """Whether another process may find a class by its module and its name."""
    return cls.__module__ != "__main__" and "<locals>" not in cls.__qualname__


def source_stamp(plugins: list[NamedTuple], by_place: bool = False) -> str | None:
    """16 hex digits of a hash of the sources for each plug-in's class that is not this package's.

    None if one has no source that a later process could compare: it was typed in, is of a script,
    or was made by a function.  `by_place` gives the stamp of version 0.2, in which the same file
    has another stamp in each folder.
    """
    stamps = [_stamp_of(plugin, by_place) for plugin in plugins]
    return None if None in stamps else "".join(map(str, stamps))


def _stamp_of(plugin: NamedTuple, by_place: bool) -> str | None:
    """A digest of the source of a plug-in's class and of its parts; None if one is unknown."""
    cls = type(plugin)
    inner = source_stamp([item for item in plugin if hasattr(item, "_fields")], by_place)
    if is_own(cls) or inner is None:
        return inner
    sources: dict[str, bytes] = {}
    if is_importable(cls):
        _collect(sys.modules.get(cls.__module__), cls.__module__, sources)
    if not sources:
        return None
    # The name of a module that was loaded from a file contains a hash of its folder, and the file
    # may have been moved since.
    without_place = cls.__module__ in _LOADED and not by_place
    module = "" if without_place else f"{cls.__module__}."
    digest = hashlib.blake2b(f"{module}{cls.__qualname__}".encode(), digest_size=8)
    ordered = [sources[name] for name in sorted(sources)] if by_place else sorted(sources.values())
    for source in ordered:
        digest.update(source)
    return inner + digest.hexdigest()


def is_own(item: type | FunctionType) -> bool:
    """Whether a class or a function is this package's."""
    return item.__module__.startswith("tribo.")


def _collect(module: ModuleType | None, root: str, sources: dict[str, bytes]) -> None:
    """Add the sources of a module and its imports; of installed packages only those of `root`."""
    name = getattr(module, "__name__", "")
    place = getattr(module, "__file__", None)
    if module is None or place is None or name in sources or name.split(".")[0] == "tribo":
        return
    if is_installed(place) and name.split(".")[0] != root.split(".")[0]:
        return
    try:
        sources[name] = _LOADED[name] if name in _LOADED else Path(place).read_bytes()
    except OSError:
        return
    for imported in _imports(sources[name], module.__package__ or ""):
        found = _BESIDE.get(root, {}).get(imported, sys.modules.get(imported))
        _collect(found, root, sources)


def files_beside(file: Path) -> Iterator[Path]:
    """The files in the folder of a plug-in, and in packages there, that it imports, each once."""
    waiting = [file]
    found = {file}
    while waiting:
        each = waiting.pop()
        try:
            names = _imports(each.read_bytes(), "")
        except OSError:
            continue
        for name in names:
            place = file.parent.joinpath(*name.split("."))
            head = file.parent / name.partition(".")[0]
            files = [place.with_suffix(".py"), *head.rglob("*.py")]
            new = [path for path in files if path not in found and path.is_file()]
            found.update(new)
            waiting += new
            yield from new


@functools.cache
def _imports(source: bytes, package: str) -> tuple[str, ...]:
    """Full names of the modules that a source imports, and of the objects imported from them.

    Found once: every loop asks for the stamp of its plug-ins, also in threads, where ast.parse of
    Python 3.11 may fail.
    """
    try:
        tree = ast.parse(source)
    except (ValueError, SyntaxError):
        return ()
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
    return tuple(names)
