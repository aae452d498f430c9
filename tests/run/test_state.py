"""States: a run that continues from one gives the bits of a run without the pause."""

import numpy as np
import pytest

import tribo
from support.continued import chain, same_end
from tribo.run import contacts


@pytest.fixture
def lists(monkeypatch):
    """Neighbour lists for few bobs too."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)


@pytest.mark.parametrize("method", ["verlet", "gauss-8"])
def test_continued_run(lists, method, tmp_path):
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
    # Once more, from a run that was continued itself.
    again = tribo.simulate(chain((1.0, 2.0, 3.0), temperature), **how, start=half.state())
    rest = tribo.simulate(chain((1.0, 3.0, 4.0), temperature), **how, start=again.state())
    assert again.t.tolist() == [2.0, 3.0] and rest.t.tolist() == [3.0, 4.0]
    assert np.all(np.abs(rest.system["total_energy_change"] - rest.system["applied_work"]) < 1e-2)
