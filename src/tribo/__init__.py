"""tribo: sliding friction from the asperite up."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tribo.archive import load_result
    from tribo.asperite import Asperite
    from tribo.bath import Bath
    from tribo.drives import Custom, Ends, Forced, Free, Pulled
    from tribo.ensembles import ensemble
    from tribo.fields import Corrugation, Field
    from tribo.langevin import Langevin
    from tribo.potentials import (
        BornMayer,
        Buckingham,
        Coulomb,
        LennardJones,
        Mie,
        Morse,
        Plummer,
        WeeksChandlerAndersen,
        Yukawa,
        with_cutoff,
    )
    from tribo.result import Result
    from tribo.roughness import Roughness
    from tribo.rows import commensurate_rows, incommensurate_rows, periodic_rows
    from tribo.scene import Interaction, Numerics, Output, Periodic, Scene
    from tribo.scene_file import load_scene
    from tribo.simulation import Simulation, prepare, simulate
    from tribo.spectra import Spectrum
    from tribo.springs import Springs
    from tribo.surface import Initial, Surface
    from tribo.validation import InputError

__version__ = "0.1.0"

# Each public name and the module that has it; loaded when first used.
_HOME = {
    "Asperite": "tribo.asperite",
    "Bath": "tribo.bath",
    "BornMayer": "tribo.potentials",
    "Buckingham": "tribo.potentials",
    "commensurate_rows": "tribo.rows",
    "Corrugation": "tribo.fields",
    "Coulomb": "tribo.potentials",
    "Custom": "tribo.drives",
    "Ends": "tribo.drives",
    "ensemble": "tribo.ensembles",
    "Field": "tribo.fields",
    "Forced": "tribo.drives",
    "Free": "tribo.drives",
    "incommensurate_rows": "tribo.rows",
    "Initial": "tribo.surface",
    "InputError": "tribo.validation",
    "Interaction": "tribo.scene",
    "Langevin": "tribo.langevin",
    "LennardJones": "tribo.potentials",
    "load_result": "tribo.archive",
    "load_scene": "tribo.scene_file",
    "Mie": "tribo.potentials",
    "Morse": "tribo.potentials",
    "Numerics": "tribo.scene",
    "Output": "tribo.scene",
    "Periodic": "tribo.scene",
    "periodic_rows": "tribo.rows",
    "Plummer": "tribo.potentials",
    "prepare": "tribo.simulation",
    "Pulled": "tribo.drives",
    "Result": "tribo.result",
    "Roughness": "tribo.roughness",
    "Scene": "tribo.scene",
    "simulate": "tribo.simulation",
    "Simulation": "tribo.simulation",
    "Spectrum": "tribo.spectra",
    "Springs": "tribo.springs",
    "Surface": "tribo.surface",
    "WeeksChandlerAndersen": "tribo.potentials",
    "with_cutoff": "tribo.potentials",
    "Yukawa": "tribo.potentials",
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
