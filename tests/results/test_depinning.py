"""The force at which pulled and pushed surfaces start to slide, against exact static friction."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from support.transformations import boosted

AMPLITUDE = 0.3
PERIOD = 1.0
GAMMA = 1.0
# Of a tip on a corrugation, reached a quarter of a period from its minimum.
STATIC = 2.0 * np.pi * AMPLITUDE / PERIOD
HOW = {"method": "verlet", "step": 0.02}


def run(drive, duration, count=1, spacing=1.1, springs=None, gamma=GAMMA):
    """Rigid asperites on a corrugation, with damping of the bars."""
    surface = tribo.Surface(
        "tip",
        shape=(count, 1),
        spacing=(spacing, 0.0),
        asperite=tribo.Asperite(kappa=np.inf),
        drive=drive,
        langevin=tribo.Langevin(gamma=gamma),
        springs=springs or {},
    )
    field = tribo.Field(tribo.Corrugation(AMPLITUDE, PERIOD), on=["tip"])
    output = tribo.Output(samples=4001)
    return tribo.simulate(
        tribo.Scene([surface], [], duration, fields=[field], output=output), **HOW
    )


def test_a_stage_at_rest_above_what_moves():
    """As a tip that is pulled, in another frame."""
    scene = run(tribo.Pulled(stiffness=5.0, speed=0.02), 60.0).scene
    known = tribo.simulate(scene, **HOW).depinning("tip")
    for speed in (-0.02, 0.5):
        found = tribo.simulate(boosted(scene, (speed, 0.0)), **HOW).depinning("tip")
        assert found.mean == pytest.approx(known.mean, rel=1e-9)
        assert found.times == known.times
    lower = tribo.Surface(
        "lower",
        facing="up",
        shape=(8, 1),
        spacing=(1.5, 0.0),
        asperite=tribo.Asperite(kappa=np.inf),
        drive="bars",
    )
    tip = replace(scene.surfaces[0], bob=(4.5, 0.8), drive=tribo.Pulled(stiffness=1.0, speed=0.02))
    contact = tribo.Gaussian(0.5, 0.5).with_cutoff(1.5)
    scene = replace(scene, surfaces=[tip, lower], interactions=contact, fields=[])
    known = tribo.simulate(scene, **HOW).depinning("tip")
    found = tribo.simulate(boosted(scene, (-0.02, 0.0)), **HOW).depinning("tip")
    assert found.mean == pytest.approx(known.mean, rel=1e-9)


def test_a_tip_that_is_pulled_slowly():
    """Four independent ones from four places; the drag at the tip's speed is 0.2 % of the force."""
    found = run(tribo.Pulled(stiffness=5.0, speed=0.005), 250.0, count=4).depinning("tip")
    np.testing.assert_allclose(found.each, STATIC, rtol=5e-3)
    assert found.mean == np.mean(found.each)
    half_width = stats.t.ppf(0.975, 3) * np.std(found.each, ddof=1) / 2.0
    assert found.half_width == pytest.approx(half_width)
    # The spring has the force at x = period / 4.
    expected = (PERIOD / 4.0 + STATIC / 5.0) / 0.005
    assert found.times[0] == pytest.approx(expected, rel=0.02)


def test_a_tip_that_a_moving_observer_sees():
    """Tip, stage, corrugation and reservoir move for the observer; the force is the same."""
    tip = tribo.Surface(
        "tip",
        asperite=tribo.Asperite(kappa=np.inf),
        drive=tribo.Pulled(stiffness=5.0, speed=0.02),
        langevin=tribo.Langevin(gamma=GAMMA),
    )
    field = tribo.Field(tribo.Corrugation(AMPLITUDE, PERIOD), on=["tip"])
    output = tribo.Output(samples=1001)
    scene = tribo.Scene([tip], [], 60.0, fields=[field], output=output)
    known, found = (
        tribo.simulate(each, **HOW).depinning("tip") for each in (scene, boosted(scene, (0.5, 0.0)))
    )
    assert found.mean == pytest.approx(known.mean, rel=1e-9)


def test_a_schedule_of_negative_speeds_pulls_the_other_way():
    """The force is that of the mirror image, whose speed is a positive number, but for its sign."""
    known, found = (
        run(tribo.Pulled(stiffness=5.0, speed=speed), 40.0).depinning("tip")
        for speed in (0.05, [[0.0, -0.05], [40.0, -0.05]])
    )
    assert known.mean > 0.0
    assert found.mean == pytest.approx(-known.mean, rel=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_run_that_ends_after_a_slip_of_several_periods(sign):
    """The spring then pushes back, which is not the direction of the slide."""
    pull = tribo.Pulled(stiffness=0.1 * (2.0 * np.pi) ** 2 * AMPLITUDE, speed=sign * 0.05)
    long = run(pull, 60.0, gamma=0.3)
    force = sign * pull.stiffness * (pull.speed * long.t - long["tip"].x_bar[:, 0])
    assert force.min() < -0.5 * STATIC
    short = run(pull, long.t[np.argmin(force)], gamma=0.3)
    for result in (long, short):
        assert sign * result.depinning("tip").mean == pytest.approx(STATIC, rel=0.05)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_growing_push(sign):
    """The delay is that of a saddle-node bifurcation, and the excess grows as the rate^(2/3)."""
    excess = []
    for rate in (0.008, 0.001):
        push = tribo.Pushed(rate=(sign * rate, 0.0))
        found = run(push, 2.2 / rate).depinning("tip")
        assert np.isnan(found.half_width)
        excess.append(sign * found.mean / STATIC - 1.0)
    assert 0.0 < excess[1] < 0.03
    assert excess[0] / excess[1] == pytest.approx(4.0, rel=0.2)


def test_bars_that_springs_couple_start_together():
    """Half a period apart, the corrugation's forces on them cancel."""
    pull = tribo.Pulled(stiffness=0.5, speed=0.005)
    stiff = {"stiffness": 200.0}
    found = run(pull, 250.0, count=2, spacing=0.5, springs=stiff).depinning("tip")
    assert found.each.shape == (1,) and abs(found.mean) < 0.05 * STATIC
    found = run(pull, 1000.0, count=2, spacing=1.0, springs=stiff).depinning("tip")
    assert found.mean == pytest.approx(STATIC, rel=0.01)


def test_what_does_not_start():
    """Without a slide, a period, or a drive that pulls."""
    with pytest.raises(tribo.InputError, match=r'that "tip" moves, got 0.5, .* move by 0\.0'):
        run(tribo.Pushed(force=(0.3, 0.0)), 20.0).depinning("tip")
    result = run(tribo.Free(), 1.0)
    with pytest.raises(tribo.InputError, match="must be one that pulls or pushes along x"):
        result.depinning("tip")


def test_the_coefficient_of_friction():
    """The force on all asperites over the load on all of them; a surface without load has none."""
    rigid = tribo.Asperite(kappa=np.inf)
    pull = tribo.Pulled(load=0.2, stiffness=1.0, speed=0.2)
    row = {"shape": (2, 1), "spacing": (1.5, 0.0), "asperite": rigid}
    langevin = tribo.Langevin(gamma=1.0)
    upper = tribo.Surface("upper", bob=(0.0, 0.8), drive=pull, langevin=langevin, **row)
    lower = tribo.Surface("lower", facing="up", drive="bars", **row)
    output = tribo.Output(samples=401, series=["forces"])
    potential = tribo.Gaussian(0.5, 0.5).with_cutoff(1.5)
    scene = tribo.Scene([upper, lower], potential, 100.0, periodic={"x": 3.0}, output=output)
    result = tribo.simulate(scene, **HOW)
    found = result.friction_coefficient("upper")
    force = result.friction_force("upper")
    assert found.mean == pytest.approx(-force.mean / 0.4) and found.mean > 0.0
    assert found.half_width == pytest.approx(force.half_width / 0.4, nan_ok=True)
    assert f"{found.mean:.4g} of the load" in str(result)
    with pytest.raises(tribo.InputError, match=r"lower\.drive\.load: is missing"):
        result.friction_coefficient("lower")


@pytest.mark.parametrize("last", [-0.2, -0.1])
def test_a_stage_that_turns_back_is_refused(last):
    """Also where it returns to its start, so that it has not moved at the end."""
    speed = [[0.0, 0.2], [2.0, 0.2], [2.0, last], [4.0, last]]
    tip = tribo.Surface("tip", drive=tribo.Pulled(stiffness=1.0, speed=speed))
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=["tip"])
    output = tribo.Output(samples=41, series=["forces"])
    scene = tribo.Scene([tip], [], 4.0, fields=[field], output=output)
    with pytest.raises(tribo.InputError, match="does not turn back"):
        tribo.simulate(scene, step=0.05).depinning("tip")


@pytest.mark.parametrize(
    "settings",
    [
        {"drive": {"damping": 0.5}},
        {"drive": {"tilt": "free"}, "initial": tribo.Initial(nu=0.02)},
        {"drive": {}, "elastic": tribo.Elastic(modulus=0.3, poisson=0.3)},
    ],
    ids=["damped", "tilting", "elastic"],
)
def test_blocks_whose_force_is_not_known_without_a_record(settings):
    """Places of bars do not tell it; recorded forces do, and bars of a block count as one."""
    how = {"stiffness": 1.5, "speed": 0.15, "load": 0.1, "block": True} | settings.pop("drive")
    row = {"shape": (5, 1), "spacing": (1.13, 1.2), "bob": (0.3, 0.0)}
    rigid = tribo.Asperite(kappa=np.inf)
    tip = tribo.Surface("tip", asperite=rigid, drive=tribo.Pulled(**how), **row, **settings)
    field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=["tip"])
    scene = tribo.Scene([tip], [], 12.0, fields=[field], output=tribo.Output(samples=601))
    with pytest.raises(tribo.InputError, match='"forces", without which the force on "tip"'):
        tribo.simulate(scene, method="rk4", step=0.02).depinning("tip", 0.3)
    recorded = replace(scene, output=tribo.Output(samples=601, series=["forces"]))
    found = tribo.simulate(recorded, method="rk4", step=0.02).depinning("tip", 0.3)
    assert found.each.shape == (1,) and np.isnan(found.half_width)
    assert found.mean > 0.0


def test_the_force_on_a_rigid_block_needs_no_record():
    """It follows from the places of the bars, which is what the spring of the block sees."""
    drive = tribo.Pulled(stiffness=5.0, speed=0.1, load=0.1, block=True)
    tip = tribo.Surface(
        "tip",
        shape=(3, 1),
        spacing=(1.0, 0.0),
        asperite=tribo.Asperite(kappa=np.inf),
        drive=drive,
        langevin=tribo.Langevin(gamma=GAMMA),
    )
    field = tribo.Field(tribo.Corrugation(0.1, PERIOD), on=["tip"])
    told, quiet = (
        tribo.simulate(
            tribo.Scene([tip], [], 20.0, fields=[field], output=output), method="rk4", step=0.02
        ).depinning("tip", 0.3)
        for output in (
            tribo.Output(samples=401, series=["forces"]),
            tribo.Output(samples=401),
        )
    )
    assert quiet.mean == pytest.approx(told.mean, rel=1e-9)
