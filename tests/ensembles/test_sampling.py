"""Distributions are drawn right; quasi-random points are those of scipy."""

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

import tribo
from tribo import InputError, ensemble, paper
from tribo.ensembles.members import Variation, sources_of


@pytest.mark.parametrize(
    "distribution",
    [stats.norm(0.3, 0.1), stats.uniform(-1.0, 3.0), stats.expon(scale=2.0), stats.cauchy()],
)
def test_draws_have_their_distribution(distribution):
    """By the test of Kolmogorov and Smirnov, over blocks, and independent between quantities."""
    vary = {"upper.theta": distribution, "upper.omega": distribution}
    variation = Variation(paper.scene("A"), vary, seed=5)
    one, other = (variation.rows(key, np.arange(100, 20_100))[:, 0] for key in vary)
    for line in (one, other):
        assert stats.kstest(line, distribution.cdf).pvalue > 1e-3
        ranks = stats.rankdata(line)
        assert abs(np.corrcoef(ranks[1:], ranks[:-1])[0, 1]) < 0.03
    assert abs(stats.spearmanr(one, other).statistic) < 0.03
    assert stats.kstest(one, stats.norm(0.32, 0.1).cdf).pvalue < 1e-3


def test_samplers():
    """Points of scipy's sampler through the inverse cumulative functions, the same each time."""
    vary = {"upper.theta": stats.norm(0.0, 0.1), "lower.omega": stats.uniform(-1.0, 2.0)}
    sampler = qmc.Sobol(2, rng=7)
    points = qmc.Sobol(2, rng=7).random(64)
    first, second = (
        ensemble(paper.scene("A"), 64, vary, sampler=sampler, keep=["upper.w1"]) for _ in range(2)
    )
    np.testing.assert_array_equal(first["upper.theta"][:, 0], vary["upper.theta"].ppf(points[:, 0]))
    np.testing.assert_array_equal(first["lower.omega"][:, 0], 2.0 * points[:, 1] - 1.0)
    np.testing.assert_array_equal(first["upper.w1"], second["upper.w1"])
    row = tribo.Surface("row", shape=(3, 1), spacing=(5.0, 0.0), langevin=tribo.Langevin(1.0, 0.3))
    scene = tribo.Scene((row,), (), 2.0)
    vary = {"row.theta": stats.norm(), "row.velocity": stats.norm(), "row.nu": [[0.0]] * 8}
    found = sources_of(scene, vary, qmc.LatinHypercube(4, rng=1), 8)
    assert found["row.theta"].shape == (8, 3) and found["row.velocity"].shape == (8, 1)
    strata = np.sort(np.floor(8 * stats.norm.cdf(found["row.theta"])), axis=0)
    np.testing.assert_array_equal(strata, np.tile(np.arange(8.0)[:, None], (1, 3)))


def test_a_sample_of_members_is_spread_over_all():
    """Four of a hundred members are those at equal distances."""
    scene = tribo.Scene([tribo.Surface("s")], [], 1.0)
    variation = Variation(scene, {"s.theta": np.linspace(0.0, 1.0, 100)}, 0)
    assert variation.sample(100, 4).numbers.tolist() == [0, 25, 50, 75]


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"sampler": 3}, "^sampler: must be one of scipy.stats.qmc, got 3"),
        ({"sampler": qmc.Sobol(3)}, "^sampler: has 3 dimensions, and members have 1 number"),
        ({"sampler": qmc.Sobol(1), "members": None}, "^members: is missing"),
        ({"sampler": qmc.Sobol(1), "half_width": {"upper.W": 0.1}}, "^half_width: cannot go with"),
    ],
)
def test_refusals(settings, words):
    """By name."""
    arguments = {"members": 8, "vary": {"upper.theta": stats.norm()}} | settings
    with pytest.raises(InputError, match=words):
        ensemble(paper.scene("A"), **arguments)
