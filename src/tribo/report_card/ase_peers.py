"""Potentials compared with calculators of the Atomic Simulation Environment.

Energies are in eV, lengths in Angstrom and charges in e, as in ASE.  Two atoms take the positions
of two bobs of charge 1.

A. H. Larsen et al., J. Phys.: Condens. Matter 29 (2017) 273002.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from tribo.potentials import Coulomb, LennardJones, Morse
from tribo.report_card.agreement import check_same
from tribo.report_card.card import Check
from tribo.report_card.scan import PotentialScan
from tribo.validation import InputError

if TYPE_CHECKING:
    from ase.calculators.calculator import Calculator

# Number of distances at which energies and forces are compared.
DISTANCES = 40
# Largest distance compared [typical distance]: there, the energy at FAR, by which ASE shifts U, is
# below round-off.
WIDEST = 30.0
# Cutoff of a calculator that needs one [length of the potential]: beyond all distances compared.
FAR = 1e4


def coulomb(potential: Coulomb) -> Calculator:
    """Two ions whose charges give k_c q_1 q_2 = strength; k_c = e^2 / (4 pi eps0) [eV Angstrom]."""
    from ase.calculators.counterions import AtomicCounterIon, k_c

    q = np.sqrt(abs(potential.strength) / k_c)
    charges = [q, np.copysign(q, potential.strength)]
    return AtomicCounterIon(charges, epsilon=0.0, sigma=1.0, sites_per_mol=2, rc=FAR)


def lennard_jones(potential: LennardJones) -> Calculator:
    """epsilon and sigma as here; the energy is shifted to be zero at the cutoff."""
    from ase.calculators.lj import LennardJones as Peer

    return Peer(epsilon=potential.epsilon, sigma=potential.sigma, rc=FAR * potential.sigma)


def morse(potential: Morse) -> Calculator:
    """rho0 = alpha r0; between rcut1 and rcut2, in units of r0, the energy is smoothed to zero."""
    from ase.calculators.morse import MorsePotential

    depth, r0, rho0 = potential.D, potential.r0, potential.alpha * potential.r0
    return MorsePotential(epsilon=depth, r0=r0, rho0=rho0, rcut1=FAR, rcut2=2.0 * FAR)


PEERS: dict[type, Callable[..., Calculator]] = {
    Coulomb: coulomb,
    LennardJones: lennard_jones,
    Morse: morse,
}


def pair(
    calculator: Calculator, symbols: str | Sequence[str], r: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """A calculator's energy of two atoms [eV], and the force between them [eV / Angstrom]."""
    from ase import Atoms

    energies, forces = np.empty(r.size), np.empty(r.size)
    for k, x in enumerate(r):
        atoms = Atoms(symbols, positions=[[0.0, 0.0, 0.0], [x, 0.0, 0.0]], calculator=calculator)
        energies[k] = atoms.get_potential_energy()
        forces[k] = atoms.get_forces()[1, 0]
    return energies, forces


def check_ase(
    scan: PotentialScan, calculator: Calculator | None, symbols: str | Sequence[str]
) -> list[Check]:
    """Compare energy and force with the calculator, or with the potential's own in ASE."""
    if calculator is None:
        if type(scan.potential) not in PEERS:
            return []
        calculator = PEERS[type(scan.potential)](scan.potential)
    r = scan.r[scan.r < min(scan.cutoff, WIDEST * scan.length)]
    r = r[:: max(1, r.size // DISTANCES)]
    try:
        with np.errstate(all="ignore"):
            energy, force = pair(calculator, symbols, r)
    except Exception as error:
        name = type(calculator).__name__
        raise InputError(
            "ase", f"{name} fails for {symbols!r} ({type(error).__name__}: {error})"
        ) from None
    text = f"{type(calculator).__name__} of ASE, at {r.size} distances"
    return [check_same("ase", text, scan, r, scan.compiled(r), (energy, force))]
