"""Starts of pendulums by name: their energies, their phases, and refusals."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

import tribo
from tribo import InputError, paper
from tribo.ensembles.members import Variation, draws_of, sources_of

FORCED = paper.scene("A")
DRIVEN = replace(FORCED, surfaces=[replace(s, drive=tribo.DrivenBars()) for s in FORCED.surfaces])
KAPPA, INERTIA, ABOUT_BAR = 2.0, 2.0 / 3.0 * 2.0**2, 1.0 * 2.0**2


def rows(scene, vary, count=20_000):
    """The values of members."""
    return Variation(scene, vary, seed=5).members(np.arange(100, 100 + count)).values


def energy(values, name, inertia=INERTIA):
    """The energies of the pendulums of a surface."""
    kinetic = 0.5 * inertia * values[f"{name}.omega"] ** 2
    return kinetic + 0.5 * KAPPA * values[f"{name}.swing"] ** 2


@pytest.mark.parametrize(("scene", "inertia"), [(FORCED, INERTIA), (DRIVEN, ABOUT_BAR)])
def test_canonical_starts_are_normal(scene, inertia):
    """Swings and rates are independent normal deviates, in the energy that belongs to the drive."""
    values = rows(scene, {"*.swing_state": tribo.Canonical(0.3)})
    lines = [values[f"{s}.{part}"][:, 0] for s in ("upper", "lower") for part in ("swing", "omega")]
    for line, stiffness in zip(lines, 2 * [KAPPA, inertia], strict=True):
        assert stats.kstest(line, stats.norm(0.0, np.sqrt(0.3 / stiffness)).cdf).pvalue > 1e-3
    for one, other in zip(lines, [*lines[1:], lines[0]], strict=True):
        assert abs(stats.spearmanr(one, other).statistic) < 0.03
        assert abs(stats.spearmanr(one**2, other**2).statistic) < 0.03


def test_energies_of_three_pendulums():
    """One energy has a uniform simplex; a ball has (e / E)^N below e."""
    row = tribo.Surface("row", shape=(3, 1), spacing=(5.0, 0.0), initial=tribo.Initial(phi=0.2))
    scene = tribo.Scene((row, replace(row, name="other")), (), 2.0)
    kappa, inertia = row.each["kappa"], row.each["inertia"]

    def energies(source):
        values = rows(scene, {"*.swing_state": source})
        each = [
            0.5 * inertia * values[f"{name}.omega"] ** 2
            + 0.5 * kappa * (values[f"{name}.swing"] - 0.2) ** 2
            for name in ("row", "other")
        ]
        return np.concatenate(each, axis=1)

    fixed = energies(tribo.Microcanonical(1.5))
    np.testing.assert_allclose(fixed.sum(axis=1), 1.5, rtol=1e-13)
    for column in fixed.T / 1.5:  # a share of a uniform simplex has a beta distribution
        assert stats.kstest(column, stats.beta(1, 5).cdf).pvalue > 1e-3
    ball = energies(tribo.EnergyBall(1.5))
    assert stats.kstest((ball.sum(axis=1) / 1.5) ** 6, stats.uniform.cdf).pvalue > 1e-3
    for column in (ball / ball.sum(axis=1, keepdims=True)).T:
        assert stats.kstest(column, stats.beta(1, 5).cdf).pvalue > 1e-3


@pytest.mark.parametrize("sampled", [False, True])
def test_each_member_draws_with_its_own_numbers(sampled):
    """Stiffness, masses and lengths that differ change swings and rates, not their energies."""
    count = 4096
    rng = np.random.default_rng(2)
    numbers = {name: rng.uniform(0.5, 4.0, count) for name in ("kappa", "m1", "m2", "length")}
    vary = {f"upper.asperite.{name}": values for name, values in numbers.items()}
    vary |= {"*.swing_state": tribo.Canonical(0.3)}
    if sampled:
        vary = sources_of(FORCED, vary, qmc.Sobol(4, rng=3), count)
    values = Variation(FORCED, vary, seed=5).members(np.arange(count)).values
    m1, m2 = numbers["m1"], numbers["m2"]
    inertia = m1 * m2 / (m1 + m2) * numbers["length"] ** 2
    kinetic = 0.5 * inertia * values["upper.omega"][:, 0] ** 2
    stored = 0.5 * numbers["kappa"] * values["upper.swing"][:, 0] ** 2
    for each in (kinetic, stored):
        assert stats.kstest(2.0 * each / 0.3, stats.chi2(1).cdf).pvalue > 1e-3
    total = kinetic + stored
    assert stats.kstest(total, stats.expon(scale=0.3).cdf).pvalue > 1e-3
    for number in numbers.values():
        assert abs(stats.spearmanr(total, number).statistic) < 0.06


def test_one_energy_has_uniform_phases():
    """Of a single pendulum, by quasi-random points too, which are drawn in one dimension."""
    vary = {"upper.swing_state": tribo.Microcanonical(0.5), "lower.theta": stats.norm(3.0, 0.1)}
    numbers = {key: draw.dimensions for key, draw in draws_of(FORCED, vary).items()}
    assert numbers == {"upper.swing_state": 1, "lower.theta": 1}
    points = qmc.Sobol(2, rng=3)
    sampled = Variation(FORCED, sources_of(FORCED, vary, points, 1024), seed=5)
    for values in (rows(FORCED, vary), sampled.members(np.arange(1024)).values):
        np.testing.assert_allclose(energy(values, "upper"), 0.5, rtol=1e-13)
        phase = np.arctan2(
            np.sqrt(INERTIA) * values["upper.omega"], np.sqrt(KAPPA) * values["upper.swing"]
        )
        assert stats.kstest(phase[:, 0] / (2.0 * np.pi) + 0.5, stats.uniform.cdf).pvalue > 1e-3


def test_members_do_not_depend_on_their_company():
    """Nor on the start of the other surface, if each has its own."""
    vary = {"upper.swing_state": tribo.Canonical(0.3), "lower.swing_state": tribo.Canonical(0.2)}
    variation = Variation(FORCED, vary, seed=5)
    one, many = variation.members(np.array([9_000])), variation.members(np.arange(20_000))
    for key, values in one.values.items():
        np.testing.assert_array_equal(values[0], many.values[key][9_000])
    alone = Variation(FORCED, {"upper.swing_state": tribo.Canonical(0.3)}, seed=5)
    alone = alone.members(np.array([9_000]))
    assert alone.values["upper.swing"] == one.values["upper.swing"]
    assert one.values["upper.swing"] != one.values["lower.swing"]


def test_an_ensemble_and_one_member_of_it():
    """The starts are coordinates, and the energy at the end is that of a run from them."""
    scene = replace(DRIVEN, numerics=tribo.Numerics(accuracy=1e-6))
    keep = ["upper.swing_energy", "upper.friction_work"]
    vary = {"*.swing_state": tribo.EnergyBall(0.4)}
    data = tribo.ensemble(scene, 70, vary, keep=keep)
    assert tribo.ensemble_member(data, 66).equals(data.isel(member=[66]))
    one = data.isel(member=66)
    initial = {
        s: tribo.Initial(swing=one[f"{s}.swing"].item(), omega=one[f"{s}.omega"].item())
        for s in ("upper", "lower")
    }
    surfaces = [replace(s, initial=initial[s.name]) for s in scene.surfaces]
    run = tribo.simulate(replace(scene, surfaces=surfaces))["upper"]
    assert abs(one["upper.swing_energy"].item() - run.swing_energy[-1, 0]) < 2e-6
    assert abs(one["upper.friction_work"].item() - run.friction_work[-1]) < 2e-6


@pytest.mark.parametrize(
    ("vary", "word"),
    [
        ({"upper.theta": tribo.Canonical(0.1)}, "upper.theta: must be tribo.Canonical"),
        ({"upper.swing_state": stats.norm(0.0, 0.1)}, "swing_state: must be tribo.Canonical"),
        ({"middle.swing_state": tribo.Canonical(0.1)}, "must name a surface"),
        (
            {"*.swing_state": tribo.Canonical(0.1), "upper.swing_state": tribo.Canonical(0.2)},
            "cannot go with",
        ),
        ({"*.swing_state": tribo.Canonical(0.1), "upper.omega": [0.1, 0.2]}, "upper.omega"),
        (
            {"*.swing_state": tribo.Canonical(0.1), "lower.asperite.kappa": [0.0, 2.0]},
            "needs a finite lower.asperite.kappa > 0",
        ),
    ],
)
def test_refusals(vary, word):
    """One sentence names the key and what cannot be."""
    with pytest.raises(InputError, match=word):
        Variation(FORCED, vary, seed=0).members(np.arange(2))
    for wrong in (lambda: tribo.Canonical(-1.0), lambda: tribo.EnergyBall(0.0)):
        with pytest.raises(InputError, match=r"^(temperature|energy): must"):
            wrong()
    soft = replace(FORCED.surfaces[0], asperite=tribo.Asperite(kappa=0.0))
    scene = replace(FORCED, surfaces=(soft, FORCED.surfaces[1]))
    with pytest.raises(InputError, match="kappa > 0"):
        Variation(scene, {"*.swing_state": tribo.Canonical(0.1)}, seed=0)
