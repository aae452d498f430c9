"""Inactive asperites: nothing but the time that a run takes shows that they are not stepped."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.continued import same_end
from tribo.explanation.speeds import inactive_at_start
from tribo.integrators.methods import METHODS
from tribo.kernels.records import X, Y
from tribo.kernels.simd import LANES
from tribo.kernels.status import PAUSED
from tribo.run import contacts, inactive, integrate
from tribo.run import layout as layouts
from tribo.run.general_loop import GeneralLoop
from tribo.run.layout import lay_out

VERLET = {"method": "verlet", "step": 0.02}
STOPS = (3.0, 6.0, 9.0, 12.0)


@pytest.fixture(autouse=True)
def lists(monkeypatch):
    """Neighbour lists for few bobs too."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)


def slide(stops=STOPS, **output):
    """A pulled slider that crosses a forced surface and driven bars, all of which swing."""
    slider = tribo.Surface(
        "slider",
        bob=(2.0, 0.7),
        shape=(3, 4),
        spacing=(1.0, 1.0),
        velocity=(1.5, 0.0),
        drive=tribo.Pulled(stiffness=2.0, speed=1.5),
    )
    lower = tribo.Surface(
        "lower",
        facing="up",
        shape=(50, 4),
        spacing=(0.8, 0.8),
        velocity=(-0.5, 0.0),
        asperite=tribo.Asperite(kappa=np.linspace(1.0, 3.0, 200)),
        initial=tribo.Initial(swing=np.linspace(-0.3, 0.2, 200), omega=0.1),
    )
    bars = tribo.Surface(
        "bars",
        facing="up",
        bob=(0.0, 0.05),
        depth=4.0,
        shape=(40, 3),
        spacing=(0.9, 0.9),
        drive="bars",
        bars="free",
        initial=tribo.Initial(swing=0.2, phi=-0.1),
    )
    potential = tribo.with_cutoff(tribo.LennardJones(0.05, 0.5), 1.3)
    pairs = [("slider", "lower"), ("slider", "bars")]
    return tribo.Scene(
        (slider, lower, bars),
        [tribo.Interaction(potential, pair) for pair in pairs],
        stops[-1],
        periodic={"z": 7.0},
        output=tribo.Output(times=stops, **output),
    )


def step_all(monkeypatch):
    """Let the same compiled loop step all blocks at all times."""

    def every(*scene):
        active = inactive.active_blocks(*scene)
        return active._replace(eligible=np.zeros_like(active.eligible))

    monkeypatch.setattr(layouts, "active_blocks", every)


def inactive_asperites(loop):
    """Whether each asperite is inactive, (n,)."""
    active = loop._neighbours.active
    blocks = np.ones(active.since.size, bool)
    blocks[active.blocks[: active.first[-1]]] = False
    assert np.array_equal(blocks, np.isfinite(active.since))
    return blocks[loop.layout.places.columns // LANES]


def test_results_are_those_of_steps(monkeypatch):
    """Every series agrees to round-off, also of asperites that wake, are hit and left behind."""
    closed = tribo.simulate(slide(), **VERLET)
    step_all(monkeypatch)
    stepped = tribo.simulate(slide(), **VERLET)
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


def test_inactive_bobs_are_out_of_reach(monkeypatch):
    """At every step, by the distances of bobs that another loop steps; blocks come and go."""
    scene = slide()
    reach = scene.interactions[0].potential.range()
    layout, other = lay_out(scene), lay_out(scene)
    loop = GeneralLoop(layout, METHODS["verlet"], 0.02, layout.start, 0.0)
    step_all(monkeypatch)
    every = GeneralLoop(other, METHODS["verlet"], 0.02, other.start, 0.0)
    assert loop.inactive == every.inactive == 0
    rooms, seen = [each.room(len(scene.times)) for each in (loop, every)], set()
    columns, part = layout.places.columns, layout.parts["slider"]
    sliding = np.arange(scene.count) < part.stop
    while loop.advance(scene.times, rooms[0], 1) == PAUSED:
        every.advance(scene.times, rooms[1], 1)
        places = np.column_stack([*other.model.bobs[[[X], [Y]], columns], other.depths])
        away = places[sliding, None] - places[None, ~sliding]
        away[..., 2] -= 7.0 * np.round(away[..., 2] / 7.0)
        near = np.any(np.sum(away**2, axis=-1) < reach**2, axis=0)
        asleep = inactive_asperites(loop)
        assert not np.any(asleep[sliding]) and not np.any(asleep[~sliding] & near)
        assert loop.inactive == np.count_nonzero(asleep) and every.inactive == 0
        seen.add(asleep.tobytes())
    assert len(seen) > 5 and loop.inactive > 150


def test_states_and_pauses(monkeypatch):
    """The same bits from the state of a shorter run, and however often the run pauses."""
    whole = tribo.simulate(slide(), **VERLET)
    state = tribo.simulate(slide(STOPS[:2]), **VERLET).state()
    rest = tribo.simulate(slide(), **VERLET, start=state)
    assert rest.t.tolist() == list(STOPS[1:]) and same_end(whole, rest)
    monkeypatch.setattr(integrate, "LARGEST_CHUNK", 1)
    assert same_end(whole, tribo.simulate(slide(), **VERLET))


def test_restored_between_selections():
    """A loop that is restored while blocks are inactive goes on with the same bits."""
    layout = lay_out(slide())
    times = layout.times
    one, other = (GeneralLoop(layout, METHODS["verlet"], 0.02, layout.start, 0.0) for _ in range(2))
    columns = one.room(times.size)
    one.advance(times, columns, 100)
    asleep = inactive_asperites(one)
    assert np.any(asleep)
    memory = {name: array.copy() for name, array in one.memory().items()}
    one.advance(times, columns, 10**6)
    other.restore(memory)
    assert np.array_equal(inactive_asperites(other), asleep)
    again = other.room(times.size)
    other.advance(times, again, 10**6)
    recorded = int(memory["clock"][list(one.clocks.dtype.names).index("sample")])
    for mine, theirs in zip(columns[:2], again[:2], strict=True):
        assert mine[recorded:].tobytes() == theirs[recorded:].tobytes()


def eligible(**lower):
    """Whether the asperites of "lower" can be inactive, if those of others can."""
    scene = slide()
    surfaces = [replace(s, **lower) if s.name == "lower" else s for s in scene.surfaces]
    active = lay_out(replace(scene, surfaces=tuple(surfaces))).neighbours(splits=True).active
    assert active.eligible[[0, 2]].tolist() == [0, 1]
    return active.eligible[1] == 1


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
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 12 * 150)
    active = lay_out(slide()).neighbours(splits=True).active
    assert active.eligible.tolist() == [0, 1, 0]
    assert lay_out(slide()).neighbours().active is None


def test_explanation_counts_the_live():
    """With a splitting method; adaptive ones step all."""
    scene = slide()
    layout = lay_out(scene)
    found = inactive_at_start(layout, METHODS["verlet"])
    assert 0 < found < scene.count and inactive_at_start(layout, METHODS["dop853"]) == 0
