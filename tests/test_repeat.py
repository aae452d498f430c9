"""`tribo run FILE.nc` repeats a run from its file, bit for bit, or says what differs."""

import hashlib
import json

import numpy as np
import pytest

import tribo
from support.command import main
from tribo import InputError, paper
from tribo.commands import repeat

PLUGIN = """
from pathlib import Path
from typing import NamedTuple
Path(__file__).with_name("loaded").touch()
class Own(NamedTuple):
    s: float
    def energy(self, r): return self.s / r
"""
SCENE = """
duration = 4.0
interaction = { potential = "own.py:Own", s = 0.2 }
surface = [ { name = "upper", bob = [-1.0, 0.0] }, { name = "lower", facing = "up" } ]
"""


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """The file of case A."""
    path = tmp_path_factory.mktemp("run") / "run.nc"
    tribo.simulate(paper.scene("A")).save(path)
    return path


def test_repeated_bit_for_bit(stored, tmp_path, capsys):
    """Status 0, and a file with the same series, error estimates and state."""
    again = tmp_path / "again.nc"
    assert main(["run", str(stored), "--json", "--out", str(again)]) == 0
    out, err = capsys.readouterr()
    assert err == f"{stored}: repeated, bit for bit\n"
    before, after = (tribo.load_result(path) for path in (stored, again))
    assert json.loads(out)["surfaces"] == before.end["surfaces"]
    assert before.state().digest == after.state().digest
    assert repeat.differences(before, after) == {}


@pytest.mark.thorough
def test_a_prepared_run(tmp_path, capsys):
    """With initial values of its own, one an asperite, or without estimates: the file has them."""
    simulation = tribo.prepare(paper.scene("A"), accuracy=1e-6)
    kept = {"upper.theta": 0.3, "lower.omega": np.array([-0.1])}
    for name, settings in {
        "as_it_is": {},
        "changed": {"initial": kept},
        "single": {"estimate": False},
        "changed_single": {"initial": kept, "estimate": False},
    }.items():
        path = tmp_path / f"{name}.nc"
        again = tmp_path / f"{name}_again.nc"
        result = simulation.run(**settings)
        assert result["upper"].theta[0, 0] == (0.3 if "initial" in settings else 0.0)
        result.save(path)
        assert main(["run", str(path), "--json", "--out", str(again)]) == 0
        assert capsys.readouterr().err == f"{path}: repeated, bit for bit\n"
        loaded = tribo.load_result(again)
        assert loaded.settings == tribo.load_result(path).settings
        given = loaded.settings["initial"], loaded.settings["estimate"]
        values = {"upper.theta": 0.3, "lower.omega": [-0.1]} if "initial" in settings else {}
        assert given == (values, "estimate" not in settings)
        assert main(["run", str(path), "--json", "--out", str(again), "--resume"]) == 0
        capsys.readouterr()


def test_what_differs(stored, capsys, monkeypatch):
    """Status 1: how many series differ, which most and by how much, and the versions."""
    before = tribo.load_result(stored)
    before["upper"].w1[7] += 0.5
    before.system["contact_energy"][3] = np.nextafter(before.system["contact_energy"][3], 1.0)
    found = repeat.differences(before, tribo.load_result(stored))
    assert list(found) == ["upper.w1", "contact_energy"]
    assert found["upper.w1"] == 0.5 and 0.0 < found["contact_energy"] < 1e-15
    monkeypatch.setattr("tribo.result.load_result", lambda path: before)
    assert main(["run", str(stored)]) == 1
    message = "not repeated bit for bit: 2 series or values differ, upper.w1 by 5.0e-01; other"
    assert f"{stored}: {message}" in capsys.readouterr().err
    before.version = "0.0.1 (abc)"
    assert main(["run", str(stored)]) == 1
    versions = f"the file is by tribo 0.0.1 (abc), and this is {tribo.__version__} ("
    assert f"; {versions}" in capsys.readouterr().err


def test_series_of_other_lengths(stored):
    """A series that one of the runs lacks, or with other times, differs without bound."""
    before = tribo.load_result(stored)
    after = tribo.load_result(stored)
    others = {name: values for name, values in before.system.items() if name != "applied_work"}
    before.ledger.system = others
    assert next(iter(repeat.differences(before, after).items())) == ("applied_work", np.inf)


def test_plugins_are_found_on_disk(tmp_path, capsys):
    """Never in the file: a changed, missing or refused plug-in is named, with status 2."""
    own, scene, out = (tmp_path / name for name in ("own.py", "scene.toml", "run.nc"))
    own.write_text(PLUGIN)
    scene.write_text(SCENE)
    tribo.simulate(tribo.load_scene(scene), method="verlet", step=0.1).save(out)
    assert main(["run", str(out)]) == 0
    assert "repeated, bit for bit" in capsys.readouterr().err
    (tmp_path / "loaded").unlink()
    assert main(["run", str(out), "--no-plugins"]) == 2
    assert "own.py:Own, which --no-plugins refuses" in capsys.readouterr().err
    assert not (tmp_path / "loaded").exists()
    own.write_text(PLUGIN.replace("/ r", "/ r**2"))
    assert main(["run", str(out)]) == 2
    assert "own.py:Own, or a value that it reads, has changed since" in capsys.readouterr().err
    own.unlink()
    assert main(["run", str(out)]) == 2
    assert "own.py" in capsys.readouterr().err


def test_a_plugin_of_a_result_of_version_0_2(tmp_path, capsys, monkeypatch):
    """Its stamp depends on the folder, so it is compared where the file lies; edited, refused."""
    own, scene, out = (tmp_path / name for name in ("own.py", "scene.toml", "run.nc"))
    own.write_text(PLUGIN)
    # Two asperites on one, whose loop is compiled for no potential.
    scene.write_text(SCENE.replace('"upper",', '"upper", shape = [2, 1], spacing = [3.0, 0.0],'))
    module = "tribo_plugin_" + _hash(f"{own}{PLUGIN}")
    stamps = {"interaction[0].potential": _hash(f"{module}.Own{PLUGIN}")}
    monkeypatch.setattr("tribo.results.result_file.plugin_stamps", lambda scene: stamps)
    tribo.simulate(tribo.load_scene(scene), method="verlet", step=0.1).save(out)
    assert main(["run", str(out)]) == 0
    assert "repeated, bit for bit" in capsys.readouterr().err
    own.write_text(PLUGIN.replace("/ r", "/ r**2"))
    assert main(["run", str(out)]) == 2
    assert "own.py:Own, or a value that it reads, has changed since" in capsys.readouterr().err


def _hash(text):
    return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


@pytest.mark.parametrize("option", ["--set=duration=1", "--accuracy=1e-3", "--samples=3"])
def test_changes_are_refused(stored, option, capsys):
    """A repeated run takes all settings from its file."""
    assert main(["run", str(stored), option]) == 2
    name = option.split("=")[0]
    message = f"tribo: {name}: cannot go with the file of a run; give a scene file\n"
    assert capsys.readouterr().err == message


def test_continued_runs_are_refused(stored):
    """The state where such a run began is not in its file."""
    result = tribo.load_result(stored)
    result.settings["start"] = "0123"
    with pytest.raises(InputError, match="start: is the state of another run, which the file"):
        repeat.repeat(result)
