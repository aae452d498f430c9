"""States: a run that continues from one gives the bits of a run without the pause."""

import numpy as np
import pytest

import tribo
from support.continued import chain, pair, same_end
from tribo import InputError
from tribo.run import contacts


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


def test_from_a_run_that_continued():
    """A state has all that came before it, however often a run was continued."""
    how = {"method": "verlet", "step": 0.02}
    whole = tribo.simulate(chain((1.0, 2.0, 3.0, 4.0)), **how)
    state = tribo.simulate(chain((1.0,)), **how).state()
    for end in (2, 3, 4):
        rest = tribo.simulate(chain((1.0, 2.0, 3.0, 4.0)[:end]), **how, start=state)
        assert rest.t.tolist() == [end - 1.0, end] and same_end(whole, rest)
        state = rest.state()


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
