"""Sliding friction from the asperite up: scenes, simulations and their ledgers."""

import importlib
from itertools import pairwise

# The one place of the version; pyproject.toml takes it from here.
__version__ = "0.3.0"


def _homes(stub: str) -> dict[str, str]:
    """The module of each name, from statements as "from tribo.result import Result as Result"."""
    homes: dict[str, str] = {}
    for statement in stub.split("\nfrom ")[1:]:
        module, _, names = statement.partition(" import ")
        homes |= {name: module for name, word in pairwise(names.split()) if word == "as"}
    return homes


# The module of each public name, which is imported when the name is first used.
_HOME = _homes(__loader__.get_data(f"{__path__[0]}/__init__.pyi").decode())

__all__ = [*_HOME, "__version__"]


def __getattr__(name: str) -> object:
    """A public name, imported when it is first used."""
    if name not in _HOME:
        raise AttributeError(f"module 'tribo' has no attribute {name!r}")
    home = _HOME[name]
    if home == "tribo":  # a public subpackage
        return importlib.import_module(f"tribo.{name}")
    value = getattr(importlib.import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
