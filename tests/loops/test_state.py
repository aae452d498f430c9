"""States: a run that continues from one gives the bits of a run without the pause."""

import copy
import pickle
from dataclasses import fields, replace

import numpy as np
import pytest

import tribo
from support.continued import chain, pair, same_end
from tribo import Corrugation, Field, InputError
from tribo.layout import contacts
from tribo.ledger import sinks
from tribo.loops import origin


@pytest.fixture(autouse=True)
def lists(monkeypatch):
    """Neighbour lists for few bobs too."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)


@pytest.mark.parametrize("method", ["verlet", "gauss-8"])
def test_continued_run(method, tmp_path):
    """By noise or by a method with memory, from the result or from its file."""
    temperature = 0.3 if method == "verlet" else 0.0
    how = {"method": method, "step": 0.02}
    whole = tribo.simulate(chain(temperature=temperature), **how)
    half = tribo.simulate(chain((1.0, 2.0), temperature), **how)
    half.save(tmp_path / "half.nc")
    for state in (half.state(), tribo.load_result(tmp_path / "half.nc").state()):
        rest = tribo.simulate(chain(temperature=temperature), **how, start=state)
        assert rest.t.tolist() == [2.0, 4.0]
        assert same_end(whole, rest)


def test_a_time_that_is_rounded_otherwise_is_recorded_once():
    """0.6 is the last of 6 times, and 0.6000000000000001 one of those of a longer run."""
    how = {"method": "verlet", "step": 0.02}
    short = replace(chain(), duration=0.6, output=tribo.Output(samples=6))
    state = tribo.simulate(short, **how).state()
    rest = tribo.simulate(replace(short, duration=1.0), **how, start=state)
    assert rest.status == "completed" and rest.t.tolist() == [0.6, 0.8, 1.0]


def test_from_a_run_that_continued():
    """A state has all that came before it, however often a run was continued."""
    how = {"method": "verlet", "step": 0.02}
    whole = tribo.simulate(chain((1.0, 2.0, 3.0, 4.0)), **how)
    state = tribo.simulate(chain((1.0,)), **how).state()
    for end in (2, 3, 4):
        rest = tribo.simulate(chain((1.0, 2.0, 3.0, 4.0)[:end]), **how, start=state)
        assert rest.t.tolist() == [end - 1.0, end] and same_end(whole, rest)
        state = rest.state()


@pytest.mark.parametrize("portion", [1, sinks.PORTION_BYTES])
def test_a_streamed_run_continues_as_a_held_one(portion, monkeypatch):
    """Its series begin at the state; of asperites the ends are kept."""
    state = tribo.simulate(chain((1.0, 2.0)), **EQUAL_STEPS).state()
    held = tribo.simulate(chain(), **EQUAL_STEPS, start=state)
    monkeypatch.setattr(sinks, "SERIES_BYTES", 0)
    monkeypatch.setattr(sinks, "PORTION_BYTES", portion)
    streamed = tribo.simulate(chain(), **EQUAL_STEPS, start=state)
    assert held.t[0] == 2.0 and np.array_equal(streamed.t, held.t)
    expected = held.to_xarray()
    for name, found in streamed.to_xarray().data_vars.items():
        values = expected[name].values
        ends = values if values.shape == found.shape else values[[0, -1]]
        np.testing.assert_array_equal(found.values, ends, err_msg=str(name))


def test_another_method_counts_on():
    """Works count from the start of the run, whatever method continues it."""
    whole = tribo.simulate(pair(), method="rk4", step=0.02)
    state = tribo.simulate(pair(4.0), method="rk4", step=0.02).state()
    rest = tribo.simulate(pair(), method="verlet", step=0.01, start=state)
    for name in ("upper", "lower"):
        for work in ("w1", "w2", "wL", "w"):
            theirs = whole[name][work][-len(rest.t) :]
            assert rest[name][work] == pytest.approx(theirs, abs=1e-4), work


def test_another_speed_of_a_pull():
    """The stage goes on from where it was, at its new speed; works count from the state."""
    how = {"method": "verlet", "step": 0.02}
    state = tribo.simulate(chain((2.0,), 0.0), **how).state()
    assert state.phases[0].tolist() == [0.2 * 2.0, 0.0] and state.phases[2].tolist() == [0.6, 0.0]
    stopped = tribo.simulate(chain((4.0,), 0.0, speed=0.0), **how, start=state)
    assert stopped.t.tolist() == [2.0, 4.0] and stopped.system["applied_work"][0] == 0.0
    after = stopped.state()
    assert after.phases[0].tolist() == [0.4, 0.0] and after.anchors[0].tolist() == [0.4, 0.0]
    on = tribo.simulate(chain((6.0,), 0.0), **how, start=after).state()
    assert on.phases[0] == pytest.approx([0.8, 0.0])
    moved = state.surfaces["upper"]["x"], after.surfaces["upper"]["x"]
    assert all(x.shape == (4,) for x in moved) and np.all(moved[0] != moved[1])


def test_with_an_accuracy():
    """Settings are found for the rest, whose end is that of the whole within the estimates."""
    whole = tribo.simulate(pair(), accuracy=1e-6)
    half = tribo.simulate(pair(4.0), accuracy=1e-6)
    rest = tribo.simulate(pair(), accuracy=1e-6, start=half.state())
    assert rest.met and rest.t[0] == 4.0 and rest.t[-1] == 8.0
    for name in ("upper", "lower"):
        for key, values in rest[name].items():
            bound = sum(run.error_estimate[key] for run in (whole, half, rest))
            assert np.all(np.abs(values[-1] - whole[name][key][-1]) <= bound), key


@pytest.mark.parametrize(
    ("scene", "start", "problem"),
    [
        (chain(), 5, "start: must be a tribo.State, got int"),
        (chain((1.0,)), None, "duration: must be later than the state's t = 1, got 1"),
        (pair(), None, "start: must be a state of this scene, but surface"),
    ],
)
def test_states_that_do_not_fit(scene, start, problem):
    """One sentence, before anything is compiled."""
    if start is None:
        start = tribo.simulate(chain((1.0,)), method="verlet", step=0.02).state()
    with pytest.raises(InputError, match=problem):
        tribo.simulate(scene, method="verlet", step=0.02, start=start)


EQUAL_STEPS = {"method": "verlet", "step": 0.02}


def test_copies_and_pickles():
    """They continue with the bits of the state, and have its digest."""
    whole = tribo.simulate(chain(), **EQUAL_STEPS)
    half = tribo.simulate(chain((1.0, 2.0)), **EQUAL_STEPS).state()
    for other in (copy.copy(half), copy.deepcopy(half), pickle.loads(pickle.dumps(half))):
        assert other.digest == half.digest
        assert same_end(whole, tribo.simulate(chain(), **EQUAL_STEPS, start=other))
    assert replace(half, method="rk4").digest != half.digest


def test_states_of_other_versions(monkeypatch, tmp_path):
    """They may order their numbers otherwise: from a run, a file, a pickle of long ago."""
    result = tribo.simulate(chain((1.0, 2.0)), **EQUAL_STEPS)
    old = result.state()
    result.save(tmp_path / "half.nc")
    before = copy.copy(old)
    vars(before).pop("version")
    rest = tribo.relax(chain())
    monkeypatch.setattr(origin, "version", lambda: "99.0 (later)")
    from_file = tribo.load_result(tmp_path / "half.nc").state()
    for known in (old, from_file, rest, before):
        name = getattr(known, "version", "an earlier version").partition(" ")[0]
        problem = rf"start: must be a state of this version of tribo, 99\.0 .*{name}.*made it"
        with pytest.raises(InputError, match=problem):
            tribo.simulate(chain(), **EQUAL_STEPS, start=known)


def test_shortened_states():
    """Each array of a state has the numbers that the scene calls for, or the state is refused."""
    whole = tribo.simulate(chain((1.0, 2.0)), **EQUAL_STEPS).state()
    damaged = {
        name: replace(whole, **{name: getattr(whole, name)[:-1]})
        for name in ("y", "s", "anchors", "phases")
    }
    for name in ("t", "y", "s", "contact", "field", "stored"):
        first = replace(whole.first, **{name: getattr(whole.first, name)[..., :-1]})
        damaged[f"first_{name}"] = replace(whole, first=first)
    for name, array in whole.memory.items():
        if array.size and name not in ("noise", "neighbours_index"):
            memory = {**whole.memory, name: array[..., :-1]}
            damaged[f"memory.{name}"] = replace(whole, memory=memory)
            memory = {key: values for key, values in whole.memory.items() if key != name}
            if name != "y":  # without it, the run begins a new memory
                damaged[f"memory.{name} is missing"] = replace(whole, memory=memory)
    assert len(damaged) > 20
    for name, start in damaged.items():
        said = {"y": "has other coordinates"}.get(name, name.partition(" ")[0])
        with pytest.raises(InputError, match=f"start: must be a .* but .*{said}") as info:
            tribo.simulate(chain(), **EQUAL_STEPS, start=start)
        assert "\n" not in str(info.value)
    assert {each.name for each in fields(whole.first)} - {"baths"} == {
        name.removeprefix("first_") for name in damaged if name.startswith("first_")
    }


def test_a_further_field():
    """It is where the scene puts it; stages go on from where they were."""
    scene = chain((1.0, 2.0, 4.0), 0.0)
    half = tribo.simulate(chain((1.0, 2.0), 0.0), **EQUAL_STEPS).state()
    more = Field(Corrugation(0.0, 2.0), ["upper"], origin=(0.3, 0.0))
    rest = tribo.simulate(replace(scene, fields=(*scene.fields, more)), **EQUAL_STEPS, start=half)
    stages, fields_now = rest.state().phases[:2], rest.state().phases[2:]
    assert stages[0] == pytest.approx([0.8, 0.0])
    assert fields_now == pytest.approx(np.array([[1.2, 0.0], [0.0, 0.0]]))
    whole = tribo.simulate(scene, **EQUAL_STEPS)
    # A field without amplitude; the other one continues its path, as it has kept its velocity.
    assert rest["upper"].theta[-1] == pytest.approx(whole["upper"].theta[-1], abs=1e-9)


def crossing():
    """A bar falls under its load through another surface, and has a bath."""
    rigid, bath = tribo.Asperite(kappa=np.inf), tribo.Bath([0.1], [2.0])
    drive = tribo.Free(load=0.05)
    upper = tribo.Surface("upper", bob=(0.0, 3.0), drive=drive, asperite=rigid, bath=bath)
    lower = tribo.Surface("lower", facing="up", drive="bars", asperite=rigid)
    output = tribo.Output(samples=121)
    return tribo.Scene((upper, lower), tribo.Plummer(0.01, 0.5), 60.0, output=output)


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")
@pytest.mark.parametrize("streams", [False, True])
def test_no_run_continues_from_one_that_was_cut_back(streams, tmp_path, monkeypatch):
    """Its baths and its memory are those of a later time."""
    if streams:
        monkeypatch.setattr(sinks, "SERIES_BYTES", 0)
    scene, how = crossing(), {"method": "verlet", "step": 0.02}
    result = tribo.simulate(scene, **how)
    assert result.status == "PassedThrough" and result.t[-1] < 60.0
    result.save(tmp_path / "cut.nc")
    for state in (result.state(), tribo.load_result(tmp_path / "cut.nc").state()):
        with pytest.raises(InputError, match="was cut back to t = "):
            tribo.simulate(scene, **how, start=state)
    whole = tribo.simulate(replace(scene, duration=5.0), **how)
    assert tribo.simulate(scene, **how, start=whole.state()).status == "PassedThrough"
