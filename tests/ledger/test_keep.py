"""``output.keep``: named quantities alone, to the bits of a run that records everything."""

import json
import pickle
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.command import main
from support.continued import chain
from tribo import Coulomb, Free, InputError, Output, Scene, Surface, sweep
from tribo.ensembles.figure import mean_band

KEEP = ("upper.W", "upper.x_cm", "contact_energy")
HOW = {"method": "midpoint", "step": 0.01}


def scene(**output):
    """A short pass of one asperite over a row of two."""
    surfaces = (
        Surface("upper", bob=(-1.0, 0.0), velocity=(0.5, 0.0), drive=Free()),
        Surface("lower", facing="up", shape=(2, 1), spacing=(1.0, 0.0)),
    )
    return Scene(surfaces, Coulomb(0.2), 4.0, output=Output(**{"samples": 41} | output))


def assert_kept(result, whole):
    """The result has the kept series of `whole`, and no others."""
    assert list(result["upper"]) == ["x_cm", "W"] and not len(result["lower"])
    assert list(result.system) == ["contact_energy"]
    assert np.array_equal(result.t, whole.t)
    assert np.array_equal(result["upper"].W, whole["upper"].W)
    assert np.array_equal(result["upper"].x_cm, whole["upper"].x_cm)
    assert np.array_equal(result.system["contact_energy"], whole.system["contact_energy"])
    assert list(result.error_estimate) == ["x_cm", "W", "contact_energy"]
    refusal = r'output\.keep: has only upper.W, upper.x_cm, contact_energy, so that "theta" was not'
    for absent in (lambda: result["upper"].theta, lambda: result.plot.angles()):
        with pytest.raises(InputError, match=refusal):
            absent()
    assert "theta" not in result["upper"] and not hasattr(result["upper"], "theta")
    with pytest.raises(KeyError, match='"applied_work" was not'):
        result.system["applied_work"]


@pytest.mark.parametrize("portion", [2**27, 5000])
def test_runs_record_what_is_named(portion, monkeypatch, tmp_path):
    """In one piece and in portions; files, copies and continued runs have the same."""
    monkeypatch.setattr("tribo.ledger.sinks.PORTION_BYTES", portion)
    whole, result = (tribo.simulate(scene(keep=keep), **HOW) for keep in (None, KEEP))
    assert_kept(result, whole)
    assert_kept(pickle.loads(pickle.dumps(result)), whole)
    result.save(tmp_path / "run.nc")
    loaded = tribo.load_result(tmp_path / "run.nc")
    assert_kept(loaded, whole)
    assert loaded.scene.output.keep == KEEP and "only upper.W, upper.x_cm" in str(loaded)
    result.save(tmp_path / "run.csv")
    header, *rows = (tmp_path / "run.csv").read_text().splitlines()
    assert header == "time,upper.x_cm,upper.W,contact_energy" and len(rows) == 41
    assert result.end["blocks"] == {"upper": {"W": whole["upper"].W[-1]}, "lower": {}}
    longer = replace(scene(keep=KEEP), duration=8.0)
    assert tribo.simulate(longer, **HOW, start=result.state()).t[-1] == 8.0
    samples = result.take_state.__closure__
    assert max(cell.cell_contents.samples.t.size for cell in samples if is_run(cell)) <= 3


@pytest.mark.parametrize("keep", [None, KEEP])
def test_an_accuracy_needs_few_samples(keep, monkeypatch, tmp_path):
    """Runs are compared at some times; one with the same setting is recorded at all of them."""
    whole = tribo.simulate(scene(samples=201), accuracy=1e-7)
    monkeypatch.setattr("tribo.ledger.sinks.SERIES_BYTES", 60_000)
    monkeypatch.setattr("tribo.ledger.sinks.PORTION_BYTES", 5000)
    long = scene(samples=201, keep=keep)
    result = tribo.simulate(long, accuracy=1e-7)
    assert result.met and result.cost.force_evaluations > whole.cost.force_evaluations / 2
    assert result.notes[-1 if keep else -2] == "errors are estimated at 57 times"
    assert np.array_equal(result.t, whole.t)
    for read in (lambda r: r["upper"].W, lambda r: r.system["contact_energy"]):
        bound = whole.error_estimate["W"] + result.error_estimate["W"]
        assert 0.0 < np.max(np.abs(read(result) - read(whole))) < bound
    assert ("theta" in result.error_estimate) == (keep is None)
    out = tmp_path / "run.nc"
    assert np.array_equal(
        tribo.simulate(long, accuracy=1e-7, out=out)["upper"].W, result["upper"].W
    )
    assert tribo.load_result(out).met
    alone = tribo.prepare(long, accuracy=1e-7)
    assert np.array_equal(alone.run()["upper"].W, result["upper"].W)
    assert np.array_equal(alone.run(estimate=False)["upper"].W, result["upper"].W)


def is_run(cell):
    """Whether a variable of a closure is an integration."""
    return hasattr(cell.cell_contents, "samples")


def test_means_of_noisy_forces_span_portions(monkeypatch):
    """A mean over an interval takes the sample before it, also from the portion before."""
    keep = ("upper.f_T_x", "upper.friction_force")
    noisy = chain((1.0, 2.0, 3.0, 4.0))
    output = replace(noisy.output, series=("forces", "energies"))
    how = {"method": "verlet", "step": 0.02}
    whole = tribo.simulate(replace(noisy, output=output), **how)
    monkeypatch.setattr("tribo.ledger.sinks.PORTION_BYTES", 0)
    result = tribo.simulate(replace(noisy, output=replace(output, keep=keep)), **how)
    for key in ("f_T_x", "friction_force"):
        assert np.array_equal(result["upper"][key], whole["upper"][key], equal_nan=True)


def test_names_are_checked(tmp_path, capsys):
    """Unknown names are refused; `explain` lists the others."""
    for keep in (["upper.foo"], ["W"], ["theta"], ["lower.W", "upper.f1_x"], ["side.W"]):
        with pytest.raises(InputError, match=r"output\.keep\[[01]\]: must be a quantity of a sur"):
            tribo.simulate(scene(keep=keep), **HOW)
    for keep in ([], "upper.W", [3]):
        with pytest.raises(InputError, match="keep"):
            Output(keep=keep)
    path = tmp_path / "scene.toml"
    replace(scene(keep=KEEP), numerics=tribo.Numerics(**HOW)).save(path)
    assert tribo.load_scene(path).output.keep == KEEP
    assert main(["explain", str(path)]) == 0
    assert "Recorded: only upper.W, upper.x_cm, contact_energy." in capsys.readouterr().out


def test_ensembles_and_sweeps():
    """Members and points keep the scene's quantities, and average the friction force over time."""
    forces = ["upper.friction_force", "upper.W"]
    thetas = np.array([0.0, 0.05])
    data = tribo.ensemble(scene(keep=forces), 2, {"upper.theta": thetas[:, None]}, **HOW)
    alone = tribo.prepare(scene(series=["forces"]), **HOW)
    for k, theta in enumerate(thetas):
        result = alone.run({"upper.theta": theta})
        average = result.friction_force("upper")
        assert data["upper.friction_force"].values[k] == average.mean
        half_width = data["upper.friction_force_time_half_width"].values[k]
        assert np.array_equal(half_width, average.half_width, equal_nan=True)
        assert data["upper.W"].values[k] == result["upper"].W[-1]
    assert data["upper.friction_force"].attrs["units"] == "force"
    assert "averaged over time" in data["upper.friction_force"].attrs["long_name"]
    series = tribo.ensemble(
        scene(), 2, {"upper.theta": thetas[:, None]}, **HOW, keep=forces, at="samples"
    )
    assert np.array_equal(series["upper.friction_force"][1], result["upper"].friction_force)
    mean = mean_band(series, "upper.friction_force").get_lines()[-1].get_ydata()
    assert np.array_equal(mean, series["upper.friction_force"].values.mean(axis=0))
    points = sweep(scene(keep=forces), {"upper.theta": [0.0, 0.05]}, **HOW)
    for name in (*forces, "upper.friction_force_time_half_width"):
        assert np.array_equal(points[name], data[name], equal_nan=True)
    with pytest.raises(InputError, match=r"output\.samples: must be at least 3 for averages of"):
        tribo.ensemble(scene(samples=2), 2, {"upper.theta": thetas[:, None]}, keep=forces, **HOW)


def test_averages_leave_out_the_run_in(tmp_path, capsys):
    """Of results, their JSON, ensembles and sweeps, by a key of the scene."""
    keep, output = ["upper.friction_force"], {"series": ("forces",), "run_in": 1.5}
    path = tmp_path / "scene.toml"
    late = replace(scene(samples=81, **output), numerics=tribo.Numerics(**HOW))
    late.save(path)
    assert tribo.load_scene(path).output.run_in == 1.5
    result = tribo.simulate(late)
    average = result.friction_force("upper")
    assert average[0] == result.friction_force("upper", after=1.5)[0] and average.after == 1.5
    assert average.mean != pytest.approx(result.friction_force("upper", after=0.0).mean, rel=0.1)
    assert result.end["friction_force"]["upper"]["mean"] == average.mean
    assert main(["run", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["friction_force"]["upper"]["mean"] == average.mean
    points = sweep(late, {"upper.theta": [0.0]}, keep=keep)
    members = tribo.ensemble(late, 2, {"upper.theta": np.zeros((2, 1))}, keep=keep)
    for data in (points, members):
        assert data["upper.friction_force"].values[0] == average.mean
        half_width = data["upper.friction_force_time_half_width"].values[0]
        assert np.array_equal(half_width, average.half_width, equal_nan=True)
    with pytest.raises(InputError, match=r"at least 3 from t = 3.99 on for averages"):
        sweep(
            replace(late, output=replace(late.output, run_in=3.99)),
            {"upper.theta": [0.0]},
            keep=keep,
        )
    with pytest.raises(InputError, match=r"run_in: must not be negative \[time\], got -1"):
        Output(run_in=-1)
