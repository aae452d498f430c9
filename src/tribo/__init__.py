"""tribo: sliding friction from the asperite up."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tribo.archive import load_result
    from tribo.asperite import Asperite
    from tribo.drives import Forced, Free, Pulled
    from tribo.errors import InputError
    from tribo.potentials import Coulomb, LennardJones, Morse
    from tribo.result import Result
    from tribo.scene import Interaction, Numerics, Output, Scene
    from tribo.scene_file import load_scene
    from tribo.simulation import Simulation, prepare, simulate
    from tribo.surface import Initial, Surface

__version__ = "0.1.0"

# Each public name and the module that has it; loaded when first used.
_HOME = {
    "Asperite": "tribo.asperite",
    "Coulomb": "tribo.potentials",
    "Forced": "tribo.drives",
    "Free": "tribo.drives",
    "Initial": "tribo.surface",
    "InputError": "tribo.errors",
    "Interaction": "tribo.scene",
    "LennardJones": "tribo.potentials",
    "Morse": "tribo.potentials",
    "Numerics": "tribo.scene",
    "Output": "tribo.scene",
    "Pulled": "tribo.drives",
    "Result": "tribo.result",
    "Scene": "tribo.scene",
    "Simulation": "tribo.simulation",
    "Surface": "tribo.surface",
    "load_result": "tribo.archive",
    "load_scene": "tribo.scene_file",
    "prepare": "tribo.simulation",
    "simulate": "tribo.simulation",
}

__all__ = [*_HOME, "__version__"]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'tribo' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
