"""The loop for two asperites: the same motion and the same ledger as by the general loops."""

import math
import pickle
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

import tribo
from support.laws import identities, tables
from support.strategies import asperites, coulombs, dyadic, potentials
from tribo import paper
from tribo.accuracy.plan import integrator_for
from tribo.accuracy.scales import first_guess
from tribo.accuracy.search import PILOT_LEVEL, setting_at
from tribo.integrators.methods import METHODS
from tribo.kernels import simd
from tribo.kernels.compiled import time_loop
from tribo.kernels.status import COMPLETED, PAUSED
from tribo.pair.loop import COLUMNS, pair_collocation
from tribo.plugins.sources import stamp
from tribo.run.layout import lay_out
from tribo.run.pair_adapter import has_loop, is_pair

RADAU = METHODS["gauss-radau-15"]


def pilot(layout):
    """Tolerances of a first run."""
    return setting_at(layout, RADAU, first_guess(layout), PILOT_LEVEL)


def by_general_loop(scene: tribo.Scene, accuracy: float, monkeypatch) -> tribo.Result:
    """The same method asperite by asperite."""
    with monkeypatch.context() as patch:
        patch.setattr("tribo.run.integrator.has_loop", lambda layout, method: False)
        return tribo.simulate(scene, accuracy=accuracy, method=RADAU.name)


def assert_agree(one: tribo.Result, other: tribo.Result) -> None:
    """Every series within what both say they may be off by."""
    assert one.status == other.status == "completed"
    assert np.array_equal(one.t, other.t)
    for (_, mine), (_, theirs) in zip(tables(one), tables(other), strict=True):
        assert mine.keys() == theirs.keys()
        for name, values in mine.items():
            bound = one.error_estimate[name] + other.error_estimate[name]
            assert np.max(np.abs(values - theirs[name])) <= bound, name


def pair(potential, drives, **others):
    """Two asperites of different kinds that pass close by, with velocities along y and z apart."""
    upper = tribo.Surface(
        "upper",
        bob=(-2.0, 0.7),
        depth=0.1,
        velocity=(0.75, -0.03),
        drive=drives[0],
        asperite=tribo.Asperite(m1=0.7, m2=1.5, kappa=1.9, length=1.3, bar_length=2.0, charge=1.1),
        initial=tribo.Initial(theta=0.3, omega=-0.2),
    )
    lower = tribo.Surface(
        "lower",
        facing="up",
        velocity=(-0.2, 0.02),
        drive=drives[1],
        asperite=tribo.Asperite(m1=0.9, m2=1.3, kappa=1.4, length=1.2, charge=1.3),
        initial=tribo.Initial(theta=math.pi - 0.2, omega=0.4),
    )
    output = tribo.Output(samples=17)
    return tribo.Scene((upper, lower), potential, 6.0, output=output, **others)


FORCED, FREE = tribo.Forced(), tribo.Free()
DRIVES = [(FORCED, FORCED), (FREE, FORCED), (FORCED, FREE), (FREE, FREE)]
POTENTIALS = {
    "a formula of arithmetic": tribo.Coulomb(0.3),
    "one with functions": tribo.Morse(0.3, 1.5, 0.6),
    "one with branches": tribo.with_cutoff(tribo.LennardJones(0.2, 0.5), 1.8),
}


@pytest.mark.parametrize("drives", DRIVES)
def test_same_as_asperite_by_asperite(drives, monkeypatch):
    """By the same method, and by one that shares no coefficient with it."""
    scene = pair(POTENTIALS["a formula of arithmetic"], drives)
    own = tribo.simulate(scene, accuracy=1e-11, method=RADAU.name)
    assert max(own.error_estimate["w1"], own.error_estimate["theta"]) < 1e-10
    assert np.max(np.abs(own["upper"].delta_e_int)) > 0.05
    assert_agree(own, by_general_loop(scene, 1e-11, monkeypatch))
    assert_agree(own, tribo.simulate(scene, accuracy=1e-11, method="dop853"))


@pytest.mark.filterwarnings("ignore:the accuracy is not met:tribo.TriboWarning")
@pytest.mark.parametrize("name", POTENTIALS)
def test_every_kind_of_potential(name, monkeypatch):
    """Those that cannot be computed lane by lane are computed one by one."""
    scene = pair(POTENTIALS[name], DRIVES[1])
    own = tribo.simulate(scene, accuracy=1e-10, method=RADAU.name)
    assert_agree(own, by_general_loop(scene, 1e-10, monkeypatch))


def test_facing_and_order(monkeypatch):
    """Surfaces may face as they like and come in any order."""
    scene = pair(tribo.Coulomb(0.3), DRIVES[1])
    upper, lower = scene.surfaces
    turned = replace(upper, bob=(-2.0, -0.4), facing="up", initial=tribo.Initial(theta=3.3))
    for surfaces in ((lower, upper), (turned, lower), (lower, turned)):
        changed = replace(scene, surfaces=surfaces)
        own = tribo.simulate(changed, accuracy=1e-10, method=RADAU.name)
        assert_agree(own, by_general_loop(changed, 1e-10, monkeypatch))


@st.composite
def pairs(draw):
    """Random pairs of the kind that the loop is for."""
    drive = st.sampled_from((FORCED, FREE))
    surfaces = [
        tribo.Surface(
            name,
            facing=facing,
            bob=(draw(dyadic(*x)), draw(dyadic(*y))),
            depth=draw(dyadic(0.0, 0.25)),
            velocity=(draw(dyadic(*speed)), draw(dyadic(-0.05, 0.05))),
            drive=draw(drive),
            asperite=draw(asperites(None)),
            initial=tribo.Initial(
                theta=(0.0 if facing == "down" else math.pi) + draw(dyadic(-0.4, 0.4)),
                omega=draw(dyadic(-0.4, 0.4)),
            ),
        )
        for name, facing, x, y, speed in (
            ("upper", "down", (-3.0, -1.5), (0.6, 1.0), (0.5, 1.25)),
            ("lower", "up", (-0.5, 0.5), (-0.1, 0.0), (-0.25, 0.25)),
        )
    ]
    potential = draw(st.one_of(coulombs(), potentials()))
    return tribo.Scene(tuple(surfaces), potential, 5.0, output=tribo.Output(samples=9))


@settings(max_examples=25)
@given(pairs())
def test_random_pairs(scene):
    """The ledger closes, and another method finds the same."""
    own = tribo.simulate(scene, accuracy=1e-9, method=RADAU.name)
    assert own.status == "completed"
    for law, names, whole, parts in identities([table for _, table in tables(own)]):
        bound = sum(own.error_estimate[name] for name in names)
        assert np.max(np.abs(whole - parts)) <= bound, law
    other = tribo.simulate(scene, accuracy=1e-10, method="dop853")
    assert_agree(own, other)


def test_who_has_the_loop():
    """All cases of the paper; and no scene with anything more to it."""
    for case in paper.CASES:
        assert has_loop(lay_out(paper.scene(case)), RADAU)
        assert not has_loop(lay_out(paper.scene(case)), METHODS["dop853"])
    scene = pair(tribo.Coulomb(0.3), DRIVES[0])
    upper, lower = scene.surfaces
    row = {"shape": (2, 1), "spacing": (1.0, 0.0)}
    for changes in (
        {"bars": "free"},
        {"initial": tribo.Initial(nu=0.1)},
        {"initial": tribo.Initial(phi=0.1)},
        {"drive": tribo.Forced(load=0.1)},
        {"drive": tribo.Pulled(stiffness=1.0, speed=0.5)},
        {"bath": {"oscillators": [{"mass": 0.3, "frequency": 1.5}]}},
        {"langevin": tribo.Langevin(gamma=0.1)},
        row,
        row | {"springs": tribo.Springs(1.0)},
    ):
        changed = replace(scene, surfaces=(replace(upper, **changes), lower))
        assert not is_pair(lay_out(changed)), changes
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=("upper",))
    cut = tribo.with_cutoff(tribo.Coulomb(0.3), 2.0)
    both = tribo.Interaction(tribo.Coulomb(0.3), species=("A", "B"))
    named = (replace(upper, species="A"), replace(lower, species="B"))
    third = replace(lower, name="third", bob=(2.0, 0.0))
    for other in (
        replace(scene, fields=(field,)),
        replace(scene, interactions=(tribo.Interaction(cut),), periodic=tribo.Periodic(x=8.0)),
        replace(scene, surfaces=named, interactions=(both,)),
        replace(scene, surfaces=(upper, lower, third)),
    ):
        assert not is_pair(lay_out(other)), other


@pytest.mark.filterwarnings("ignore::tribo.TriboWarning")
def test_outcomes():
    """What ends a run early has the names that it has in the general loop."""
    scene = pair(tribo.Coulomb(0.3), DRIVES[0])
    upper, lower = scene.surfaces
    still = tribo.Initial()
    one = replace(upper, bob=(0.0, 0.0), depth=0.0, initial=still)
    together = (one, replace(lower, initial=still))
    with pytest.warns(tribo.TriboWarning, match="BobsCoincide"):
        result = tribo.simulate(replace(scene, surfaces=together), method=RADAU.name)
    assert result.status == "BobsCoincide" and result.t.tolist() == [0.0]

    swallowed = tribo.with_cutoff(tribo.Coulomb(-0.3), 1.0)
    meeting = (
        replace(upper, bob=(-1.0, -0.01), depth=0.0, initial=still),
        replace(lower, initial=still, velocity=(0.0, 0.0)),
    )
    own = tribo.simulate(
        replace(scene, surfaces=meeting, interactions=(tribo.Interaction(swallowed),)),
        accuracy=1e-6,
        method=RADAU.name,
    )
    assert own.status in ("completed", "StepUnderflow", "NotFinite")
    assert np.all(np.isfinite(own["upper"].theta))


def test_interrupted_far_out():
    """A long run is stopped by a keystroke, and what it had reached is its last sample."""

    def stop(t):
        reached.append(t)
        raise KeyboardInterrupt

    reached = []
    scene = replace(pair(tribo.Coulomb(0.3), DRIVES[0]), duration=1e5)
    integrator = integrator_for(lay_out(scene), RADAU, stop)
    run = integrator(pilot(integrator.layout), scene.times)
    assert run.status == "Interrupted" and run.steps > 100
    assert run.samples.t[-1] == reached[-1]
    shorter = replace(scene, duration=reached[-1], output=tribo.Output(samples=2))
    again = tribo.simulate(shorter, accuracy=1e-9, method=RADAU.name)
    assert abs(run.samples.y[-1, 0] - again["upper"].theta[-1, 0]) < 1e-2


def test_interrupted_after_the_last_step():
    """Whoever strikes a key when a run is complete has all of its samples, and no more."""

    def stop(t):
        raise KeyboardInterrupt

    scene = replace(pair(tribo.Coulomb(0.3), DRIVES[0]), output=tribo.Output(samples=3))
    integrator = integrator_for(lay_out(scene), RADAU, stop)
    run = integrator(pilot(integrator.layout), scene.times)
    assert run.status == "Interrupted" and run.samples.t.tolist() == [0.0, 3.0, 6.0]
    undisturbed = integrator_for(lay_out(scene), RADAU)
    whole = undisturbed(pilot(undisturbed.layout), scene.times)
    assert np.array_equal(run.samples.y, whole.samples.y)


@pytest.mark.parametrize("drives", DRIVES)
def test_from_rest(drives):
    """Nothing moves at first, and no encounter is ahead."""
    scene = pair(tribo.Coulomb(0.3), drives)
    upper, lower = (
        replace(surface, velocity=(0.0, 0.0), initial=tribo.Initial()) for surface in scene.surfaces
    )
    scene = replace(scene, surfaces=(upper, lower))
    own = tribo.simulate(scene, accuracy=1e-9, method=RADAU.name)
    other = tribo.simulate(scene, accuracy=1e-9, method="rkn8")
    assert own.cost.steps < 60
    assert_agree(own, other)


@pytest.mark.parametrize("samples", [17, 2])
def test_in_pieces_as_in_one(samples):
    """A run that pauses goes on where it was, to the last bit."""
    scene = replace(pair(tribo.Coulomb(0.3), DRIVES[1]), output=tribo.Output(samples=samples))
    integrator = integrator_for(lay_out(scene), RADAU)
    layout, own = integrator.layout, integrator._pair
    whole = integrator(pilot(integrator.layout), scene.times)
    loop = time_loop(pair_collocation, stamp(layout.plugins))
    own._unbegun[0] = 0
    record = np.empty((scene.times.size + 1, COLUMNS))
    code, calls = PAUSED, 0
    while code == PAUSED:
        code = loop(*own._given, layout.start, own._clocks, scene.times, record, 3)
        calls += 1
    assert code == COMPLETED and calls > 3
    assert np.array_equal(own.samples(scene.times, record).s, whole.samples.s)
    assert np.array_equal(own.samples(scene.times, record).y, whole.samples.y)


@pytest.mark.parametrize("method", [RADAU.name, "dop853"])
def test_a_result_for_later_is_the_same(method):
    """What is put together when looked at is what it was when the run ended."""
    scene = pair(tribo.Coulomb(0.3), DRIVES[1])
    simulation = tribo.prepare(scene, accuracy=1e-8, method=method)
    later = simulation.run({"upper.theta": 0.1}, estimate=False)
    at_once = simulation.run({"upper.theta": 0.1}, estimate=False).end
    simulation.run({"upper.theta": -0.3}, estimate=False)
    copied = pickle.loads(pickle.dumps(simulation.run({"upper.theta": 0.1}, estimate=False)))
    timed = [name for name in at_once if "seconds" in name]
    for end in (later.end, copied.end):
        assert end | dict.fromkeys(timed) == at_once | dict.fromkeys(timed)


@pytest.mark.parametrize("case", ["A", "D"])
@pytest.mark.parametrize("accuracy", [1e-5, 1e-9])
def test_a_run_without_an_estimate_keeps_the_accuracy(case, accuracy):
    """Though it does not stop at the times where others are compared."""
    scene = replace(paper.scene(case), output=tribo.Output(samples=2))
    simulation = tribo.prepare(scene, accuracy=accuracy, method=RADAU.name)
    lone = simulation.run(estimate=False)
    exact = tribo.simulate(scene, accuracy=1e-12, method="dop853")
    assert lone.cost.steps < simulation.finest.steps
    for name in ("upper", "lower"):
        assert abs(lone[name].theta - exact[name].theta)[-1, 0] < accuracy
        assert abs(lone[name].w1 - exact[name].w1)[-1, 0] < accuracy


# --- lanes ---------------------------------------------------------------------------------------


@njit
def _sine_cosine(x, out):
    """Row 0 of `x` into both rows of `out`."""
    sin, cos = simd.sine_cosine(simd.load(simd.rows_of(x), 0))
    simd.store(simd.rows_of(out), 0, sin)
    simd.store(simd.rows_of(out), 1, cos)


@pytest.mark.parametrize("size", [1e-9, 0.5, 3.0, 50.0, 1e5])
def test_sine_and_cosine(size):
    """To round-off, in all quadrants."""
    rng = np.random.default_rng(1)
    out = np.empty((2, 8))
    for _ in range(200):
        x = rng.uniform(-size, size, (1, 8))
        _sine_cosine(x, out)
        for i in range(8):
            with mpmath.workdps(40):
                assert abs(out[0, i] - mpmath.sin(mpmath.mpf(x[0, i]))) < 2.3e-16
                assert abs(out[1, i] - mpmath.cos(mpmath.mpf(x[0, i]))) < 2.3e-16


@njit
def _everything(x, out):
    """Each operation once."""
    rows, into = simd.rows_of(x), simd.rows_of(out)
    a, b = simd.load(rows, 0), simd.load(rows, 1)
    simd.store(into, 0, a + b)
    simd.store(into, 1, 2.0 - a * b)
    simd.store(into, 2, a / b)
    simd.store(into, 3, simd.root(simd.magnitude(a)))
    simd.store(into, 4, simd.where_less(a, b, a, 7.0))
    simd.store(into, 5, simd.put(a, 3, simd.lane(b, 5)))
    into[6, 0] = simd.total(a)
    into[6, 1] = simd.highest(a)
    into[6, 2] = rows[1, 4]
    scaled = (a, 2.0 * a, b, simd.lanes_of(rows[0, 1]), a * b, a - b, a + b, 3.0 * b)
    simd.store(into, 7, simd.totals(scaled))


def test_arithmetic():
    """Lanes are numpy's arrays of eight."""
    rng = np.random.default_rng(2)
    for _ in range(50):
        x = rng.normal(size=(2, 8))
        out = np.empty((8, 8))
        _everything(x, out)
        a, b = x
        third = a.copy()
        third[3] = b[5]
        expected = (a + b, 2.0 - a * b, a / b, np.sqrt(abs(a)), np.where(a < b, a, 7.0), third)
        assert np.allclose(out[:6], expected, rtol=4e-16, atol=4e-16)
        assert np.allclose(out[6, :3], (np.sum(a), np.max(a), b[4]), rtol=1e-14)
        scaled = (a, 2.0 * a, b, np.full(8, a[1]), a * b, a - b, a + b, 3.0 * b)
        assert np.allclose(out[7], np.sum(scaled, axis=1), rtol=1e-13, atol=1e-14)
