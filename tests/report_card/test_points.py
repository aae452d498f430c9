"""Points of tables: wrong ones are found, and smooth, coarse and steep tables have none."""

import numpy as np
import pytest

import tribo
from tribo import check
from tribo.potentials import from_points
from tribo.report_card.points import LARGEST, deviations

SMOOTH = {
    "lennard-jones": lambda r: 4.0 * (r**-12 - r**-6),
    "a steep core": lambda r: r**-50 - r**-6,
    "a stiff bond": lambda r: np.exp(-100.0 * (r - 1.0)) - 2.0 * np.exp(-50.0 * (r - 1.0)),
    "yukawa": lambda r: np.exp(-2.0 * r) / r,
    "buckingham": lambda r: 1000.0 * np.exp(-5.0 * r) - 3.0 / r**6,
    "a contact": lambda r: np.maximum(1.0 - r, 0.0) ** 2.5,
    "a kink": lambda r: np.maximum(1.2345 - r, 0.0),
    "a step": lambda r: np.where(r < 1.5, 1.0, 0.0),
    "waves": lambda r: np.cos(20.0 * r) * np.exp(-r),
}


def typical(r, energy):
    """The depth of the energy, or its size in the outer half."""
    return max(-energy.min(), np.abs(energy[2 * r > r[0] + r[-1]]).max(), 1e-3)


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("n", [12, 14, 20, 45, 100, 1000])
def test_no_point_of_a_function_stands_out(name, n):
    """At equal distances, ratios, and inverse distances, with all digits or few."""
    for low, high in ((0.8, 3.0), (0.5, 3.0), (0.3, 10.0), (0.9, 2.2)):
        inverse = 1.0 / np.linspace(1.0 / low, 1.0 / high, n)
        for r in (np.linspace(low, high, n), np.geomspace(low, high, n), inverse):
            exact = SMOOTH[name](r)
            few = np.array([float(f"{x:.4g}") for x in exact])
            for energy in (exact, few, np.round(exact, 6)):
                off = np.abs(deviations(r, energy)) / typical(r, exact)
                assert not np.any(off > LARGEST), (low, high, np.flatnonzero(off > LARGEST))


def test_noise_does_not_stand_out():
    """Neither that of all energies, nor one that is relative to them."""
    chance = np.random.default_rng(3)
    r = np.linspace(0.8, 3.0, 400)
    energy = SMOOTH["lennard-jones"](r)
    for _ in range(20):
        noise = chance.normal(size=r.size)
        for noisy in (energy + 0.03 * noise, energy * (1.0 + 1e-3 * noise)):
            assert np.abs(deviations(r, noisy)).max() <= LARGEST


@pytest.mark.parametrize("n", [45, 100, 400])
def test_wrong_points_are_found(n):
    """Where 45 points resolve the energy, the place and the size are right."""
    r = np.linspace(0.85, 3.0, n)
    smooth = SMOOTH["lennard-jones"](r)
    for k in np.flatnonzero((r > 1.5) & (np.arange(n) < n - 3))[:: n // 15].tolist():
        energy = smooth.copy()
        energy[k] += 0.05
        off = deviations(r, energy)
        assert np.flatnonzero(np.abs(off) > LARGEST).tolist() == [k]
        assert off[k] == pytest.approx(0.05, rel=0.1)


R = np.linspace(0.8, 3.0, 45)
ENERGY = tribo.LennardJones(0.5, 1.0).energy(R)


def test_the_card_names_the_point(uncompiled):
    """In a table within a cutoff too; a table without a mistake passes."""
    assert check(from_points(R, ENERGY)).passed
    wrong = ENERGY.copy()
    wrong[20] *= -1.0
    for table in (from_points(R, wrong), from_points(R, wrong).with_cutoff(2.5)):
        report = check(table)
        assert [line.name for line in report.checks if not line.passed] == ["points"]
        assert report["points"].where == R[20]
        assert "point 21 has U = 0.057" in report["points"].note
        assert "give about -0.057" in report["points"].note


@pytest.mark.parametrize("low", [0.81, 0.85, 0.9, 0.95, 1.1])
def test_a_first_point_that_is_rounded(low):
    """Compiled code computes r from positions, which may round it to below the first point."""
    r = np.linspace(low, 3.0, 45)
    report = check(from_points(r, tribo.LennardJones(0.5, 1.0).energy(r)))
    assert report.passed, str(report)


def test_a_jump_at_the_end_is_noted(uncompiled):
    """The verdict does not approve of it; a table that ends at zero has none."""
    report = check(from_points(R, ENERGY + 0.3))
    assert "U jumps to zero by 0.6 typical energies at r = 3" in report["energy at the cutoff"].note
    assert str(report).endswith("checks; without a bound, see the note: energy at the cutoff")
    report = check(from_points(R, ENERGY).with_cutoff(2.9))
    assert str(report).endswith("checks") and not report["energy at the cutoff"].note
