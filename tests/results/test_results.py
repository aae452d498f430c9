"""Results: their series, what they print, what comes back from disk, and when they warn."""

import copy
import gc
import json
import pickle
import warnings
import weakref
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.laws import raw_samples
from tribo import (
    Coulomb,
    Free,
    Initial,
    InputError,
    Numerics,
    Output,
    Result,
    Scene,
    Surface,
    TriboWarning,
)
from tribo.kernels.status import MEANINGS, Status
from tribo.ledger.ledger import assemble
from tribo.ledger.motion import Motion
from tribo.ledger.quantities import QUANTITIES
from tribo.ledger.series_table import series_table
from tribo.ledger.totals import AsperiteSeries
from tribo.loops.journal import JournaledIntegration
from tribo.simulation import from_settings


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
    ledgers = ([item.ledger.surfaces, item.ledger.blocks, item.system] for item in (one, other))
    for a, b in zip(*ledgers, strict=True):
        assert set(a) == set(b)
        for key in a:
            single = not isinstance(a[key], Mapping)
            tables = [{"": a[key]}, {"": b[key]}] if single else [a[key], b[key]]
            assert list(tables[0]) == list(tables[1])
            pairs += [(tables[0][name], tables[1][name]) for name in tables[0]]
    return all(np.array_equal(x, y, equal_nan=True) and x.dtype == y.dtype for x, y in pairs)


def test_series(result):
    """A surface's series is a mapping, whose names are attributes too."""
    upper = result["upper"]
    lower = result["lower"]
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


def test_a_quantity_is_computed_alone(monkeypatch):
    """Reading a work computes no energy and no position, and `end` reads two samples only."""
    lone = tribo.prepare(scene(), accuracy=1e-6).run()
    rows = []

    def broken(motion):
        raise ZeroDivisionError("no energy")

    with monkeypatch.context() as patch:
        patch.setattr(Motion, "energy", property(broken))
        assert lone["upper"].w1.shape == (9, 1) and lone["upper"].x_bob.shape == (9, 1)
        with pytest.raises(ZeroDivisionError, match="no energy"):
            _ = lone["upper"].delta_e_int
    monkeypatch.setattr(
        AsperiteSeries,
        "each",
        lambda group, value: rows.append(group.samples.t.tolist()) or np.zeros((2, 1)),
    )
    assert lone.end["surfaces"]["upper"]["delta_e_int"] == [0.0]
    assert rows and all(row == [0.0, 4.0] for row in rows)


def test_results_are_released_without_a_collection():
    """Raw samples are not part of a cycle of references, which would pile up between two runs."""
    simulation = tribo.prepare(scene(), method="midpoint", step=0.01)
    gc.disable()
    try:
        lone = simulation.run()
        kept = weakref.ref(raw_samples(lone.ledger))
        assert lone["upper"].w1.size and lone["upper"].delta_E_int.size and lone.system
        del lone
        assert kept() is None
    finally:
        gc.enable()


def test_columns_are_the_series(result):
    """All series side by side, those of single surfaces too, are the same as one by one."""
    simulation = tribo.prepare(scene(), method="midpoint", step=0.01)
    samples = raw_samples(simulation.compute().ledger)
    layout = simulation.layout
    group = AsperiteSeries(layout, samples, (layout.together,))
    columns = series_table(layout, group, ("upper.W", "lower.w1"))
    ledger = assemble(layout, samples)
    stops = [*columns.starts[1:], columns.values.shape[1]]
    assert set(columns.names) == {*ledger.names, "upper.W", "lower.w1"}
    for name, start, stop in zip(columns.names, columns.starts, stops, strict=True):
        series = [each.reshape(9, -1) for each in ledger.series(name)]
        assert np.allclose(columns.values[:, start:stop], np.hstack(series), rtol=0.0, atol=1e-15)


def test_json_is_strict(result):
    """What is no number is null: JSON has no word for nan."""
    broken = replace(result, bounds=result.bounds | {"w1": float("nan")})
    assert json.loads(broken.to_json())["error_estimate"]["w1"] is None


def test_print_is_short(result):
    """A line on the run, and one a surface; not thousands of numbers."""
    lines = str(result).splitlines()
    assert len(lines) == 3 + len(result.notes) and all(len(line) < 180 for line in lines)
    assert lines[0].startswith(f"A short pass: completed at t = 4; {result.method}, ")
    assert str(replace(result, notes=("mind this",))).splitlines()[-1] == "  note: mind this"
    assert all(len(line) <= 100 for line in repr(result["upper"]).splitlines()[:6])


def test_estimates(result):
    """Every reported quantity has one, within what was asked for."""
    reported = {*result["upper"], *result.system}
    assert set(result.error_estimate) == reported
    assert result.accuracy == 1e-8 and result.met is True
    assert all(bound >= 0.0 for bound in result.error_estimate.values())


def test_estimates_of_full_names(result):
    """The bound on a quantity of all surfaces, or the own one that an accuracy asks for."""
    bounds = result.error_estimate
    assert bounds["upper.w1"] == bounds["w1"] and bounds["lower.W"] == bounds["W"]
    assert pickle.loads(pickle.dumps(result)).error_estimate["upper.W"] == bounds["W"]
    for name in ("above.w1", "upper.pressure", "upper"):
        with pytest.raises(KeyError, match=name):
            bounds[name]
    own = tribo.simulate(result.scene, accuracy={"upper.W": 1e-3}).error_estimate
    assert own["upper.W"] <= 1e-3 and "upper.W" in own and "upper.w1" not in own


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


def stopped_run():
    """A run that ends where it begins."""
    with pytest.warns(TriboWarning, match="BobsCoincide"):
        return tribo.simulate(scene(bob=(0.0, 0.0)), method="midpoint", step=0.01)


def test_round_trip_of_a_run_that_stopped(tmp_path):
    """Also when there is no estimate, and when numbers are none."""
    stopped = stopped_run()
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
    result.to_xarray().drop_attrs().to_netcdf(tmp_path / "other.nc")
    with pytest.raises(InputError):
        tribo.load_result(tmp_path / "other.nc")
    with pytest.raises(InputError, match="must be in a folder that exists"):
        result.save(tmp_path / "nowhere" / "run.nc")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["other.nc", "text.nc"]


def test_xarray(result):
    """Labelled series, by surface and quantity, each with its units and its error."""
    data = result.to_xarray()
    assert data["upper.theta"].dims == ("time", "upper_asperite")
    assert np.array_equal(data["lower.w1"].values, result["lower"].w1)
    assert np.array_equal(data["upper.W"].values, result["upper"].W)
    assert np.array_equal(data.time.values, result.t)
    for name, variable in data.variables.items():
        assert variable.attrs["units"] and variable.attrs["long_name"], name
    units = {name: data[f"upper.{name}"].attrs["units"] for name in ("theta", "omega", "x_cm", "W")}
    assert units == {"theta": "rad", "omega": "time^-1", "x_cm": "length", "W": "energy"}
    assert float(data["lower.w1_error"]) == result.error_estimate["w1"] > 0.0
    assert float(data["applied_work_error"]) == result.error_estimate["applied_work"]
    assert data["lower.w1_error"].attrs["units"] == "energy"
    series = [name for name in data.data_vars if not name.endswith("_error")]
    assert {f"{name}_error" for name in series} == set(data.data_vars) - set(series)


def test_xarray_of_observables():
    """The error of an observable that was asked for by name is its own."""
    result = tribo.simulate(scene(), accuracy={"upper.W": 1e-3, "w1": 1e-3})
    data = result.to_xarray()
    assert float(data["upper.W_error"]) == result.error_estimate["upper.W"]
    assert float(data["lower.W_error"]) == result.error_estimate["W"]


def test_asperites_have_coordinates(result):
    """One dimension for each surface; a position is looked up by the resting bob."""
    data = result.to_xarray()
    assert data["lower_asperite"].values.tolist() == [0, 1]
    assert data["lower.x_rest"].values.tolist() == [0.0, 1.0]
    assert data["upper.x_rest"].values.tolist() == [-1.0]
    assert set(data["lower.w1"].coords) == {"time", "lower_asperite"} | {
        f"lower.{axis}_rest" for axis in "xyz"
    }


def test_kinds_of_quantities(result):
    """Every reported quantity has a meaning; none has the name of an error."""
    assert {*result["upper"], *result.system} <= set(QUANTITIES)
    assert not any(name.endswith("_error") for name in QUANTITIES)


def test_statuses_are_strings():
    """A status is its name, prints as it, and has a meaning."""
    assert set(MEANINGS) == set(Status)
    assert all(isinstance(status, str) for status in Status)
    assert f"{Status.STEP_UNDERFLOW}" == "StepUnderflow" == Status.STEP_UNDERFLOW
    assert json.dumps([Status.COMPLETED]) == '["completed"]'
    stopped = stopped_run()
    assert json.loads(stopped.to_json())["status"] == "BobsCoincide"
    assert stopped.to_xarray().attrs["status"] == "BobsCoincide"


def test_a_run_that_stops_warns():
    """Once, at the line that ran it, with the status and its meaning; also when it is repeated."""
    start = scene(bob=(0.0, 0.0))
    simulation = tribo.prepare(start, method="midpoint", step=0.01)
    calls = (
        lambda: tribo.simulate(start, method="midpoint", step=0.01),
        simulation.first_result,
        simulation.run,
        lambda: simulation.run(estimate=False),
    )
    for call in calls:
        with pytest.warns(TriboWarning) as caught:
            result = call()
        (warning,) = caught
        assert str(warning.message).startswith("the run stopped at t = 0, BobsCoincide: two")
        assert warning.filename == __file__
        assert result.status == "BobsCoincide"


def test_a_run_that_misses_its_accuracy_warns():
    """Settings for a low accuracy do not give a high one."""
    plan = tribo.prepare(scene(), accuracy=1e-4).settings
    simulation = from_settings(scene(), replace(plan, accuracy=1e-10))
    with pytest.warns(
        TriboWarning, match="the accuracy is not met: errors are estimated"
    ) as caught:
        result = simulation.run()
    assert len(caught) == 1 and result.met is False


def test_a_run_as_asked_for_does_not_warn():
    """With an accuracy that is met, and with a step."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tribo.simulate(scene())
        tribo.simulate(scene(), method="midpoint", step=0.01)


def test_an_error_in_the_ledger_is_raised_each_time(result):
    """It is neither turned into a missing attribute nor forgotten."""

    def broken():
        raise ZeroDivisionError("no ledger")

    other = replace(result, assemble=broken)
    for name in ("ledger", "t", "end", "error_estimate", "system", "ledger"):
        with pytest.raises(ZeroDivisionError, match="no ledger"):
            getattr(other, name)


def test_the_ledger_is_assembled_once():
    """When it is first needed."""
    made = []
    whole = tribo.prepare(scene(), method="midpoint", step=0.01).run(estimate=False)
    counted = replace(whole, assemble=lambda: made.append(1) or whole.ledger)
    assert counted.status == "completed" and counted.cost.steps == 400 and not made
    assert counted.ledger is counted.ledger and counted.t is whole.t and made == [1]


@pytest.mark.parametrize(
    "image", [copy.copy, copy.deepcopy, lambda item: pickle.loads(pickle.dumps(item))]
)
def test_copies(image):
    """A copy is the same result, whether its ledger was assembled before or not."""
    simulation = tribo.prepare(scene(), accuracy=1e-6)
    for estimate in (False, True):
        other = image(simulation.run(estimate=estimate))
        first = simulation.run(estimate=estimate)
        assert same_series(other, first)
        assert other.error_estimate == first.error_estimate
        assert (other.met, other.notes, other.status) == (first.met, first.notes, first.status)
        assert list(image(first["upper"])) == list(first["upper"])


def test_plans_are_immutable():
    """A simulation does not change its plan, whatever it runs."""
    simulation = tribo.prepare(scene(), accuracy=1e-6)
    plan = simulation.plan
    before = dict(vars(simulation.plan))
    simulation.run({"upper.theta": 0.3})
    simulation.run(estimate=False)
    assert simulation.plan is plan and all(vars(plan)[name] is before[name] for name in before)
    with pytest.raises(AttributeError):
        plan.setting = 1.0
    assert not pickle.loads(pickle.dumps(simulation.settings)).tuned.runs


def test_another_scene_by_the_same_plan():
    """It gives the bits of the simulation that was planned, without a search."""
    simulation = tribo.prepare(scene(), accuracy=1e-6)
    other = from_settings(scene(), pickle.loads(pickle.dumps(simulation.settings)))
    for estimate in (False, True):
        one, two = (item.run({"upper.theta": 0.2}, estimate) for item in (simulation, other))
        assert same_series(one, two) and one.error_estimate == two.error_estimate


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
    jump = Coulomb(0.2).with_cutoff(2.0, "truncate")
    simulation = tribo.prepare(replace(scene(), interactions=jump), accuracy=0.1)
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
    """Ctrl-C is raised with a result, which says so, from every call that runs a scene."""

    def interrupt(t):
        raise KeyboardInterrupt

    given = {"method": "midpoint", "step": 1e-4}
    prepared = tribo.prepare(scene(), progress=interrupt, **given)
    for run in (
        lambda: tribo.simulate(scene(), progress=interrupt, **given),
        lambda: tribo.simulate(scene(), progress=interrupt),
        prepared.run,
        prepared.first_result,
    ):
        with pytest.raises(KeyboardInterrupt) as caught:
            run()
        stopped = caught.value.result
        assert stopped.status == "Interrupted" and stopped.t.size >= 1
        assert not stopped.met
        assert "the result contains the samples up to there" in str(stopped)


def test_progress_is_told():
    """Times reached, in order, up to the end."""
    told = []
    tribo.simulate(scene(), method="midpoint", step=1e-3, progress=told.append)
    assert told == sorted(told) and told[-1] == 4.0


def test_file_has_the_first_word_and_the_call_the_last():
    """Numerics of the scene are obeyed unless the call says otherwise."""
    own = replace(scene(), numerics=Numerics(method="midpoint", step=0.01))
    assert tribo.simulate(own).method == "midpoint"
    assert tribo.simulate(own, accuracy=1e-4).method == "midpoint"
    assert tribo.simulate(own, step=0.02).cost.steps == 200
    rough = replace(scene(), numerics=Numerics(accuracy=1e-3))
    assert tribo.simulate(rough).accuracy == 1e-3
    assert tribo.simulate(rough, accuracy=1e-5).accuracy == 1e-5
    assert tribo.simulate(scene()).accuracy == 1e-8


def test_a_prepared_scene_shows_its_progress(monkeypatch, capsys):
    """In the search and in each later run: a bar, a function, or nothing."""
    monkeypatch.setattr("tribo.progress.DELAY", 0.0)
    how = {"accuracy": 1e-6}
    told = []
    shown = tribo.prepare(scene(), progress=True, **how)
    assert "100%" in capsys.readouterr().err
    shown.run()
    assert "100%" in capsys.readouterr().err
    tribo.prepare(scene(), progress=False, **how).run()
    tribo.prepare(scene(), progress=told.append, **how).run()
    assert capsys.readouterr().err == "" and told[-1] == scene().duration
    with pytest.raises(InputError, match=r"^progress: must be a function"):
        tribo.prepare(scene(), progress="often")


def test_long_runs_keep_the_asperites_ends_alone(monkeypatch, tmp_path):
    """Portion by portion, the surfaces' and the system's series are what they are in one piece."""
    simulation = tribo.prepare(scene(), method="midpoint", step=0.01)
    whole = simulation.run()
    monkeypatch.setattr("tribo.ledger.sinks.SERIES_BYTES", 0)
    monkeypatch.setattr("tribo.ledger.sinks.PORTION_BYTES", 5000)
    streamed = tribo.prepare(scene(), method="midpoint", step=0.01).run()
    assert np.array_equal(streamed.t, whole.t)
    for name in ("upper", "lower"):
        for key, values in whole.ledger.blocks[name].items():
            assert np.array_equal(streamed[name][key], values)
        assert np.array_equal(streamed[name].theta, whole[name].theta[[0, -1]])
    for key, values in whole.system.items():
        assert np.array_equal(streamed.system[key], values)
    assert "only the first and the last sample are kept" in streamed.notes[-1]
    streamed.save(tmp_path / "long.nc")
    assert same_series(tribo.load_result(tmp_path / "long.nc"), streamed)
    assert streamed.to_xarray()["end"].values.tolist() == [0.0, 4.0]


@pytest.mark.parametrize("keep", [None, ("upper.W", "contact_energy")])
def test_long_runs_are_continued_after_kills(monkeypatch, tmp_path, keep):
    """Killed again and again between portions and while it writes them: the same bits."""
    monkeypatch.setattr("tribo.ledger.sinks.SERIES_BYTES", 0)
    monkeypatch.setattr("tribo.ledger.sinks.PORTION_BYTES", 2500)
    for name in ("INTERVAL", "RELATIVE_INTERVAL"):
        monkeypatch.setattr(f"tribo.loops.frames.{name}", 0.0)
    long = replace(scene(), output=replace(scene().output, keep=keep))
    how = {"method": "midpoint", "step": 0.01}
    whole = tribo.simulate(long, **how)
    out = tmp_path / "long.nc"
    write = JournaledIntegration.write
    kills = 0

    def killing(integration, name, arrays):
        """Every third frame is the last that a process writes."""
        write(integration, name, arrays)
        killing.left -= 1
        if killing.left == 0:
            raise MemoryError

    monkeypatch.setattr(JournaledIntegration, "write", killing)
    while True:
        killing.left = 3
        try:
            found = tribo.simulate(long, **how, out=out, resume=True)
            break
        except MemoryError:
            kills += 1
    assert kills > 3 and same_series(found, whole)
    assert found.cost.steps == whole.cost.steps


@pytest.mark.parametrize("estimate", [False, True])
def test_half_of_a_step(estimate):
    """A plan with a given step has one with half of it, for all runs."""
    plan = tribo.prepare(scene(), method="midpoint", step=0.01).settings
    half = from_settings(scene(), plan.at_half_step())
    assert half.run(estimate=estimate).cost.steps == 800
    assert from_settings(scene(), plan).run(estimate=estimate).cost.steps == 400
