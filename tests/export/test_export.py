"""Atoms of ASE and tables of pandas have the numbers of the result, also from files."""

import time
from dataclasses import replace

import ase.io
import numpy as np
import pytest

import tribo
from tribo import InputError, paper


@pytest.fixture(scope="module")
def result():
    scene = replace(paper.scene("C"), output=tribo.Output(samples=2001), duration=50.0)
    return tribo.simulate(scene, accuracy=1e-8)


@pytest.mark.parametrize("suffix", ["traj", "extxyz"])
def test_atoms_through_a_file(result, suffix, tmp_path):
    images = result.to_ase({"upper": "Si"})
    assert len(images) == 2001
    ase.io.write(tmp_path / f"run.{suffix}", images[::400])
    back = ase.io.read(tmp_path / f"run.{suffix}", ":")
    assert [atoms.get_chemical_formula() for atoms in back] == ["SiX3"] * 6
    for k, atoms in zip(range(0, 2001, 400), back, strict=True):
        upper = result["upper"]
        lower = result["lower"]
        assert atoms.positions[0, 0] == pytest.approx(upper.x_bob[k, 0], abs=1e-7)
        assert atoms.positions[3, 1] == pytest.approx(lower.y_bar[k, 0], abs=1e-7)
        assert atoms.get_masses() == pytest.approx([4.0, 4.0, 8.0, 8.0])
        assert atoms.get_initial_charges() == pytest.approx([1.0, 1.0, 0.0, 0.0])
        energy = result.system["contact_energy"][k]
        assert atoms.get_potential_energy() == pytest.approx(energy, abs=1e-7)
        if suffix == "extxyz":  # .traj drops arrays that ASE does not know
            angles = np.tile([upper.theta[k, 0], lower.theta[k, 0]], 2)
            assert atoms.arrays["theta"] == pytest.approx(angles, abs=1e-7)


def test_velocities_and_forces_are_derivatives(result):
    """Velocities are those of the positions; the power of the forces is the loss of energy."""
    images = result.to_ase()
    dt = result.t[1] - result.t[0]
    k = 800
    moved = (images[k + 1].positions - images[k - 1].positions) / (2.0 * dt)
    assert images[k].get_velocities() == pytest.approx(moved, abs=2e-4)
    assert np.abs(moved).max() > 0.1
    power = np.sum(images[k].get_forces() * images[k].get_velocities())
    energy = [atoms.get_potential_energy() for atoms in (images[k - 1], images[k + 1])]
    assert power == pytest.approx((energy[0] - energy[1]) / (2.0 * dt), rel=3e-3)
    assert abs(power) > 1e-4
    assert np.all(images[k].get_forces()[images[k].arrays["is_bar"]] == 0.0)


def test_wrong_symbols(result):
    with pytest.raises(InputError, match=r"symbols\['upper'\]: must be the symbol of an element"):
        result.to_ase({"upper": "Zz"})
    with pytest.raises(InputError, match="symbols: must be one of upper, lower"):
        result.to_ase({"middle": "Si"})


def test_tables(result):
    pytest.importorskip("pandas", reason="xarray brings pandas")
    table = result.to_pandas()
    end = result.end_to_pandas()
    assert np.array_equal(table["upper", 0, "w1"], result["upper"].w1[:, 0])
    assert np.array_equal(table["lower", "all", "W"], result["lower"].W)
    assert np.array_equal(table["system", "all", "applied_work"], result.system["applied_work"])
    assert np.array_equal(table.index, result.t)
    assert end.loc[("lower", 0), "theta"] == result["lower"].theta[-1, 0]
    assert end.shape == (2, 25)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["extxyz", "traj"])
def test_ovito_opens_trajectories(result, suffix, tmp_path):
    """OVITO reads extended XYZ itself, and .traj through ASE, with all frames and particles."""
    pytest.importorskip("ovito", reason="needs OVITO's wheel")
    from ovito.io import import_file
    from ovito.io.ase import ase_to_ovito

    images = result.to_ase({"upper": "Si"})[::400]
    path = tmp_path / f"run.{suffix}"
    ase.io.write(path, images)
    if suffix == "extxyz":
        pipeline = import_file(str(path))
        assert pipeline.source.num_frames == len(images)
        frames = [pipeline.compute(k) for k in range(len(images))]
        assert frames[3].attributes["time"] == pytest.approx(images[3].info["time"])
    else:
        frames = [ase_to_ovito(atoms) for atoms in ase.io.read(path, ":")]
    for data, atoms in zip(frames, images, strict=True):
        assert data.particles.positions[...] == pytest.approx(atoms.positions, abs=1e-6)
    types = frames[0].particles.particle_types
    names = [types.type_by_id(kind).name for kind in types[...]]
    assert names == ["Si", "X", "X", "X"]
    if suffix == "extxyz":
        forces = frames[2].particles.forces[...]
        assert forces == pytest.approx(images[2].get_forces(), abs=1e-6)


def cpu_time_of_forces(n):
    """Processor time of the contact forces of n x n over n x n bobs, and the forces."""
    grids = {"shape": (n, n), "spacing": (1.0, 1.0)}
    upper = tribo.Surface("upper", bob=(0.3, 0.9), **grids)
    lower = tribo.Surface("lower", facing="up", **grids)
    potential = tribo.LennardJones(0.1, 0.8).with_cutoff(2.0, "shift")
    scene = tribo.Scene((upper, lower), potential, 1e-6, output=tribo.Output(samples=2))
    result = tribo.simulate(scene, method="verlet", step=1e-6)
    times = []
    for _ in range(4):  # the first compiles
        began = time.process_time()
        atoms = result.to_ase()[0]
        times.append(time.process_time() - began)
    return min(times), atoms.positions[: 2 * n * n], atoms.get_forces()


def test_forces_of_many_bobs_take_time_in_proportion():
    """Four times the bobs take about four times as long, not sixteen; the forces are right."""
    few, places, forces = cpu_time_of_forces(28)
    bob = 784 // 2 + 14
    d = places[bob] - places[784:]
    r = np.linalg.norm(d, axis=1)
    pull = -24.0 * 0.1 * (0.8**6 / r**7 - 2.0 * 0.8**12 / r**13) * (r < 2.0)
    np.testing.assert_allclose(forces[bob, :2], (pull / r) @ d[:, :2], rtol=1e-9)
    assert cpu_time_of_forces(56)[0] < 8.0 * few
