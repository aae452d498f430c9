"""Potentials as ASE calculators, and ASE calculators as tables of their dimers."""

import numpy as np
import pytest
from ase import Atoms
from ase.build import bulk, molecule
from ase.calculators.emt import EMT
from ase.calculators.fd import calculate_numerical_forces, calculate_numerical_stress
from ase.calculators.lj import LennardJones as LennardJonesOfASE
from ase.io import read
from ase.md.verlet import VelocityVerlet
from ase.optimize import BFGS

import tribo
from tribo.potentials import as_calculator, from_dimer

LJ = tribo.LennardJones(0.0103, 3.4)


def rattled(atoms, by=0.1):
    """The atoms, each moved a little."""
    atoms.rattle(by, seed=1)
    return atoms


@pytest.mark.parametrize(
    "potential",
    [
        LJ.with_cutoff(8.0),
        tribo.Morse(0.3, 1.7, 3.0).with_cutoff(6.5, "force-shift"),
        LJ.with_cutoff(8.0) + tribo.Coulomb(1.4).with_cutoff(9.0),
    ],
    ids=["lennard-jones", "morse", "charged sum"],
)
def test_forces_and_stress_are_derivatives(potential):
    """ASE's own finite differences of the energy of a rattled crystal, images and all."""
    atoms = rattled(bulk("Ar", "fcc", 5.3, cubic=True).repeat((1, 1, 2)), 0.2)
    atoms.set_initial_charges(np.resize([0.1, -0.1, 0.05], len(atoms)))
    atoms.calc = as_calculator(potential)
    forces = atoms.get_forces()
    scale = np.max(np.abs(forces))
    assert scale > 1e-3
    assert np.max(np.abs(forces - calculate_numerical_forces(atoms, eps=1e-4))) < 1e-6 * scale
    stress = atoms.get_stress()
    errors = np.abs(stress - calculate_numerical_stress(atoms, eps=1e-5))
    assert np.max(errors) < 1e-6 * np.max(np.abs(stress))
    assert np.sum(atoms.get_potential_energies()) == pytest.approx(atoms.get_potential_energy())


def test_a_crystal_as_ase_has_it():
    """Energy, forces and stress of a periodic crystal equal those of ASE's own Lennard-Jones."""
    energies = []
    for calculator in (
        as_calculator(LJ.with_cutoff(9.0, "shift")),
        LennardJonesOfASE(epsilon=LJ.epsilon, sigma=LJ.sigma, rc=9.0),
    ):
        atoms = rattled(bulk("Ar", "fcc", 5.3).repeat(3))
        atoms.calc = calculator
        energies.append((atoms.get_potential_energy(), atoms.get_forces(), atoms.get_stress()))
    for ours, theirs in zip(*energies, strict=True):
        assert np.allclose(ours, theirs, rtol=1e-12, atol=1e-14)


def test_an_optimiser_finds_the_minimum():
    """A dimer relaxes to the distance that the potential declares."""
    atoms = Atoms("Ar2", positions=[[0.0, 0.0, 0.0], [3.5, 0.4, 0.0]])
    atoms.calc = as_calculator(LJ)
    BFGS(atoms, logfile=None).run(fmax=1e-9, steps=200)
    r, depth, _ = tribo.potentials.as_potential(LJ).minimum()
    assert atoms.get_distance(0, 1) == pytest.approx(r, abs=1e-6)
    assert atoms.get_potential_energy() == pytest.approx(depth, rel=1e-10)


def test_a_trajectory_keeps_its_energy(tmp_path):
    """ASE's dynamics and its files take the calculator."""
    atoms = bulk("Ar", "fcc", 5.3, cubic=True)
    atoms.calc = as_calculator(LJ.with_cutoff(8.0))
    atoms.set_velocities(np.random.default_rng(0).normal(0.0, 1e-3, (len(atoms), 3)))
    dynamics = VelocityVerlet(atoms, 0.5, trajectory=str(tmp_path / "run.traj"))
    before = atoms.get_total_energy()
    dynamics.run(50)
    assert atoms.get_total_energy() == pytest.approx(before, abs=1e-7)
    frames = read(tmp_path / "run.traj", index=":")
    assert len(frames) == 51 and frames[-1].get_potential_energy() == atoms.get_potential_energy()


def test_by_elements():
    """Each pair of elements has its own potential, and others have none."""
    water = molecule("H2O")
    water.calc = as_calculator({("O", "H"): tribo.Morse(5.0, 2.0, 0.96)})
    bond = water.get_distance(0, 1)
    expected = 2.0 * tribo.Morse(5.0, 2.0, 0.96).energy(bond)
    assert water.get_potential_energy() == pytest.approx(expected, rel=1e-12, abs=0.0)


def test_periodic_atoms_need_a_cutoff():
    """Periodic atoms need a cutoff."""
    atoms = bulk("Ar", "fcc", 5.3)
    atoms.calc = as_calculator(LJ)
    with pytest.raises(tribo.InputError, match="needs a cutoff for periodic atoms"):
        atoms.get_potential_energy()


def test_a_dimer_curve_to_a_stated_error():
    """The table of ASE's Lennard-Jones differs from the formula by no more than it says."""
    calculator = LennardJonesOfASE(epsilon=0.3, sigma=1.1, rc=1e4)
    table = from_dimer(calculator, ("Ar", "Ar"), 0.9, 4.0, tolerance=1e-7)
    r = np.linspace(0.9, 4.0, 3001)[:-1]
    formula = tribo.LennardJones(0.3, 1.1)
    off = np.max(np.abs(table.energy(r) - (formula.energy(r) - formula.energy(4.0))))
    assert 1e-10 < off <= table.error <= 1e-7


def test_many_bodies_are_refused_or_said():
    """EMT is not a sum over pairs: refused by default, or part of the table's stated error."""
    with pytest.raises(tribo.InputError, match="EMT does not sum over pairs: for three atoms of"):
        from_dimer(EMT(), ("Cu", "Cu"), 1.6, 4.5, tolerance=1e-4)
    table = from_dimer(EMT(), ("Cu", "Cu"), 1.6, 4.5, tolerance=1e-4, many_body=True)
    assert table.error > 0.1


def test_emt_as_a_table_drives_a_scene(tmp_path):
    """A scene file may name a calculator; it is saved as points, without ASE."""
    (tmp_path / "scene.toml").write_text(
        """
        duration = 4.0
        [interaction]
        potential = "ase-dimer"
        calculator = "ase.calculators.emt:EMT"
        symbols = ["Cu", "Cu"]
        low = 1.4
        high = 4.5
        tolerance = 1e-5
        many_body = true
        [[surface]]
        name = "upper"
        bob = [-1.0, 2.4]
        velocity = [0.5, 0.0]
        [[surface]]
        name = "lower"
        facing = "up"
        [output]
        samples = 3
        """
    )
    scene = tribo.load_scene(tmp_path / "scene.toml")
    result = tribo.simulate(scene, accuracy=1e-6)
    assert result.status == "completed"
    assert np.max(np.abs(result["upper"].w1)) > 1e-3
    scene.save(tmp_path / "again.toml")
    again = tribo.simulate(tribo.load_scene(tmp_path / "again.toml"), accuracy=1e-6)
    assert np.array_equal(again["upper"].w1, result["upper"].w1)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"symbols": "Cu2"}, "symbols: must be two elements"),
        ({"calculator": "emt"}, 'calculator: must be "module:Class"'),
        ({"high": 1.0}, "high: must be above low"),
        ({"tolerance": 0.0}, "tolerance: must be positive"),
    ],
)
def test_refusals(arguments, says):
    """The message names the argument."""
    given = {"calculator": EMT(), "symbols": ("Cu", "Cu"), "low": 1.6, "high": 4.5}
    with pytest.raises(tribo.InputError, match=says):
        from_dimer(**(given | {"tolerance": 1e-3} | arguments))
