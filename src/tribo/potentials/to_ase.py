"""Any potential as an ASE calculator, for ASE's tools: optimisers, dynamics, bulk structures.

    E = 1/2 sum_ij q_ij U(r_ij),   F_i = sum_j q_ij F(r_ij) (r_i - r_j)/r_ij,
    stress = 1/(2 V) sum_ij -q_ij F(r_ij) (r_ij x r_ij)/r_ij

over all pairs within the potential's range, periodic images included.  The potential's numbers are
in eV and Angstrom.  Charged potentials use the atoms' initial charges, in the unit in which
`strength` is an energy times a length.

A. H. Larsen et al., J. Phys.: Condens. Matter 29 (2017) 273002.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from ase import Atoms
from ase.calculators.calculator import Calculator, all_changes
from ase.neighborlist import neighbor_list
from ase.stress import full_3x3_to_voigt_6_stress

from tribo.potentials.potential import Potential, as_potential
from tribo.validation import InputError, must_be


class PairCalculator(Calculator):
    """A calculator of ASE for a potential between all atoms, or one for each pair of elements."""

    implemented_properties = ["energy", "energies", "free_energy", "forces", "stress"]  # noqa: RUF012

    def __init__(self, potential: object, **settings: Any) -> None:
        super().__init__(**settings)
        self._potentials = _by_elements(potential)

    def calculate(
        self,
        atoms: Any = None,
        properties: Sequence[str] = ("energy",),
        system_changes: Sequence[str] = all_changes,
    ) -> None:
        """Energy, energies of atoms [eV], forces [eV / Angstrom]; stresses if there is a cell."""
        super().calculate(atoms, properties, system_changes)
        atoms = self.atoms
        n = len(atoms)
        energies = np.zeros(n)
        forces = np.zeros((n, 3))
        virial = np.zeros((3, 3))
        i, j, d, r = self._pairs(atoms)
        names = np.array(atoms.get_chemical_symbols())
        both = np.sort([names[i], names[j]], axis=0)
        charges = atoms.get_initial_charges()
        for elements, potential in self._potentials.items():
            k = r < potential.range()
            if elements is not None:
                k &= np.all(both == np.sort(elements)[:, None], axis=0)
            pair = (r[k], charges[i[k]], charges[j[k]])
            pull = (potential.force_between(*pair) / r[k])[:, None] * d[k]
            np.add.at(energies, i[k], 0.5 * potential.energy_between(*pair))
            np.add.at(forces, i[k], -pull)
            virial -= 0.5 * pull.T @ d[k]
        self.results = {
            "energy": float(np.sum(energies)),
            "free_energy": float(np.sum(energies)),
            "energies": energies,
            "forces": forces,
        }
        if atoms.cell.rank == 3:
            self.results["stress"] = full_3x3_to_voigt_6_stress(virial / atoms.get_volume())

    def _pairs(self, atoms: Atoms) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Atoms i and j of all ordered pairs, r_j - r_i, and its length."""
        reach = max(potential.range() for potential in self._potentials.values())
        if math.isfinite(reach):
            i, j, d, r = neighbor_list("ijDd", atoms, reach)
            return i, j, d, r
        if np.any(atoms.pbc):
            raise InputError("potential", "needs a cutoff for periodic atoms; see .with_cutoff")
        i, j = np.nonzero(~np.eye(len(atoms), dtype=bool))
        d = atoms.positions[j] - atoms.positions[i]
        return i, j, d, np.linalg.norm(d, axis=1)


def _by_elements(potential: object) -> dict[tuple[str, str] | None, Potential]:
    """Potentials by the two elements between which they act; None for all elements."""
    if not isinstance(potential, Mapping):
        return {None: as_potential(potential)}
    table: dict[tuple[str, str] | None, Potential] = {}
    for key, item in potential.items():
        if not isinstance(key, tuple) or len(key) != 2:
            raise must_be("potential", 'a mapping with keys of two elements, as ("Cu", "O")', key)
        table[key] = as_potential(item)
    return table
