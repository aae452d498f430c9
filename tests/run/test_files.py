"""Result files and journals: complete or not at all, and never other numbers."""

import pytest

import tribo
from support.continued import chain, pair, same_end
from tribo.run import integrate, journal

SLOWLY = 3  # steps of a chunk: small enough for many checkpoints


class Killed(BaseException):
    """The process ends here."""


@pytest.fixture
def often(monkeypatch):
    """A checkpoint after every chunk of a few steps."""
    monkeypatch.setattr(journal, "INTERVAL", -1.0)
    monkeypatch.setattr(journal, "RELATIVE_INTERVAL", 0.0)
    monkeypatch.setattr(integrate, "FIRST_CHUNK", SLOWLY)
    monkeypatch.setattr(integrate, "LARGEST_CHUNK", SLOWLY)


def killer(after):
    """A progress that kills the process after so many calls."""
    calls = []

    def progress(t):
        calls.append(t)
        if len(calls) > after:
            raise Killed

    return progress


HOW = {  # scene, and how it is run
    "noise": (chain(), {"method": "verlet", "step": 0.02}),
    "pair": (pair(), {"accuracy": 1e-6}),
}


@pytest.mark.parametrize("name", HOW)
def test_resumed_after_kills(often, tmp_path, name):
    """Killed again and again, a run ends with the bits of one that was not."""
    scene, how = HOW[name]
    out = tmp_path / "run.nc"
    whole = tribo.simulate(scene, **how)
    kills = 0
    while True:
        try:
            found = tribo.simulate(scene, **how, out=out, resume=True, progress=killer(2))
            break
        except Killed:
            kills += 1
            assert not out.exists() and (tmp_path / "run.nc.part").exists()
    assert kills > 5
    assert same_end(whole, found) and found.error_estimate == whole.error_estimate
    assert not (tmp_path / "run.nc.part").exists()
    again = tribo.simulate(scene, **how, out=out, resume=True, progress=killer(0))
    assert same_end(whole, again) and found.cost == again.cost
