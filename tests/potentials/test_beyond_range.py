"""Potentials are zero from their range on; tables are judged where bobs come; energies agree."""

import numpy as np
import pytest

import tribo
from tribo import Potential
from tribo.potentials import from_points

EPSILON = 0.02
SIGMA = 2.5
END = 4.0


class Cap(Potential):
    """An energy that is no number beyond its range."""

    A: float
    d: float

    def energy(self, r):
        return self.A * (1.0 - r / self.d) ** 1.5

    def range(self):
        return self.d


class Bowl(Cap):
    """An energy that rises again beyond its range."""

    def energy(self, r):
        return self.A * (r - self.d) ** 2

    def range(self):
        return self.d


class Uneven(tribo.Coulomb):
    """Only the energy between charges is its own; charges of one give twice its energy."""

    def energy_between(self, r, one, other):
        return self.strength * (one + other) / r


class OnlyBetween(Potential):
    """No other energy is defined."""

    k: float

    def energy_between(self, r, one, other):
        return self.k * (one + other) / r


R = np.linspace(0.2, 2.0, 37)


def both(potential, r=R):
    with np.errstate(invalid="ignore"):
        return np.array(
            [potential.energy_between(r, 1.0, 1.0), potential.force_between(r, 1.0, 1.0)]
        )


@pytest.mark.parametrize("own", [Cap(0.3, 1.0), Bowl(0.3, 1.0)], ids=["cap", "bowl"])
def test_a_range_of_ones_own_ends_sums_and_cutoffs(own):
    """Beyond the range the formula does not count, as a part, under a cutoff, or both."""
    expected = np.where(R < 1.0, both(own), 0.0)
    gauss = tribo.Gaussian(0.1, 0.5)
    for words in ("truncate", "shift", "force-shift", "switch"):
        settings = {"switch_from": 1.2} if words == "switch" else {}
        cut = own.with_cutoff(1.5, words, **settings)
        assert both(cut) == pytest.approx(expected, rel=1e-14, abs=1e-16)
        assert both(cut + gauss) == pytest.approx(expected + both(gauss), rel=1e-14, abs=1e-16)
    for summed in (own + gauss, gauss + own, 0.5 * (2.0 * own) + gauss):
        assert both(summed) == pytest.approx(expected + both(gauss), rel=1e-14, abs=1e-16)
    sliced = (own + 0.0 * gauss).with_cutoff(1.5, "shift")
    assert both(sliced) == pytest.approx(expected, rel=1e-14, abs=1e-16)


def test_runs_of_sums_with_a_range_of_ones_own():
    """One head-on pass: alone, scaled, in a sum and under a cutoff beyond the range."""
    upper = tribo.Surface("upper", bob=(-2.0, 0.5), velocity=(1.0, 0.0))
    surfaces = [upper, tribo.Surface("lower", facing="up")]
    works = []
    for own in (Cap(0.3, 1.0), Bowl(0.3, 1.0)):
        for potential in (own, own + 0.0 * tribo.Gaussian(1.0, 0.5), own.with_cutoff(1.5, "shift")):
            scene = tribo.Scene(surfaces, potential, 4.0, output=tribo.Output(samples=5))
            result = tribo.simulate(scene, method="verlet", step=0.01)
            works.append(float(result["upper"].w1[-1, 0]))
    assert works[1:3] == pytest.approx([works[0]] * 2, rel=1e-12, abs=0.0)
    assert works[4:6] == pytest.approx([works[3]] * 2, rel=1e-12, abs=0.0)


def lennard_jones(r):
    return 4.0 * EPSILON * ((SIGMA / r) ** 12 - (SIGMA / r) ** 6)


@pytest.mark.parametrize("first", [0.1, 0.3, 1.0, 2.0])
def test_tables_that_begin_in_a_core(first):
    """The jump at the end, the error and the lengths are those of a table without the core."""
    r = np.linspace(first, END, 2000)
    table = from_points(r, lennard_jones(r))
    assert table.smoothness() == -1
    assert from_points(r, lennard_jones(r) - lennard_jones(END)).smoothness() == 0
    outer = np.linspace(2.0, END, 4001)[:-1]
    true = float(np.max(np.abs(table.energy(outer) - lennard_jones(outer))))
    assert true <= table.error <= 1e-6
    assert table.clearance(2.8) == pytest.approx(0.151, abs=0.01)  # 0.06 sigma
    assert table.clearance(first) == table.length <= 0.08 * max(first, 2.0)
    assert table.clearance(END + 1.0) == 1.0


def test_tables_end_where_values_do():
    """A core does not hide a kink, nor zeros behind the end a smooth end."""
    r = np.linspace(0.05, 4.0, 2000)
    switched = tribo.LennardJones(EPSILON, 1.0).with_cutoff(3.0)
    assert from_points(r, switched.energy(r)).smoothness() == 2
    assert from_points(r, 0.0 * r).smoothness() == 2


def test_energies_of_composed_potentials_are_those_of_their_parts():
    """Also where charges of one are not a coupling of one, and where no energy is defined."""
    own = Uneven(1.0)
    gauss = tribo.Gaussian(0.0, 0.5)
    for made in (1.0 * own, own + gauss, own.with_cutoff(3.0, "truncate")):
        assert made.energy(1.3) == pytest.approx(own.energy(1.3), rel=1e-15, abs=0.0)
        assert made.force(1.3) == pytest.approx(own.force(1.3), rel=1e-15, abs=0.0)
        for charges in ((1.0, 1.0), (2.0, -0.3)):
            assert made.energy_between(1.3, *charges) == own.energy_between(1.3, *charges)
    shifted = own.with_cutoff(3.0, "shift").energy(1.3)
    assert shifted == pytest.approx(own.energy(1.3) - own.energy(3.0), rel=1e-14, abs=0.0)
    between = OnlyBetween(1.0)
    assert (
        between.energy(1.3) == (1.0 * between).energy(1.3) == between.energy_between(1.3, 1.0, 1.0)
    )
