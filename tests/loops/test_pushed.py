"""A push on the bars: closed forms of motion and works, invariances, what it cannot go with."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.transformations import boosted, drive_in_units

FORCE, RATE = np.array([0.6, -0.3]), np.array([0.2, 0.5])
HOW = {"method": "verlet", "step": 0.01}


def pushed(strength=0.0, velocity=(0.3, -0.1), **drive):
    """A surface that is pushed, and one that a constraint holds."""
    drive = {"force": FORCE, "rate": RATE} | drive
    surfaces = (
        tribo.Surface("upper", bob=(-1.0, 0.7), velocity=velocity, drive=tribo.Pushed(**drive)),
        tribo.Surface("lower", facing="up", drive=tribo.DrivenBars()),
    )
    output = tribo.Output(samples=21, series=["forces"])
    return tribo.Scene(surfaces, tribo.Coulomb(strength), 3.0, output=output)


@pytest.mark.parametrize("how", [HOW, {"accuracy": 1e-9}])
def test_closed_form(how):
    """The centre of mass moves by the force alone, whatever the pendulum does."""
    result = tribo.simulate(pushed(), **how)
    table, t = result["upper"], result.t[:, None]
    for axis, (force, rate, v) in enumerate(zip(FORCE, RATE, (0.3, -0.1), strict=True)):
        name, tolerance = "xy"[axis], {"abs": 1e-5 if how is HOW else 1e-8}
        x = v * t + (force * t**2 / 2.0 + rate * t**3 / 6.0) / 3.0
        assert table[f"{name}_cm"] - table[f"{name}_cm"][0] == pytest.approx(x, **tolerance)
        speed = v + (force * t + rate * t**2 / 2.0) / 3.0
        assert table[f"v{name}_cm"] == pytest.approx(speed, **tolerance)
        assert table[f"f2_{name}"] == pytest.approx(force + rate * t, abs=1e-14)
    assert np.max(np.abs(table.omega)) > 0.1
    assert table.w2_ps == pytest.approx(table.delta_k_trans, abs=1e-8)
    assert table.w - table.w_ps == pytest.approx(table.delta_e_int, abs=1e-8)
    change = result.system["total_energy_change"]
    assert result.system["applied_work"] == pytest.approx(change, abs=1e-8)
    assert abs(change[-1]) > 0.5


def test_invariances_and_continuation():
    """In contact: seen by an observer who moves, mirrored, in other units, and in two parts."""
    scene = pushed(0.3)
    one = tribo.simulate(scene, **HOW)
    along = tribo.simulate(boosted(scene, (0.4, 0.2)), **HOW)
    assert along["upper"].theta == pytest.approx(one["upper"].theta, abs=1e-11)
    assert along["upper"].w1 - along["upper"].w1_ps == pytest.approx(
        one["upper"].w1 - one["upper"].w1_ps, abs=1e-11
    )
    upper, lower = scene.surfaces
    drive = replace(upper.drive, force=FORCE * (-1.0, 1.0), rate=RATE * (-1.0, 1.0))
    mirrored = replace(upper, bob=(1.0, 0.7), velocity=(-0.3, -0.1), drive=drive)
    other = tribo.simulate(replace(scene, surfaces=(mirrored, lower)), **HOW)
    assert other["upper"].theta == pytest.approx(-one["upper"].theta, abs=1e-12)
    assert other["upper"].w2 == pytest.approx(one["upper"].w2, abs=1e-12)
    half = replace(scene, duration=1.5, output=replace(scene.output, samples=11))
    state = tribo.simulate(half, **HOW).state()
    rest = tribo.simulate(scene, start=state, **HOW)
    for name in ("theta", "x_cm", "y_cm", "w2", "w1", "f2_x"):
        assert np.array_equal(rest["upper"][name], one["upper"][name][10:]), name


def test_one_push_in_many_ways(tmp_path):
    """In a file, in units, beside a load, explained; what it cannot go with is refused."""
    scene = pushed(0.3)
    scene.save(tmp_path / "scene.toml")
    drive = tribo.load_scene(tmp_path / "scene.toml").surfaces[0].drive
    assert drive == scene.surfaces[0].drive
    table = {"kind": "push", "force": [0.1, 0.0]}
    assert tribo.Surface("upper", drive=table).drive.rate == (0.0, 0.0)
    scaled = drive_in_units(drive, 2.0, 3.0, 4.0)
    assert scaled.force == pytest.approx(FORCE * 6.0 / 16.0)
    assert scaled.rate == pytest.approx(RATE * 6.0 / 64.0)
    assert "push" in scene.effects and "load" not in scene.effects
    assert "drive.force" in tribo.explain(scene).effects["push"]
    with_load = pushed(load=0.4, force=(0.6, 0.0), rate=(0.2, 0.0))
    result = tribo.simulate(with_load, **HOW)
    assert np.all(result["upper"].f2_y == -0.4)
    assert result["upper"].f2_x[-1, 0] == pytest.approx(0.6 + 0.2 * 3.0, rel=1e-15, abs=0.0)
    for settings, problem in (
        ({"force": [0.1, 0.2], "load": 0.3}, "force: must be zero along y beside a load, got 0.2"),
        ({"rate": [0.1, 0.2], "load": 0.3}, "rate: must be zero along y beside a load, got 0.2"),
        ({"force": 0.1}, "force: "),
        ({"force": [0.1, float("nan")]}, r"force\[1\]: "),
    ):
        with pytest.raises(tribo.InputError, match=problem):
            tribo.Pushed(**settings)
    with pytest.raises(tribo.InputError, match="force: is missing"):
        tribo.Surface("upper", drive={"kind": "push"})
    with pytest.raises(tribo.InputError, match="rate: is not a known key"):
        table = {"kind": "pulled", "stiffness": 1.0, "speed": 0.1, "rate": [0.0, 0.0]}
        tribo.Surface("upper", drive=table)
