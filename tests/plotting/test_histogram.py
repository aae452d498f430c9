"""Histograms with their mirror images."""

import numpy as np
import pytest
from scipy import stats

from tribo import InputError, plotting


def test_densities():
    """Both integrate to one, and the weighted mirror image of Gaussian works is their density."""
    mean = 0.3
    works = np.random.default_rng(1).normal(mean, np.sqrt(2.0 * mean), 200_000)
    ax = plotting.reflected_histogram(works, temperature=1.0, bins=40)
    _, own, mirrored = (patch.get_data() for patch in ax.patches)
    for values, edges, _ in (own, mirrored):
        assert abs(np.sum(values * np.diff(edges)) - 1.0) < 1e-12
    np.testing.assert_array_equal(own.values, mirrored.values[::-1])
    x, weighted = ax.lines[0].get_data()
    exact = np.exp(-((x - mean) ** 2) / (4.0 * mean)) / np.sqrt(4.0 * np.pi * mean)
    well = exact * np.exp(-x) > 0.01
    assert well.sum() > 15
    np.testing.assert_allclose(weighted[well], exact[well], rtol=0.15)


@pytest.mark.parametrize("wrong", [{"work": [0.0]}, {"bins": 3}, {"temperature": 0.0}])
def test_refusals(wrong):
    """One sentence says what would do."""
    with pytest.raises(InputError):
        plotting.reflected_histogram(**({"work": [1.0, -2.0]} | wrong))


def test_members():
    """The bars count the finite values; the mean has the interval of Student's t."""
    values = np.random.default_rng(2).normal(3.0, 0.5, 200)
    ax = plotting.histogram([*values, np.nan], "upper.W")
    counts, _, _ = ax.patches[1].get_data()
    assert counts.sum() == 200 and ax.get_xlabel() == "upper.W"
    (mean,) = (line.get_xdata()[0] for line in ax.lines)
    assert mean == pytest.approx(values.mean(), rel=1e-12, abs=0.0)
    shown = f"mean {values.mean():.3f} ± {stats.t.ppf(0.975, 199) * stats.sem(values):.3f} (95 %)"
    assert ax.lines[0].get_label() == shown
    low, high = stats.t.interval(0.95, 199, values.mean(), stats.sem(values))
    span = ax.patches[2].get_extents().transformed(ax.transData.inverted())
    assert (span.x0, span.x1) == pytest.approx((low, high), rel=1e-9)
    with pytest.raises(InputError, match="values: must have two finite ones, got 1"):
        plotting.histogram([1.0, np.inf], "upper.W")
