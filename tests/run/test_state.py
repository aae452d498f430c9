"""States: a run that continues from one gives the bits of a run without the pause."""


import numpy as np
import pytest

import tribo
from tribo import (
    Asperite,
    Bath,
    Corrugation,
    Coulomb,
    Field,
    Free,
    Langevin,
    Morse,
    Output,
    Pulled,
    Scene,
    Surface,
    with_cutoff,
)
from tribo.run import contacts


def chain(times=(1.0, 2.0, 4.0), temperature=0.3, speed=0.2):
    """A pulled row with noise and a bath over a row with a moving field, by neighbour lists."""
    asperite = Asperite(kappa=3.0)
    upper = Surface(
        "upper",
        bob=(-1.0, 0.6),
        shape=(4, 1),
        spacing=(1.1, 0.0),
        asperite=asperite,
        drive=Pulled(stiffness=2.0, speed=speed),
        bath=Bath([0.1], [2.0]),
        langevin=Langevin(gamma=0.1, temperature=temperature),
    )
    lower = Surface("lower", facing="up", shape=(5, 1), spacing=(1.0, 0.0), drive=Free())
    field = Field(Corrugation(0.1, 2.0), ["lower"], velocity=(0.3, 0.0))
    potential = with_cutoff(Morse(1.0, 2.5, 0.7), 1.4)
    output = Output(times=times)
    return Scene((upper, lower), potential, times[-1], fields=(field,), seed=3, output=output)


def pair(duration=8.0):
    """One asperite passes one."""
    upper = Surface("upper", bob=(-2.0, 0.0), velocity=(0.5, 0.0))
    lower = Surface("lower", facing="up", drive=Free())
    return Scene((upper, lower), Coulomb(0.2), duration, output=Output(samples=5))


@pytest.fixture
def lists(monkeypatch):
    """Neighbour lists for few bobs too."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)


def same_end(one, other):
    """Whether two results have the same bits from the first time of the second on."""
    ledger = one.ledger.rows(np.isin(one.t, other.t))
    pairs = [(ledger.t, other.t)]
    pairs += [(ledger.system[key], other.system[key]) for key in other.system]
    for kind in ("surfaces", "blocks"):
        for name, theirs in getattr(other.ledger, kind).items():
            mine = getattr(ledger, kind)[name]
            assert set(mine) == set(theirs)
            pairs += [(mine[key], theirs[key]) for key in theirs]
    return all(np.array_equal(a, b) for a, b in pairs)


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
