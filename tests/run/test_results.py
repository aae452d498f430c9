"""Results: what can be read off them, what they print, and what comes back from disk."""

import json
from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import Coulomb, Free, Initial, InputError, Numerics, Output, Result, Scene, Surface


def scene(**upper):
    """A short pass of one asperite over a row of two."""
    surfaces = (
        Surface("upper", **({"bob": (-1.0, 0.0), "velocity": (0.5, 0.0), "drive": Free()} | upper)),
        Surface("lower", facing="up", shape=(2, 1), spacing=(1.0, 0.0)),
    )
    return Scene(surfaces, Coulomb(0.2), 4.0, title="A short pass", output=Output(samples=9))


@pytest.fixture(scope="module")
def result():
    """The pass at the default accuracy."""
    return tribo.simulate(scene())


def same_series(one, other):
    """Whether all arrays of two results are the same, to the last bit."""
    pairs = [(one.t, other.t)]
    for a, b in zip(one.ledger.__dict__.values(), other.ledger.__dict__.values(), strict=True):
        assert set(a) == set(b)
        for key in a:
            tables = [a[key], b[key]] if isinstance(a[key], dict) else [{"": a[key]}, {"": b[key]}]
            assert list(tables[0]) == list(tables[1])
            pairs += [(tables[0][name], tables[1][name]) for name in tables[0]]
    return all(np.array_equal(x, y, equal_nan=True) and x.dtype == y.dtype for x, y in pairs)


def test_series(result):
    """A surface's series is a mapping, whose names are attributes too."""
    upper, lower = result["upper"], result["lower"]
    assert upper.theta is upper["theta"]
    assert "theta" in upper and "no such" not in upper
    assert len(upper) == len(list(upper)) == len(set(upper)) > 20
    assert dict(upper).keys() == {name for name in dir(upper) if name in upper}
    assert upper.theta.shape == (9, 1) and lower.theta.shape == (9, 2)
    assert upper.W.shape == lower.delta_E_int.shape == (9,)
    assert result.system["applied_work"].shape == (9,)
    assert np.array_equal(result.t, np.linspace(0.0, 4.0, 9))


def test_names_that_are_none(result):
    """What is asked for in vain is answered with what there is."""
    with pytest.raises(KeyError, match="there is no surface 'middle'; there are upper, lower"):
        result["middle"]
    with pytest.raises(AttributeError, match="no quantity 'w3'; there are theta, phi"):
        _ = result["upper"].w3
    with pytest.raises(KeyError):
        result["upper"]["w3"]


def test_end_is_what_is_printed(result):
    """.end and to_json() are one thing, and that is the last row of every series."""
    end = result.end
    assert json.loads(result.to_json()) == end
    assert end["t"] == result.t[-1] == 4.0
    for name in ("upper", "lower"):
        for key, values in end["surfaces"][name].items():
            assert values == result[name][key][-1].tolist()
        for key, value in end["blocks"][name].items():
            assert value == result[name][key][-1]
    assert end["system"] == {key: values[-1] for key, values in result.system.items()}
    assert end["error_estimate"] == result.error_estimate


def test_json_is_strict(result):
    """What is no number is null: JSON has no word for nan."""
    broken = replace(result, error_estimate=result.error_estimate | {"w1": float("nan")})
    assert json.loads(broken.to_json())["error_estimate"]["w1"] is None


def test_print_is_short(result):
    """A line on the run, and one a surface; not thousands of numbers."""
    lines = str(result).splitlines()
    assert len(lines) == 3 and all(len(line) < 180 for line in lines)
    assert lines[0].startswith(f"A short pass: completed at t = 4; {result.method}, ")
    assert str(replace(result, notes=("mind this",))).splitlines()[-1] == "  note: mind this"
    assert len(repr(result["upper"])) < 200


def test_estimates(result):
    """Every reported quantity has one, within what was asked for."""
    reported = {*result["upper"], *result.system}
    assert set(result.error_estimate) == reported
    assert result.accuracy == 1e-8 and result.met is True and result.notes == ()
    assert all(bound >= 0.0 for bound in result.error_estimate.values())


def test_round_trip(result, tmp_path):
    """Everything that is known of a run comes back from disk."""
    path = tmp_path / "run.nc"
    result.save(path)
    loaded = tribo.load_result(path)
    assert isinstance(loaded, Result)
    assert same_series(loaded, result)
    assert loaded.end == result.end
    assert str(loaded) == str(result)
    assert (loaded.notes, loaded.met, loaded.accuracy) == (
        result.notes,
        result.met,
        result.accuracy,
    )
    assert same_series(tribo.simulate(loaded.scene), result)
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


def test_round_trip_of_a_run_that_stopped(tmp_path):
    """Also when there is no estimate, and when numbers are none."""
    stopped = tribo.simulate(scene(bob=(0.0, 0.0)), method="midpoint", step=0.01)
    assert stopped.status == "BobsCoincide"
    stopped.save(tmp_path / "run.nc")
    loaded = tribo.load_result(tmp_path / "run.nc")
    assert same_series(loaded, stopped)
    assert loaded.status == "BobsCoincide" and loaded.t.size == 1
    assert loaded.to_json() == stopped.to_json()


def test_file_that_is_none(tmp_path, result):
    """No file, no result in it, or no place for it."""
    (tmp_path / "text.nc").write_text("no data")
    for path in (tmp_path / "no.nc", tmp_path / "text.nc", tmp_path):
        with pytest.raises(InputError, match="cannot be read"):
            tribo.load_result(path)
    result.to_xarray().drop_attrs().to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(InputError):
        tribo.load_result(tmp_path / "other.nc")
    with pytest.raises(InputError, match="cannot be written"):
        result.save(tmp_path / "nowhere" / "run.nc")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["other.nc", "text.nc"]


def test_xarray(result):
    """Labelled series, by surface and quantity."""
    data = result.to_xarray()
    assert data["upper.theta"].dims == ("time", "upper_asperite")
    assert np.array_equal(data["lower.w1"].values, result["lower"].w1)
    assert np.array_equal(data["upper.W"].values, result["upper"].W)
    assert np.array_equal(data.time.values, result.t)


def test_prepared_run(result):
    """What is planned once runs again and again; the first time it gives what `simulate` gives."""
    simulation = tribo.prepare(scene())
    again = simulation.run()
    assert np.array_equal(again["upper"].theta, result["upper"].theta)
    assert again.met
    bare = simulation.run(estimate=False)
    off = np.max(np.abs(bare["upper"].theta - result["upper"].theta))
    assert off <= simulation.accuracy  # its steps do not end where runs are compared
    assert set(bare.error_estimate.values()) == {None} and bare.met is None
    assert bare.cost.force_evaluations < again.cost.force_evaluations


@pytest.mark.parametrize("name", ["accuracy", "met", "notes", "why", "status", "t"])
def test_a_lone_run_is_whole_whatever_is_looked_at_first(name):
    """It is put together when it is looked at, and shows nothing else before."""
    jump = tribo.with_cutoff(Coulomb(0.2), 2.0, "truncate")
    simulation = tribo.prepare(replace(scene(), interactions=jump), accuracy=0.1, method="rkn8")
    first = getattr(simulation.run(estimate=False), name)
    after = simulation.run(estimate=False)
    assert after.status == "completed" and after.accuracy == 0.1 and "jumps" in after.notes[0]
    assert np.array_equal(first, getattr(after, name))


STARTS = {
    "theta": ({"upper.theta": 0.1}, {"upper": Initial(theta=0.1)}),
    "an array": ({"upper.omega": np.array([0.3])}, {"upper": Initial(omega=0.3)}),
    "one each": ({"lower.theta": [3.0, 3.3]}, {"lower": Initial(theta=[3.0, 3.3])}),
    "several": (
        {"upper.theta": -0.1, "lower.omega": 0.2},
        {"upper": Initial(theta=-0.1), "lower": Initial(omega=0.2)},
    ),
}


@pytest.mark.parametrize("name", STARTS)
def test_prepared_run_from_elsewhere(name):
    """New initial values give what a scene with them gives."""
    start, initial = STARTS[name]
    found = tribo.prepare(scene()).run(start)
    surfaces = tuple(replace(s, initial=initial.get(s.name, s.initial)) for s in scene().surfaces)
    expected = tribo.simulate(replace(scene(), surfaces=surfaces))
    for surface in ("upper", "lower"):
        for key, values in expected[surface].items():
            bound = found.error_estimate[key] + expected.error_estimate[key]
            assert np.max(np.abs(found[surface][key] - values)) <= bound, key


def test_prepared_run_leaves_no_trace():
    """A run from elsewhere does not change the next one from the scene's own start."""
    simulation = tribo.prepare(scene(), accuracy=1e-4)
    first = simulation.run()
    simulation.run({"upper.theta": 0.5, "lower.omega": [1.0, 2.0]})
    assert same_series(simulation.run(), first)


def test_same_run_twice(result):
    """There is nothing random in a run."""
    assert same_series(tribo.simulate(scene()), result)


def test_interrupted_run_keeps_what_it_has():
    """Ctrl-C ends a run with a result, which says so."""

    def interrupt(t):
        raise KeyboardInterrupt

    for how in ({"method": "midpoint", "step": 1e-4}, {}):
        stopped = tribo.simulate(scene(), progress=interrupt, **how)
        assert stopped.status == "Interrupted" and stopped.t.size >= 1
        assert not stopped.met
        assert "what it had reached is kept" in str(stopped)


def test_progress_is_told():
    """Times reached, in order, up to the end."""
    told = []
    tribo.simulate(scene(), method="midpoint", step=1e-3, progress=told.append)
    assert told == sorted(told) and told[-1] == 4.0


def test_file_has_the_first_word_and_the_call_the_last():
    """Numerics of the scene are obeyed unless the call says otherwise."""
    own = replace(scene(), numerics=Numerics(method="midpoint", step=0.01))
    assert tribo.simulate(own).method == "midpoint"
    assert tribo.simulate(own, accuracy=1e-4).method != "midpoint"
    assert tribo.simulate(own, step=0.02).cost.steps == 200
    rough = replace(scene(), numerics=Numerics(accuracy=1e-3))
    assert tribo.simulate(rough).accuracy == 1e-3
    assert tribo.simulate(rough, accuracy=1e-5).accuracy == 1e-5
    assert tribo.simulate(scene()).accuracy == 1e-8
