"""Units against ASE's table, closed forms, and a scene computed in two systems of units."""

import math

import ase.units
import pytest
from scipy import constants

import tribo
from tribo import units


def test_those_of_ase():
    """ASE's own units, whose constants are of CODATA 2014 and so differ by up to 6e-7."""
    assert units.ASE.time == pytest.approx(1.0 / ase.units.second, rel=1e-6, abs=0.0)
    assert units.ASE.energy == pytest.approx(1.0 / ase.units.J, rel=1e-6, abs=0.0)
    assert units.ASE.kT(300.0) == pytest.approx(300.0 * ase.units.kB, rel=1e-6)
    assert units.ASE.force == pytest.approx(ase.units.m / ase.units.J, rel=1e-6, abs=0.0)


def test_closed_forms():
    """One ag nm^2/ns^2 is 1e-21 J; argon's reduced time is sigma sqrt(m / epsilon)."""
    nano = units.AG_NM_NS
    expected = {"velocity": 1.0, "energy": 1e-21, "force": 1e-12, "stiffness": 1e-3}
    found = {name: getattr(nano, name) for name in expected}
    assert found == pytest.approx(expected, rel=1e-12, abs=0.0)
    assert nano.damping == pytest.approx(1e-12, rel=1e-12, abs=0.0)
    argon = units.from_energy(3.4e-10, 39.95 * constants.atomic_mass, 119.8 * constants.k)
    time = 3.4e-10 * math.sqrt(argon.mass / argon.energy)
    assert argon.time == pytest.approx(time, rel=1e-12, abs=0.0)
    assert argon.kT(119.8) == pytest.approx(1.0)


def test_a_scene_in_two_systems():
    """Work in joules does not depend on the units of the scene."""

    def joules(system):
        length = 1e-9 / system.length
        mass = 1e-21 / system.mass
        speed = 0.5 / system.velocity
        asperite = tribo.Asperite(
            m1=mass,
            m2=2.0 * mass,
            kappa=2e-21 / system.energy,
            length=2.0 * length,
            bar_length=3.0 * length,
            i2=5.0 * mass * length**2,
        )
        upper = tribo.Surface(
            "upper", bob=(-10.0 * length, 0.0), velocity=(speed, 0.0), asperite=asperite
        )
        lower = tribo.Surface("lower", facing="up", asperite=asperite)
        strength = 0.2e-21 * 1e-9 / (system.energy * system.length)
        scene = tribo.Scene((upper, lower), tribo.Coulomb(strength), 40e-9 / system.time)
        return tribo.simulate(scene)["upper"].w1[-1, 0] * system.energy

    nano = joules(units.AG_NM_NS)
    assert nano == pytest.approx(-0.345151e-21, rel=1e-5, abs=0.0)
    assert joules(units.ASE) == pytest.approx(nano, rel=1e-6, abs=0.0)
