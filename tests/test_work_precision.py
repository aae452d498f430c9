"""Error against cost: the front, the reference, the figure, the JSON; means where noise acts."""

import json
from dataclasses import replace
from importlib import import_module
from itertools import pairwise
from types import SimpleNamespace

import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st

import tribo
from support.command import main
from tribo import interrupts
from tribo import work_precision as module
from tribo.integrators.methods import METHODS
from tribo.layout.layout import lay_out
from tribo.loops.setting import Setting
from tribo.work_precision import (
    MeanRow,
    MeansPrecision,
    Reference,
    Row,
    WorkPrecision,
    means_precision,
    measure,
    work_precision,
)
from tribo.work_precision.diagram import with_front
from tribo.work_precision.means import _row

FLOOR = 1e-9
ERRORS = st.sampled_from([1e-11, 1e-10, 1e-9, 1e-6, 1e-3, 1.0])  # some cannot be told apart
SECONDS = st.sampled_from([0.1, 0.2, 0.5, 1.0])
ROWS = st.lists(st.builds(Row, st.just("m"), st.just(1.0), ERRORS, st.just(1), SECONDS), min_size=1)


@given(ROWS)
def test_the_front(rows):
    """Along the front, more time buys less error; every other run is beaten by one on it."""
    marked = list(with_front(rows, FLOOR))
    told = [(row.seconds, max(row.error, FLOOR)) for row in marked]
    front = sorted({pair for pair, row in zip(told, marked, strict=True) if row.front})
    assert front
    for (time, error), (longer, better) in pairwise(front):
        assert time < longer and better < error
    for (time, error), row in zip(told, marked, strict=True):
        if not row.front:
            beating = [(t, e) for t, e in front if t <= time and e <= error]
            assert beating and (time, error) not in front


@pytest.mark.parametrize(("cutoff", "expected"), [(None, "gauss-radau-15"), (2.5, "rkn8")])
def test_a_reference_is_good_where_potentials_are_rough(cutoff, expected):
    """With a switched potential another method provides the reference."""
    row = {"shape": (3, 1), "spacing": (1.1, 0.0), "asperite": tribo.Asperite(kappa=4.0)}
    upper = tribo.Surface("upper", bob=(-3.0, 0.9), velocity=(0.8, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    jones = tribo.LennardJones(0.1, 1.0)
    scene = tribo.Scene((upper, lower), jones if cutoff is None else jones.with_cutoff(cutoff), 6.0)
    found = work_precision(scene, ["rkn8"], seconds=1e9)
    assert found.reference.method == expected
    assert found.reference.error < 1e-11
    errors = [row.error for row in found.rows]
    assert min(errors) < 1e-10
    assert found.best(1e-6).error <= 1e-6
    assert found.best(0.0) is None or min(errors) == 0.0


def test_figure(tmp_path):
    """Both costs on axes of the caller or new ones; and a file, whose name may be a string."""
    rows = tuple(Row("rkn8", 10.0**-k, 10.0**-k, 100 * k, 1e-3 * k, True) for k in range(1, 5))
    found = WorkPrecision(rows, Reference("dop853", 1e-14, 1.0), {"rkn8": 1.0})
    for cost in ("seconds", "force_evaluations"):
        ax = found.plot(cost)
        (curve,) = (line for line in ax.get_lines() if line.get_label() == "rkn8")
        assert list(curve.get_xdata()) == [getattr(row, cost) for row in rows]
        assert list(curve.get_ydata()) == [row.error for row in rows]
        assert found.plot(cost, ax) is ax
    found = replace(found, automatic={1e-3: "rkn8", 1e-6: "verlet"})
    (rings,) = (ln for ln in found.plot().get_lines() if ln.get_label() == "automatic choice")
    assert list(rings.get_xdata()) == [rows[2].seconds] and list(rings.get_ydata()) == [1e-3]
    found.save_figure(str(tmp_path / "figure.png"))
    assert (tmp_path / "figure.png").stat().st_size > 5000


def test_json():
    """As documented for programs: rows, reference, times of compilation and the cheapest runs."""
    row = Row("rkn8", 0.1, 1e-3, 100, 0.5, True)
    finer = Row("rkn8", 0.01, 1e-4, 150, 0.8, True)
    other = Row("dop853", 0.1, 1e-3, 50, 0.7)
    found = WorkPrecision(
        (row, finer, other), Reference("dop853", 1e-14, 1.0), {"rkn8": 2.0}, {1e-3: "dop853"}
    )
    table = json.loads(found.to_json())
    cheapest = table.pop("cheapest")
    assert table == {
        "rows": [row.__dict__, finer.__dict__, other.__dict__],
        "reference": {"method": "dop853", "error": 1e-14, "seconds": 1.0},
        "compile_seconds": {"rkn8": 2.0},
        "status": "completed",
    }
    assert [item["error"] for item in cheapest] == [1e-3, 1e-6, 1e-9, 1e-12]
    assert cheapest[0] == {
        "error": 1e-3,
        "method": "rkn8",
        "setting": 0.1,
        "force_evaluations": 100,
        "seconds": 0.5,
        "digit_more": 1.5,
        "automatic_method": "dop853",
        "automatic_seconds": 0.7,
    }
    assert set(cheapest[1].values()) == {1e-6, None}


def test_conclusion():
    """The text ends with the cheapest run for each error, and what one digit more takes."""
    rows = tuple(Row("rkn8", 10.0**-k, 10.0**-k, 10 * k, 1e-3 * k) for k in range(1, 9))
    chosen = {1e-3: "rkn8", 1e-6: "verlet"}
    found = WorkPrecision(rows, Reference("dop853", 1e-14, 1.0), {"rkn8": 1.0}, chosen)
    assert str(found).splitlines()[-4:] == [
        "error 1e-03: rkn8 with tolerance 0.001 is the cheapest, 30 evaluations, 0.003 s; one "
        "digit more takes 1.33 times as many; tribo chooses it too",
        "error 1e-06: rkn8 with tolerance 1e-06 is the cheapest, 60 evaluations, 0.006 s; one "
        "digit more takes 1.17 times as many; tribo chooses verlet",
        "error 1e-09: no run reached it",
        "error 1e-12: no run reached it",
    ]
    assert found.cheapest(1e-8).digit_more is None
    assert found.automatic_rows == [rows[2]]


@pytest.fixture
def interrupted(monkeypatch):
    """Let the second method be interrupted after its first run; nothing is compiled."""
    monkeypatch.setattr(interrupts, "_report", [])
    truth = None, None, Reference("gauss-radau-15", 1e-13, 1.0)
    monkeypatch.setattr(measure, "_reference", lambda *given: truth)
    stand_in = SimpleNamespace(compile_seconds=0.0)
    monkeypatch.setattr(measure, "Integrator", lambda layout, method: stand_in)
    curves = iter([2, 1])

    def curve(*given):
        for k in range(next(curves)):
            yield Row("rkn8", 0.1**k, 0.01**k, 10, 0.1)
        if not curves.__length_hint__():
            raise KeyboardInterrupt

    monkeypatch.setattr(measure, "_curve", curve)


def test_finished_runs_survive_an_interrupt(interrupted, tmp_path, capsys):
    """They are printed, with status 1; also where the program is ended while it compiles."""
    tribo.Scene((tribo.Surface("upper"),), (), 1.0).save(tmp_path / "scene.toml")
    command = ["accuracy", str(tmp_path / "scene.toml"), "--json", "--methods", "rkn8", "rk4"]
    assert main(command) == 1
    table = json.loads(capsys.readouterr().out)
    assert len(table["rows"]) == 3 and table["status"] == "Interrupted"
    interrupts.report(json=False)  # as before the second method was compiled
    table = json.loads(capsys.readouterr().out)
    assert len(table["rows"]) == 2 and table["status"] == "Interrupted"


def test_an_interrupt_ends_a_script(interrupted):
    """The interrupt goes on, with the runs that ended before it."""
    scene = tribo.Scene((tribo.Surface("upper"),), (), 1.0)
    with pytest.raises(interrupts.Interrupted) as caught:
        work_precision(scene, ["rkn8", "rk4"])
    found = caught.value.result
    assert len(found.rows) == 3 and found.status == "Interrupted"


def test_an_interrupt_ends_means_in_a_script(monkeypatch):
    """Likewise, with the ensembles that ended before it."""
    ended = []

    def ensemble(scene, members, **settings):
        if ended:
            raise KeyboardInterrupt
        ended.append(members)
        return tribo.ensemble(scene, members, **settings)

    monkeypatch.setattr(import_module("tribo.work_precision.means"), "ensemble", ensemble)
    with pytest.raises(interrupts.Interrupted) as caught:
        means_precision(noisy(), seconds=1e4)  # compiling takes its time
    found = caught.value.result
    assert len(found.rows) == 1 and found.status == "Interrupted"


def test_a_run_that_is_interrupted_ends_its_method(monkeypatch):
    """It is no run that stopped early, after which a finer one follows."""
    monkeypatch.setattr(measure, "setting_at", lambda *given: Setting(step=0.1))
    monkeypatch.setattr(measure, "reported_scales", lambda *given: None)
    layout = lay_out(tribo.Scene((tribo.Surface("upper"),), (), 1.0))

    def run(setting, times):
        return SimpleNamespace(status="Interrupted")

    run.layout = layout
    run.method = METHODS["rk4"]
    with pytest.raises(KeyboardInterrupt):
        list(measure._curve(run, None, None, (), 1e-12, 1e9))


def noisy():
    """Two asperites on reservoirs, without contact."""
    warm = {"langevin": tribo.Langevin(0.6, 0.3), "asperite": tribo.Asperite(m2=0.5)}
    upper = tribo.Surface("upper", shape=(2, 1), spacing=(5.0, 0.0), **warm)
    numerics = tribo.Numerics(method="verlet", step=0.05)
    return tribo.Scene((upper,), (), 2.0, output=tribo.Output(samples=3), numerics=numerics)


@pytest.mark.thorough
def test_means_with_noise():
    """The half-width is that of an ensemble, and four times the members halve it."""
    (row,) = means_precision(noisy(), ["upper.W"], seconds=1e-9).rows
    few, many = (tribo.ensemble(noisy(), n)["upper.W_half_width"] for n in (16, 64))
    scale = float(few.max()) / row.half_width
    assert (row.method, row.setting, row.members) == ("verlet", 0.05, 16)
    assert row.force_evaluations == 16 * tribo.simulate(noisy()).cost.force_evaluations
    halved = row.scaled_to(0.5 * row.half_width)
    assert halved.members == 64
    assert 0.6 < float(many.max()) / (scale * halved.half_width) < 1.6
    assert halved.force_evaluations == 4 * row.force_evaluations
    with pytest.raises(tribo.InputError, match=r"observables: must be one of upper\.W, "):
        means_precision(noisy(), ["upper.work"], seconds=1e-9)


def test_the_command_with_noise(tmp_path, monkeypatch, capsys):
    """It prints the ensembles and what half-widths take; a figure and methods are refused."""
    noisy().save(tmp_path / "scene.toml")
    command = ["accuracy", str(tmp_path / "scene.toml")]
    assert main([*command, "--figure", str(tmp_path / "a.png")]) == 2
    assert "--figure: cannot go with a scene that has thermal noise" in capsys.readouterr().err
    found = MeansPrecision((MeanRow("verlet", 0.05, 16, 0.2, 0.05, 160, 0.1, 0.02, 0.01),))
    monkeypatch.setattr(module, "means_precision", lambda *given: found)
    assert main([*command, "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    (row,) = table["rows"]
    assert (row["members"], row["bias"], row["bias_half_width"]) == (16, 0.05, 0.02)
    cheapest = [(row["half_width"], row["members"]) for row in table["cheapest"]]
    assert cheapest == [(0.1, 64), (0.01, 6400), (0.001, 640000)]
    lines = str(found).splitlines()
    assert lines[-5].startswith(
        "half-width 0.1: 64 members by verlet at step 0.05, 640 evaluations"
    )
    assert not lines[-5].endswith("larger") and lines[-4].endswith("; the step's bias is larger")
    assert lines[-2] == "at the end, the step's bias is 0.050 +- 0.020"


@pytest.mark.parametrize(
    ("biases", "expected"),
    [
        ((0.3, 0.3), "no bias of the step can be seen (below its half-width of 0.51)"),
        ((0.3, 0.45), "no bias of the step can be seen (below its half-width of 0.51)"),
        ((0.3, -0.9), "the step's bias is 0.90 +- 0.51"),
        ((0.6, None), "the step's bias is 0.60 +- 0.44"),
        ((0.3, None), "no bias of the step can be seen (below its half-width of 0.44)"),
        ((None, None), "the bias of the step was not measured"),
    ],
)
def test_bias_by_chance(biases, expected):
    """A bias counts beside its own half-width at the end, however narrow those of the means are."""
    values = {}
    for name, bias in zip(("upper.W", "upper.delta_E_int"), biases, strict=True):
        values[f"{name}_half_width"] = "time", [0.01, 0.01]
        if bias is not None:
            values |= {f"{name}_bias": ("time", [5.0, bias])}
            values |= {f"{name}_bias_half_width": ("time", [0.1, 0.44])}
    data = xarray.Dataset(values, {"member": range(64)}, {"seconds": 1.0})
    simulation = tribo.prepare(noisy(), progress=False)
    names = ["upper.W", "upper.delta_E_int"]
    assert _row(data, names, simulation, 1.0, 640).bias_text == expected


def test_no_run_in_time(tmp_path, monkeypatch, capsys):
    """The command says so, and ends with status 1."""
    tribo.Scene((tribo.Surface("upper"),), (), 1.0).save(tmp_path / "scene.toml")
    empty = WorkPrecision((), Reference("dop853", 1e-14, 1.0), {})
    monkeypatch.setattr(module, "work_precision", lambda *given, **how: empty)
    assert main(["accuracy", str(tmp_path / "scene.toml"), "--json"]) == 1
    out, err = capsys.readouterr()
    assert json.loads(out)["rows"] == []
    assert err == "tribo: no run ended in time; give more --seconds\n"
