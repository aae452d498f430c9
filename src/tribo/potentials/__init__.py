"""Interaction potentials: one a file, formula and source first."""

from tribo.potentials.born_mayer import BornMayer
from tribo.potentials.buckingham import Buckingham
from tribo.potentials.coulomb import Coulomb
from tribo.potentials.cutoff import ForceShifted, Shifted, Switched, Truncated
from tribo.potentials.expression import expression
from tribo.potentials.from_ase import live
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.mie import Mie
from tribo.potentials.morse import Morse
from tribo.potentials.plummer import Plummer
from tribo.potentials.registry import BUILT_IN, as_potential, scaled, total, with_cutoff
from tribo.potentials.sum import Scaled, Sum
from tribo.potentials.table import Table, from_csv, from_points, tabulated
from tribo.potentials.weeks_chandler_andersen import WeeksChandlerAndersen
from tribo.potentials.written import named
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
    "as_potential",
    "expression",
    "from_csv",
    "from_points",
    "live",
    "named",
    "scaled",
    "tabulated",
    "total",
    "with_cutoff",
]
