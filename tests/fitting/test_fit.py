"""Fits of scenes to measured series: known parameters, their intervals, and what is refused."""

import json
import runpy
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray

import tribo
from tribo import InputError
from tribo.fitting.data import trace_of
from tribo.model.parameters import with_values

ROOT = Path(__file__).resolve().parents[2]
afm = SimpleNamespace(**runpy.run_path(str(ROOT / "benchmarks" / "fit_coverage.py")))


@pytest.fixture(scope="module")
def force():
    return afm.exact()


@pytest.fixture(scope="module")
def found(force):
    return afm.fitted(force, 0, starts=32)


@pytest.mark.thorough
def test_a_synthetic_trace(found):
    """Both parameters are within their intervals, which are those of the profiles."""
    for key, true in afm.TRUE.items():
        assert abs(found.values[key] - true) <= found.half_width[key] < 0.02 * true
        curve = found.profiles[key]
        lowest = float(curve["chi2"].min())
        assert lowest == pytest.approx(found.chi2, abs=0.2)
        for side in (-1.0, 1.0):
            edge = found.values[key] + side * found.half_width[key]
            grown = float(curve["chi2"].interp(value=edge)) - found.chi2
            assert grown == pytest.approx(3.84, rel=0.2)
    assert abs(found.chi2 - 299) < 4.0 * np.sqrt(2 * 299)
    assert found.notes == ()
    covariance = found.covariance
    widths = list(found.half_width.values())
    assert 1.96 * np.sqrt(np.diag(covariance)) == pytest.approx(widths, rel=1e-3)
    assert found.residuals.std() == pytest.approx(afm.NOISE, rel=0.2)
    assert set(json.loads(found.to_json())) >= {"values", "half_width", "chi2", "notes"}
    assert "field.amplitude = 0.09" in str(found) or "field.amplitude = 0.10" in str(found)
    assert found.plot().get_ylabel() == afm.QUANTITY


def test_noise_that_is_not_known(force):
    """It follows from the residuals, and data may be labelled or in files."""
    noisy = force + np.random.default_rng(1).normal(0.0, afm.NOISE, force.size)
    data = xarray.DataArray(noisy, {"time": afm.TIMES}, ("time",))
    one = {"field.amplitude": (0.08, 0.12)}
    scene = with_values(afm.scene(), {"upper.drive.stiffness": 0.5})
    found = tribo.fit(scene, data, one, afm.QUANTITY, starts=8, profiles=False)
    assert found.noise == pytest.approx(afm.NOISE, rel=0.15)
    assert found.chi2 == pytest.approx(300.0)
    assert abs(found.values["field.amplitude"] - 0.1) <= found.half_width["field.amplitude"]


def test_a_parameter_without_an_effect_is_not_determined(force):
    """It says so, and gives no interval."""
    data = afm.TIMES, force + np.random.default_rng(2).normal(0.0, afm.NOISE, force.size)
    ranges = {"field.amplitude": (0.08, 0.12), "upper.drive.load": (0.1, 1.0)}
    scene = with_values(afm.scene(), {"upper.drive.stiffness": 0.5})
    found = tribo.fit(scene, data, ranges, afm.QUANTITY, noise=afm.NOISE, starts=8, profiles=False)
    assert found.half_width["upper.drive.load"] == np.inf
    assert any(note.startswith("upper.drive.load is not determined") for note in found.notes)


def test_files_of_data(tmp_path):
    """By names of columns, without names, and with other delimiters."""
    t, values = np.arange(4.0), np.array([1.0, 2.0, 0.5, 0.25])
    rows = [f"{a},{b},{c}" for a, b, c in zip(t, values, t**2, strict=True)]
    path = tmp_path / "trace.csv"
    path.write_text("\n".join(["# of a microscope", "time,upper.pull_force,other", *rows]))
    assert np.array_equal(trace_of(path, "upper.pull_force").values, values)
    with pytest.raises(InputError, match=r'must have the columns "time" and "upper\.W"'):
        trace_of(path, "upper.W")
    path.write_text("\n".join(f"{a} {b}" for a, b in zip(t, values, strict=True)))
    assert np.array_equal(trace_of(str(path), "upper.W").t, t)
    for last in ("3,four", "3,nan", "3"):
        path.write_text(f"1,2\n\n{last}")
        with pytest.raises(InputError, match=r"must have finite numbers in two col.*line 3 is"):
            trace_of(path, "upper.W")
    for text in ("t;x\n0,5;1,5\n1,5;2", "0,5 1,5\n1 2", "0;1\n0,5;2", "t\tx\n0\t1\n0,5\t2"):
        path.write_text(text)
        with pytest.raises(InputError, match="with points before decimals"):
            trace_of(path, "upper.W")
    path.write_text("t,x\n0,5,1,5\n1,5,2,5")
    with pytest.raises(InputError, match="got 2 names and 4 columns in the first row"):
        trace_of(path, "upper.W")
    path.write_text("\ufeff0,1\n1,2\n", encoding="utf-8")  # Excel begins with this mark
    assert trace_of(path, "upper.W").t.tolist() == [0.0, 1.0]
    path.write_text("time,force\n0.,1.,\n1.,2.,\n")
    assert trace_of(path, "upper.W").values.tolist() == [1.0, 2.0]
    path.write_text("force,time\n0.1,0\n0.2,1\n")
    assert trace_of(path, "upper.W").t.tolist() == [0.0, 1.0]
    path.write_bytes("time,force [µN]\n0,1\n1,2\n".encode("latin-1"))
    with pytest.raises(InputError, match="is not a text file in UTF-8"):
        trace_of(path, "upper.W")
    for wrong, message in (
        ((t[::-1], values), "that increase"),
        ((t - 1.0, values), "from 0 or later"),
        ("no.csv", "cannot be read"),
        (t, r"must be \(t, values\)"),
        (xarray.DataArray(values), "must have times"),
    ):
        with pytest.raises(InputError, match=message):
            trace_of(wrong, "upper.W")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ranges": {"field.amplitude": (0.2, 0.1)}}, "must grow from low to high"),
        ({"ranges": {}}, "must map keys to"),
        ({"members": 4}, "nothing in the scene is random"),
        ({"noise": -1.0}, "noise: must be positive"),
        ({"data": (np.arange(100.0), np.arange(100.0))}, "must end within the scene's duration"),
        ({"data": ([1.0, 2.0], [3.0, 3.0])}, "must change over time"),
        ({"quantity": "upper.w7"}, "w7"),
    ],
)
def test_refusals(changes, message):
    given = {"data": (np.arange(4.0), np.arange(4.0)), "ranges": {"field.amplitude": (0.1, 0.2)}}
    given = given | {"quantity": afm.QUANTITY} | changes
    with pytest.raises(InputError, match=message):
        tribo.fit(afm.scene(), **given)


def test_random_scenes_need_members():
    warm = replace(afm.scene().surfaces[0], langevin=tribo.Langevin(2.0, 0.01))
    scene = replace(afm.scene(), surfaces=(warm,))
    data = np.arange(1.0, 9.0), np.arange(8.0)
    with pytest.raises(InputError, match="members: is missing"):
        tribo.fit(scene, data, {"field.amplitude": (0.1, 0.2)}, afm.QUANTITY)


@pytest.mark.thorough
def test_a_thermal_scene_is_fitted_by_means():
    """The mean path of a warm tip; candidates share their noise, so that chi^2 is smooth."""
    warm = replace(afm.scene().surfaces[0], langevin=tribo.Langevin(2.0, 0.0005))
    scene = replace(afm.scene(), surfaces=(warm,), duration=12.0)
    t = np.linspace(1.0, 12.0, 23)
    true = with_values(scene, {"upper.drive.stiffness": 0.5})
    true = replace(true, output=tribo.Output(times=t[:-1].tolist()))
    many = tribo.ensemble(true, 32, keep=["upper.x_bar"], at="samples", seed=5, progress=False)
    mean = many["upper.x_bar"].mean("member").sel(time=t, method="nearest").values[:, 0]
    ranges = {"upper.drive.stiffness": (0.3, 0.8)}
    found = tribo.fit(
        scene,
        (t, mean),
        ranges,
        "upper.x_bar",
        noise=0.01,
        members=8,
        starts=4,
        profiles=False,
    )
    assert found.values["upper.drive.stiffness"] == pytest.approx(0.5, abs=0.03)
    assert any("correlated over time" in note for note in found.notes)
