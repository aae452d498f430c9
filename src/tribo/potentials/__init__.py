"""Interaction potentials: formulas, and potentials made from tables and calculators."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tribo.potentials.charges import Coulomb, Plummer, Yukawa
from tribo.potentials.combined import Scaled, Sum
from tribo.potentials.cutoff import ForceShifted, Shifted, Switched, Truncated
from tribo.potentials.dimers import from_dimer
from tribo.potentials.exponentials import BornMayer, Buckingham, Morse
from tribo.potentials.expression import expression
from tribo.potentials.from_ase import from_calculator
from tribo.potentials.inverse_powers import LennardJones, Mie, SoftSphere, WeeksChandlerAndersen
from tribo.potentials.potential import Potential, as_potential
from tribo.potentials.soft_cores import Gaussian, Hertz
from tribo.potentials.spline import Table, from_csv, from_points, tabulated
from tribo.potentials.tables import BUILT_IN, named

if TYPE_CHECKING:
    from ase.calculators.calculator import Calculator

__all__ = [
    "BUILT_IN",
    "BornMayer",
    "Buckingham",
    "Coulomb",
    "ForceShifted",
    "Gaussian",
    "Hertz",
    "LennardJones",
    "Mie",
    "Morse",
    "Plummer",
    "Potential",
    "Scaled",
    "Shifted",
    "SoftSphere",
    "Sum",
    "Switched",
    "Table",
    "Truncated",
    "WeeksChandlerAndersen",
    "Yukawa",
    "as_calculator",
    "as_potential",
    "expression",
    "from_calculator",
    "from_csv",
    "from_dimer",
    "from_points",
    "named",
    "tabulated",
]


def as_calculator(potential: object) -> Calculator:
    """A potential as a calculator of the Atomic Simulation Environment (ASE).

    Parameters
    ----------
    potential : Potential, NamedTuple or dict
        The potential between all atoms, or a mapping from two elements, as ("Cu", "O"), to the
        potential between them; its numbers are in eV and Angstrom.

    Returns
    -------
    ase.calculators.calculator.Calculator
        It computes energies [eV], forces [eV / Angstrom] and, in a cell, stresses
        [eV / Angstrom^3], with neighbour lists where the potential has a cutoff.

    Raises
    ------
    InputError
        If `potential` is no potential.
    """
    from tribo.potentials.to_ase import PairCalculator

    return PairCalculator(potential)
