"""Error against cost: the front, the reference, the figure and the JSON."""

import json
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

import tribo
from tribo import paper
from tribo import work_precision as module
from tribo.cli import main
from tribo.work_precision import (
    Automatic,
    Cheapest,
    Reference,
    Row,
    WorkPrecision,
    measure,
    with_front,
    work_precision,
)

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
    told = []
    found = work_precision(scene, ["rkn8"], seconds=1e9, finished=told.append)
    assert found.reference.method == expected
    assert found.reference.error < 1e-11
    errors = [row.error for row in found.rows]
    assert min(errors) < 1e-10
    assert found.best(1e-6).error <= 1e-6
    assert found.best(0.0) is None or min(errors) == 0.0
    assert found.status == "completed" and [each.rows for each in told] == [found.rows]
    assert found.automatic.accuracy == 1e-8 and found.automatic.error < 1e-8


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


def measured(errors, seconds, reference=1e-14):
    """Runs of two methods with these errors and times."""
    pairs = enumerate(zip(errors, seconds, strict=True))
    names = ("rkn8", "verlet")
    rows = tuple(Row(names[k % 2], 0.5**k, e, 100 * k, s) for k, (e, s) in pairs)
    return WorkPrecision(rows, Reference("dop853", reference, 1.0), {"rkn8": 1.0})


def test_cheapest():
    """The fastest run that keeps each accuracy, and what a digit more costs."""
    found = measured([1e-4, 1e-6, 1e-6, 1e-7, 1e-9], [1.0, 2.0, 3.0, 5.0, 8.0])
    third, sixth, ninth, twelfth = found.cheapest
    assert (third.method, third.force_evaluations, third.seconds) == ("rkn8", 0, 1.0)
    assert (third.digit_more, sixth.method, sixth.setting) == (1.0, "verlet", 0.5)
    assert (sixth.seconds, sixth.digit_more) == (2.0, 2.5)
    assert (ninth.seconds, ninth.digit_more) == (8.0, None)
    assert twelfth == Cheapest(1e-12)
    text = str(found).splitlines()
    assert text[-3] == (
        "For 1e-6 the cheapest is verlet at the step 0.5: 100 evaluations, 2 s; one digit more "
        "takes 2.5 times as long."
    )
    assert text[-2].endswith("one digit more was not reached.")
    assert text[-1] == "For 1e-12: no run was accurate enough in the time given."
    blurred = measured([1e-4, 1e-6], [1.0, 2.0], reference=1e-5)
    assert blurred.cheapest[1].method is None and "as the reference is less" in str(blurred)


def test_automatic_choice_is_marked():
    """By a star at its cost and error."""
    found = replace(measured([1e-4], [1.0]), automatic=Automatic(1e-8, "rkn8", 1e-9, 700, 0.25))
    for cost, place in (("seconds", 0.25), ("force_evaluations", 700)):
        (star,) = (x for x in found.plot(cost).get_lines() if x.get_label() == "tribo's choice")
        assert (list(star.get_xdata()), list(star.get_ydata())) == ([place], [1e-9])
    assert str(found).splitlines()[-1].startswith("Asked for 1e-8, tribo takes rkn8: error 1.0e-09")


def test_interrupted(tmp_path, monkeypatch, capsys):
    """Finished rows survive an interrupt, in print, as JSON and in the figure; status 1."""
    scene = replace(paper.scene("A"), title="Interrupted")
    scene.save(tmp_path / "scene.toml")
    timed, calls = measure._timed, []

    def interrupt_at_fifth(*given):
        calls.append(given)
        if len(calls) == 5:
            raise KeyboardInterrupt
        return timed(*given)

    monkeypatch.setattr(measure, "_timed", interrupt_at_fifth)
    figure = tmp_path / "figure.svg"
    command = ["accuracy", str(tmp_path / "scene.toml"), "--methods", "gauss-radau-15", "--json"]
    assert main([*command, "--figure", str(figure)]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "Interrupted" and 1 <= len(found["rows"]) <= 4
    assert found["cheapest"][0]["method"] == "gauss-radau-15" and figure.exists()


def test_json():
    """As documented for programs."""
    row = Row("rkn8", 0.1, 1e-3, 100, 0.5, True)
    found = WorkPrecision((row,), Reference("dop853", 1e-14, 1.0), {"rkn8": 2.0})
    table = json.loads(found.to_json())
    assert [each["accuracy"] for each in table["cheapest"]] == [1e-3, 1e-6, 1e-9, 1e-12]
    assert table.pop("cheapest")[0] == {
        "accuracy": 1e-3,
        "method": "rkn8",
        "setting": 0.1,
        "force_evaluations": 100,
        "seconds": 0.5,
        "digit_more": None,
    }
    assert table == {
        "rows": [row.__dict__],
        "reference": {"method": "dop853", "error": 1e-14, "seconds": 1.0},
        "compile_seconds": {"rkn8": 2.0},
        "automatic": None,
        "status": "completed",
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
