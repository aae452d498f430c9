"""The commands `tribo fit` and `tribo sensitivity` give what the functions give."""

import json

import numpy as np
import pytest

import tribo
from support.command import main

CASE = tribo.paper.scene("A")


@pytest.fixture
def files(tmp_path):
    """A scene file, and its angle as a table without noise."""
    CASE.save(tmp_path / "a.toml")
    result = tribo.simulate(CASE)
    rows = [f"{t},{angle}" for t, angle in zip(result.t, result["upper"].theta[:, 0], strict=True)]
    (tmp_path / "angle.csv").write_text("\n".join(["time,upper.theta", *rows[::8]]))
    return tmp_path


def test_fit(files, capsys):
    """The strength is found, as JSON and in words; a figure is drawn; errors name the option."""
    scene, trace = str(files / "a.toml"), str(files / "angle.csv")
    command = ["fit", scene, trace, "--quantity", "upper.theta", "--starts", "8", "--no-profiles"]
    vary = ["--vary", "interaction.strength=0.1:0.4"]
    figure = files / "fit.png"
    assert main([*command, *vary, "--json", "--figure", str(figure)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["values"]["interaction.strength"] == pytest.approx(0.2, abs=1e-3)
    assert found["runs"] >= 8 and figure.stat().st_size > 0
    for wrong, message in (
        (["--vary", "interaction.strength=0.4"], "--vary interaction.strength: must be LOW:HIGH"),
        (["--vary", "interaction.strength=0.4:0.1"], "--vary interaction.strength: must grow"),
        ([*vary, "--noise", "-1"], "--noise"),
    ):
        assert main([*command, *wrong]) == 2
        assert message in capsys.readouterr().err


def test_sensitivity(files, capsys):
    """Derivatives as JSON and as a table, the largest first."""
    scene = str(files / "a.toml")
    keys = "upper.velocity,interaction.strength"
    command = ["sensitivity", scene, "--keep", "upper.W", "--keys", keys, "--accuracy", "1e-6"]
    figure = files / "tornado.png"
    assert main([*command, "--json", "--figure", str(figure)]) == 0
    found = json.loads(capsys.readouterr().out)
    names = [row["key"] for row in found["derivatives"]]
    assert names == keys.split(",") and figure.stat().st_size > 0
    slope = found["derivatives"][1]
    values = [
        tribo.simulate(tribo.model.parameters.with_values(CASE, {"interaction.strength": s}))
        for s in (0.199, 0.201)
    ]
    ends = [float(result["upper"].W[-1]) for result in values]
    assert slope["derivative"] == pytest.approx(np.diff(ends)[0] / 0.002, rel=1e-3)
    assert main([*command]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[2].split()[0] == "interaction.strength"
    assert main(["sensitivity", scene, "--keep", "upper.W", "--keys", "upper.drive"]) == 2
    assert "--keys upper.drive: must be a number" in capsys.readouterr().err
