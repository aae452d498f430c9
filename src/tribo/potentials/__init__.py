"""Interaction potentials: one a file, formula and source first."""

from tribo.potentials.coulomb import Coulomb
from tribo.potentials.cutoff import ForceShifted, Shifted, Switched, Truncated
from tribo.potentials.from_ase import live
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.morse import Morse
from tribo.potentials.registry import BUILT_IN, as_potential, with_cutoff

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
    "live",
    "with_cutoff",
]
