"""Error against cost: the front, the reference, the figure and the JSON."""

import json
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

import tribo
from tribo import work_precision as module
from tribo.cli import main
from tribo.work_precision import Reference, Row, WorkPrecision, with_front, work_precision

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
    scene = tribo.Scene(
        (upper, lower), jones if cutoff is None else tribo.with_cutoff(jones, cutoff), 6.0
    )
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
    found.save_figure(str(tmp_path / "figure.png"))
    assert (tmp_path / "figure.png").stat().st_size > 5000


def test_json():
    """As documented for programs: rows, reference and times of compilation."""
    row = Row("rkn8", 0.1, 1e-3, 100, 0.5, True)
    found = WorkPrecision((row,), Reference("dop853", 1e-14, 1.0), {"rkn8": 2.0})
    assert json.loads(found.to_json()) == {
        "rows": [row.__dict__],
        "reference": {"method": "dop853", "error": 1e-14, "seconds": 1.0},
        "compile_seconds": {"rkn8": 2.0},
    }


def test_no_run_in_time(tmp_path, monkeypatch, capsys):
    """The command says so, and ends with status 1."""
    tribo.Scene((tribo.Surface("upper"),), (), 1.0).save(tmp_path / "scene.toml")
    empty = WorkPrecision((), Reference("dop853", 1e-14, 1.0), {})
    monkeypatch.setattr(module, "work_precision", lambda *given, **how: empty)
    assert main(["accuracy", str(tmp_path / "scene.toml"), "--json"]) == 1
    out, err = capsys.readouterr()
    assert json.loads(out)["rows"] == []
    assert err == "tribo: no run ended in time; give more --seconds\n"
