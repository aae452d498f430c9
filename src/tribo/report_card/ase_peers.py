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
from tribo.report_card.card import Check
from tribo.report_card.scan import PotentialScan
from tribo.validation import InputError

if TYPE_CHECKING:
    from ase.calculators.calculator import Calculator

# Largest acceptable difference, relative to the scale of the potential at that distance.
ROUND_OFF = 1e-12

# Number of distances at which energies and forces are compared.
DISTANCES = 40

# Largest distance compared [typical distance]: there, the energy at FAR, by which ASE shifts U, is
# below round-off.
WIDEST = 30.0

# Cutoff of a calculator that needs one [length of the potential]: beyond all distances compared.
FAR = 1e4


def coulomb(potential: Coulomb, rc: float | None = None) -> Calculator:
    """Two ions whose charges give k_c q_1 q_2 = strength; k_c = e^2 / (4 pi eps0) [eV Angstrom]."""
    from ase.calculators.counterions import AtomicCounterIon, k_c

    q = np.sqrt(abs(potential.strength) / k_c)
    charges = [q, np.copysign(q, potential.strength)]
    reach = FAR if rc is None else rc
    return AtomicCounterIon(charges, epsilon=0.0, sigma=1.0, sites_per_mol=2, rc=reach)


def lennard_jones(potential: LennardJones, rc: float | None = None) -> Calculator:
    """epsilon and sigma as here; the energy is shifted to be zero at rc."""
    from ase.calculators.lj import LennardJones as Peer

    reach = FAR * potential.sigma if rc is None else rc
    return Peer(epsilon=potential.epsilon, sigma=potential.sigma, rc=reach)


def morse(potential: Morse, rcut1: float | None = None, rcut2: float | None = None) -> Calculator:
    """rho0 = alpha r0; between rcut1 and rcut2, in units of r0, the energy is smoothed to zero."""
    from ase.calculators.morse import MorsePotential

    return MorsePotential(
        epsilon=potential.D,
        r0=potential.r0,
        rho0=potential.alpha * potential.r0,
        rcut1=FAR if rcut1 is None else rcut1,
        rcut2=2.0 * FAR if rcut2 is None else rcut2,
    )


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
        peer = PEERS.get(type(scan.potential))
        if peer is None:
            return []
        calculator = peer(scan.potential)
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
    ours = scan.compiled(r)
    scale = scan.scale(r)
    errors = np.maximum(np.abs(ours[0] - energy) / (scale * r), np.abs(ours[1] - force) / scale)
    worst = int(np.argmax(errors))
    return [
        Check(
            "ase",
            f"{type(calculator).__name__} of ASE, at {r.size} distances",
            float(errors[worst]),
            ROUND_OFF,
            float(r[worst]),
        )
    ]
