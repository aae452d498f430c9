"""One potential computed in several ways: arrays, compiled code, charges exchanged, and ASE.

Calculators of the Atomic Simulation Environment have energies in eV, lengths in Angstrom and
charges in e.  Two atoms take the positions of two bobs of charge 1.

A. H. Larsen et al., J. Phys.: Condens. Matter 29 (2017) 273002.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from tribo.potentials import Coulomb, LennardJones, Morse
from tribo.report_card.card import Check
from tribo.report_card.derivatives import BOUND, TRUSTED, derivative, reach_of
from tribo.report_card.scan import PotentialScan
from tribo.validation import InputError

if TYPE_CHECKING:
    from ase.calculators.calculator import Calculator

# Largest acceptable difference, relative to the scale of the potential at that distance.
ROUND_OFF = 1e-12
# Distances at which charges are exchanged, and calculators called; and two charges.
DISTANCES = 40
CHARGES = (0.7, -1.3)
# Charges between which force and energy are compared too.
OTHER_CHARGES = (1.0, -1.0), (-1.0, -1.0), CHARGES, (0.0, 1.0), (2.0, 0.5)
# Errors are of other charges alone where they exceed those of the scan's own so many times.
TWICE = 2.0
# Largest distance compared [typical distance]: there, the energy at FAR, by which ASE shifts U, is
# below round-off.
WIDEST = 30.0
# Cutoff of a calculator that needs one [length of the potential]: beyond all distances compared.
FAR = 1e4


def check_agreement(scan: PotentialScan) -> list[Check]:
    """Compare arrays and compiled code with the potential's methods, one distance at a time."""
    r = scan.everywhere
    r = r[r < scan.cutoff]
    single = [scan.one_by_one(method, r) for method in scan.methods]
    note = ""
    try:
        with np.errstate(all="ignore"):
            found = (np.asarray(method(r, *scan.charges), float) for method in scan.methods)
            arrays = [np.broadcast_to(values, r.shape) for values in found]
    except Exception as error:
        note = f"takes no arrays ({type(error).__name__}); np.where and np.maximum do"
        arrays = single
    text = f"values for one r at a time, at {r.size} distances"
    compared = replace(check_same("arrays", text, scan, r, single, arrays), note=note)
    return [
        compared,
        check_same("compiled", text, scan, r, single, _compiled_like(scan, r, single)),
    ]


def _compiled_like(
    scan: PotentialScan, r: np.ndarray, single: Sequence[np.ndarray]
) -> list[np.ndarray]:
    """Compiled values, without the difference that the rounding of a distance makes at a jump.

    Compiled code computes r from two positions.  At a jump of the Python values, the compiled one
    may be that of the next floating-point number on either side.
    """
    scale = scan.scale(r)
    like = []
    for method, python, compiled, unit in zip(
        scan.methods, single, scan.compiled(r), (scale * r, scale), strict=True
    ):
        with np.errstate(all="ignore"):
            rounded = np.abs(compiled - python) / unit > ROUND_OFF
        found = compiled.copy()
        for side in (0.0, np.inf):
            beside = scan.one_by_one(method, np.nextafter(r[rounded], side))
            with np.errstate(all="ignore"):
                same = np.abs(compiled[rounded] - beside) / unit[rounded] <= ROUND_OFF
            found[rounded] = np.where(same, python[rounded], found[rounded])
        like.append(found)
    return like


def check_third_law(scan: PotentialScan) -> Check:
    """Check that energy and force stay the same if two charges are exchanged."""
    r = scan.r[:: max(1, scan.r.size // DISTANCES)]
    one = [scan.one_by_one(method, r, CHARGES) for method in scan.methods]
    other = [scan.one_by_one(method, r, CHARGES[::-1]) for method in scan.methods]
    text = f"charges exchanged, at {r.size} distances"
    return check_same("third law", text, scan, r, one, other)


def check_charges(scan: PotentialScan) -> Check:
    """Check force and energy between charges of either sign, and whether they act as declared."""
    r = scan.r[scan.r < scan.cutoff]
    r = r[:: max(1, r.size // DISTANCES)]
    worst = np.zeros(r.size)
    note = ""
    same = _error_between(scan, r, scan.charges)[1]  # which the force's own check has
    for charges in OTHER_CHARGES:
        energies, error = _error_between(scan, r, charges)
        error = np.where(error > TWICE * same, error, 0.0)
        if np.any(error > BOUND):
            note = f"between charges of {charges[0]:g} and {charges[1]:g}"
        worst = np.maximum(worst, error)
        acts = np.nan_to_num(np.abs(energies) / r) > ROUND_OFF * scan.scale(r)
        if np.any(acts) and not scan.potential.acts_between(*charges):
            note = (
                f"acts_between({charges[0]:g}, {charges[1]:g}) is false, and energy and force are "
                "not zero: runs leave them out"
            )
            worst = np.where(acts, np.inf, worst)
    text = f"force and -dU/dr of charges of either sign, at {r.size} distances"
    return replace(Check.of_worst("charges", text, worst, BOUND, r), note=note)


def _error_between(
    scan: PotentialScan, r: np.ndarray, charges: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """The energies of two charges, and the error of their force; 0 where dU/dr is not known."""
    energies = scan.python_energies(r, charges).astype(float)
    force = scan.one_by_one(scan.methods[1], r, charges)
    of_charges = partial(scan.python_energies, charges=charges)
    with np.errstate(all="ignore"):
        slope, unsure = derivative(of_charges, r, reach_of(scan, r))
        scale = np.maximum(scan.scale(r), np.abs(force) + np.abs(energies) / r)
        error = np.abs(force + slope) / scale
    known = np.isfinite(error) & (TRUSTED * unsure / scale <= BOUND)
    return energies, np.where(known, error, 0.0)


def check_same(
    name: str,
    text: str,
    scan: PotentialScan,
    r: np.ndarray,
    one: Sequence[np.ndarray],
    other: Sequence[np.ndarray],
) -> Check:
    """The largest difference of energies and forces that are computed in two ways.

    None where neither value is finite, infinite where one is.
    """
    scale = scan.scale(r)
    errors = np.zeros(r.size)
    for k, unit in enumerate((scale * r, scale)):
        both = np.isfinite(one[k]) & np.isfinite(other[k])
        same_kind = np.isfinite(one[k]) == np.isfinite(other[k])
        gap = np.abs(np.subtract(one[k], other[k], where=both, out=np.zeros(r.size))) / unit
        errors = np.maximum(errors, np.where(same_kind, gap, np.inf))
    return Check.of_worst(name, text, errors, ROUND_OFF, r)


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

    depth = potential.D
    r0 = potential.r0
    rho0 = potential.alpha * potential.r0
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

    energies = np.empty(r.size)
    forces = np.empty(r.size)
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
