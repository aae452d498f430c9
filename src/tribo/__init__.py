"""Sliding friction from the asperite up: scenes, simulations and their ledgers."""

from __future__ import annotations

import importlib

# As in `typing`, whose import takes as long as all else before the program can be interrupted.
TYPE_CHECKING = False

if TYPE_CHECKING:  # "X as X" exports a name to type checkers
    from typing import Any

    from tribo import (
        paper as paper,
        plotting as plotting,
        potentials as potentials,
        units as units,
    )
    from tribo.ensembles import ensemble as ensemble, ensemble_member as ensemble_member
    from tribo.ensembles.swing_states import (
        Canonical as Canonical,
        EnergyBall as EnergyBall,
        Microcanonical as Microcanonical,
    )
    from tribo.explanation import Explanation as Explanation, explain as explain
    from tribo.model.asperite import Asperite as Asperite
    from tribo.model.bath import Bath as Bath
    from tribo.model.drives import (
        Custom as Custom,
        DrivenBars as DrivenBars,
        Ends as Ends,
        Forced as Forced,
        Free as Free,
        Pulled as Pulled,
        Pushed as Pushed,
    )
    from tribo.model.fields import Corrugation as Corrugation, Field as Field
    from tribo.model.initial import Initial as Initial
    from tribo.model.interaction import Interaction as Interaction, Periodic as Periodic
    from tribo.model.langevin import Langevin as Langevin
    from tribo.model.roughness import Roughness as Roughness
    from tribo.model.rows import (
        commensurate_rows as commensurate_rows,
        incommensurate_rows as incommensurate_rows,
        periodic_rows as periodic_rows,
    )
    from tribo.model.scene import Scene as Scene
    from tribo.model.scene_file import load_scene as load_scene
    from tribo.model.settings import Numerics as Numerics, Output as Output
    from tribo.model.spectrum import Spectrum as Spectrum
    from tribo.model.springs import Springs as Springs
    from tribo.model.surface import Surface as Surface
    from tribo.model.topography import Topography as Topography
    from tribo.potentials import (
        BornMayer as BornMayer,
        Buckingham as Buckingham,
        Coulomb as Coulomb,
        Gaussian as Gaussian,
        Hertz as Hertz,
        LennardJones as LennardJones,
        Mie as Mie,
        Morse as Morse,
        Plummer as Plummer,
        Potential as Potential,
        SoftSphere as SoftSphere,
        WeeksChandlerAndersen as WeeksChandlerAndersen,
        Yukawa as Yukawa,
    )
    from tribo.prepared import Simulation as Simulation
    from tribo.report_card import check as check
    from tribo.results.averages import Average as Average, time_average as time_average
    from tribo.results.exponential_average import (
        ExponentialAverage as ExponentialAverage,
        exponential_average as exponential_average,
    )
    from tribo.analysis.relax import NoEquilibriumError as NoEquilibriumError, relax as relax
    from tribo.result import Result as Result
    from tribo.result import load_result as load_result
    from tribo.loops.state import State as State
    from tribo.simulation import prepare as prepare, simulate as simulate
    from tribo.sliders import play as play
    from tribo.sweeps import sweep as sweep
    from tribo.validation import InputError as InputError, TriboWarning as TriboWarning

# The public names of each module, which is imported when one of them is first used.
_MODULES = {
    "analysis.relax": "NoEquilibriumError relax",
    "ensembles": "ensemble ensemble_member",
    "ensembles.swing_states": "Canonical EnergyBall Microcanonical",
    "explanation": "explain Explanation",
    "loops.state": "State",
    "model.asperite": "Asperite",
    "model.bath": "Bath",
    "model.drives": "Custom DrivenBars Ends Forced Free Pulled Pushed",
    "model.fields": "Corrugation Field",
    "model.initial": "Initial",
    "model.interaction": "Interaction Periodic",
    "model.langevin": "Langevin",
    "model.roughness": "Roughness",
    "model.rows": "commensurate_rows incommensurate_rows periodic_rows",
    "model.scene": "Scene",
    "model.scene_file": "load_scene",
    "model.settings": "Numerics Output",
    "model.spectrum": "Spectrum",
    "model.springs": "Springs",
    "model.surface": "Surface",
    "model.topography": "Topography",
    "potentials": (
        "BornMayer Buckingham Coulomb Gaussian Hertz LennardJones Mie Morse Plummer Potential "
        "SoftSphere WeeksChandlerAndersen Yukawa"
    ),
    "prepared": "Simulation",
    "report_card": "check",
    "result": "load_result Result",
    "results.averages": "Average time_average",
    "results.exponential_average": "exponential_average ExponentialAverage",
    "simulation": "prepare simulate",
    "sliders": "play",
    "sweeps": "sweep",
    "validation": "InputError TriboWarning",
}
_HOME = {name: f"tribo.{module}" for module, names in _MODULES.items() for name in names.split()}

# Public subpackages, imported when first used.
_SUBPACKAGES = ("paper", "plotting", "potentials", "units")

__all__ = [*_HOME, *_SUBPACKAGES, "__version__"]

# The one place of the version; pyproject.toml takes it from here.
__version__ = "0.2.0"


def __getattr__(name: str) -> object:
    if name in _SUBPACKAGES:
        return importlib.import_module(f"tribo.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'tribo' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
