"""`tribo ensemble`: the data set of tribo.ensemble in a file, and refusals."""

import json

import numpy as np
import pytest
import xarray
from scipy import stats
from scipy.stats import qmc

import tribo
from support.command import main
from tribo import ensemble, paper, plotting
from tribo.ensembles import batches
from tribo.model.parameters import with_values
from tribo.progress import ProgressBar

HISTOGRAM = plotting.histogram


def test_the_file_has_the_members(tmp_path, capsys):
    """Bit for bit those of tribo.ensemble with the same seed."""
    scene = paper.scene("A")
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(scene.to_toml(), encoding="utf-8")
    vary = ["--vary", "upper.theta=normal(0,0.1)", "--vary", "lower.omega=uniform(-0.1, 0.1)"]
    keep = "upper.w1,contact_energy"
    command = ["ensemble", str(path), *vary, "--members", "70", "--keep", keep, "--seed", "3"]
    assert main([*command, "--out", str(out)]) == 0
    assert "70 completed" in capsys.readouterr().out
    assert main([*command, "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    drawn = {"upper.theta": stats.norm(0.0, 0.1), "lower.omega": stats.uniform(-0.1, 0.2)}
    data = ensemble(scene, 70, drawn, seed=3, keep=keep.split(","))
    with xarray.open_dataset(out) as file:
        for name in (*keep.split(","), "upper.theta", "lower.omega", "status"):
            np.testing.assert_array_equal(file[name], data[name])
    assert table["members"] == {"completed": 70} and table["n"] == 70
    numbers = table["quantities"]["upper.w1"]
    values = data["upper.w1"].values
    assert numbers["mean"] == pytest.approx(np.mean(values), rel=1e-14, abs=0.0)
    # Of a sample of 70 members.
    assert numbers["deviation"] == pytest.approx(np.std(values, ddof=1), rel=1e-12, abs=0.0)
    half_width = stats.t.ppf(0.975, 69) * stats.sem(values.ravel())
    assert numbers["half_width"] == pytest.approx(half_width, rel=1e-10)


def test_the_interval_of_a_mean_over_asperites(tmp_path, capsys):
    """Asperites of a member are not independent: the sample is their means, also of statistics."""
    upper = tribo.Surface("upper", shape=(2, 1), spacing=(3.0, 0.0))
    scene = tribo.Scene((upper,), (), 1.0, output=tribo.Output(samples=3))
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    scene.save(path)
    command = ["ensemble", str(path), "--vary", "upper.theta=normal(0,0.1)", "--members", "9"]
    command += ["--keep", "upper.omega", "--step", "0.01"]
    assert main([*command, "--out", str(out)]) == 0
    head, row = capsys.readouterr().out.splitlines()[2:4]
    assert head.split() == ["quantity", "mean", "deviation", "half-width"]
    with xarray.open_dataset(out) as data:
        half_width = stats.t.ppf(0.975, 8) * stats.sem(data["upper.omega"].mean("upper_asperite"))
    assert float(row.split()[3]) == pytest.approx(half_width, rel=1e-5)
    assert main([*command, "--statistics", "--json"]) == 0
    table = json.loads(capsys.readouterr().out)["quantities"]["upper.omega"]
    assert table["half_width"] == pytest.approx(half_width, rel=1e-9)


@pytest.mark.thorough
def test_a_histogram(tmp_path, capsys, monkeypatch):
    """Of the first quantity, of a scene with the values of --set; members are needed."""
    path, figure = tmp_path / "a.toml", tmp_path / "a.png"
    paper.scene("A").save(path)
    drawn = []

    def histogram(*arguments):
        drawn.append(arguments)
        return HISTOGRAM(*arguments)

    monkeypatch.setattr(plotting, "histogram", histogram)
    vary = ["--vary", "upper.theta=normal(0,0.1)", "--set", "interaction.strength=0.3"]
    command = ["ensemble", str(path), *vary, "--members", "20", "--figure", str(figure)]
    assert main(command) == 0
    assert main([*command, "--keep", "lower.w1,upper.W"]) == 0
    scene = with_values(paper.scene("A"), {"interaction.strength": 0.3})
    data = ensemble(scene, 20, {"upper.theta": stats.norm(0.0, 0.1)}, keep=["upper.W", "lower.w1"])
    for (values, name), want in zip(drawn, ("upper.W", "lower.w1"), strict=True):
        assert name == f"{want} at the end"
        np.testing.assert_allclose(values, np.ravel(data[want]), rtol=1e-6)
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert main([*command, "--statistics"]) == 2
    assert "--figure: needs the members" in capsys.readouterr().err


def test_statistics_of_a_grid(tmp_path, capsys):
    """In a file that a second command only reads; other arguments are refused by name."""
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(paper.scene("A").to_toml(), encoding="utf-8")
    vary = ["--vary", "upper.theta=grid(0,0.2,5)", "--vary", "upper.omega=grid(-1,1,3)"]
    command = ["ensemble", str(path), *vary, "--keep", "upper.w1", "--statistics", "--resume"]
    command += ["--out", str(out)]
    assert main(command) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == ["completed: 15 of 15 members", "15 completed"]
    assert any("members on a grid are no random sample" in line for line in lines)
    plane = {
        "upper.theta": np.repeat(np.linspace(0.0, 0.2, 5), 3),
        "upper.omega": np.tile([-1.0, 0.0, 1.0], 5),
    }
    data = ensemble(paper.scene("A"), vary=plane, keep=["upper.w1"])
    (row,) = (line.split() for line in lines if line.startswith("upper.w1 "))
    assert float(row[1]) == pytest.approx(float(data["upper.w1"].mean()), rel=1e-5)
    assert main(command) == 0
    assert capsys.readouterr().out.splitlines()[:-1] == lines[:-1]
    assert main([*command, "--seed", "1"]) == 2
    assert "settings.seed was 0, is 1" in capsys.readouterr().err
    masses = ["--vary", "upper.asperite.m1=normal(1,1)", "--members", "100"]
    assert main(["ensemble", str(path), *masses]) == 2
    assert "--vary upper.asperite.m1[0]: must be positive" in capsys.readouterr().err
    mixed = ["--vary", "lower.omega=normal(0,1)"]
    assert main([*command, *mixed]) == 2
    assert "cannot mix grid(...)" in capsys.readouterr().err
    assert main(["ensemble", str(path), *vary, "--resume"]) == 2
    assert "--resume: needs --out FILE" in capsys.readouterr().err


def test_an_interrupt_keeps_the_file(tmp_path, capsys, monkeypatch):
    """Exit status 1, and the number of members that FILE.part has."""
    monkeypatch.setattr(batches, "CHUNK", 64)
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(paper.scene("A").to_toml(), encoding="utf-8")

    def stop(bar, done):
        raise KeyboardInterrupt

    command = ["ensemble", str(path), "--vary", "upper.theta=normal(0,0.1)", "--members", "200"]
    command += ["--keep", "upper.w1", "--out", str(out), "--resume"]
    with monkeypatch.context() as context:
        context.setattr("tribo.progress._is_watched", lambda: True)
        context.setattr("tribo.progress.ProgressBar.__call__", stop)
        assert main(command) == 1
    printed = capsys.readouterr().out
    assert printed.startswith("Interrupted: 64 of 200 members\n64 completed\n")
    assert "\nupper.w1 " not in printed  # its mean takes long with many members
    assert f"interrupted; the finished members are in {out}.part; --resume goes on" in printed
    assert not out.exists()
    assert main(command) == 0
    assert capsys.readouterr().out.startswith("completed: 200 of 200 members\n")
    assert out.exists()


@pytest.mark.parametrize("settings", [[], ["--statistics"]])
def test_an_interrupt_without_a_file(tmp_path, capsys, monkeypatch, settings):
    """The means of the members that are finished are printed."""
    monkeypatch.setattr(batches, "CHUNK", 64)
    path = tmp_path / "a.toml"
    path.write_text(paper.scene("A").to_toml(), encoding="utf-8")

    def stop(bar, done):
        if done == 128:
            raise KeyboardInterrupt

    command = ["ensemble", str(path), "--vary", "upper.theta=normal(0,0.1)", "--members", "200"]
    command += ["--keep", "upper.w1", "--json"]
    with monkeypatch.context() as context:
        context.setattr("tribo.progress._is_watched", lambda: True)
        context.setattr("tribo.progress.ProgressBar.__call__", stop)
        assert main([*command, *settings]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "Interrupted" and found["members"] == {"completed": 128}
    assert "those of the finished members" in found["notes"][0]
    data = ensemble(paper.scene("A"), 200, {"upper.theta": stats.norm(0, 0.1)}, keep=["upper.w1"])
    mean = float(data["upper.w1"][:128].mean())
    assert found["quantities"]["upper.w1"]["mean"] == pytest.approx(mean, rel=1e-12, abs=0.0)


def test_a_sampler(tmp_path, capsys):
    """The members are at the sampler's points; without distributions there are none."""
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(paper.scene("A").to_toml(), encoding="utf-8")
    command = ["ensemble", str(path), "--members", "16", "--keep", "upper.w1", "--seed", "5"]
    normal = ["--vary", "upper.theta=normal(0,0.1)", "--vary", "upper.velocity=uniform(0.4,0.6)"]
    for name, kind in (("sobol", qmc.Sobol), ("latin-hypercube", qmc.LatinHypercube)):
        assert main([*command, *normal, "--sampler", name, "--out", str(out)]) == 0
        points = kind(2, rng=np.random.default_rng(5)).random(16)
        with xarray.open_dataset(out) as file:
            drawn = stats.norm(0.0, 0.1).ppf(points[:, 0])
            np.testing.assert_array_equal(file["upper.theta"][:, 0], drawn)
    capsys.readouterr()
    assert main([*command, "--vary", "upper.theta=grid(0,1,16)", "--sampler", "sobol"]) == 2
    assert "--sampler: needs distributions" in capsys.readouterr().err


def test_the_rate_of_a_resumed_bar(monkeypatch):
    """Members that were read from a file do not count."""
    monkeypatch.setattr("tribo.progress.DELAY", 0.0)
    bar = ProgressBar(3000, "members")
    bar(1000)
    bar(1500)
    assert bar._bar.format_dict["initial"] == 1000
    assert bar._bar.format_dict["n"] == 1500
    bar(1500.0000000000002)
    assert " 1500/3000 members [" in str(bar._bar)
    bar.close()


def test_means_over_time(tmp_path, capsys):
    """Without --keep: the means of tribo.ensemble, and those at the end in print."""
    scene = paper.scene("A")
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(scene.to_toml(), encoding="utf-8")
    arguments = ["ensemble", str(path), "--vary", "upper.theta=normal(0,0.1)", "--members", "4"]
    assert main([*arguments, "--out", str(out)]) == 0
    data = ensemble(scene, 4, {"upper.theta": stats.norm(0.0, 0.1)})
    with xarray.open_dataset(out) as file:
        np.testing.assert_array_equal(file["upper.W_mean"], data["upper.W_mean"])
    lines = capsys.readouterr().out.splitlines()
    (row,) = (line.split() for line in lines if line.startswith("upper.W "))
    assert float(row[1]) == pytest.approx(float(data["upper.W_mean"][-1]), rel=1e-5)
    assert main([*arguments, "--json"]) == 0
    table = json.loads(capsys.readouterr().out)["quantities"]["upper.W"]
    assert table["half_width"] == float(data["upper.W_half_width"][-1])


def test_a_half_width_determines_the_members(tmp_path, capsys):
    """As the argument of tribo.ensemble, and of tribo.sweep at each point."""
    scene = paper.scene("A")
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(scene.to_toml(), encoding="utf-8")
    settings = ["--vary", "upper.theta=normal(0,0.1)", "--half-width", "upper.W=0.02"]
    settings += ["--step", "0.1"]
    assert main(["ensemble", str(path), *settings, "--out", str(out)]) == 0
    how = {"half_width": {"upper.W": 0.02}, "step": 0.1}
    data = ensemble(scene, vary={"upper.theta": stats.norm(0.0, 0.1)}, **how)
    with xarray.open_dataset(out) as file:
        assert file.sizes["member"] == data.sizes["member"] > 16
        np.testing.assert_array_equal(file["upper.W_mean"], data["upper.W_mean"])
    capsys.readouterr()
    assert main(["sweep", str(path), "--set", "interaction.strength=0.2", *settings, "--json"]) == 0
    (point,) = json.loads(capsys.readouterr().out)["points"]
    assert point["members"] == {"completed": data.sizes["member"]}
    for wrong in ("upper.W", "upper.W=wide", "upper.nothing=1"):
        assert main(["ensemble", str(path), *settings[:2], "--half-width", wrong]) == 2
        assert "half" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ("", "--members: is missing; give a number, or the half-width of a mean"),
        ("--members 4", "--vary: is empty"),
        ("--members 0", "--members: must be an integer of at least 2, got 0"),
        ("--half-width upper.W=-1", "--half-width upper.W: must be positive, got -1.0"),
        ("--members 4 --keep uper.W", "--keep uper.W: must be a quantity"),
        ("--members 4 --step 0", "--step: must be positive [time], got 0.0"),
    ],
)
def test_messages_name_options(tmp_path, capsys, given, problem):
    """Not the arguments of the function behind a command."""
    path = tmp_path / "a.toml"
    path.write_text(paper.scene("A").to_toml(), encoding="utf-8")
    vary = [] if "--vary" in problem else ["--vary", "upper.theta=normal(0,0.1)"]
    assert main(["ensemble", str(path), *vary, *given.split()]) == 2
    assert capsys.readouterr().err.startswith(f"tribo: {problem}")


def test_an_unresolved_step_may_be_allowed(tmp_path, capsys):
    """For runs, ensembles and sweeps."""
    stiff = tribo.Surface("upper", asperite=tribo.Asperite(kappa=1e4))
    scene = tribo.Scene((stiff,), (), 1.0, output=tribo.Output(samples=2))
    scene.save(tmp_path / "a.toml")
    many = ["--vary", "upper.theta=normal(0,0.1)", "--members", "2"]
    for command, *rest in (["run"], ["ensemble", *many], ["sweep", "--set", "duration=1.0,2.0"]):
        arguments = [
            command,
            str(tmp_path / "a.toml"),
            "--method",
            "verlet",
            "--step",
            "0.1",
            *rest,
        ]
        assert main(arguments) != 0
        printed = capsys.readouterr()
        assert "allow_unresolved" in printed.err + printed.out
        assert main([*arguments, "--allow-unresolved"]) == 0
        capsys.readouterr()


@pytest.mark.parametrize(
    "text",
    [
        "upper.theta",
        "upper.theta=cauchy(0,1)",
        "upper.theta=uniform(1,0)",
        "x=normal(0)",
        "x=grid(0,1,1.5)",
    ],
)
def test_refusals(text, tmp_path, capsys):
    """Exit status 2 and the form that is wanted."""
    path = tmp_path / "a.toml"
    path.write_text(paper.scene("A").to_toml(), encoding="utf-8")
    arguments = ["ensemble", str(path), "--vary", text, "--members", "3", "--keep", "upper.w1"]
    assert main(arguments) == 2
    assert "KEY=normal(MEAN,DEVIATION)" in capsys.readouterr().err


def test_averages_over_time_are_named(tmp_path, capsys):
    """A quantity has one value at the end, and another as the average of a member's samples."""
    row = {"shape": (3, 1), "spacing": (1.0, 0.0)}
    upper = tribo.Surface("upper", bob=(0.0, 1.2), velocity=(0.2, 0.0), **row)
    scene = tribo.Scene(
        [upper, tribo.Surface("lower", facing="up", **row)],
        tribo.LennardJones(0.1, 1.0).with_cutoff(2.5),
        4.0,
        output=tribo.Output(samples=21, series=["forces"]),
    )
    path = tmp_path / "a.toml"
    scene.save(path)
    many = ["ensemble", str(path), "--vary", "upper.theta=normal(0,0.1)", "--members", "4"]
    assert main([*many, "--keep", "upper.friction_force,upper.w1", "--step", "0.05"]) == 0
    text = capsys.readouterr().out
    averaged = ("friction_force", "friction_force_time_half_width", "time_without_contact")
    listed = ", ".join(f"upper.{name}" for name in averaged)
    assert f"\naverages over time: {listed}; others are those at the end\n" in text
    assert main([*many, "--step", "0.05"]) == 0
    text = capsys.readouterr().out
    assert "upper.friction_force " in text and "\nvalues are those at the end\n" in text
