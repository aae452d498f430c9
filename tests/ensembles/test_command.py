"""`tribo ensemble`: the data set of tribo.ensemble in a file, and refusals."""

import numpy as np
import pytest
import xarray
from scipy import stats

from tribo import ensemble, paper
from tribo.cli import main
from tribo.model.scene_writer import scene_text


def test_the_file_has_the_members(tmp_path, capsys):
    """Bit for bit those of tribo.ensemble with the same seed."""
    scene = paper.scene("A")
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(scene_text(scene), encoding="utf-8")
    vary = ["--vary", "upper.theta=normal(0,0.1)", "--vary", "lower.omega=uniform(-0.1, 0.1)"]
    keep = "upper.w1,contact_energy"
    command = ["ensemble", str(path), *vary, "-n", "70", "--keep", keep, "--seed", "3"]
    assert main([*command, "--out", str(out)]) == 0
    assert "70 completed" in capsys.readouterr().out
    drawn = {"upper.theta": stats.norm(0.0, 0.1), "lower.omega": stats.uniform(-0.1, 0.2)}
    data = ensemble(scene, 70, drawn, seed=3, keep=keep.split(","))
    with xarray.open_dataset(out) as file:
        for name in (*keep.split(","), "upper.theta", "lower.omega", "status"):
            np.testing.assert_array_equal(file[name], data[name])


def test_means_over_time(tmp_path, capsys):
    """Without --keep: the means of tribo.ensemble, and those at the end in print."""
    scene = paper.scene("A")
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(scene_text(scene), encoding="utf-8")
    arguments = ["ensemble", str(path), "--vary", "upper.theta=normal(0,0.1)", "-n", "4"]
    assert main([*arguments, "--out", str(out)]) == 0
    data = ensemble(scene, 4, {"upper.theta": stats.norm(0.0, 0.1)})
    with xarray.open_dataset(out) as file:
        np.testing.assert_array_equal(file["upper.W_mean"], data["upper.W_mean"])
    lines = capsys.readouterr().out.splitlines()
    (row,) = (line.split() for line in lines if line.startswith("upper.W "))
    assert float(row[1]) == pytest.approx(float(data["upper.W_mean"][-1]), rel=1e-5)


@pytest.mark.parametrize(
    "text", ["upper.theta", "upper.theta=cauchy(0,1)", "upper.theta=uniform(1,0)", "x=normal(0)"]
)
def test_refusals(text, tmp_path, capsys):
    """Exit status 2 and the form that is wanted."""
    path = tmp_path / "a.toml"
    path.write_text(scene_text(paper.scene("A")), encoding="utf-8")
    arguments = ["ensemble", str(path), "--vary", text, "-n", "3", "--keep", "upper.w1"]
    assert main(arguments) == 2
    assert "KEY=normal(MEAN,DEVIATION)" in capsys.readouterr().err
