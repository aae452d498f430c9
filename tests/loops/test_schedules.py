"""Runs with schedules of speed, load, push and temperature."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo.loops import integrate

STIFFNESS = 0.5
MASS = 3.0
RIGID = tribo.Asperite(m1=1.0, m2=2.0, kappa=np.inf)
# Speed of a stage: between two samples, it jumps at 3.25 and stays from 6.5 on.
POINTS = ((0.0, 0.2), (3.25, 0.5), (3.25, -0.4), (6.5, 0.1))


def tip(drive, **others):
    return tribo.Surface("tip", drive=drive, asperite=RIGID, **others)


def scene_of(drive, duration=8.0, samples=9, series=(), **others):
    output = tribo.Output(samples=samples, series=series)
    return tribo.Scene([tip(drive, **others)], [], duration=duration, output=output)


def exact(t):
    """x of a mass on a spring to the stage, at times t: in each leg it swings about a parabola."""
    w = np.sqrt(STIFFNESS / MASS)
    x, v, place = 0.0, 0.0, 0.0
    found = np.zeros(t.size)
    legs = [(0.0, 3.25, 0.2, 0.3 / 3.25), (3.25, 6.5, -0.4, 0.5 / 3.25), (6.5, np.inf, 0.1, 0.0)]
    for begin, end, speed, slope in legs:
        lag = x - place + slope / w**2
        rate = v - speed

        def state(u, lag=lag, rate=rate, place=place, speed=speed, slope=slope):
            stage = place + speed * u + 0.5 * slope * u**2
            turn = w * u
            x = stage - slope / w**2 + lag * np.cos(turn) + rate / w * np.sin(turn)
            v = speed + slope * u - w * lag * np.sin(turn) + rate * np.cos(turn)
            return x, v, stage

        mine = (t >= begin) & (t < end)
        found[mine] = state(t[mine] - begin)[0]
        if np.isfinite(end):
            x, v, place = state(end - begin)
    return found


@pytest.mark.parametrize(
    ("settings", "error"),
    [
        ({"method": "gauss-radau-15", "accuracy": 1e-11}, 1e-10),
        ({"method": "rkn8", "accuracy": 1e-10}, 1e-9),
        ({"method": "dop853", "accuracy": 1e-10}, 1e-9),
        ({"method": "midpoint", "step": 0.002}, 1e-6),
        ({"method": "kahan-li-8", "step": 0.05}, 1e-10),
        ({"method": "verlet", "step": 0.002}, 1e-6),
    ],
)
def test_pulled(settings, error):
    """The motion is the closed form, for every kind of time loop; and the budget closes."""
    result = tribo.simulate(scene_of(tribo.Pulled(stiffness=STIFFNESS, speed=POINTS)), **settings)
    series = result["tip"]
    np.testing.assert_allclose(series["x_cm"][:, 0], exact(result.t), atol=error)
    pull = series["e_pull"] - series["e_pull"][0]
    np.testing.assert_allclose(series["stage_work"], series["w2"][:, 0] + pull, atol=error)


def test_frame():
    """A stage in a moving frame does the work of that frame's motion, too."""
    u = 2.0
    faster = tuple((t, v + u) for t, v in POINTS)
    moving = scene_of(tribo.Pulled(stiffness=STIFFNESS, speed=faster), velocity=(u, 0.0))
    result = tribo.simulate(moving, method="rkn8", accuracy=1e-10)
    series = result["tip"]
    np.testing.assert_allclose(series["x_cm"][:, 0], exact(result.t) + u * result.t, atol=1e-9)
    pull = series["e_pull"] - series["e_pull"][0]
    np.testing.assert_allclose(series["stage_work"], series["w2"][:, 0] + pull, atol=1e-9)


def test_position():
    """A position that is the integral of a speed gives the same motion; and a sine its own."""
    bent = tribo.Schedule([[0, 0.2], [4, 0.2], [4, -0.1]])
    place = [[0, 0], [4, 0.8], [8, 0.4]]
    runs = [
        tribo.simulate(scene_of(tribo.Pulled(stiffness=STIFFNESS, **given)), method="rkn8")
        for given in ({"speed": bent}, {"position": place})
    ]
    for name in ("x_cm", "stage_work", "e_pull"):
        one, other = (run["tip"][name] for run in runs)
        np.testing.assert_allclose(one, other, atol=1e-9)
    w, driven = np.sqrt(STIFFNESS / MASS), 2 * np.pi / 5.0
    sine = tribo.Schedule.sine(0.0, 0.3, 5.0)
    run = tribo.simulate(scene_of(tribo.Pulled(stiffness=STIFFNESS, position=sine)), method="rkn8")
    amplitude = 0.3 * w**2 / (w**2 - driven**2)
    wanted = amplitude * (np.sin(driven * run.t) - driven / w * np.sin(w * run.t))
    np.testing.assert_allclose(run["tip"]["x_cm"][:, 0], wanted, atol=1e-9)


def test_push_and_load():
    """Momentum and energy of a mass that a push and a load accelerate."""
    force = tribo.Schedule([[0, 0], [4, 1.0], [4, 0.2]])
    load = tribo.Schedule.sine(0.5, 0.3, 3.0)
    run = tribo.simulate(scene_of(tribo.Pushed(force=[force, 0.0], load=load)), method="rkn8")
    np.testing.assert_allclose(
        run["tip"]["vx_cm"][:, 0], force.integral(run.t) / MASS, atol=1e-9
    )
    np.testing.assert_allclose(
        run["tip"]["vy_cm"][:, 0], -load.integral(run.t) / MASS, atol=1e-9
    )
    kinetic = 0.5 * MASS * (run["tip"]["vx_cm"] ** 2 + run["tip"]["vy_cm"] ** 2)
    np.testing.assert_allclose(run["tip"]["w2"], kinetic, atol=1e-9)
    own = tribo.simulate(scene_of(tribo.Pushed(force=[force, load])), method="rkn8")
    np.testing.assert_allclose(own["tip"]["vy_cm"], -run["tip"]["vy_cm"], atol=1e-9)


def test_constant_schedule():
    """A schedule without changes is the number."""
    for given in ([[0, 0.3]], [[0, 0.3], [5, 0.3]], tribo.Schedule.sine(0.3, 0.0, 1.0)):
        one, other = (
            tribo.simulate(
                scene_of(tribo.Pulled(stiffness=STIFFNESS, speed=speed, load=load)), method="rkn8"
            )
            for speed, load in ((given, given), (0.3, 0.3))
        )
        for name in ("x_cm", "y_cm", "w2", "stage_work", "e_pull"):
            np.testing.assert_allclose(one["tip"][name], other["tip"][name], atol=1e-12)


def test_forces_at_kinks():
    """Series of forces have the value after a step that happens at a sample."""
    load = tribo.Schedule([[0, 0.1], [4, 0.3]], kind="steps")
    drive = tribo.Pulled(stiffness=STIFFNESS, speed=POINTS, load=load)
    result = tribo.simulate(scene_of(drive, series=["forces"]), method="rkn8")
    np.testing.assert_allclose(result["tip"]["f2_y"][:, 0], -load.at(result.t), rtol=1e-14)
    stage = tribo.Schedule(POINTS).integral(result.t)
    wanted = STIFFNESS * (stage - result["tip"]["x_bar"][:, 0])
    np.testing.assert_allclose(result["tip"]["f2_x"][:, 0], wanted, atol=1e-14)


@pytest.mark.parametrize(
    "settings",
    [{"method": "gauss-radau-15", "accuracy": 1e-9}, {"method": "verlet", "step": 0.05}],
)
def test_pauses_and_states(settings, monkeypatch):
    """Pauses at any step, and runs that continue from a state, give the bits of one run."""
    drive = tribo.Pulled(stiffness=STIFFNESS, speed=POINTS, load=[[0, 0.1], [4, 0.3], [4, 0.1]])
    scene = replace(scene_of(drive), output=tribo.Output(times=[2.0, 3.0, 3.25, 4.0, 5.0]))
    prepared = tribo.prepare(scene, **settings)
    whole = prepared.run(estimate=False)
    for reached in (3.25, 4.0, 5.0):
        times = [t for t in scene.output.times if t <= reached]
        shorter = replace(scene, duration=reached, output=replace(scene.output, times=times))
        first = tribo.simulate(shorter, **settings)
        rest = tribo.simulate(scene, start=first.state(), **settings)
        if "step" in settings:
            assert rest["tip"]["x_cm"][-1, 0] == whole["tip"]["x_cm"][-1, 0]
            assert rest["tip"]["stage_work"][-1] == whole["tip"]["stage_work"][-1]
        np.testing.assert_allclose(rest["tip"]["w2"][-1], whole["tip"]["w2"][-1], atol=1e-8)
    monkeypatch.setattr(integrate, "LARGEST_CHUNK", 3)
    paused = prepared.run(estimate=False)
    for name in ("x_cm", "w2", "stage_work"):
        np.testing.assert_array_equal(paused["tip"][name], whole["tip"][name])


def test_changed_schedule_begins():
    """A schedule that is changed begins when the run continues, and the stage keeps its place."""
    first = tribo.simulate(scene_of(tribo.Pulled(stiffness=STIFFNESS, speed=POINTS)), method="rkn8")
    state = first.state()
    other = tribo.Schedule([[0, 0.3], [2, -0.2]])
    scene = scene_of(tribo.Pulled(stiffness=STIFFNESS, speed=other), duration=12.0, samples=13)
    then = tribo.simulate(scene, start=state, method="rkn8", accuracy=1e-10)
    place = tribo.Schedule(POINTS).integral(8.0) + other.integral(then.t - 8.0)
    wanted = 0.5 * STIFFNESS * (place - then["tip"]["x_bar"][:, 0]) ** 2
    np.testing.assert_allclose(then["tip"]["e_pull"], wanted, atol=1e-9)
    # The same schedule goes on, beside another stiffness.
    same = scene_of(tribo.Pulled(stiffness=0.7, speed=POINTS), duration=12.0, samples=13)
    then = tribo.simulate(same, start=state, method="rkn8", accuracy=1e-10)
    place = tribo.Schedule(POINTS).integral(then.t)
    wanted = 0.5 * 0.7 * (place - then["tip"]["x_bar"][:, 0]) ** 2
    np.testing.assert_allclose(then["tip"]["e_pull"], wanted, atol=1e-9)


@pytest.mark.parametrize("kind", ["steps", "linear"])
def test_temperature(kind):
    """<v^2> of free masses whose reservoir is heated: the closed form of an Ornstein-Uhlenbeck."""
    points = [[0, 0.2], [2.25, 1.0], [4.0, 0.0]]
    temperature = tribo.Schedule(points, kind=kind)
    gamma = 1.5
    langevin = tribo.Langevin(gamma, temperature)
    scene = scene_of(tribo.Free(), duration=6.0, samples=7, langevin=langevin)
    scene = replace(scene, numerics=tribo.Numerics(method="verlet", step=0.05))
    members = 4000
    keep = ["tip.vx_cm", "tip.heat"]
    data = tribo.ensemble(scene, members, keep=keep, at="samples", seed=3, progress=False)
    t = data["time"].values
    rate = 2.0 * gamma / MASS
    fine = np.linspace(0.0, 6.0, 60001)
    v2 = np.zeros(fine.size)
    h = fine[1]
    for k in range(1, fine.size):
        middle = rate * temperature.at(fine[k] - 0.5 * h) / MASS
        v2[k] = v2[k - 1] * np.exp(-rate * h) + middle * h * np.exp(-0.5 * rate * h)
    wanted = np.interp(t, fine, v2)
    v = data["tip.vx_cm"].values.reshape(members, t.size)
    found = np.mean(v**2, axis=0)
    error = np.std(v**2, axis=0) / np.sqrt(members)
    assert np.all(np.abs(found - wanted) <= 4.0 * error + 1e-12)
    lost = -np.mean(data["tip.heat"].values.reshape(members, t.size)[:, -1])
    assert lost == pytest.approx(MASS * wanted[-1], abs=0.05)


def test_members_side_by_side():
    """Members in lanes have the bits of runs alone, with kinks between samples."""
    drive = tribo.Pulled(stiffness=STIFFNESS, speed=POINTS, load=[[0, 0.1], [4.25, 0.3]])
    langevin = tribo.Langevin(0.5, [[0, 0.1], [1.75, 0.4], [1.75, 0.2]])
    scene = scene_of(drive, langevin=langevin)
    scene = replace(scene, numerics=tribo.Numerics(method="verlet", step=0.125))
    alone = replace(scene, output=replace(scene.output, series=["forces"]))
    keep = ["tip.x_cm", "tip.w2", "tip.stage_work", "tip.heat"]
    one, other = (
        tribo.ensemble(each, 9, keep=keep, at="samples", seed=5, progress=False)
        for each in (scene, alone)
    )
    for name in keep:
        np.testing.assert_array_equal(one[name].values, other[name].values)


def test_sweep_of_points():
    scene = scene_of(tribo.Pulled(stiffness=STIFFNESS, speed=POINTS))
    values = [0.1, 0.3]
    data = tribo.sweep(
        scene, {"tip.drive.speed.1.1": values}, keep=["tip.stage_work"], progress=False
    )
    for k, value in enumerate(values):
        points = [list(point) for point in POINTS]
        points[1][1] = value
        run = tribo.simulate(scene_of(tribo.Pulled(stiffness=STIFFNESS, speed=points)))
        found = data["tip.stage_work"].values.ravel()[k]
        assert found == pytest.approx(run["tip"]["stage_work"][-1], abs=1e-8)


def test_steps_have_to_meet_kinks():
    scene = scene_of(tribo.Pulled(stiffness=STIFFNESS, speed=[[0, 0.2], [3.3, 0.5], [6.25, 0.0]]))
    with pytest.raises(tribo.InputError, match=r"kink of a schedule at t = 3\.3.*0\.025 does"):
        tribo.prepare(scene, method="verlet", step=0.03)
    tribo.prepare(scene, method="verlet", step=0.025)


def test_refused_averages():
    load = tribo.Schedule([[0, 0.1], [4, 0.3]])
    corrugation = {"kind": "corrugation", "on": ["tip"], "amplitude": 0.05, "period": 1.0}
    drive = tribo.Pulled(stiffness=STIFFNESS, speed=[[0, 0.5], [6, -0.5]], load=load)
    scene = replace(scene_of(drive, samples=81, series=["forces"]), fields=[corrugation])
    result = tribo.simulate(scene, accuracy=1e-6)
    assert "changes the conditions" in result.friction_force("tip").note
    with pytest.raises(tribo.InputError, match="changes with time"):
        result.friction_coefficient("tip")
    with pytest.raises(tribo.InputError, match="does not turn back"):
        result.depinning("tip")
