"""Interaction potentials: one a file, formula and source first."""

from tribo.potentials.coulomb import Coulomb
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.morse import Morse
from tribo.potentials.plugin import BUILT_IN, as_potential, named

__all__ = ["BUILT_IN", "Coulomb", "LennardJones", "Morse", "as_potential", "named"]
