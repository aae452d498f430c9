"""One simulation in several threads, and its copies and pickles: the bits of serial runs."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

import tribo
from support.laws import tables
from tribo import paper
from tribo.threads.writable_memory import arrays_in

RUNS = 60
STARTS = [{"upper.theta": float(theta)} for theta in np.linspace(-0.2, 0.2, RUNS)]


class Bell(NamedTuple):
    """A potential of the user's own."""

    strength: float

    def energy(self, r):
        """A smooth repulsion."""
        return self.strength * np.exp(-(r**2))


class Push(NamedTuple):
    """A drive of the user's own."""

    strength: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """A pull that saturates."""
        return self.strength - 0.3 * vx, -fy


def grid(**kinds):
    """3 over 3."""
    upper = tribo.Surface(
        "upper", bob=(-2, 0.6), velocity=(0.5, 0), shape=(3, 1), spacing=(0.9, 0), **kinds
    )
    lower = tribo.Surface("lower", facing="up", shape=(3, 1), spacing=(0.9, 0))
    return tribo.Scene((upper, lower), tribo.Coulomb(0.4), 12.0, output=tribo.Output(samples=5))


def noisy():
    """Springs, baths, reservoirs, driven bars and rigid surfaces, a field, a user's own kinds."""
    reservoir, bars = tribo.Langevin(0.3, 0.2), {"shape": (3, 1), "spacing": (0.9, 0)}
    scene = grid(
        springs=tribo.Springs(5.0),
        bath=tribo.Bath((0.4, 0.3), (4.0, 7.0)),
        langevin=reservoir,
        drive=tribo.Custom(force=Push(0.3)),
    )
    swing = tribo.Langevin(0.2, 0.1, on="swing")
    held = tribo.Surface("held", facing="up", bob=(1, 0.1), drive="bars", langevin=swing, **bars)
    block = tribo.Surface("block", bob=(2, 0.7), drive=tribo.Free(rigid=True, load=0.1), **bars)
    field = tribo.Field(tribo.Corrugation(0.2, 1.5), on=("upper",))
    surfaces = (*scene.surfaces, held, block)
    contact = tribo.Interaction(Bell(0.4))
    return replace(scene, surfaces=surfaces, interactions=(contact,), fields=(field,), duration=4.0)


@cache
def simulation(kind):
    """Of a pair, of 3 + 3, and of one with every effect and noise."""
    if kind == "pair":
        return tribo.prepare(paper.scene("A"), accuracy=1e-8)
    if kind == "grid":
        return tribo.prepare(grid(), method="rkn8", accuracy=1e-6, threads=1)
    return tribo.prepare(noisy(), method="verlet", step=0.02, threads=1)


def values(result):
    """All series of a result in one array."""
    series = [values for _, table in tables(result) for values in table.values()]
    return np.concatenate([np.ravel(each) for each in series])


@cache
def serial(kind):
    """The values of runs one after another."""
    return [values(simulation(kind).run(start, estimate=False)) for start in STARTS]


KINDS = pytest.mark.parametrize("kind", ["pair", "grid", "noisy"])


@KINDS
def test_two_threads(kind):
    """Each of many runs has the bits of the serial one."""
    expected, one = serial(kind), simulation(kind)

    def run(start):
        return values(one.run(start, estimate=False))

    with ThreadPoolExecutor(2) as pool:
        for _ in range(20 if kind == "pair" else 1):
            wrong = [
                not np.array_equal(found, wanted)
                for found, wanted in zip(pool.map(run, STARTS), expected, strict=True)
            ]
            assert not any(wrong), f"{sum(wrong)} of {RUNS} runs"


def test_a_run_leaves_its_layout():
    """A run writes to no array of the layout, which other runs read."""
    one = simulation("noisy")
    arrays = list(arrays_in(tuple(one.layout.model)))
    before = [array.tobytes() for array in arrays]
    assert one.run().status == "completed"
    assert [array.tobytes() for array in arrays] == before


@KINDS
@pytest.mark.parametrize(
    "made", [copy.copy, copy.deepcopy, lambda s: pickle.loads(pickle.dumps(s))]
)
def test_copies(kind, made):
    """Copies and pickles give the bits of the original, also while that goes on."""
    one, expected = simulation(kind), serial(kind)
    other = made(one)
    for n in (0, 30, 59):
        one.run(STARTS[5], estimate=False)
        assert np.array_equal(values(other.run(STARTS[n], estimate=False)), expected[n])
    mine, theirs = (s.run(STARTS[3]) for s in (one, other))
    assert np.array_equal(values(mine), values(theirs))
    assert mine.error_estimate == theirs.error_estimate and mine.notes == theirs.notes


def test_a_pickle_continues_from_a_state():
    """A simulation that begins from the state of a run does so after it was pickled."""
    scene = simulation("noisy").scene
    half = tribo.simulate(replace(scene, duration=2.0), method="verlet", step=0.02)
    one = tribo.prepare(scene, method="verlet", step=0.02, start=half.state())
    other = pickle.loads(pickle.dumps(one))
    assert np.array_equal(values(one.run()), values(other.run()))
    assert one.run().t[0] == other.run().t[0] == 2.0


def test_an_ensemble_in_threads_of_an_engine():
    """Members with kept friction forces have the bits of members that run one by one."""
    output = tribo.Output(samples=25)
    scene = replace(simulation("grid").scene, duration=40.0, output=output)
    setting = {"method": "rkn8", "keep": ["upper.friction_force", "upper.w1"]}
    vary = {"upper.theta": np.linspace(-0.2, 0.2, 80)}
    alone = tribo.ensemble(scene, vary=vary, **setting)
    with ThreadPoolExecutor(2) as pool:
        shared = tribo.ensemble(scene, vary=vary, engine=pool, **setting)
    assert np.isfinite(alone["upper.friction_force"]).all()
    assert shared.drop_attrs().identical(alone.drop_attrs())


def test_an_ensemble_on_a_worker_with_two_threads():
    """The same on a cluster whose only worker runs two tasks at a time in one process."""
    distributed = pytest.importorskip("distributed")
    scene = replace(simulation("grid").scene, duration=40.0, output=tribo.Output(samples=25))
    setting = {"method": "rkn8", "keep": ["upper.friction_force", "upper.w1"]}
    vary = {"upper.theta": np.linspace(-0.2, 0.2, 80)}
    alone = tribo.ensemble(scene, vary=vary, **setting)
    local = {"processes": False, "n_workers": 1, "threads_per_worker": 2}
    with distributed.Client(**local, dashboard_address=None) as client:
        shared = tribo.ensemble(scene, vary=vary, engine=client, **setting)
    assert np.isfinite(alone["upper.friction_force"]).all()
    assert shared.drop_attrs().identical(alone.drop_attrs())
