"""Fits of series in closed form, which take the place of runs: values, intervals, profiles, notes.

Where a series is linear in its parameters, all that a fit reports follows from one matrix.
"""

import json
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from scipy import optimize, stats

import tribo
from tribo.fitting.notes import on_residuals
from tribo.fitting.search import Minimum

AMPLITUDE, STIFFNESS = KEYS = "field.amplitude", "upper.drive.stiffness"
RANGES = {AMPLITUDE: (0.06, 0.16), STIFFNESS: (0.3, 0.8)}
QUANTITY = "upper.pull_force"
TRUE = np.array([0.1, 0.5])
NOISE = 0.02
T = np.linspace(0.0, 6.0, 61)
# Columns of a matrix: what each parameter adds to the series.
COLUMNS = np.stack([np.sin(T), 0.3 + 0.1 * T], axis=1)


def linear(parameters, columns=COLUMNS):
    """Series (points, times) of parameters (points, 2)."""
    return parameters @ columns.T


def scene(**langevin):
    """A tip that a spring pulls over a corrugation."""
    surface = tribo.Surface(
        "upper",
        drive=tribo.Pulled(stiffness=0.4, speed=0.1),
        langevin=tribo.Langevin(2.0, **{"temperature": 0.0} | langevin),
    )
    field = tribo.Field(tribo.Corrugation(0.08, 1.0), on=("upper",))
    return tribo.Scene((surface,), (), float(T[-1]), fields=(field,))


@pytest.fixture
def series(monkeypatch):
    """Takes a function of parameters (points, keys), whose series stand for those of runs."""

    def use(function, error=0.0):
        def sweep(scene, swept, members, **settings):
            ((_, rows),) = swept.items()
            found = function(np.array(rows, float).reshape(len(rows), -1))
            places = np.rint(scene.times / T[1]).astype(int)
            tables = {QUANTITY: found}
            if members:
                errors = np.broadcast_to(error * stats.t.ppf(0.975, members - 1), found.shape)
                tables = {f"{QUANTITY}_mean": found, f"{QUANTITY}_half_width": errors}
            return {
                name: xarray.DataArray(table[:, places, None]) for name, table in tables.items()
            }

        monkeypatch.setattr("tribo.fitting.model.sweep", sweep)

    return use


def noisy(values, noise=NOISE, seed=0):
    return values + np.random.default_rng(seed).normal(0.0, 1.0, T.size) * noise


def least_squares(data, noise=NOISE, columns=COLUMNS):
    """Values, covariance, and chi^2 of the linear fit."""
    weights = np.broadcast_to(1.0 / np.asarray(noise), data.shape)
    scaled = columns * weights[:, None]
    covariance = np.linalg.inv(scaled.T @ scaled)
    values = covariance @ scaled.T @ (data * weights)
    return values, covariance, np.sum(((data - columns @ values) * weights) ** 2)


@pytest.mark.parametrize(
    "noise", [NOISE, NOISE * (1.0 + 0.5 * np.sin(3.0 * T))], ids=["one", "each"]
)
def test_values_intervals_and_profiles(series, noise):
    """Of two parameters, by the normal equations; the profile of each is a parabola."""
    series(linear)
    data = noisy(linear(TRUE), noise)
    values, covariance, chi2 = least_squares(data, noise)
    found = tribo.fit(scene(), (T, data), RANGES, QUANTITY, noise=noise, starts=8)
    errors = np.sqrt(np.diag(covariance))
    assert list(found.values.values()) == pytest.approx(values, abs=1e-3 * errors.min())
    assert found.covariance == pytest.approx(covariance, rel=1e-4)
    half_widths = stats.norm.ppf(0.975) * errors
    assert list(found.half_width.values()) == pytest.approx(half_widths, rel=1e-4)
    assert found.chi2 == pytest.approx(chi2, rel=1e-6)
    assert found.noise is noise
    assert found.residuals.values == pytest.approx(data - COLUMNS @ values, abs=1e-5)
    for k, key in enumerate(KEYS):
        curve = found.profiles[key]
        away = (curve["value"].values - values[k]) / half_widths[k]
        assert away == pytest.approx([-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0], abs=0.01)
        parabola = chi2 + ((curve["value"].values - values[k]) / errors[k]) ** 2
        assert curve["chi2"].values == pytest.approx(parabola, rel=1e-4)
    assert found.notes == ()
    assert found.scene.surfaces[0].drive.stiffness == found.values[STIFFNESS]
    told = json.loads(found.to_json())
    assert told["values"] == found.values and told["half_width"] == found.half_width
    assert told["degrees_of_freedom"] == T.size - 2
    assert f"{AMPLITUDE} = {found.values[AMPLITUDE]:.6g} +- " in str(found)
    assert found.plot().get_ylabel() == QUANTITY


def test_unknown_noise(series):
    """It is that of the residuals, with the quantile of Student for as many degrees of freedom."""
    series(linear)
    data = noisy(linear(TRUE))
    few = np.arange(0, T.size, 10)
    values, covariance, chi2 = least_squares(data[few], 1.0, COLUMNS[few])
    degrees = few.size - 2
    found = tribo.fit(scene(), (T[few], data[few]), RANGES, QUANTITY, starts=8)
    assert found.noise == pytest.approx(np.sqrt(chi2 / degrees), rel=1e-6)
    assert found.chi2 == pytest.approx(degrees)
    assert found.covariance == pytest.approx(chi2 / degrees * covariance, rel=1e-4)
    half_widths = stats.t.ppf(0.975, degrees) * np.sqrt(chi2 / degrees * np.diag(covariance))
    assert list(found.half_width.values()) == pytest.approx(half_widths, rel=1e-4)
    for k, key in enumerate(KEYS):
        curve = found.profiles[key]["chi2"].interp(value=values[k] + half_widths[k])
        assert float(curve) - found.chi2 == pytest.approx(
            stats.t.ppf(0.975, degrees) ** 2, rel=0.01
        )


def test_errors_of_means_add_to_the_noise(series):
    """As squares; a note says that they are not independent."""
    error = NOISE * np.where(T < 3.0, 0.5, 3.0)
    series(linear, error)
    data = noisy(linear(TRUE))
    values, covariance, chi2 = least_squares(data, np.hypot(NOISE, error))
    how = {"noise": NOISE, "members": 8, "starts": 8, "profiles": False}
    found = tribo.fit(scene(temperature=0.01), (T, data), RANGES, QUANTITY, **how)
    assert found.covariance == pytest.approx(covariance, rel=1e-4)
    assert found.chi2 == pytest.approx(chi2, rel=1e-6)
    assert "errors of means over members are correlated over time" in found.notes[-1]
    assert list(found.values.values()) == pytest.approx(values, rel=1e-4)


def test_a_direction_without_an_effect(series):
    """Both parameters that share it are not determined, and no interval is given."""
    series(lambda parameters: linear(parameters * [1.0, 0.2], np.stack([COLUMNS[:, 0]] * 2, 1)))
    data = noisy(0.2 * np.sin(T))
    how = {"noise": NOISE, "starts": 8, "profiles": False}
    found = tribo.fit(scene(), (T, data), RANGES, QUANTITY, **how)
    assert list(found.half_width.values()) == [np.inf, np.inf]
    assert np.all(np.isinf(found.covariance))
    for key in KEYS:
        assert any(note.startswith(f"{key} is not determined") for note in found.notes)


def test_a_combination_alone(series):
    """Two columns that are nearly one."""
    columns = np.stack([np.sin(T), np.sin(T) + 0.1 * np.cos(T)], axis=1) * [1.0, 0.2]
    series(lambda parameters: linear(parameters, columns))
    data = noisy(columns @ TRUE, 1e-3)
    found = tribo.fit(scene(), (T, data), RANGES, QUANTITY, noise=1e-3, starts=8, profiles=False)
    _, covariance, _ = least_squares(data, 1e-3, columns)
    correlation = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    (note,) = found.notes
    assert note.endswith(f"their correlation is {correlation:.4f}")


@pytest.mark.parametrize(("true", "end"), [(0.05, "lower"), (0.2, "upper")])
def test_an_end_of_a_range(series, true, end):
    """The value stops there, and a note says so."""
    series(linear)
    data = noisy(linear(np.array([true, 0.5])))
    found = tribo.fit(scene(), (T, data), RANGES, QUANTITY, noise=NOISE, profiles=False)
    at_end = RANGES[AMPLITUDE][end == "upper"]
    assert found.values[AMPLITUDE] == pytest.approx(at_end, abs=2e-4)
    assert any(note.startswith(f"{AMPLITUDE} is at the {end} end") for note in found.notes)


def test_two_minima(series):
    """The better one is found from any start; one that fits as well is noted."""

    def even(depth):
        """A series in which 0.08 and 0.14 of the first are alike but for some cosine."""

        def function(parameters):
            away = parameters[:, :1] - 0.11
            bent = np.concatenate([away**2 / 0.03, parameters[:, 1:]], axis=1)
            return linear(bent) + depth * away * np.cos(T)

        return function

    true = np.array([[0.08, 0.5]])
    for depth, notes in ((1.0, 0), (0.0, 1)):
        series(even(depth))
        data = noisy(even(depth)(true)[0], 2e-3)
        how = {"noise": 2e-3, "starts": 16, "profiles": False}
        for seed in range(4):
            found = tribo.fit(scene(), (T, data), RANGES, QUANTITY, seed=seed, **how)
            others = [note for note in found.notes if note.startswith("another minimum fits")]
            assert len(others) == notes
            if not notes:
                assert found.values[AMPLITUDE] == pytest.approx(0.08, abs=0.005)


def test_no_parabola(series):
    """Where a series saturates on one side; profiles are minima over the other parameter."""

    def saturated(parameters):
        bent = -0.002 * np.exp((0.1 - parameters[:, :1]) / 0.001)
        return linear(np.concatenate([bent, parameters[:, 1:]], axis=1))

    series(saturated)
    data = saturated(TRUE[None])[0]
    found = tribo.fit(scene(), (T, data), RANGES, QUANTITY, noise=0.01, starts=8)
    assert any(note.startswith(f"the interval of {AMPLITUDE} is not") for note in found.notes)
    curve = found.profiles[STIFFNESS]
    for stiffness, chi2 in zip(curve["value"].values, curve["chi2"].values, strict=True):

        def of_amplitude(amplitude, stiffness=stiffness):
            rest = saturated(np.array([[amplitude, stiffness]]))[0] - data
            return np.sum((rest / 0.01) ** 2)

        least = optimize.minimize_scalar(of_amplitude, bounds=(0.096, 0.104), method="bounded")
        assert chi2 == pytest.approx(least.fun, rel=1e-3, abs=1e-6)


def test_residuals_that_are_no_noise(series):
    """Of a scene that lacks something: neighbours are correlated, and chi^2 is too large."""
    series(linear)
    data = noisy(linear(TRUE) + 0.05 * np.cos(2.0 * T))
    found = tribo.fit(scene(), (T, data), RANGES, QUANTITY, noise=NOISE, starts=8, profiles=False)
    rest = found.residuals.values
    correlation = np.sum(rest[1:] * rest[:-1]) / np.sum(rest**2)
    neighbours, size = found.notes
    assert f"have the correlation {correlation:.2f}" in neighbours
    assert size.startswith(f"chi^2 is {found.chi2:.4g} with {T.size - 2} degrees of freedom")


def test_residuals_of_the_usual_size_are_not_noted():
    """chi^2 of 2000 with 199 degrees of freedom is all right where the noise follows from it."""
    rest = np.random.default_rng(0).standard_normal(200)
    least = Minimum(np.zeros(1), 2000.0)
    assert on_residuals(rest, SimpleNamespace(impossible=0), None, least, 199) == []


def test_candidates_without_a_series(series):
    """They count as bad fits, and a note has their number."""
    tried = []

    def broken(parameters):
        found = linear(parameters)
        lost = parameters[:, 0] > 0.14
        tried.append(np.count_nonzero(lost))
        found[lost, 30:] = np.nan
        return found

    series(broken)
    data = noisy(linear(TRUE))
    found = tribo.fit(scene(), (T, data), RANGES, QUANTITY, noise=NOISE, starts=8, profiles=False)
    values, _, _ = least_squares(data)
    assert list(found.values.values()) == pytest.approx(values, rel=1e-4)
    assert any(note.startswith("1 candidates did not complete") for note in found.notes), tried
