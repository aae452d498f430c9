"""Interaction potentials: one a file, formula and source first."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tribo.potentials.coulomb import Coulomb
from tribo.potentials.cutoff import ForceShifted, Shifted, Switched, Truncated
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.morse import Morse
from tribo.potentials.registry import BUILT_IN, as_potential, with_cutoff

if TYPE_CHECKING:
    from tribo.report_card import Report

__all__ = [
    "BUILT_IN",
    "Coulomb",
    "ForceShifted",
    "LennardJones",
    "Morse",
    "Shifted",
    "Switched",
    "Truncated",
    "as_potential",
    "check",
    "with_cutoff",
]


def check(potential: Any, ase: Any = None, symbols: Any = "H2") -> Report:
    """A report card: everything that a run relies on in a potential, checked and graded.

    `ase` is a calculator of the Atomic Simulation Environment to compare with, in eV and Angstrom,
    on two atoms named by `symbols`; Coulomb, LennardJones and Morse have theirs.  The card is
    printed by ``print``, and has ``passed``, ``checks``, ``to_json()`` and ``save_figure(path)``.
    Raises InputError for what is no potential, or does not compile.
    """
    from tribo.report_card import report

    return report(potential, ase, symbols)
