"""The same physics in another program: potentials against those of ASE.

Where the cutoffs of ASE are out of the way, energies and forces are the same to round-off.  With
the cutoffs that ASE has by itself the difference is the one that its documentation predicts, so
that a change there is noticed.

A. H. Larsen et al., J. Phys.: Condens. Matter 29 (2017) 273002.
"""

import numpy as np
import pytest
from ase import Atoms, units
from ase.calculators.counterions import AtomicCounterIon
from ase.calculators.lj import LennardJones as PeerLennardJones
from ase.calculators.morse import MorsePotential
from hypothesis import given
from hypothesis import strategies as st

from tribo.potentials import Coulomb, LennardJones, Morse
from tribo.report_card.agreement import PEERS, pair

ROUND_OFF = 1e-12  # relative to |U| + r |F|
lengths = st.floats(0.5, 5.0)
energies = st.floats(0.01, 10.0)


def apart(potential, calculator, r):
    """Differences of energy and force at each r, from ASE's."""
    theirs = pair(calculator, "H2", r)
    return potential.energy(r) - theirs[0], potential.force(r) - theirs[1]


def assert_same(potential, calculator, r):
    scale = np.abs(potential.energy(r)) + r * np.abs(potential.force(r))
    energy, force = apart(potential, calculator, r)
    assert np.all(np.abs(energy) <= ROUND_OFF * scale)
    assert np.all(np.abs(force) * r <= ROUND_OFF * scale)


potentials = st.one_of(
    st.builds(LennardJones, energies, lengths),
    st.builds(Morse, energies, st.floats(0.5, 5.0), lengths),
    st.builds(Coulomb, st.floats(-20.0, 20.0).filter(lambda s: abs(s) > 1e-3)),
)


@given(potentials, st.lists(st.floats(0.7, 3.0), min_size=1, max_size=4))
def test_same_to_round_off(potential, places):
    """With the cutoffs far away, at distances about the potential's own length."""
    length = {LennardJones: "sigma", Morse: "r0"}.get(type(potential))
    r = np.array(places) * (getattr(potential, length) if length else 3.0)
    assert_same(potential, PEERS[type(potential)](potential), r)


def test_units_of_charge():
    """Two charges of e one Angstrom apart have 14.4 eV, by ASE's constants too."""
    e2 = units._e / (4.0 * np.pi * units._eps0) * 1e10  # e / (4 pi eps0) [V Angstrom]
    ions = AtomicCounterIon([1.0, 1.0], epsilon=0.0, sigma=1.0, sites_per_mol=2, rc=1e4)
    r = np.array([0.5, 1.0, 7.3])
    assert e2 == pytest.approx(14.3996, abs=1e-4)
    assert pair(ions, "Na2", r)[0] == pytest.approx(e2 / r, rel=1e-7)
    assert_same(Coulomb(units.Hartree * units.Bohr), ions, r)


def test_three_atoms_are_three_pairs():
    """Pairwise sums: a triangle of Lennard-Jones atoms, with forces in the plane."""
    places = np.array([[0.0, 0.0, 0.0], [1.2, 0.1, 0.0], [0.4, 1.3, 0.0]])
    ours = LennardJones(0.7, 1.1)
    atoms = Atoms("Ar3", places, calculator=PEERS[LennardJones](ours))
    energy = 0.0
    force = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            if i != j:
                apart = places[i] - places[j]
                r = np.linalg.norm(apart)
                energy += 0.5 * ours.energy(r)
                force[i] += ours.force(r) * apart / r
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-12, abs=0.0)
    assert atoms.get_forces() == pytest.approx(force, rel=1e-12, abs=1e-12)


# --- ASE's cutoffs -------------------------------------------------------------------------------


def test_lennard_jones_is_shifted():
    """By default U is shifted to be zero at 3 sigma, and forces are left as they are."""
    ours = LennardJones(0.6, 1.4)
    end = 3.0 * ours.sigma
    r = np.linspace(1.0, end - 1e-9, 30)
    energy, force = apart(ours, PeerLennardJones(epsilon=0.6, sigma=1.4), r)
    assert energy == pytest.approx(np.full(r.size, ours.energy(end)), rel=1e-9, abs=1e-12)
    assert np.max(np.abs(force)) <= 1e-12 * np.max(np.abs(ours.force(r)))
    beyond = pair(PeerLennardJones(epsilon=0.6, sigma=1.4), "H2", np.array([end + 1e-6]))
    assert beyond[0] == beyond[1] == 0.0


def test_morse_is_smoothed():
    """By default U is multiplied by a quintic that falls from 1 at 1.9 r0 to 0 at 2.7 r0."""
    ours = Morse(0.8, 1.5, 2.0)
    begin = 1.9 * ours.r0
    end = 2.7 * ours.r0
    r = np.linspace(0.8 * ours.r0, end, 60)
    energy, force = apart(ours, MorsePotential(epsilon=0.8, r0=2.0, rho0=3.0), r)
    u = np.clip((r - begin) / (end - begin), 0.0, 1.0)
    less = u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
    slope = 30.0 * u**2 * (1.0 - u) ** 2 / (end - begin)
    assert energy == pytest.approx(ours.energy(r) * less, rel=1e-9, abs=1e-12)
    predicted = ours.force(r) * less - ours.energy(r) * slope
    assert force == pytest.approx(predicted, rel=1e-9, abs=1e-12)


def test_coulomb_is_smoothed():
    """By default U is multiplied by a cubic over the last Angstrom before 7 Angstrom."""
    ours = Coulomb(units.Hartree * units.Bohr)
    ions = AtomicCounterIon([1.0, 1.0], epsilon=0.0, sigma=1.0, sites_per_mol=2)
    r = np.linspace(2.0, 7.0 - 1e-9, 60)
    energy, force = apart(ours, ions, r)
    u = np.clip(r - 6.0, 0.0, 1.0)
    assert energy == pytest.approx(ours.energy(r) * u**2 * (3.0 - 2.0 * u), rel=1e-9, abs=1e-12)
    less = ours.force(r) * u**2 * (3.0 - 2.0 * u) - ours.energy(r) * 6.0 * u * (1.0 - u)
    assert force == pytest.approx(less, rel=1e-9, abs=1e-12)
