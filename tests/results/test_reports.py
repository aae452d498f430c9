"""Results for readers: representations, tables, progress."""

import csv

import numpy as np
import pytest

import tribo
from tribo import InputError, Output, paper, prepare, progress

SCENE = paper.scene("A")


@pytest.fixture(scope="module")
def result():
    """Case A."""
    return tribo.simulate(SCENE, accuracy=1e-6)


def test_representations_fit_a_screen(result):
    """A result, its series and its ledger say what they are in a few lines."""
    for item in (result, result["upper"], result.system, result.ledger, result.state()):
        lines = repr(item).splitlines()
        assert len(lines) <= 12 and max(map(len, lines)) <= 200
        assert "object at 0x" not in repr(item)
    assert repr(result) == str(result)
    assert "theta" in repr(result["upper"]) and "applied_work" in repr(result.system)
    assert "401 times" in repr(result.ledger)


def test_the_error_in_the_summary_has_one_unit():
    """That of energies: of numbers in SI units, lengths and rates are larger by many powers."""
    small = tribo.Asperite(m1=1e-21, m2=2e-21, kappa=2e-21, length=2e-9, bar_length=3e-9, i2=5e-39)
    start = {"bob": (-1e-8, 0.0), "velocity": (0.5, 0.0)}
    upper = tribo.Surface("upper", asperite=small, **start)
    lower = tribo.Surface("lower", facing="up", asperite=small)
    result = tribo.simulate(tribo.Scene((upper, lower), tribo.Coulomb(2e-31), 4e-8))
    text = str(result).splitlines()[0]
    largest = max(result.error_estimate[name] for name in ("w1", "w", "W", "applied_work"))
    shown = float(text.rpartition("errors of energies up to ")[2])
    assert 0.9 * largest <= shown < 3.0 * largest
    assert max(value for value in result.error_estimate.values()) > 1e3 * shown


def test_html(result):
    """In a notebook: the surfaces at the end with their errors, and nothing unescaped."""
    text = result._repr_html_()
    assert "<table>" in text and f"{result['upper'].W[-1]:.6g}" in text
    assert f"{result.error_estimate['W']:.1e}" in text
    titled = tribo.Scene(SCENE.surfaces, SCENE.interactions, 1.0, title="<script>")
    assert "<script>" not in tribo.simulate(titled)._repr_html_()


def test_csv(result, tmp_path):
    """save("x.csv") writes all series, a column each."""
    path = tmp_path / "series.csv"
    result.save(path)
    with path.open(newline="") as file:
        head, *rows = csv.reader(file)
    assert head[0] == "time" and len(rows) == 401
    columns = dict(zip(head, np.array(rows, dtype=float).T, strict=True))
    np.testing.assert_array_equal(columns["upper.theta"], result["upper"].theta[:, 0])
    np.testing.assert_array_equal(columns["lower.W"], result["lower"].W)
    np.testing.assert_array_equal(columns["applied_work"], result.system["applied_work"])


@pytest.mark.parametrize("name", ["run.json", "run.pdf", "run.PNG", "run.html", "run"])
def test_other_formats_are_refused(result, tmp_path, name):
    """No NetCDF file has the name of another format; nor has a run's own file that of a table."""
    with pytest.raises(InputError, match=r"must end on \.nc"):
        result.save(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_other_formats_keep_the_file_that_is_there(tmp_path):
    """Of runs, ensembles with members and with statistics, and sweeps."""
    there = tmp_path / "mine.csv"
    there.write_text("mine")
    refused = pytest.raises(
        InputError, match=r"out: must end on \.nc.*got '.*mine\.csv'; .*to_html"
    )
    kept = {"vary": {"upper.theta": [0.1, 0.2]}, "keep": ["upper.w1"], "out": there}
    with refused:
        tribo.simulate(SCENE, out=there)
    with refused:
        tribo.sweep(SCENE, {"duration": [1.0, 2.0]}, out=there)
    for settings in ({}, {"statistics": True}):
        with refused:
            tribo.ensemble(SCENE, **kept, **settings)
    assert there.read_text() == "mine" and len(list(tmp_path.iterdir())) == 1


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")
def test_interrupted_runs_have_the_same_estimates():
    """Names that an accuracy asks for stay after an interrupt."""
    asked = {"upper.W": 1e-6}
    whole = tribo.simulate(SCENE, asked)

    def interrupt(t):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        tribo.simulate(SCENE, asked, progress=interrupt)
    part = caught.value.result
    assert part.status == "Interrupted" and "upper.W" in whole.error_estimate
    assert list(part.error_estimate) == list(whole.error_estimate)
    assert set(part.error_estimate.values()) == {None}


def test_progress(monkeypatch, capsys):
    """True shows a bar; without it only a terminal does; False never."""
    scene = tribo.Scene(SCENE.surfaces, SCENE.interactions, 40.0, output=Output(samples=2))
    monkeypatch.setattr(progress, "DELAY", 0.0)
    tribo.simulate(scene, progress=True)
    assert "%|" in capsys.readouterr().err
    tribo.simulate(scene)
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(progress, "_is_watched", lambda: True)
    tribo.simulate(scene)
    assert "%|" in capsys.readouterr().err
    tribo.simulate(scene, progress=False)
    assert capsys.readouterr().err == ""
    for function in (tribo.simulate, prepare):
        with pytest.raises(InputError, match="progress: must be a function"):
            function(scene, progress="yes")
