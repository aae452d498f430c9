"""States are read by surface, asperite and coordinate: nothing jumps where another scene begins."""

import itertools
import pickle
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.continued import same_end
from support.everything import everything
from tribo import Asperite, Forced, Free, InputError, Pulled, Pushed

HOW = {"method": "verlet", "step": 0.05}
MOTION = ("theta", "omega", "phi", "nu", "x_cm", "y_cm", "vx_cm", "vy_cm", "x_bob", "y_bar")
DRIVES = {
    "forced": Forced(),
    "pressed": Forced(load=0.05),
    "free": Free(load=0.05),
    "block": Free(load=0.05, rigid=True),
    "pulled": Pulled(stiffness=0.5, speed=0.3),
    "pulled and pressed": Pulled(load=0.05, stiffness=0.5, speed=0.3),
    "pushed": Pushed(force=(0.02, 0.0), rate=(0.03, -0.01)),
    "bars": tribo.DrivenBars(),
}


def scene(drive="forced", bars="clamped", end=1.0, order=1, **settings):
    """A row over a row whose clamped bars turn; `order` is -1 for the other one first."""
    upper = {
        "bob": (0.3, 1.5),
        "velocity": (0.2, 0.0),
        "shape": (2, 1),
        "spacing": (1.3, 0.0),
        "asperite": Asperite(kappa=3.0, m1=[1.0, 1.4]),
        "initial": tribo.Initial(swing=[0.1, 0.15], nu=0.2 if bars == "clamped" else 0.1),
    } | settings
    lower = tribo.Surface(
        "lower",
        facing="up",
        shape=(3, 1),
        spacing=(1.1, 0.0),
        drive="bars",
        initial=tribo.Initial(nu=0.1),
    )
    rows = [tribo.Surface("upper", drive=DRIVES[drive], bars=bars, **upper), lower][::order]
    contact = tribo.Gaussian(0.4, 0.8).with_cutoff(2.5)
    return tribo.Scene(rows, contact, end, output=tribo.Output(times=[end]))


def state_after(*settings, **more):
    return tribo.simulate(scene(*settings, **more), **HOW).state()


def assert_continuous(before, after):
    """All motion at the start of a run is that at the end of another."""
    for surface in ("upper", "lower"):
        for name in MOTION:
            end, start = before[surface][name][-1], after[surface][name][0]
            assert start == pytest.approx(end, abs=1e-12), (surface, name)


@pytest.mark.thorough
def test_from_any_drive_to_any_other():
    """Where the new scene holds what the state has displaced, it is refused; else nothing jumps."""
    kinds = list(itertools.product(DRIVES, ("clamped", "free")))
    rng, accepted = np.random.default_rng(1), 0
    for drive, bars in kinds:
        before = tribo.simulate(scene(drive, bars), **HOW)
        state = before.state()
        tops = {name: np.abs(values).max() for name, values in state.surfaces["upper"].items()}
        for k in rng.choice(len(kinds), 4, replace=False):
            other, others = kinds[k]
            after = scene(other, others, 2.0, order=int(rng.choice([-1, 1])))
            upper = next(s for s in after.surfaces if s.name == "upper")
            held = [a for a in "xy" if not getattr(after, f"slides_along_{a}")(upper)]
            jumps = any(tops[name] > 1e-8 for axis in held for name in (axis, f"v{axis}"))
            if other == "bars":
                jumps = drive != "bars"
            if other == "block":
                jumps = jumps or np.ptp(state.surfaces["upper"]["vx"]) > 1e-8
            if jumps:
                expected = r'^start: must have .* of "upper" .*, but they (?!are displaced by 0 )'
                with pytest.raises(InputError, match=expected):
                    tribo.simulate(after, **HOW, start=state)
                continue
            accepted += 1
            assert_continuous(before, tribo.simulate(after, **HOW, start=state))
    assert accepted > 20


def test_a_moving_surface_cannot_be_held():
    """A refusal gives the speed at which the state has bars that the new scene drives."""
    rigid = Asperite(kappa=np.inf)
    falling = tribo.Surface("s", asperite=rigid, drive=Free(load=0.1))
    one = tribo.Scene([falling], [], 1.0, output=tribo.Output(samples=2))
    state = tribo.simulate(one, accuracy=1e-8).state()
    speed = abs(state.surfaces["s"]["vy"][0].item())
    held = tribo.Scene([replace(falling, drive="bars")], [], 2.0)
    with pytest.raises(InputError, match=f"move at {speed:.3g}"):
        tribo.simulate(held, start=state)


@pytest.mark.parametrize(("drive", "bars"), [("pushed", "free"), ("pulled and pressed", "clamped")])
def test_a_scene_that_changed_goes_on_as_one(drive, bars):
    """What began at a state keeps its time, its stage and its clamps, in copies and pickles too."""
    state = state_after("pressed", "free")
    whole = tribo.simulate(replace(scene(drive, bars, 3.0), output=TWO), **HOW, start=state)
    half = tribo.simulate(scene(drive, bars, 2.0), **HOW, start=state).state()
    for each in (half, pickle.loads(pickle.dumps(half))):
        rest = tribo.simulate(scene(drive, bars, 3.0), **HOW, start=each)
        assert rest.t.tolist() == [2.0, 3.0] and same_end(whole, rest)
    prepared = tribo.prepare(scene(drive, bars, 3.0), **HOW, start=half)
    assert same_end(whole, pickle.loads(pickle.dumps(prepared)).run())


def test_a_rigid_body_that_others_deform_goes_on():
    """Its asperites share contact forces alone: a field and a bath move them apart."""
    upper, lower = everything(1.0).surfaces
    first = replace(everything(1.0), surfaces=(upper, replace(lower, drive=Free(rigid=True))))
    before = tribo.simulate(first, **HOW)
    assert np.ptp(before["lower"].vx_cm[-1]) > 1e-3
    after = tribo.simulate(replace(first, duration=2.0), **HOW, start=before.state())
    assert_continuous(before, after)


TWO = tribo.Output(times=[2.0, 3.0])


def test_surfaces_that_move_exchange_nothing():
    """Each of two free and forced surfaces keeps its own displacement, and lacks no other."""
    state = state_after("free")
    with pytest.raises(InputError, match=r'centres of mass of "upper" .* along x.*displaced by'):
        tribo.simulate(scene("forced", end=2.0), **HOW, start=state)


def test_masses_that_change_leave_bobs_and_bars():
    """The centres of mass move along the rods, and the bobs and bars do not."""
    before = tribo.simulate(scene("free"), **HOW)
    other = scene("free", end=2.0, asperite=Asperite(kappa=3.0, m1=2.0, m2=1.0))
    after = tribo.simulate(other, **HOW, start=before.state())
    for name in ("theta", "x_bob", "y_bob", "x_bar", "y_bar"):
        assert after["upper"][name][0] == pytest.approx(before["upper"][name][-1], abs=1e-12)
    for velocity, across, sign in (("vx_cm", "y", 1.0), ("vy_cm", "x", -1.0)):
        ends = []  # velocities of the bars
        for result, at in ((before, -1), (after, 0)):
            table = result["upper"]
            arm = table[f"{across}_cm"][at] - table[f"{across}_bar"][at]
            ends.append(table[velocity][at] + sign * table.omega[at] * arm)
        assert ends[1] == pytest.approx(ends[0], abs=1e-12)
        assert np.abs(after["upper"][velocity][0] - before["upper"][velocity][-1]).min() > 1e-4


def test_random_heights_are_those_of_the_state():
    """Another seed, or another order of surfaces, draws no others; other heights are refused."""
    row = {"shape": (4, 1), "asperite": Asperite(kappa=3.0), "initial": tribo.Initial(nu=0.2)}
    rough = row | {"heights": tribo.Roughness(0.05)}
    first = replace(scene("free", **rough), seed=3)
    before = tribo.simulate(first, **HOW)
    heights = before.state().heights["upper"]
    assert np.ptp(heights) > 0.0 and before.state().heights["lower"] is None
    for order, seed in ((1, 4), (-1, 3)):
        other = replace(scene("free", end=2.0, order=order, **rough), seed=seed)
        after = tribo.simulate(other, **HOW, start=before.state())
        assert_continuous(before, after)
        assert 'the random heights of "upper" are those of the state' in after.notes
        again = tribo.simulate(replace(other, duration=3.0), **HOW, start=after.state())
        assert_continuous(after, again)
    assert not tribo.simulate(replace(first, duration=2.0), **HOW, start=before.state()).notes
    for given in (tribo.Roughness(0.06), tribo.Roughness(0.05, seed=7), None, heights + 0.01):
        other = scene("free", end=2.0, **row | {"heights": given})
        with pytest.raises(InputError, match=r'the heights of "upper" are others in it'):
            tribo.simulate(other, **HOW, start=before.state())
    with pytest.raises(InputError, match="heights"):
        tribo.simulate(scene("free", end=2.0, **rough), **HOW, start=state_after("free", **row))


def test_what_a_scene_lacks():
    """One sentence that names the surface, and what differs."""
    state = state_after()
    upper, lower = scene(end=2.0).surfaces
    bath, rigid = tribo.Bath([0.1], [2.0]), Asperite(kappa=np.inf, m1=[1.0, 1.4])
    third = replace(lower, name="third", depth=9.0)
    for surfaces, problem in (
        ([upper], 'surface "lower" is not in the scene'),
        ([upper, lower, third], 'surface "third" is not in the state'),
        ([upper, replace(lower, shape=(4, 1))], r'surface "lower": shape\[0\] was 3, is 4'),
        ([upper, replace(lower, bob=(0.0, 0.1))], 'surface "lower": bob'),
        ([replace(upper, velocity=(0.3, 0.0)), lower], 'surface "upper": velocity'),
        ([replace(upper, asperite=Asperite(length=3.0)), lower], "asperite.length was 2.0"),
        ([replace(upper, bath=bath), lower], 'the oscillators of "upper" are others'),
        (
            [replace(upper, asperite=rigid, initial=tribo.Initial()), lower],
            'bars of "upper" that do not turn',
        ),
    ):
        other = replace(scene(end=2.0), surfaces=surfaces)
        with pytest.raises(InputError, match=problem) as error:
            tribo.simulate(other, **HOW, start=state)
        assert str(error.value).startswith("start: must ") and "\n" not in str(error.value)


def test_changed_initial_values_leave_the_rest_of_a_state():
    """An angle phi that is changed does not move theta, which the state has."""
    state = state_after("free", "free")
    simulation = tribo.prepare(scene("free", "free", 2.0), **HOW, start=state)
    changed = simulation.run({"upper.phi": 0.5})
    assert changed["upper"].phi[0].tolist() == [0.5, 0.5]
    assert changed["upper"].theta[0].tolist() == state.surfaces["upper"]["swing"].tolist()
