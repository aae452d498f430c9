"""Streaming statistics against numpy on data that fits in memory."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from tribo import InputError, ensemble, paper
from tribo.ensembles import stores
from tribo.ensembles.kept_values import Kept
from tribo.ensembles.statistics import FINE, PROBABILITIES, Moments, variables_of

DRAWS = {
    "normal": stats.norm(1e3, 1e-3),
    "heavy tails": stats.cauchy(2.0, 0.1),
    "zeros": stats.binom(1, 1e-3),
}


@pytest.mark.parametrize("name", DRAWS)
def test_against_numpy(name):
    """Means, covariances, quantiles and counts of parts of any size."""
    rng = np.random.default_rng(3)
    values = DRAWS[name].rvs(size=(20_000, 2, 3), random_state=rng).astype(float)
    values[:, 1, 1] = 0.25  # constant
    kept = Kept({"upper.w1": (2, 3)}, True)
    found = stores.StatisticsStore(kept, None)
    first = 0
    for size in (1, 1, 4000, 17, 15_981):
        part = values[first : first + size]
        found.add(kept.without_runs(size, "completed") | {"upper.w1": part})
        first += size
    moments = found.moments()
    assert first == found.done == moments.count == 20_000
    np.testing.assert_allclose(moments.mean, values.mean(axis=0), rtol=1e-13)
    for time in range(2):
        exact = np.cov(values[:, time], rowvar=False)
        scale = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
        assert np.all(np.abs(moments.covariance[time] - exact) <= 1e-8 * scale + 1e-20)
    quantiles = moments.quantiles()
    np.testing.assert_array_equal(quantiles[[0, -1]], [values.min(axis=0), values.max(axis=0)])
    for k, p in enumerate(PROBABILITIES):
        exact = np.quantile(values, p, axis=0, method="lower")
        width = np.hypot(exact - moments.centre, moments.unit) / FINE
        assert np.all(np.abs(quantiles[k] - exact) <= 1.1 * width + 1e-12 * np.abs(exact))
    for column in range(6):
        bins, counts = moments.bins_of(column)
        below = moments.edges(bins, column)
        line = np.sort(values.reshape(-1, 6)[:, column])
        wanted = line.size - np.searchsorted(line, below)
        # An edge and a value on it may differ by round-off.
        assert np.max(np.abs(np.cumsum(counts[::-1])[::-1] - wanted)) <= 2 * (bins.size > 1)
        assert counts.sum() == 20_000


def test_parts_in_any_division():
    """Merged counts do not depend on it; means only in the last digit."""
    values = np.random.default_rng(1).normal(size=(5000, 1, 2))
    whole = Moments.of(values)
    like = Moments.of(values[:100], None)
    some = like
    for part in np.split(values[100:], [50, 3000]):
        some = some.merged(Moments.of(part, like))
    again = Moments.of(values, like)
    np.testing.assert_array_equal(some.keys, again.keys)
    np.testing.assert_array_equal(some.counts, again.counts)
    np.testing.assert_allclose(some.products, whole.products, rtol=1e-12)


def test_an_ensembles_statistics():
    """Those of its members, with any number of threads."""
    scene = replace(paper.scene("A"), numerics=tribo.Numerics(accuracy=1e-6))
    vary, keep = {"upper.theta": stats.uniform(0.0, 0.2)}, ["upper.w1", "contact_energy"]
    data = ensemble(scene, 20_000, vary, keep=keep)
    one, two = (
        ensemble(scene, 20_000, vary, keep=keep, statistics=True, threads=k) for k in (1, 2)
    )
    assert one.drop_attrs().identical(two.drop_attrs())
    assert one["value"].values.tolist() == ["upper.w1[0]", "contact_energy"]
    assert json.loads(one.attrs["members"]) == {"completed": 20_000}
    both = np.column_stack([data["upper.w1"].values[:, 0], data["contact_energy"].values])
    np.testing.assert_allclose(one["covariance"], np.cov(both, rowvar=False), rtol=1e-10)
    for k, name in enumerate(keep):
        line, shape = both[:, k], data[name].shape[1:]
        assert one[f"{name}_mean"].shape == shape
        assert float(one[f"{name}_mean"].squeeze()) == pytest.approx(
            line.mean(), rel=1e-13, abs=0.0
        )
        variance = float(one[f"{name}_variance"].squeeze())
        assert variance == pytest.approx(line.var(ddof=1), rel=1e-10)
        half = float(one[f"{name}_half_width"].squeeze())
        assert half == pytest.approx(1.96 * np.sqrt(variance / 20_000), rel=1e-3)
        exact = np.quantile(line, PROBABILITIES)
        quantiles = one[f"{name}_quantile"].values.reshape(-1)
        assert np.max(np.abs(quantiles - exact)) < np.std(line) / 100
        edges = one[f"{name}_edge"].values.ravel()
        counts, _ = np.histogram(line, edges)
        np.testing.assert_array_equal(one[f"{name}_count"].values.ravel(), counts)


def test_incomplete_members_are_in_no_mean():
    """They are counted by name."""
    scene = paper.scene("A")
    upper, lower = scene.surfaces
    touching = replace(upper, bob=lower.bob, initial=tribo.Initial(theta=0.3))
    scene = replace(scene, surfaces=(touching, lower))
    vary = {"upper.theta": np.array([0.3, 0.0, 0.4, 0.5])}
    arguments = {"keep": ["upper.w1"], "method": "gauss-radau-15"}
    data = ensemble(scene, 4, vary, **arguments)
    found = ensemble(scene, 4, vary, statistics=True, **arguments)
    assert json.loads(found.attrs["members"]) == {"BobsCoincide": 1, "completed": 3}
    assert int(found["complete_members"]) == 3
    mean = np.nanmean(data["upper.w1"].values)
    assert float(found["upper.w1_mean"][0]) == pytest.approx(mean, rel=1e-14, abs=0.0)


def test_too_many_covariances(monkeypatch):
    """Are refused before anything is run."""
    monkeypatch.setattr(stores, "MOST_BYTES", 1000)
    with pytest.raises(InputError, match=r"^statistics: would keep covariances of 1 values at 401"):
        ensemble(
            paper.scene("A"),
            4,
            {"upper.theta": stats.norm()},
            keep=["upper.W"],
            at="samples",
            statistics=True,
        )


def test_members_that_stop_are_left_out(tmp_path):
    """Statistics are those of the others, also at a point of a sweep; none is a sentence."""
    upper = tribo.Surface("upper", bob=(-1.0, 0.3), velocity=(0.5, 0.0))
    scene = tribo.Scene([upper, tribo.Surface("lower", facing="up")], tribo.Coulomb(0.2), 2.0)
    how = {"keep": ["upper.friction_force"], "method": "verlet", "step": 0.05, "progress": False}
    speeds = {"upper.velocity": [0.5, 0.6, 80.0, 0.7]}
    each = ensemble(scene, vary=speeds, **how)
    found = ensemble(scene, vary=speeds, statistics=True, out=tmp_path / "a.nc", **how)
    assert json.loads(found.attrs["members"]) == {"completed": 3, "EncounterJumped": 1}
    name = "upper.friction_force"
    np.testing.assert_allclose(found[f"{name}_mean"], np.nanmean(each[name]), rtol=1e-12)
    thetas = {"upper.theta": [0.0, 0.1, 0.2]}
    with pytest.raises(InputError, match="is completed by no member"):
        fast = replace(scene, surfaces=[replace(upper, velocity=(80.0, 0.0)), scene.surfaces[1]])
        ensemble(fast, vary=thetas, statistics=True, **how)
    swept = {"upper.velocity": [0.5, 80.0]}
    data = tribo.sweep(scene, swept, 3, thetas, statistics=True, **how)
    assert data["point_status"].values.tolist() == ["completed", "Refused"]
    assert np.isfinite(data[f"{name}_mean"][0]) and np.isnan(data[f"{name}_mean"][1])


def test_values_that_some_members_lack():
    """They have no mean and no quantile; bins count those that are there; other times have both."""
    values = np.random.default_rng(1).normal(size=(50, 3, 1))
    values[:, 0], values[7, 1] = np.nan, np.nan
    kept = Kept({"upper.f_T_x": (3, 1)}, True)
    found = stores.StatisticsStore(kept, None)
    for part in (values[:20], values[20:]):
        found.add(kept.without_runs(len(part), "completed") | {"upper.f_T_x": part})
    moments = found.moments()
    np.testing.assert_allclose(moments.mean, values.mean(axis=0), rtol=1e-13)
    known = np.isfinite(moments.quantiles()[:, :, 0]).all(axis=0)
    assert known.tolist() == [False, False, True]
    variables = variables_of(kept, moments)
    assert variables["upper.f_T_x_count"][1].sum(axis=(1, 2)).tolist() == [0, 49, 50]
