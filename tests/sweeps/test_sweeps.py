"""Sweeps: each point is a run of its scene; finished points are kept; statuses and refusals."""

import json
import math
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
import xarray
from scipy import stats

import tribo
from support.command import main
from tribo import InputError, Output, ensemble, paper, sweep
from tribo.ensembles import batches, request
from tribo.loops import frames
from tribo.model.parameters import with_values
from tribo.sweeps.figure import law_lines, quantities, sweep_lines

SCENE = paper.scene("A")
VALUES = {"upper.velocity": [0.45, 0.5, 0.6], "interaction.strength": [0.1, 0.2]}
THETA = {"upper.theta": stats.norm(0.0, 0.1)}


@pytest.fixture(scope="module")
def whole():
    """A sweep of six points."""
    return sweep(SCENE, VALUES)


def numbers(data):
    """What must not depend on how a sweep was run."""
    return data.drop_vars("seconds", errors="ignore").drop_attrs()


def test_points_are_runs(whole):
    """Those of the scenes with the values in their files, within their errors; with units."""
    assert whole["upper.W"].dims == tuple(VALUES)
    for key, values in VALUES.items():
        np.testing.assert_array_equal(whole[key], values)
    for index in np.ndindex(3, 2):
        own = {key: VALUES[key][k] for (key, k) in zip(VALUES, index, strict=True)}
        scene = replace(with_values(SCENE, own), output=Output(samples=2))
        result = tribo.simulate(scene, accuracy=1e-11)
        for name in ("upper.W", "upper.W_ps", "upper.delta_E_int", "contact_energy"):
            series = result.ledger.series(name)[0]
            bound = whole[f"{name}_error"].values[index]
            assert abs(whole[name].values[index] - series[-1]) <= bound < 1e-8, name
        assert whole["status"].values[index] == "completed"
    assert whole["upper.W"].attrs["units"] == "energy"
    assert len(np.unique(whole["upper.W"])) == 6


def test_errors_at_a_rough_accuracy_are_bounds():
    """Encounters limit the steps there, in runs and in those that check them."""
    pulled = tribo.Pulled(stiffness=1.0, speed=0.3, load=0.1)
    row = {"spacing": (1.0, 0.0)}
    upper = tribo.Surface("upper", shape=(3, 1), bob=(0.0, 1.2), drive=pulled, **row)
    lower = tribo.Surface("lower", facing="up", shape=(6, 1), drive="bars", **row)
    scene = tribo.Scene((upper, lower), tribo.Morse(0.2, 2.0, 1.0), 5.0, output=Output(samples=6))
    loads = {"upper.drive.load": [0.05, 0.1, 0.15, 0.2, 0.25, 0.4]}
    kept = ["upper.W", "upper.theta", "lower.delta_E_int"]
    rough, exact = (sweep(scene, loads, keep=kept, accuracy=a) for a in (1e-2, 1e-11))
    for name in kept:
        error = abs(rough[name] - exact[name]).values.reshape(6, -1).max(axis=1)
        assert np.all(error <= rough[f"{name}_error"].values), name


def test_ends_of_drawn_starts_have_names_of_their_own():
    """The start of a swing keeps its key, also where swing and rate are drawn together."""
    vary = {"upper.swing_state": tribo.Canonical(0.01)}
    strengths = {"interaction.strength": [0.1, 0.2]}
    data = sweep(SCENE, strengths, members=3, vary=vary, keep=["upper.omega"], accuracy=1e-4)
    assert data["upper.omega"].dims == ("member", "upper_asperite")
    assert data["upper.omega_end"].dims == ("interaction.strength", "member", "upper_asperite")
    assert not np.any(data["upper.omega"] == data["upper.omega_end"])


def test_in_parallel(whole):
    """An engine gives the same bits."""
    with ThreadPoolExecutor(2) as pool:
        xarray.testing.assert_identical(numbers(sweep(SCENE, VALUES, engine=pool)), numbers(whole))


@pytest.fixture
def small(monkeypatch):
    """Two points at a time, which are written at once."""
    monkeypatch.setattr(batches, "CHUNK", 2)
    monkeypatch.setattr(frames, "INTERVAL", -1.0)
    monkeypatch.setattr(frames, "RELATIVE_INTERVAL", 0.0)


def interrupt_after(count):
    """A progress function that interrupts after so many points."""

    def progress(done):
        if done == count:
            raise KeyboardInterrupt

    return progress


def test_resumed(whole, tmp_path, small):
    """Finished points are not run again, and what was cut off is."""
    out, part = tmp_path / "sweep.nc", tmp_path / "sweep.nc.part"
    with pytest.raises(KeyboardInterrupt) as caught:
        sweep(SCENE, VALUES, out=out, progress=interrupt_after(4))
    first = caught.value.result
    assert first.attrs["status"] == "Interrupted" and not out.exists()
    assert (first["status"] == "completed").sum() == 4
    assert np.isnan(first["upper.W"].values).sum() == 2
    part.write_bytes(part.read_bytes()[:-5])
    told = []
    data = sweep(SCENE, VALUES, out=out, resume=True, progress=told.append)
    assert told == [4, 6] and not part.exists()
    xarray.testing.assert_identical(numbers(data), numbers(whole))
    again = sweep(SCENE, VALUES, out=out, resume=True, progress=told.append)
    assert told == [4, 6]
    with again:
        xarray.testing.assert_identical(numbers(again), numbers(whole))
    with pytest.raises(InputError, match="accuracy was missing, is 1e-06"):
        sweep(SCENE, VALUES, accuracy=1e-6, out=out, resume=True)
    out.rename(part)
    with pytest.raises(InputError, match="is no such file"):
        sweep(SCENE, VALUES, out=out, resume=True)


def test_the_command_prints_what_is_finished(tmp_path, capsys, monkeypatch, small):
    """Exit status 1, and which points were not run."""
    path = tmp_path / "a.toml"
    path.write_text(SCENE.to_toml(), encoding="utf-8")
    monkeypatch.setattr("tribo.progress._is_watched", lambda: True)
    stop = interrupt_after(4)
    monkeypatch.setattr("tribo.progress.ProgressBar.__call__", lambda bar, done: stop(done))
    texts = [f"{key}={','.join(map(str, values))}" for key, values in VALUES.items()]
    assert main(["sweep", str(path), "--set", texts[0], "--set", texts[1], "--json"]) == 1
    table = json.loads(capsys.readouterr().out)
    ends = [point["status"] for point in table["points"]]
    assert table["status"] == "Interrupted" and ends == 4 * ["completed"] + 2 * ["not run"]


def test_a_second_sweep_is_refused(whole, tmp_path, small):
    """Until the first one ends, which keeps its points; one that was killed locks nothing."""
    out, part = tmp_path / "sweep.nc", tmp_path / "sweep.nc.part"

    def another(done):
        if done == 4:
            for resume in (True, False):
                with pytest.raises(InputError, match="is being written by another process"):
                    sweep(SCENE, VALUES, out=out, resume=resume)

    xarray.testing.assert_identical(
        numbers(sweep(SCENE, VALUES, out=out, progress=another)), numbers(whole)
    )
    assert out.exists() and not part.exists()
    out.unlink()
    killed = (
        "import os, tribo; from tribo import paper; from tribo.ensembles import batches\n"
        "from tribo.loops import frames\n"
        "batches.CHUNK, frames.INTERVAL, frames.RELATIVE_INTERVAL = 2, -1.0, 0.0\n"
        "def kill(done): os.kill(os.getpid(), 9)\n"
        f"tribo.sweep(paper.scene('A'), {VALUES}, out={str(out)!r}, progress=kill)"
    )
    assert abs(subprocess.run([sys.executable, "-c", killed]).returncode) == 9
    assert part.exists()
    told = []
    data = sweep(SCENE, VALUES, out=out, resume=True, progress=told.append)
    assert told[0] == 4
    xarray.testing.assert_identical(numbers(data), numbers(whole))


def test_keys_together_and_words():
    """A tuple of keys is one dimension; words and durations take scenes of their own."""
    pairs = [(0.5, 40.0), (0.25, 80.0)]
    values = {("upper.velocity", "duration"): pairs, "interaction.strength": [0.1, 0.2]}
    data = sweep(SCENE, values, keep=["upper.W"])
    assert data["upper.W"].dims == ("point", "interaction.strength")
    np.testing.assert_array_equal(data["duration"], [40.0, 80.0])
    for k, (speed, duration) in enumerate(pairs):
        for m, strength in enumerate((0.1, 0.2)):
            own = {"upper.velocity": speed, "duration": duration, "interaction.strength": strength}
            run = tribo.simulate(with_values(SCENE, own), accuracy=1e-11)
            bound = float(data["upper.W_error"][k, m])
            assert abs(float(data["upper.W"][k, m]) - run["upper"].W[-1]) <= bound < 1e-8
    with pytest.raises(InputError, match="must be a list of 2 values each"):
        sweep(SCENE, {("upper.velocity", "duration"): [0.5, 0.6]})
    with pytest.raises(InputError, match="is swept twice"):
        sweep(SCENE, {"duration": [1.0], ("upper.velocity", "duration"): [(0.5, 2.0)]})


def test_order_of_keys_and_members_in_lanes():
    """Keys of one plan behind one that takes plans: each point is its own ensemble."""
    values = {"upper.velocity": [0.4, 0.5], "duration": [30.0, 40.0, 50.0]}
    data = sweep(SCENE, values, 3, THETA, keep=["upper.W"])
    assert data["upper.W"].dims == ("upper.velocity", "duration", "member")
    alone = with_values(SCENE, {"upper.velocity": 0.5, "duration": 30.0})
    own = ensemble(alone, 3, THETA, keep=["upper.W"])
    np.testing.assert_allclose(data["upper.W"][1, 0], own["upper.W"], atol=1e-8)
    np.testing.assert_array_equal(data["upper.theta"], own["upper.theta"])


def test_statistics_at_each_point(tmp_path, monkeypatch):
    """They are those of the members that a sweep without them keeps; they continue too."""
    values = {"upper.velocity": [0.4, 0.5], "duration": [30.0, 35.0, 40.0]}
    members = sweep(SCENE, values, 70, THETA, keep=["upper.W"])["upper.W"].values
    monkeypatch.setattr(batches, "CHUNK", 16)
    out = tmp_path / "a.nc"
    how = {"keep": ["upper.W"], "statistics": True, "out": out}
    with pytest.raises(KeyboardInterrupt) as caught:
        sweep(SCENE, values, 70, THETA, progress=interrupt_after(3), **how)
    part = caught.value.result
    assert part.attrs["status"] == "Interrupted"
    assert {*part["point_status"].values.ravel()} == {"completed", "not run"}
    data = sweep(SCENE, values, 70, THETA, resume=True, **how)
    assert data["upper.W_mean"].dims == ("upper.velocity", "duration")
    np.testing.assert_allclose(data["upper.W_mean"], members.mean(axis=2), rtol=1e-12)
    np.testing.assert_allclose(data["upper.W_variance"], members.var(axis=2, ddof=1), rtol=1e-9)
    np.testing.assert_array_equal(data["upper.W_quantile"][:, :, -1], members.max(axis=2))
    assert np.all(data["upper.W_count"].sum("upper.W_bin") == 70)
    assert not out.with_name("a.nc.part").exists()
    with pytest.raises(InputError, match=r"^statistics: needs members"):
        sweep(SCENE, values, keep=["upper.W"], statistics=True)


def test_a_half_width_at_each_point():
    """Its number of members is that of the ensemble there; others have no values."""
    wanted, values = {"upper.W": 0.02}, {"upper.velocity": [0.4, 0.8]}
    data = sweep(SCENE, values, vary=THETA, half_width=wanted)
    counts = []
    for k, speed in enumerate(values["upper.velocity"]):
        own = ensemble(
            with_values(SCENE, {"upper.velocity": speed}), None, THETA, half_width=wanted
        )
        count = own.sizes["member"]
        np.testing.assert_array_equal(data["upper.W"][k, :count], own["upper.W"])
        np.testing.assert_array_equal(data["upper.W_half_width"][k], own["upper.W_half_width"])
        assert np.isnan(data["upper.W"][k, count:]).all()
        counts.append(count)
    assert counts[0] != counts[1] and data.sizes["member"] == max(counts)
    assert set(data["point_status"].values) == {"completed"}


@pytest.mark.parametrize("members", [None, 3])
def test_keys_of_all_surfaces(members, tmp_path):
    """One value for every surface, in lanes as in a scene of its own; no name in a file has "*"."""
    key, vary = "*.asperite.kappa", None if members is None else THETA
    out = tmp_path / "all.nc"
    data = sweep(SCENE, {key: [0.8, 1.3]}, members, vary, keep=["upper.W"], out=out)
    assert data["upper+lower.asperite.kappa"].values.tolist() == [0.8, 1.3]
    with xarray.open_dataset(out) as file:
        xarray.testing.assert_equal(numbers(file), numbers(data))
    pairs = {(key, "duration"): [(0.8, 10.0), (1.3, 20.0)]}
    joined = sweep(SCENE, pairs, members, vary, keep=["upper.W"], out=tmp_path / "pairs.nc")
    assert joined["upper+lower.asperite.kappa"].dims == ("point",)
    both = {f"{name}.asperite.kappa": 1.3 for name in ("upper", "lower")}
    one = sweep(with_values(SCENE, both), {"duration": [40.0]}, members, vary, keep=["upper.W"])
    np.testing.assert_allclose(data["upper.W"][1], one["upper.W"][0], atol=1e-8)
    assert abs(data["upper.W"][1] - data["upper.W"][0]).min() > 1e-3
    with pytest.raises(InputError, match=r"upper\.asperite\.kappa: is swept too"):
        sweep(SCENE, {key: [1.0]}, 3, {"upper.asperite.kappa": [1.0, 1.1, 1.2]})


def test_one_of_two_numbers_has_a_key_of_its_own():
    with pytest.raises(InputError, match=r"upper\.bob: .*as those of upper\.bob\.0"):
        sweep(SCENE, {"upper.bob": [(-10.0, 0.1), (-10.0, 0.2)]})


def test_means_to_a_half_width_keep_their_own_quantities():
    """A sweep once took `keep`, and kept all."""
    given = {"vary": THETA, "half_width": {"upper.W": 0.1}}
    with pytest.raises(InputError, match="half_width: cannot go with keep"):
        sweep(SCENE, {"upper.velocity": [0.4]}, keep=["upper.W"], **given)
    with pytest.raises(InputError, match="statistics: cannot go with half_width"):
        sweep(SCENE, {"upper.velocity": [0.4]}, statistics=True, **given)


def test_members(tmp_path):
    """Each point is an ensemble; its mean has the interval of its members."""
    values, keep = {"upper.velocity": [0.4, 0.5]}, ["upper.w1", "upper.W", "upper.theta"]
    out = tmp_path / "members.nc"
    data = sweep(SCENE, values, members=8, keep=keep, vary=THETA, seed=3, out=out)
    scene = with_values(SCENE, {"upper.velocity": 0.4})
    own = ensemble(scene, 8, THETA, seed=3, keep=keep)
    assert data["upper.w1"].dims == ("upper.velocity", "member", "upper_asperite")
    np.testing.assert_allclose(data["upper.w1"][0], own["upper.w1"], atol=1e-8)
    np.testing.assert_allclose(data["upper.theta_end"][0], own["upper.theta_end"], atol=1e-8)
    work = own["upper.W"].values
    half = stats.t.ppf(0.975, 7) * work.std(ddof=1) / np.sqrt(8)
    assert float(data["upper.W_mean"][0]) == pytest.approx(work.mean(), rel=1e-7)
    assert float(data["upper.W_half_width"][0]) == pytest.approx(half, rel=1e-6)
    with xarray.open_dataset(out) as file:
        xarray.testing.assert_equal(numbers(file), numbers(data))
    assert quantities(data) == ["upper.w1", "upper.W", "upper.theta"]
    (drawn,) = sweep_lines(data, "upper.w1").containers
    assert np.array_equal(drawn.lines[0].get_ydata(), data["upper.w1_mean"][:, 0])
    (drawn,) = sweep_lines(data, "upper.W").containers
    assert np.array_equal(drawn.lines[0].get_ydata(), data["upper.W_mean"])
    (bars,) = drawn.lines[2]
    top = [segment[1, 1] for segment in bars.get_segments()]
    np.testing.assert_allclose(top, data["upper.W_mean"] + data["upper.W_half_width"])


def test_statuses(monkeypatch):
    """A point that stops or is refused has its status and no value; others have theirs."""
    side_by_side = (tribo.Surface("one", bob=(-1.0, 0.0)), tribo.Surface("other", bob=(1.0, 0.0)))
    scene = tribo.Scene(side_by_side, tribo.Coulomb(1.0), 4.0)
    prepare = request.prepare_members

    def refuse_third(scene, *settings):
        if scene.interactions[0].potential.strength == 2.0:
            raise InputError("accuracy", "is out of reach")
        return prepare(scene, *settings)

    monkeypatch.setattr(request, "prepare_members", refuse_third)
    data = sweep(scene, {"interaction.strength": [-1.0, 2.0, 1.0]})
    assert data["status"].values.tolist() == ["StepUnderflow", "Refused", "completed"]
    assert np.isnan(data["one.W"]).values.tolist() == [True, True, False]
    first, second = json.loads(data.attrs["notes"])
    assert first.startswith("interaction.strength = -1.0: the run stopped at t = ")
    assert second == "interaction.strength = 2.0: accuracy: is out of reach"
    with pytest.raises(InputError, match="accuracy: is out of reach"):
        sweep(scene, {"interaction.strength": [2.0]})


def test_the_work_of_a_stage_beside_an_accuracy():
    """It has no accuracy of its own: alone, all quantities that have one are compared."""
    tip = tribo.Surface(
        "tip",
        asperite=tribo.Asperite(kappa=math.inf),
        drive=tribo.Pulled(stiffness=1.0, speed=0.2),
    )
    corrugation = tribo.Field(tribo.Corrugation(0.1, 1.0), on=["tip"])
    scene = tribo.Scene([tip], [], 10.0, fields=[corrugation])
    speeds = {"tip.drive.speed": [0.1, 0.3]}
    bare = replace(scene, output=tribo.Output(ledger="none"))  # it is a work, and kept if named
    found = tribo.sweep(bare, speeds, accuracy=1e-6, keep=["tip.stage_work"], progress=False)
    whole = tribo.sweep(scene, speeds, accuracy=1e-6, progress=False)
    for place, speed in enumerate(speeds["tip.drive.speed"]):
        drive = tribo.Pulled(stiffness=1.0, speed=speed)
        one = replace(scene, surfaces=[replace(tip, drive=drive)])
        work = tribo.simulate(one, accuracy=1e-8, progress=False)["tip"].stage_work[-1]
        for data in (found, whole):
            assert float(data["tip.stage_work"][place]) == pytest.approx(work, abs=1e-6)
            assert "tip.stage_work_error" not in data


def test_values_that_belong_together():
    """No scene is made between the old values and the new ones, which it might refuse."""
    wide = tribo.LennardJones(0.3, 1.0).with_cutoff(2.5)
    scene = replace(SCENE, interactions=wide, periodic={"x": 6.0})
    narrow = with_values(scene, {"periodic.x": 4.0, "interaction.cutoff": 1.9})
    assert narrow.periodic.x == 4.0
    assert narrow.interactions[0].potential.range() == 1.9


def test_figure_of_means_over_seeds():
    """Seeds are samples of which the mean and Student's interval are drawn."""
    rng = np.random.default_rng(1)
    drawn = rng.normal(size=(3, 5))
    keys = {"upper.drive.load": [0.1, 0.2, 0.4], "seed": np.arange(5)}
    status = (tuple(keys), np.full((3, 5), "completed"))
    variables = {"status": status, "upper.W": (tuple(keys), drawn)}
    data = xarray.Dataset(variables, keys)
    ax = sweep_lines(data, "upper.W")
    (line,) = ax.containers
    assert np.allclose(line.lines[0].get_ydata(), drawn.mean(axis=1))
    (bars,) = line.lines[2]
    ends = np.array([segment[:, 1] for segment in bars.get_segments()])
    half_width = stats.t.ppf(0.975, 4) * stats.sem(drawn, axis=1)
    np.testing.assert_allclose(ends[:, 1] - ends[:, 0], 2.0 * half_width)
    assert ax.get_title() == "bars: 95 % interval of the mean over seeds"
    assert len(sweep_lines(data, "upper.W", against="seed").containers) == 3


@pytest.mark.parametrize(
    ("values", "options", "field", "problem"),
    [
        ({}, {}, "values", "must map keys"),
        ({"upper.drive.load": 0.1}, {}, "values.upper.drive.load", "a list of numbers"),
        ({"upper.drive.load": [0.1, 0.1]}, {}, "values.upper.drive.load", "a value twice"),
        ({"upper.theta": [0.1, [0.2]]}, {}, "values.upper.theta", "a list of numbers"),
        ({"uper.theta": [0.1]}, {}, "values.uper.theta", 'did you mean "upper.theta"?'),
        ({"upper.asperite.kappa": [1, -1]}, {}, "values.upper.asperite.kappa", "negative"),
        (VALUES, {"keep": ["upper.w9"]}, "keep.upper.w9", "must be a quantity"),
        (VALUES, {"keep": "upper.W"}, "keep", "must be a list"),
        (VALUES, {"vary": THETA}, "members", "is missing"),
        (VALUES, {"members": 1}, "members", "at least 2"),
        (VALUES, {"engine": 3}, "engine", "submit or map"),
        (VALUES, {"accuracy": 2.0}, "accuracy", "must be from"),
        (VALUES, {"resume": True}, "resume", "needs out"),
        (VALUES, {"progress": 3}, "progress", "a function, True, False or None"),
    ],
)
def test_refusals(monkeypatch, values, options, field, problem):
    """Before anything is run, with the argument's name."""
    monkeypatch.setattr(request, "prepare", lambda *_, **__: pytest.fail("compiled"))
    with pytest.raises(InputError) as caught:
        sweep(SCENE, values, **options)
    assert caught.value.field == field and problem in caught.value.problem


def test_command(whole, tmp_path, capsys):
    """`tribo sweep` writes the data set of `tribo.sweep` and prints its points."""
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(SCENE.to_toml(), encoding="utf-8")
    texts = [f"{key}={','.join(map(str, values))}" for key, values in VALUES.items()]
    command = ["sweep", str(path), "--set", texts[0], "--set", texts[1], "--out", str(out)]
    assert main(command) == 0
    first, head, *rows = capsys.readouterr().out.splitlines()
    assert first == "6 completed" and head.split()[:3] == [*VALUES, "upper.W"]
    row = rows[5].split()
    assert row[:2] == ["0.6", "0.2"]
    assert float(row[2]) == pytest.approx(float(whole["upper.W"][2, 1]), rel=1e-5)
    with xarray.open_dataset(out) as file:
        xarray.testing.assert_equal(numbers(file), numbers(whole))
    figure = tmp_path / "a.png"
    assert main([*command, "--resume", "--json", "--figure", str(figure)]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["status"] == "completed" and len(table["points"]) == 6
    point = table["points"][5]
    assert point["values"] == {"upper.velocity": 0.6, "interaction.strength": 0.2}
    assert point["upper.W"] == float(whole["upper.W"][2, 1]) and point["status"] == "completed"
    assert figure.stat().st_size > 10_000
    assert main([*command, "--figure", "a.txt"]) == 2


def test_figure(whole):
    """A line for each value of the other key, with the errors as bars; means have intervals."""
    ax = sweep_lines(whole, "upper.W", against="interaction.strength")
    lines = [container for container in ax.containers if container.has_yerr]
    assert len(lines) == 3
    for k, line in enumerate(lines):
        x, y = line.lines[0].get_data()
        assert np.array_equal(x, VALUES["interaction.strength"])
        assert np.array_equal(y, whole["upper.W"].values[k])
        (bars,) = line.lines[2]
        ends = np.array([segment[:, 1] for segment in bars.get_segments()])
        error = whole["upper.W_error"].values[k]
        np.testing.assert_allclose(ends[:, 1] - ends[:, 0], 2.0 * error, rtol=1e-3)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("interaction.strength", "upper.W at the end")
    assert ax.get_legend().get_title().get_text() == "bars: error estimate"
    for name, key, problem in (
        ("upper.work", None, "name: must be one of upper.W, .*got 'upper.work'"),
        ("upper.W", "velocity", "against: must be one of upper.velocity, interaction.strength"),
    ):
        with pytest.raises(InputError, match=problem):
            sweep_lines(whole, name, key)
    many = whole.sel({"upper.velocity": [0.5] * 13}, method="nearest")
    with pytest.raises(InputError, match="data: has 13 lines"):
        sweep_lines(many, "upper.W", "interaction.strength")


def test_figure_of_keys_that_are_swept_together():
    """Against the values of the first, or of another by its name; lines name every key."""
    pair, key = "upper.drive.speed,duration", "interaction.strength"
    dimensions, work = (pair, key), np.arange(6.0).reshape(3, 2)
    coordinates = {
        "upper.drive.speed": (pair, [0.5, 0.25, 0.1]),
        "duration": (pair, [40.0, 80.0, 200.0]),
        key: [0.1, 0.2],
    }
    status = (dimensions, np.full((3, 2), "completed"))
    data = xarray.Dataset({"status": status, "upper.W": (dimensions, work)}, coordinates)
    shown = {None: "upper.drive.speed", pair: "upper.drive.speed", "duration": "duration"}
    for against, name in shown.items():
        ax = sweep_lines(data, "upper.W", against)
        assert ax.get_xlabel() == name and len(ax.containers) == 2
        order = np.argsort(data[name].values)
        for line, works in zip(ax.containers, work.T, strict=True):
            assert np.array_equal(line.lines[0].get_xdata(), data[name][order])
            assert np.array_equal(line.lines[0].get_ydata(), works[order])
            assert line.lines[0].get_linestyle() != "None"
    twice = data.assign_coords({"duration": (pair, [40.0, 80.0, 80.0])})
    for line in sweep_lines(twice, "upper.W", "duration").containers:
        assert line.lines[0].get_linestyle() == "None"
    labels = [line.get_label() for line in sweep_lines(data, "upper.W", key).containers]
    assert labels[1] == "upper.drive.speed = 0.25, duration = 80.0"


def test_figure_of_two_points_at_one_place():
    """Marks and names tell the points apart that differ in a key swept together with this one."""
    pair = "upper.drive.speed,duration"
    coordinates = {
        "upper.drive.speed": (pair, [0.5, 0.5, 0.1, 0.1]),
        "duration": (pair, [10.0, 40.0, 50.0, 200.0]),
    }
    variables = {"status": (pair, ["completed"] * 4), "upper.W": (pair, np.arange(4.0))}
    data = xarray.Dataset(variables, coordinates)
    ax = sweep_lines(data, "upper.W")
    lines = [container.lines[0] for container in ax.containers]
    assert [list(line.get_ydata()) for line in lines] == [[2.0, 0.0], [3.0, 1.0]]
    assert len({line.get_marker() for line in lines}) == 2
    names = [text.get_text() for text in ax.get_legend().get_texts()]
    assert names == ["duration = 50.0, 10.0", "duration = 200.0, 40.0"]


@pytest.mark.parametrize("is_law", [False, True])
def test_figure_of_points_without_values_or_intervals(is_law):
    """A line without any value has no name, and marks without an interval are open."""
    keys = {"load": [0.1, 0.2, 0.4], "speed": [0.5, 1.0, 2.0]}
    values = np.arange(9.0).reshape(3, 3)
    values[:, 1] = np.nan
    half_widths = np.full((3, 3), 0.3)
    half_widths[1, 0] = np.nan
    variables = {
        "status": (tuple(keys), np.full((3, 3), "completed")),
        "friction": (tuple(keys), values),
        "friction_half_width": (tuple(keys), half_widths),
        "upper.W_mean": (tuple(keys), values),
        "upper.W_half_width": (tuple(keys), half_widths),
    }
    data = xarray.Dataset(variables, keys, {"surface": "upper"})
    ax = law_lines(data) if is_law else sweep_lines(data, "upper.W")
    shown = ax.get_legend()
    names = ["speed 0.5", "speed 2"] if is_law else ["speed = 0.5", "speed = 2.0"]
    assert [text.get_text() for text in shown.get_texts()] == names
    assert shown.get_title().get_text().endswith("open marks: no interval")
    opened = [line for line in ax.get_lines() if line.get_markerfacecolor() == "white"]
    assert [list(line.get_xydata().ravel()) for line in opened] == [[0.2, 3.0], []]


def test_table_of_means(tmp_path, capsys):
    """Each with the half-width of its interval over members, not with those over time."""
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    path.write_text(SCENE.to_toml(), encoding="utf-8")
    command = ["sweep", str(path), "--set", "upper.velocity=0.4,0.5", "--members", "3"]
    command += ["--vary", "upper.theta=normal(0,0.1)", "--keep", "upper.friction_force"]
    assert main([*command, "--out", str(out)]) == 0
    _, head, first, _, meaning, note, _ = capsys.readouterr().out.splitlines()
    assert "6 of 6 runs have no interval" in note
    assert head.split() == ["upper.velocity", "upper.friction_force_mean", "half-width", "status"]
    assert meaning == "half-width: of the 95 % interval of the mean over members"
    with xarray.open_dataset(out) as data:
        names = ("upper.friction_force_mean", "upper.friction_force_half_width")
        wanted = [float(data[name][0]) for name in names]
    assert [*map(float, first.split()[1:3])] == pytest.approx(wanted, rel=1e-5)


def test_table_of_averages_over_time(tmp_path, capsys):
    """Without members, averages over time have the half-widths of their intervals."""
    path, out = tmp_path / "a.toml", tmp_path / "a.nc"
    scene = replace(SCENE, output=Output(samples=401, series=("forces",)))
    path.write_text(scene.to_toml(), encoding="utf-8")
    command = ["sweep", str(path), "--set", "upper.velocity=0.4,0.5", "--out", str(out)]
    assert main([*command, "--keep", "upper.friction_force,upper.W"]) == 0
    _, head, first, _, meaning, *_ = capsys.readouterr().out.splitlines()
    names = ["upper.velocity", "upper.friction_force", "half-width", "upper.W", "status"]
    assert head.split() == names
    assert meaning == "half-width: of the 95 % interval of the average over time"
    with xarray.open_dataset(out) as data:
        wanted = float(data["upper.friction_force_time_half_width"][0])
    assert float(first.split()[2]) == pytest.approx(wanted, rel=1e-5, nan_ok=True)
    for other in ("plot", "view"):
        assert main([other, str(out)]) == 2
        err = capsys.readouterr().err
        assert "a.nc: is the file of a sweep, and the file of a run is needed: " in err
        assert "draws it with --resume --figure FILE.png" in err
    assert main([*command, "--resume", "--keep", "upper.friction_force,upper.W"]) == 0


def test_averages_begin_before_the_shortest_duration(tmp_path, capsys):
    path = tmp_path / "a.toml"
    scene = replace(SCENE, output=Output(samples=401, series=("forces",), run_in=10.0))
    path.write_text(scene.to_toml(), encoding="utf-8")
    command = ["sweep", str(path), "--keep", "upper.friction_force"]
    status = main([*command, "--set", "duration=8.0,20.0"])
    assert status != 0
    said = "".join(capsys.readouterr())
    assert 'change with it in a sweep, as "duration,output.run_in" does' in said
    assert main([*command, "--set", "duration,output.run_in=[8.0,4.0],[20.0,10.0]"]) == 0


def test_quantities_of_asperites_of_the_command(tmp_path, capsys):
    """Table, JSON and figure of a surface with one; a line names those of a surface with more."""
    upper = tribo.Surface("upper", shape=(2, 1), spacing=(3.0, 0.0))
    lower = tribo.Surface("lower", initial=tribo.Initial(theta=0.1))
    scene = tribo.Scene((upper, lower), (), 1.0, output=Output(samples=3))
    path, figure = tmp_path / "a.toml", tmp_path / "a.png"
    scene.save(path)
    command = ["sweep", str(path), "--set", "duration=1.0,2.0", "--step", "0.01"]
    command += ["--keep", "lower.theta,upper.theta"]
    assert main([*command, "--figure", str(figure)]) == 0
    _, head, first, _, rest, _ = capsys.readouterr().out.splitlines()
    assert head.split() == ["duration", "lower.theta", "status"]
    assert rest == "several values at each point, only in the file of --out: upper.theta"
    assert figure.stat().st_size > 10_000
    assert main([*command, "--json"]) == 0
    point = json.loads(capsys.readouterr().out)["points"][0]
    assert point["lower.theta"] == pytest.approx(float(first.split()[1]), rel=1e-5)
    assert "upper.theta" not in point


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("upper.theta", "--set: must be KEY=VALUE, got 'upper.theta'"),
        ("upper.theta=0.1,,0.2", "--set: must be values with commas"),
        ("uper.theta=0.1", '--set uper.theta: is not a known key; did you mean "upper.theta"?'),
        ("upper.theta=0.1,much", "--set upper.theta: must be a number [rad], got 'much'"),
    ],
)
def test_wrong_values_of_the_command(tmp_path, capsys, text, problem):
    """Status 2 and one line."""
    path = tmp_path / "a.toml"
    path.write_text(SCENE.to_toml(), encoding="utf-8")
    assert main(["sweep", str(path), "--set", text]) == 2
    err = capsys.readouterr().err
    assert err.startswith(f"tribo: {problem}") and err.count("\n") == 1
