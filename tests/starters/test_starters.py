"""Scene files to start from load, and run; the doctor knows a wrong machine from a right one."""

import pytest

import tribo
from support.command import main
from tribo.commands import doctor
from tribo.starters import KINDS, starter


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_scene_loads(kind, tmp_path, capsys):
    path = tmp_path / f"{kind}.toml"
    assert main(["new", kind, "-o", str(path)]) == 0
    scene = tribo.load_scene(path)
    assert scene.title and scene.count >= 1
    assert capsys.readouterr().out.startswith(f"{path}: {KINDS[kind]}")
    assert main(["new", kind, "-o", str(path)]) == 2
    assert "--out: must be a new file" in capsys.readouterr().err
    assert path.read_text() == starter(kind)
    assert sum("#" in line for line in starter(kind).splitlines()) >= 5


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_new_scene_runs(kind, tmp_path):
    (tmp_path / "scene.toml").write_text(starter(kind))
    result = tribo.simulate(tribo.load_scene(tmp_path / "scene.toml"))
    assert result.status == "completed" and result.met
    assert result.notes == ()


def test_the_first_scene_is_the_papers(tmp_path, capsys):
    assert main(["new"]) == 0
    (tmp_path / "a.toml").write_text(capsys.readouterr().out)
    result = tribo.simulate(tribo.load_scene(tmp_path / "a.toml"))
    assert result["upper"].w[-1, 0] == pytest.approx(doctor.KNOWN_WORK, abs=1e-6)


@pytest.mark.parametrize("case", "ABCDE")
def test_a_case_of_the_paper(case, tmp_path, capsys):
    """Its file is that of the case, without the values that a file need not give."""
    path = tmp_path / "case.toml"
    assert main(["new", case, "-o", str(path)]) == 0
    assert capsys.readouterr().out.startswith(f"{path}: case {case} of the paper")
    assert tribo.load_scene(path) == tribo.paper.scene(case)
    assert not {"samples", "seed", "bar_length"} & set(path.read_text().split())


def test_doctor(capsys, monkeypatch, tmp_path):
    assert main(["doctor"]) == 0
    lines = filter(None, capsys.readouterr().out.splitlines())
    said = dict(line.split(maxsplit=1) for line in lines)
    assert {"python", "tribo", "numba", "cores", "cache", "known"} <= said.keys()
    assert "agrees with 0.519665" in said["known"]
    assert said["writing"].startswith("new code goes to /")
    monkeypatch.setattr(doctor, "cache_folder", lambda loop: None)
    monkeypatch.setattr(doctor, "KNOWN_WORK", 0.52)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert main(["doctor"]) == 1
    said = capsys.readouterr().out
    assert "DIFFERS from" in said and "no compiled functions yet" in said
    assert "cannot be written: each start compiles again; set NUMBA_CACHE_DIR" in said
