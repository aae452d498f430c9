"""The command line: what is printed, what is written, and with which status it ends."""

import json
import os
import re
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np
import pytest

import tribo
from support.command import main
from tribo import Coulomb, Numerics, Output, Scene, Surface
from tribo.commands import parser, scene_options
from tribo.kernels.status import MEANINGS

# The keys of `tribo run --json`: names that people's programs rely on.
TOP = {
    *("status", "t", "method", "steps", "force_evaluations", "wall_seconds", "compile_seconds"),
    *("surfaces", "blocks", "system", "error_estimate"),
}
MORE = {"accuracy", "accuracy_met", "notes", "why"}
MORE |= {"seconds_for_digit_more", "seconds_for_digit_fewer"}
SURFACE = {
    *("theta", "phi", "omega", "nu", "x_cm", "y_cm", "vx_cm", "vy_cm"),
    *("x_bob", "y_bob", "x_bar", "y_bar"),
    *("w1", "w2", "wL", "wR", "w_int", "w", "w1_ps", "w2_ps", "w_int_ps", "w_ps"),
    *("delta_k_trans", "delta_e_int", "swing_energy"),
}
BLOCK = {"W", "W_ps", "delta_K", "delta_E_int", "friction_work"}
SYSTEM = {"contact_energy", "total_energy_change", "applied_work"}

SCENE = """
title = "A short pass"
duration = 4.0
[interaction]
potential = "coulomb"
strength = 0.2
[[surface]]
name = "upper"
bob = [-1.0, 0.0]
velocity = [0.5, 0.0]
[[surface]]
name = "lower"
facing = "up"
"""
LEAVING_NUMBERS = """
import math
from typing import NamedTuple
class Broken(NamedTuple):
    s: float
    def energy(self, r): return self.s / r if r > 0.9 else math.nan
    def force(self, r): return self.s / r**2 if r > 0.9 else math.nan
"""

# Two that hang side by side and attract each other collide head on.
HEAD_ON = """
title = "A collision"
duration = 4.0
interaction = { potential = "coulomb", strength = -1.0 }
surface = [ { name = "upper", bob = [-1.0, 0.0] }, { name = "lower", bob = [1.0, 0.0] } ]
"""
LONG_STEPS = """
output = { samples = 2 }
numerics = { step = 4.0 }
"""

# Scenes that cannot go on, by the name of what stops them, and when it does.
STOPS = {
    "BobsCoincide": (SCENE.replace("[-1.0, 0.0]", "[0.0, 0.0]"), (0.0, 0.0)),
    "NotFinite": (SCENE.replace('"coulomb"\nstrength', '"broken.py:Broken"\ns'), (0.1, 3.9)),
    "EncounterJumped": (LONG_STEPS + SCENE, (0.0, 0.0)),
    "StepUnderflow": (HEAD_ON, (1.0, 3.9)),
}


@pytest.fixture
def run(tmp_path, capsys):
    """Write a scene file, run it with some options; returns status, stdout and stderr."""

    def call(text, *options):
        path = tmp_path / "scene.toml"
        path.write_text(text)
        (tmp_path / "broken.py").write_text(LEAVING_NUMBERS)
        status = main(["run", str(path), *options])
        return status, *capsys.readouterr()

    return call


def strictly(text):
    """The data in a JSON text without NaN or Infinity."""

    def refuse(word):
        raise ValueError(f"{word} is not JSON")

    return json.loads(text, parse_constant=refuse)


def test_text(run):
    """Without --json: one line on the run, one a surface, and what one may do next."""
    status, out, err = run(SCENE)
    assert status == 0 and err == ""
    first, *rest = out.splitlines()
    assert first.startswith("A short pass: completed at t = 4; gauss-radau-15, ")
    assert [line.split(":")[0].strip() for line in rest] == ["upper", "lower", "", "Next"]


def test_json(run):
    """The keys are those of the contract, and every value is of its kind."""
    status, out, err = run(SCENE, "--json")
    end = strictly(out)
    assert status == 0 and err == ""
    assert set(end) == TOP | MORE
    assert (end["status"], end["t"], end["method"]) == ("completed", 4.0, "gauss-radau-15")
    assert all(isinstance(end[key], int) and end[key] > 0 for key in ("steps", "force_evaluations"))
    assert list(end["surfaces"]) == list(end["blocks"]) == ["upper", "lower"]
    for name in ("upper", "lower"):
        assert set(end["surfaces"][name]) == SURFACE
        assert set(end["blocks"][name]) == BLOCK
        for values in end["surfaces"][name].values():
            assert len(values) == 1 and isinstance(values[0], float)
    assert set(end["system"]) == SYSTEM
    assert set(end["error_estimate"]) == SURFACE | BLOCK | SYSTEM
    assert all(0.0 <= bound < 1e-6 for bound in end["error_estimate"].values())


def test_field_and_reservoir_add_their_own(run):
    """Where a field or a reservoir is present, so are its works."""
    text = (
        SCENE
        + """langevin = { gamma = 0.1 }
        [[field]]
        kind = "corrugation"
        on = ["upper"]
        amplitude = 0.1
        period = 2.0
        """
    )
    _, out, _ = run(text, "--json")
    end = strictly(out)
    own = {"w_field", "w_field_ps", "w_T", "w_T_ps", "heat"}
    for name in ("upper", "lower"):
        assert set(end["surfaces"][name]) - SURFACE <= own
    everything = {key for table in end["surfaces"].values() for key in table}
    assert everything == SURFACE | own
    assert set(end["error_estimate"]) == everything | BLOCK | SYSTEM


def test_own_step_has_no_error_estimate(run):
    """With a given method and step, the bounds are null."""
    status, out, _ = run("numerics = { method = 'midpoint', step = 0.01 }\n" + SCENE, "--json")
    end = strictly(out)
    assert status == 0 and end["method"] == "midpoint" and end["steps"] == 400
    assert set(end["error_estimate"]) == SURFACE | BLOCK | SYSTEM
    assert set(end["error_estimate"].values()) == {None}


def test_out(run, tmp_path):
    """--out writes a file that loads again and holds what was printed, and leaves nothing else."""
    status, out, _ = run(SCENE, "--json", "--out", str(tmp_path / "run.nc"))
    assert status == 0
    loaded = tribo.load_result(tmp_path / "run.nc")
    assert json.loads(loaded.to_json()) == strictly(out)
    assert loaded.t.size == 401
    assert {p.name for p in tmp_path.iterdir()} == {"scene.toml", "broken.py", "run.nc"}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", STOPS)
def test_run_that_stops(run, tmp_path, name):
    """Status 1; what was reached is printed and kept, and says why."""
    text, (earliest, latest) = STOPS[name]
    status, out, err = run(text, "--json", "--out", str(tmp_path / "run.nc"))
    end = strictly(out)
    assert status == 1 and err == ""
    assert end["status"] == name and earliest <= end["t"] <= latest
    assert set(end["surfaces"]["upper"]) == SURFACE
    loaded = tribo.load_result(tmp_path / "run.nc")
    assert (loaded.status, loaded.t[-1]) == (name, end["t"])
    status, out, _ = run(text)
    first, second, *_ = out.splitlines()
    assert status == 1 and f": {name} at t = " in first
    assert second.strip() == MEANINGS[name]


def test_module():
    """`python -m tribo` is the program, and has its name."""
    command = [sys.executable, "-m", "tribo", "--version"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == f"tribo {tribo.__version__}\n"


def test_paper(capsys, tmp_path, monkeypatch):
    """The table of a case as text and as JSON, which draws nothing."""
    monkeypatch.chdir(tmp_path)
    assert main(["paper", "D"]) == 0
    out = capsys.readouterr().out
    assert [path.name for path in tmp_path.iterdir()] == ["paper.png"]
    Path("paper.png").write_text("mine")
    assert out.startswith('Numbers printed in J. David Brown, "Work Done by Sliding Friction"')
    assert "\nD  free sliding, attractive: 8 of 8 printed numbers agree\n" in out
    assert "\n8 of 8 printed numbers agree. All numbers that the paper prints for the end" in out
    assert main(["paper", "A", "--json"]) == 0
    table = strictly(capsys.readouterr().out)
    assert list(table) == ["A"]
    keys = {"where", "t", "quantity", "printed", "computed", "agrees", "note"}
    for row in table["A"]:
        assert keys <= set(row) <= keys | {"error"}
        assert isinstance(row["agrees"], bool) and isinstance(row["computed"], float)
        assert isinstance(row["printed"], str)
    assert Path("paper.png").read_text() == "mine"


def test_paper_keeps_a_picture(capsys, tmp_path, monkeypatch):
    """A picture of the same name is kept, unless --figure names it."""
    monkeypatch.chdir(tmp_path)
    Path("paper.png").write_text("mine")
    assert main(["paper", "D"]) == 0
    assert "\npaper.png exists and is kept; --figure FILE draws " in capsys.readouterr().out
    assert Path("paper.png").read_text() == "mine"
    assert main(["paper", "D", "--figure", "paper.png"]) == 0
    assert Path("paper.png").read_bytes().startswith(b"\x89PNG")
    assert main(["paper", "D", "--figure", "no/such.png"]) == 2


def test_what_to_do_next(capsys, tmp_path, monkeypatch):
    """The texts of commands end with a next command, which exists; JSON does not."""
    monkeypatch.chdir(tmp_path)
    tribo.paper.scene("D").save("d.toml")
    for command in ("run d.toml", "run d.toml --out d.nc", "explain d.toml", "doctor"):
        assert main(command.split()) == 0
        *_, blank, last = capsys.readouterr().out.splitlines()
        assert not blank and last.startswith("Next:  tribo ")
    assert main(["run", "d.toml", "--json"]) == 0
    assert "Next" not in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main([])
    assert "start with: tribo new -o scene.toml" in capsys.readouterr().err.splitlines()[-1]


@pytest.mark.parametrize("arguments", ["", "jump", "run", "run a.toml --fast", "paper F"])
def test_wrong_arguments(capsys, arguments):
    """argparse says how to use it, and ends with status 2."""
    with pytest.raises(SystemExit) as caught:
        main(arguments.split())
    assert caught.value.code == 2
    assert "usage: tribo" in capsys.readouterr().err


def test_version(capsys):
    """--version prints the package's own."""
    with pytest.raises(SystemExit) as caught:
        main(["--version"])
    assert caught.value.code == 0
    assert capsys.readouterr().out == f"tribo {tribo.__version__}\n"


def test_program():
    """The program that is installed is this `main`."""
    (program,) = entry_points(group="console_scripts", name="tribo")
    assert program.load() is main


def test_scene_from_python_gives_the_same(run, tmp_path):
    """The command line prints what `simulate` returns for the same scene."""
    surfaces = (
        Surface("upper", bob=(-1.0, 0.0), velocity=(0.5, 0.0)),
        Surface("lower", facing="up"),
    )
    scene = Scene(surfaces, Coulomb(0.2), 4.0, title="A short pass")
    _, out, _ = run(SCENE, "--json")
    printed = strictly(out)
    end = tribo.simulate(scene).end
    for key in ("surfaces", "blocks", "system", "error_estimate", "steps", "force_evaluations"):
        assert printed[key] == end[key]


def test_broken_pipe_is_quiet(tmp_path):
    """A reader that goes away is no reason for a traceback."""
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    main = "from tribo.commands.cli import main"
    code = f"import sys; {main}; sys.exit(main(['run', {str(path)!r}, '--json']))"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        process.stdout.close()
        assert "Traceback" not in process.stderr.read()


@pytest.mark.thorough
def test_a_figure_that_cannot_be_drawn(tmp_path):
    """What was computed is printed, with one sentence; files need no backend of a notebook."""
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE, encoding="utf-8")
    (tmp_path / "matplotlibrc").write_text("text.usetex: True", encoding="utf-8")
    figure = tmp_path / "a.png"
    program = [sys.executable, "-m", "tribo"]
    backend = os.environ | {"MPLBACKEND": "module://not_installed", "PATH": ""}
    no_latex = backend | {"MATPLOTLIBRC": str(tmp_path / "matplotlibrc")}
    for words in (["run", scene], ["sweep", scene, "--set", "upper.theta=0.1,0.2"]):
        done = [
            subprocess.run(
                [*program, *words, "--figure", figure], env=env, capture_output=True, text=True
            )
            for env in (backend, no_latex)
        ]
        assert [each.returncode for each in done] == [0, 2]
        assert figure.stat().st_size > 1000 and "completed" in done[1].stdout
        assert re.fullmatch(r"tribo: --figure: .*a\.png cannot be drawn \(.*\)\n", done[1].stderr)


@pytest.mark.skipif(os.name == "nt", reason="needs a shell of POSIX")
@pytest.mark.parametrize(
    "closed",
    [
        pytest.param(">&-", marks=pytest.mark.thorough),
        pytest.param("2>&-", marks=pytest.mark.thorough),
        "<&- >&- 2>&-",
    ],
)
def test_closed_streams(tmp_path, closed):
    """A run completes where a shell or a daemon has closed the streams; its file has no output."""
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE, encoding="utf-8")
    command = f"{sys.executable} -m tribo run {scene} --out {tmp_path / 'run.nc'} {closed}"
    assert subprocess.run(command, shell=True, capture_output=True).returncode == 0
    assert tribo.load_result(tmp_path / "run.nc").status == "completed"
    wrong = f"{sys.executable} -m tribo run {tmp_path / 'none.toml'} {closed}"
    assert subprocess.run(wrong, shell=True, capture_output=True).returncode == 2


def test_output_travels_with_the_file(run, tmp_path):
    """Samples and numerics of the file are obeyed."""
    text = SCENE + "[output]\ntimes = [0.5, 1.0]\n[numerics]\naccuracy = 1e-4\n"
    run(text, "--out", str(tmp_path / "run.nc"))
    loaded = tribo.load_result(tmp_path / "run.nc")
    assert np.array_equal(loaded.t, [0.0, 0.5, 1.0, 4.0])
    assert loaded.accuracy == 1e-4
    assert loaded.scene.output == Output(times=(0.5, 1.0))
    assert loaded.scene.numerics == Numerics(accuracy=1e-4)


def test_values_in_place_of_the_file(run, tmp_path):
    """Options of `run` are those of `simulate`; --set changes the scene that is saved."""
    options = ["--set", "upper.velocity=0.4", "--set", "interaction.strength=.3"]
    options += ["--accuracy", "1e-5", "--samples", "11", "--out", str(tmp_path / "run.nc")]
    figure = tmp_path / "works.svg"
    status, _, err = run("output = { times = [0.5] }\n" + SCENE, *options, "--figure", str(figure))
    loaded = tribo.load_result(tmp_path / "run.nc")
    assert status == 0 and err == ""
    assert loaded.accuracy == 1e-5 and loaded.t.size == 11
    assert loaded.scene.surfaces[0].velocity == (0.4, 0.0)
    assert loaded.scene.interactions[0].potential.strength == 0.3
    assert "<svg" in figure.read_text()[:500]
    status, out, _ = run(SCENE, "--method", "midpoint", "--step", "0.01", "--json")
    end = strictly(out)
    assert status == 0 and (end["method"], end["steps"]) == ("midpoint", 400)


def test_a_table_as_text(run, tmp_path):
    """A file that ends on .csv has the series; it cannot be continued, and has no parts."""
    out = tmp_path / "run.csv"
    status, printed, err = run(SCENE, "--out", str(out), "--samples", "11")
    assert status == 0 and err == "" and "run.nc" not in printed
    head, *rows = out.read_text().splitlines()
    assert head.startswith("time,upper.theta,") and len(rows) == 11
    assert {path.name for path in tmp_path.iterdir()} == {"scene.toml", "broken.py", "run.csv"}
    status, _, err = run(SCENE, "--out", str(out), "--resume")
    assert status == 2 and err.startswith("tribo: --resume: needs a file that ends on .nc, got ")
    status, _, err = run(SCENE, "--out", str(tmp_path / "run.png"))
    assert status == 2 and "must end on .nc or .csv" in err
    assert "--figure writes figures, and tribo view a page" in err


WRONG = [
    (["--set", "upper.velocity"], "--set: must be KEY=VALUE, got 'upper.velocity'"),
    (["--set", "uper.theta=1"], '--set uper.theta: is not a known key; did you mean "upper.theta"'),
    (["--set", "upper.theta=much"], "--set upper.theta: must be a number [rad], got 'much'"),
    (["--set", "duration=1", "--set", "duration=2"], "--set duration: is given twice"),
    (["--accuracy", "much"], "--accuracy: must be a number, got 'much'"),
    (["--accuracy", "2"], "--accuracy: must be from 1e-13 to 0.1"),
    (["--accuracy", "1e-6", "--step", "0.1"], "--accuracy: cannot go with a step"),
    (["--method", "euler"], "--method: must be"),
    (["--step", "-1"], "--step: must be positive"),
    (["--step", "0"], "--step: must be positive"),
    (["--samples", "1"], "--samples: must be an integer of at least 2, got 1"),
    (["--figure", "works.gif"], "--figure: must end on"),
]


@pytest.mark.parametrize(("options", "problem"), WRONG, ids=[" ".join(w[0]) for w in WRONG])
def test_wrong_values(run, monkeypatch, options, problem):
    """One line that names the option and what would do, before anything is compiled."""
    for place in ("tribo.loops.select.Pair", "tribo.loops.select.compile_loop"):
        monkeypatch.setattr(place, lambda *arguments: pytest.fail("compiled"))
    status, out, err = run(SCENE, *options)
    assert status == 2 and out == ""
    assert err.startswith(f"tribo: {problem}") and err.count("\n") == 1


def test_what_is_given_without_an_option():
    """Messages about all else name the option, which has the name of its value."""
    (commands,) = (each.choices for each in parser._parser()._actions if each.choices)
    places = {"command"}
    for command in commands.values():
        for action in command._actions:
            if not action.option_strings:
                places.add(action.dest)
            else:
                assert f"--{action.dest.replace('_', '-')}" in action.option_strings
    assert places == scene_options.ARGUMENTS


def test_set_on_explain(tmp_path, capsys):
    """`explain` takes --set too: a load is one more effect."""
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    for options, present in (([], False), (["--set", "upper.drive.load=0.4"], True)):
        assert main(["explain", str(path), "--json", *options]) == 0
        assert ("load" in strictly(capsys.readouterr().out)["effects"]) == present
