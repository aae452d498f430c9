"""Inactive asperites: nothing but the time that a run takes shows that they are not stepped."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.continued import same_end
from support.inactive import STEP, STOPS, check, crossing, step_all
from support.inactive import inactive as not_stepped
from tribo.explanation import contact
from tribo.integrators.methods import METHODS
from tribo.layout import contacts
from tribo.layout.layout import lay_out
from tribo.loops import integrate
from tribo.loops.general import GeneralLoop
from tribo.loops.setting import Setting

VERLET = {"method": "verlet", "step": STEP}


@pytest.fixture(autouse=True)
def lists(monkeypatch):
    """Neighbour lists for few bobs too."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)


def test_results_are_those_of_steps(monkeypatch):
    """Every series agrees to round-off, also of asperites that wake, are hit and left behind."""
    closed = tribo.simulate(crossing(), **VERLET)
    every = contacts.active_packs
    monkeypatch.setattr(contacts, "active_packs", lambda *scene: step_all(every(*scene)))
    stepped = tribo.simulate(crossing(), **VERLET)
    assert closed.status == stepped.status == "completed"
    assert closed.cost.steps == stepped.cost.steps
    for name in ("lower", "bars"):
        worked = np.max(np.abs(stepped[name].w1), axis=0) > 0.0
        assert 10 < np.count_nonzero(worked) < worked.size
    pairs = [(closed[name], stepped[name]) for name in ("slider", "lower", "bars")]
    for one, other in (*pairs, (closed.system, stepped.system)):
        for key in other:
            bound = 1e-12 * np.max(np.abs(other[key]))
            assert np.max(np.abs(one[key] - other[key])) <= bound, key


def test_asperites_that_are_not_stepped():
    """Those out of reach, selected when bobs have moved by the margin, at every step of a run."""
    assert check(crossing()) == ""


def test_states_and_pauses(monkeypatch):
    """The same bits from the state of a shorter run, and however often the run pauses."""
    whole = tribo.simulate(crossing(), **VERLET)
    state = tribo.simulate(crossing(STOPS[:2]), **VERLET).state()
    rest = tribo.simulate(crossing(), **VERLET, start=state)
    assert rest.t.tolist() == list(STOPS[1:]) and same_end(whole, rest)
    monkeypatch.setattr(integrate, "LARGEST_CHUNK", 1)
    assert same_end(whole, tribo.simulate(crossing(), **VERLET))


def test_restored_between_selections():
    """A loop that is restored while packs are inactive goes on with the same bits."""
    layout = lay_out(crossing())
    times = layout.times
    one, other = (
        GeneralLoop(layout, METHODS["verlet"], Setting(step=STEP), layout.start, 0.0)
        for _ in range(2)
    )
    columns = one.room(times.size)
    one.advance(times, columns, 100)
    asleep = not_stepped(one)
    assert np.any(asleep)
    unlike = layout.parts["lower"]
    rotations = one._scratch[0].rotations[0, 0, layout.places.columns[unlike]]
    assert np.any(np.isnan(rotations)) and not np.any(np.isnan(rotations[~asleep[unlike]]))
    memory = {name: array.copy() for name, array in one.memory().items()}
    one.advance(times, columns, 10**6)
    other.restore(memory)
    assert np.array_equal(not_stepped(other), asleep)
    again = other.room(times.size)
    other.advance(times, again, 10**6)
    recorded = int(memory["clock"][list(one.clocks.dtype.names).index("sample")])
    for mine, theirs in zip(columns[:2], again[:2], strict=True):
        assert mine[recorded:].tobytes() == theirs[recorded:].tobytes()


def eligible(**lower):
    """Whether the asperites of "lower" can be active, if those of others can."""
    scene = crossing()
    surfaces = [replace(s, **lower) if s.name == "lower" else s for s in scene.surfaces]
    active = lay_out(replace(scene, surfaces=tuple(surfaces))).neighbours(splits=True).active
    assert active.eligible[1:].tolist() == [0, 1]
    return active.eligible[0] == 1


@pytest.mark.parametrize(
    "more",
    [
        {"drive": tribo.Forced(load=0.1)},
        {"drive": "free"},
        {"springs": tribo.Springs(1.0)},
        {"bath": tribo.Bath([0.1], [1.0])},
        {"langevin": tribo.Langevin(gamma=0.1, temperature=0.1, on="swing")},
        {"initial": tribo.Initial(nu=0.1)},
    ],
    ids=lambda more: next(iter(more)),
)
def test_asperites_that_are_always_stepped(more):
    """Those on which more than contact acts, or whose bars do not move uniformly."""
    assert eligible() and not eligible(**more)


def test_surfaces_without_lists(monkeypatch):
    """Bobs whose contacts are in no list are stepped: too few, or reached from everywhere."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 1200)
    active = lay_out(crossing()).neighbours(splits=True).active
    assert active.eligible.tolist() == [1, 0, 0]
    assert lay_out(crossing()).neighbours().active.packs.size == 0


def test_explanation_counts_the_live():
    """With a splitting method; adaptive ones step all."""
    scene = crossing()
    layout = lay_out(scene)
    found = contact(layout, METHODS["verlet"]).inactive
    assert 0 < found < scene.count and contact(layout, METHODS["dop853"]).inactive == 0
