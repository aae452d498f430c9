"""Plug-ins: NamedTuples of numbers with methods, from Python or from a user's file.

Potentials, fields, drives and the forces on bars' ends are all of this kind.  numba types a
NamedTuple by its class, finds its methods when a kernel is compiled, and inlines them.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import inspect
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from tribo.checks import known_keys, number
from tribo.errors import InputError


def check_class(cls: Any, field: str, method: str) -> None:
    """Complain, about `field`, if a class is not a plug-in that has `method`."""
    name = getattr(cls, "__name__", repr(cls))
    if not (isinstance(cls, type) and issubclass(cls, tuple) and hasattr(cls, "_fields")):
        raise InputError(field, f"{name} must be a NamedTuple whose fields are numbers")
    if not cls._fields:
        raise InputError(field, f"{name} has no parameters; give it at least one field")
    if not callable(getattr(cls, method.partition("(")[0], None)):
        raise InputError(field, f"{name} has no method {method}")


def with_numbers(value: Any) -> Any:
    """The same plug-in with its fields as finite floats."""
    return type(value)(**{key: number(key, item) for key, item in value._asdict().items()})


def instance(cls: Any, parameters: dict[str, Any]) -> Any:
    """The class with its parameters, which a file or a command line names."""
    required = [f for f in cls._fields if f not in cls._field_defaults]
    return cls(**known_keys(parameters, cls._fields, required))


def class_in_file(field: str, name: str, folder: Path) -> Any:
    """The class that ``file.py:Class`` names, the path being relative to `folder`."""
    place, _, class_name = name.rpartition(":")
    try:
        path = (folder / place).resolve()
    except (OSError, ValueError):
        raise InputError(field, f"must name a file, got {name!r}") from None
    try:
        module = _load(path)
    except FileNotFoundError:
        raise InputError(field, f"there is no file {path}") from None
    except (Exception, SystemExit) as error:
        reason = f"{type(error).__name__}: {error}"
        raise InputError(field, f"{path} cannot be loaded ({reason})") from None
    if not hasattr(module, class_name):
        raise InputError(field, f"{path} defines no {class_name}")
    return getattr(module, class_name)


def name_of(plugin: Any, built_in: dict[str, Any]) -> str:
    """The name by which a scene file finds the plug-in's class again."""
    for name, cls in built_in.items():
        if type(plugin) is cls:
            return name
    source = inspect.getsourcefile(type(plugin))
    return f"{source}:{type(plugin).__qualname__}"


def stamp(plugin: Any) -> str:
    """Hash of the sources that a plug-in's classes come from; empty for those of this package."""
    cls = type(plugin)
    inner = "".join(stamp(item) for item in plugin if hasattr(item, "_fields"))
    if is_own(cls):
        return inner
    digest = hashlib.blake2b(f"{cls.__module__}.{cls.__qualname__}".encode(), digest_size=8)
    sources: dict[str, bytes] = {}
    _collect_sources(sys.modules.get(cls.__module__), sources)
    for place in sorted(sources):
        digest.update(sources[place])
    if not sources:
        digest.update(repr(cls).encode())
    return inner + digest.hexdigest()


def is_own(cls: type) -> bool:
    """Whether a class is this package's."""
    return cls.__module__.startswith("tribo.")


def _collect_sources(module: ModuleType | None, sources: dict[str, bytes]) -> None:
    """The source of a user's module, and of all of the user's own that it imports from."""
    place = getattr(module, "__file__", None)
    name = getattr(module, "__name__", "")
    installed = place is None or place.startswith((sys.prefix, sys.base_prefix))
    if module is None or installed or place in sources or name.split(".")[0] == "tribo":
        return
    try:
        sources[str(place)] = Path(str(place)).read_bytes()
    except OSError:
        return
    for node in ast.walk(ast.parse(sources[str(place)])):
        if isinstance(node, ast.ImportFrom):
            _collect_sources(sys.modules.get(node.module or ""), sources)
        elif isinstance(node, ast.Import):
            for alias in node.names:
                _collect_sources(sys.modules.get(alias.name), sources)


def _load(path: Path) -> ModuleType:
    """The module in a file, under a name of its own by which the disk cache finds it again."""
    source = path.read_bytes()
    label = hashlib.blake2b(str(path).encode() + source, digest_size=8).hexdigest()
    name = f"tribo_plugin_{label}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        exec(compile(source, str(path), "exec"), module.__dict__)
    except BaseException:
        del sys.modules[name]
        raise
    return module
