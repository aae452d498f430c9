"""Interaction potentials: one a file, formula and source first."""

from __future__ import annotations

from typing import Any

from tribo.potentials.born_mayer import BornMayer
from tribo.potentials.buckingham import Buckingham
from tribo.potentials.coulomb import Coulomb
from tribo.potentials.cutoff import ForceShifted, Shifted, Switched, Truncated
from tribo.potentials.dimers import from_dimer
from tribo.potentials.expression import expression
from tribo.potentials.from_ase import live
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.mie import Mie
from tribo.potentials.morse import Morse
from tribo.potentials.plummer import Plummer
from tribo.potentials.registry import BUILT_IN, as_potential, scaled, total, with_cutoff
from tribo.potentials.spline import Table, from_csv, from_points, tabulated
from tribo.potentials.sum import Scaled, Sum
from tribo.potentials.tables import named
from tribo.potentials.weeks_chandler_andersen import WeeksChandlerAndersen
from tribo.potentials.yukawa import Yukawa

__all__ = [
    "BUILT_IN",
    "BornMayer",
    "Buckingham",
    "Coulomb",
    "ForceShifted",
    "LennardJones",
    "Mie",
    "Morse",
    "Plummer",
    "Scaled",
    "Shifted",
    "Sum",
    "Switched",
    "Table",
    "Truncated",
    "WeeksChandlerAndersen",
    "Yukawa",
    "as_calculator",
    "as_potential",
    "expression",
    "from_csv",
    "from_dimer",
    "from_points",
    "live",
    "named",
    "scaled",
    "tabulated",
    "total",
    "with_cutoff",
]


def as_calculator(potential: Any) -> Any:
    """A potential as a calculator of the Atomic Simulation Environment, in eV and Angstrom.

    `potential` is for all atoms, or a mapping from two elements, as ("Cu", "O"), to the potential
    between them.  Energies, forces and stresses; with neighbour lists where there is a cutoff.
    Raises InputError.
    """
    from tribo.potentials.to_ase import PairCalculator

    return PairCalculator(potential)
