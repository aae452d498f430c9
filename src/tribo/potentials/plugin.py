"""What makes a class a potential, and how one is found by its name.

A potential is a NamedTuple of floats with ``energy(self, r)``.  It may say more:

    force(self, r)   -dU/dr; otherwise the derivative is taken by a complex step, to round-off
    feature(self)    (length over which the force changes, distance out to which it is felt), by
                     which no step jumps an encounter; otherwise the force is taken to change on
                     the scale of r itself
    coupling(self, one, other)
                     what U is multiplied by for bobs of charges one and other, as one * other;
                     otherwise 1
"""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from tribo.checks import known_keys, number
from tribo.errors import InputError
from tribo.potentials.coulomb import Coulomb
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.morse import Morse

BUILT_IN: dict[str, Any] = {"coulomb": Coulomb, "morse": Morse, "lennard-jones": LennardJones}

TINY = 1e-100  # the complex step: its square is below round-off of anything


def _complex_step(self: Any, r: Any) -> Any:
    return -self.energy(r + 1e-100j).imag / 1e-100


def _no_feature(self: Any) -> Any:
    return 0.0, 0.0


def _no_coupling(self: Any, one: Any, other: Any) -> Any:
    return 1.0


DEFAULTS = {"force": _complex_step, "feature": _no_feature, "coupling": _no_coupling}


def complete(cls: Any) -> Any:
    """The class with all that kernels ask of a potential; a complaint if it is none."""
    name = getattr(cls, "__name__", repr(cls))
    if not (isinstance(cls, type) and issubclass(cls, tuple) and hasattr(cls, "_fields")):
        raise InputError("potential", f"{name} must be a NamedTuple whose fields are numbers")
    if not cls._fields:
        raise InputError("potential", f"{name} has no parameters; give it at least one field")
    if not callable(getattr(cls, "energy", None)):
        raise InputError("potential", f"{name} has no method energy(self, r)")
    for method, default in DEFAULTS.items():
        if not hasattr(cls, method):
            setattr(cls, method, default)
    return cls


def as_potential(value: Any) -> Any:
    """An instance whose class is complete and whose fields are finite numbers."""
    complete(type(value))
    fields = {key: number(key, item) for key, item in value._asdict().items()}
    return type(value)(**fields)


def named(name: Any, parameters: dict[str, Any], folder: Path) -> Any:
    """The potential that a scene file or a command line names, with its parameters.

    `name` is a built-in one's, or ``file.py:Class`` with the path relative to `folder`.
    """
    if not isinstance(name, str):
        raise InputError("potential", f"must be a name, got {name!r}")
    if ".py:" in name:
        cls = complete(_from_file(name, folder))
    elif name in BUILT_IN:
        cls = complete(BUILT_IN[name])
    else:
        known = ", ".join(f'"{k}"' for k in BUILT_IN)
        raise InputError("potential", f'must be {known} or "yourfile.py:YourClass", got {name!r}')
    required = [f for f in cls._fields if f not in cls._field_defaults]
    return as_potential(cls(**known_keys(parameters, cls._fields, required)))


def name_of(potential: Any) -> str:
    """The name by which `named` finds the potential's class again."""
    for name, cls in BUILT_IN.items():
        if type(potential) is cls:
            return name
    source = inspect.getsourcefile(type(potential))
    return f"{source}:{type(potential).__qualname__}"


def stamp(potential: Any) -> str:
    """Hash of the source that the potential's class comes from; empty for a built-in one."""
    cls = type(potential)
    if cls.__module__.startswith("tribo."):
        return ""
    try:
        source = Path(inspect.getsourcefile(cls) or "").read_bytes()
    except (OSError, TypeError):
        source = repr(cls).encode()
    return hashlib.blake2b(source + cls.__qualname__.encode(), digest_size=8).hexdigest()


def _from_file(name: str, folder: Path) -> Any:
    place, _, class_name = name.rpartition(":")
    path = (folder / place).resolve()
    try:
        module = _load(path)
    except FileNotFoundError:
        raise InputError("potential", f"there is no file {path}") from None
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise InputError("potential", f"{path} cannot be loaded ({reason})") from None
    if not hasattr(module, class_name):
        raise InputError("potential", f"{path} defines no {class_name}")
    return getattr(module, class_name)


def _load(path: Path) -> ModuleType:
    """The module in a file, under a name of its own by which the disk cache finds it again."""
    source = path.read_bytes()
    label = hashlib.blake2b(str(path).encode() + source, digest_size=8).hexdigest()
    name = f"tribo_plugin_{label}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        exec(compile(source, str(path), "exec"), module.__dict__)
    except BaseException:
        del sys.modules[name]
        raise
    return module
