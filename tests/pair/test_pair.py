"""The loop for two asperites: the same motion and the same ledger as by the general loops."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tribo
from support.laws import identities, raw_samples, tables
from support.strategies import asperites, coulombs, dyadic, potentials
from tribo import paper
from tribo.accuracy.levels import first_guess, setting_at
from tribo.accuracy.search_runs import PILOT_LEVEL
from tribo.integrators.methods import METHODS
from tribo.kernels.status import COMPLETED, PAUSED
from tribo.layout.layout import lay_out
from tribo.ledger.ledger import assemble
from tribo.ledger.pair_samples import PairSamples
from tribo.ledger.samples import Samples
from tribo.loops.pair import PairLoop
from tribo.loops.pair_records import has_pair_loop, is_pair
from tribo.loops.select import Integrator
from tribo.pair.loop import COLUMNS

RADAU = METHODS["gauss-radau-15"]


def pilot(layout):
    """Tolerances of a first run."""
    return setting_at(layout, RADAU, first_guess(layout), PILOT_LEVEL)


def by_general_loop(scene: tribo.Scene, accuracy: float, monkeypatch) -> tribo.Result:
    """A run by the same method in the general loop."""
    with monkeypatch.context() as patch:
        patch.setattr("tribo.loops.select.has_pair_loop", lambda layout, method: False)
        return tribo.simulate(scene, accuracy=accuracy, method=RADAU.name)


def assert_agree(one: tribo.Result, other: tribo.Result) -> None:
    """Every series agrees within the sum of both error estimates."""
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


FORCED = tribo.Forced()
FREE = tribo.Free()
BARS = tribo.DrivenBars()
DRIVES = [
    (FORCED, FORCED),
    (FREE, FORCED),
    (FORCED, FREE),
    (FREE, FREE),
    (BARS, BARS),
    (BARS, FREE),
]
POTENTIALS = {
    "a formula of arithmetic": tribo.Coulomb(0.3),
    "one with functions": tribo.Morse(0.3, 1.5, 0.6),
    "one with branches": tribo.LennardJones(0.2, 0.5).with_cutoff(1.8),
}


@pytest.mark.parametrize("drives", DRIVES)
def test_same_as_asperite_by_asperite(drives, monkeypatch):
    """The motion is that of the general loop, and that of a method with other coefficients."""
    scene = pair(POTENTIALS["a formula of arithmetic"], drives)
    own = tribo.simulate(scene, accuracy=1e-11, method=RADAU.name)
    assert max(own.error_estimate["w1"], own.error_estimate["theta"]) < 1e-10
    assert np.max(np.abs(own["upper"].delta_e_int)) > 0.05
    assert_agree(own, by_general_loop(scene, 1e-11, monkeypatch))
    assert_agree(own, tribo.simulate(scene, accuracy=1e-11, method="dop853"))


@pytest.mark.filterwarnings("ignore:the accuracy is not met:tribo.TriboWarning")
@pytest.mark.parametrize(
    "name",
    [pytest.param(k, marks=[pytest.mark.slow] * (k == "one with functions")) for k in POTENTIALS],
)
def test_every_kind_of_potential(name, monkeypatch):
    """Formulas that Lanes cannot compute are computed one distance after another."""
    scene = pair(POTENTIALS[name], DRIVES[1])
    own = tribo.simulate(scene, accuracy=1e-10, method=RADAU.name)
    assert_agree(own, by_general_loop(scene, 1e-10, monkeypatch))


def test_facing_and_order(monkeypatch):
    """Surfaces may face either way and come in any order."""
    scene = pair(tribo.Coulomb(0.3), DRIVES[1])
    upper, lower = scene.surfaces
    turned = replace(upper, bob=(-2.0, -0.4), facing="up", initial=tribo.Initial(theta=3.3))
    for surfaces in ((lower, upper), (turned, lower), (lower, turned)):
        changed = replace(scene, surfaces=surfaces)
        own = tribo.simulate(changed, accuracy=1e-10, method=RADAU.name)
        assert_agree(own, by_general_loop(changed, 1e-10, monkeypatch))


@st.composite
def pairs(draw):
    """Random scenes that the pair's loop serves."""
    drive = st.sampled_from((FORCED, FREE, BARS))
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


@settings(max_examples=4)  # each compiles a loop
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
    """The loop serves all cases of the paper, and no scene with any other effect."""
    for case in paper.CASES:
        assert has_pair_loop(lay_out(paper.scene(case)), RADAU)
        assert not has_pair_loop(lay_out(paper.scene(case)), METHODS["dop853"])
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
    cut = tribo.Coulomb(0.3).with_cutoff(2.0)
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
    """A run that stops early has the same status as in the general loop."""
    scene = pair(tribo.Coulomb(0.3), DRIVES[0])
    upper, lower = scene.surfaces
    still = tribo.Initial()
    one = replace(upper, bob=(0.0, 0.0), depth=0.0, initial=still)
    together = (one, replace(lower, initial=still))
    with pytest.warns(tribo.TriboWarning, match="BobsCoincide"):
        result = tribo.simulate(replace(scene, surfaces=together), method=RADAU.name)
    assert result.status == "BobsCoincide" and result.t.tolist() == [0.0]

    swallowed = tribo.Coulomb(-0.3).with_cutoff(1.0)
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
    """A keystroke stops a long run, and the state that it reached is the last sample."""

    def stop(t):
        reached.append(t)
        if len(reached) == 4:
            raise KeyboardInterrupt

    reached = []
    scene = replace(pair(tribo.Coulomb(0.3), DRIVES[0]), duration=1e5)
    integrator = Integrator(lay_out(scene), RADAU, stop)
    run = integrator(pilot(integrator.layout), scene.times)
    assert run.status == "Interrupted" and run.steps > 100
    assert run.samples.t[-1] == reached[-1]
    shorter = replace(scene, duration=reached[-1], output=tribo.Output(samples=2))
    again = tribo.simulate(shorter, accuracy=1e-9, method=RADAU.name)
    assert abs(run.samples.y[-1, 0] - again["upper"].theta[-1, 0]) < 1e-2


def test_interrupted_after_the_last_step():
    """A keystroke after the last step leaves all samples, and adds none."""

    def stop(t):
        if t == 6.0:
            raise KeyboardInterrupt

    scene = replace(pair(tribo.Coulomb(0.3), DRIVES[0]), output=tribo.Output(samples=3))
    integrator = Integrator(lay_out(scene), RADAU, stop)
    run = integrator(pilot(integrator.layout), scene.times)
    assert run.status == "Interrupted" and run.samples.t.tolist() == [0.0, 3.0, 6.0]
    undisturbed = Integrator(lay_out(scene), RADAU)
    whole = undisturbed(pilot(undisturbed.layout), scene.times)
    assert np.array_equal(run.samples.y, whole.samples.y)


@pytest.mark.parametrize("drives", DRIVES)
def test_from_rest(drives):
    """A run starts from rest, with no encounter ahead."""
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
    """A run that pauses continues with the same bits."""
    scene = replace(pair(tribo.Coulomb(0.3), DRIVES[1]), output=tribo.Output(samples=samples))
    integrator = Integrator(lay_out(scene), RADAU)
    layout = integrator.layout
    own = integrator.pair
    whole = integrator(pilot(integrator.layout), scene.times)
    paused = PairLoop(own, own.beginning(pilot(layout)), layout.start)
    record = np.empty((scene.times.size + 1, COLUMNS))
    code = PAUSED
    calls = 0
    while code == PAUSED:
        code = paused.advance(scene.times, (record,), 3)
        calls += 1
    assert code == COMPLETED and calls > 3
    assert np.array_equal(paused.samples(scene.times, (record,)).s, whole.samples.s)
    assert np.array_equal(paused.samples(scene.times, (record,)).y, whole.samples.y)


@pytest.mark.parametrize("drives", DRIVES)
def test_series_from_the_record(drives):
    """A series that is read from the loop's record is that of the samples, alone or at the end."""
    simulation = tribo.prepare(pair(tribo.Coulomb(0.3), drives), accuracy=1e-8, method=RADAU.name)
    result = simulation.run({"upper.theta": 0.1}, estimate=False)
    samples = raw_samples(result.ledger)
    plain = assemble(simulation.layout, pickle.loads(pickle.dumps(samples)))
    assert type(samples) is PairSamples and type(raw_samples(plain)) is Samples
    for (_, mine), (_, theirs) in zip(
        tables(result), tables(replace(result, assemble=lambda: plain)), strict=True
    ):
        for name, values in mine.items():
            assert np.allclose(values, theirs[name], rtol=0.0, atol=2e-15), name
    end = result.end
    for surface in ("upper", "lower"):
        for name, value in (end["surfaces"][surface] | end["blocks"][surface]).items():
            assert np.array_equal(value, result[surface][name][-1]), name
    assert end["system"] == {name: series[-1] for name, series in result.system.items()}


@pytest.mark.parametrize("method", [RADAU.name, "dop853"])
def test_a_result_for_later_is_the_same(method):
    """A result that is computed at its first use is what it was when the run ended."""
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
    """It does so without samples at the times where other runs are compared."""
    scene = replace(paper.scene(case), output=tribo.Output(samples=2))
    simulation = tribo.prepare(scene, accuracy=accuracy, method=RADAU.name)
    lone = simulation.run(estimate=False)
    exact = tribo.simulate(scene, accuracy=1e-12, method="dop853")
    assert lone.cost.steps < simulation.finest.steps
    for name in ("upper", "lower"):
        assert abs(lone[name].theta - exact[name].theta)[-1, 0] < accuracy
        assert abs(lone[name].w1 - exact[name].w1)[-1, 0] < accuracy


@pytest.mark.parametrize("key", ["upper.x", "upper.vx"])
def test_displaced_centres_of_mass(key):
    """A prepared pair that starts so is the run of a scene that starts so, by the general loop."""
    lower = tribo.Surface("lower", facing="up")

    def scene(**initial):
        upper = tribo.Surface(
            "upper", bob=(-3.0, 0.3), velocity=(0.5, 0.0), drive="free", initial=initial
        )
        return tribo.Scene([upper, lower], tribo.Coulomb(0.2), 8.0)

    run = tribo.prepare(scene(), accuracy=1e-8).run({key: 0.2})
    other = tribo.simulate(scene(**{key.partition(".")[2]: 0.2}), accuracy=1e-8)
    for name in ("w1", "w2", "x_cm", "delta_k_trans"):
        bound = run.error_estimate[name] + other.error_estimate[name]
        assert np.max(np.abs(run["upper"][name] - other["upper"][name])) <= bound, name
