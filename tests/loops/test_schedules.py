"""Runs with schedules of speed, load, push and temperature."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

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
    np.testing.assert_allclose(run["tip"]["vx_cm"][:, 0], force.integral(run.t) / MASS, atol=1e-9)
    np.testing.assert_allclose(run["tip"]["vy_cm"][:, 0], -load.integral(run.t) / MASS, atol=1e-9)
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


@pytest.mark.parametrize(
    ("drive", "name"),
    [
        (lambda value: tribo.Free(load=value, block=True), "vy_cm"),
        (lambda value: tribo.Pushed(force=(value, 0.0), block=True), "vx_cm"),
    ],
    ids=["load", "push"],
)
def test_constant_schedule_of_a_block(drive, name):
    """A load or a push of a whole block is divided among its asperites, as the number is."""
    constant = [[0.0, 0.4], [5.0, 0.4]]
    row = {"shape": (3, 1), "spacing": (1.0, 0.0)}
    one, other = (
        tribo.simulate(scene_of(drive(value), 2.0, samples=3, **row), accuracy=1e-9)
        for value in (0.4, constant)
    )
    moved = one["tip"][name]
    assert np.all(np.abs(moved[-1]) == pytest.approx(0.4 * 2.0 / (3.0 * MASS), rel=1e-9))
    assert other["tip"][name] == pytest.approx(moved, rel=1e-9)


def test_forces_at_kinks():
    """Series of forces have the value after a step that happens at a sample."""
    load = tribo.Schedule([[0, 0.1], [4, 0.3]], kind="steps")
    drive = tribo.Pulled(stiffness=STIFFNESS, speed=POINTS, load=load)
    result = tribo.simulate(scene_of(drive, series=["forces"]), method="rkn8")
    np.testing.assert_allclose(result["tip"]["f2_y"][:, 0], -load.at(result.t), rtol=1e-14)
    stage = tribo.Schedule(POINTS).integral(result.t)
    wanted = STIFFNESS * (stage - result["tip"]["x_bar"][:, 0])
    np.testing.assert_allclose(result["tip"]["f2_x"][:, 0], wanted, atol=1e-14)


def test_forces_at_a_kink_at_the_end():
    """The last sample too has the value after a step, as the first one of a run that goes on."""
    force = tribo.Schedule([[0, 0.1], [4, 0.5]], kind="steps")
    first = tribo.simulate(
        scene_of(tribo.Pushed(force=[force, 0.0]), 4.0, 3, ("forces",)), method="rkn8"
    )
    np.testing.assert_array_equal(first["tip"].f2_x[:, 0], [0.1, 0.1, 0.5])
    later = scene_of(tribo.Pushed(force=[force, 0.0]), 8.0, 3, ("forces",))
    then = tribo.simulate(later, method="rkn8", accuracy=1e-8, start=first.state())
    np.testing.assert_array_equal(then["tip"].f2_x[:, 0], [0.5, 0.5])


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


@pytest.mark.parametrize("change", [0.0, 1e-12])
def test_unchanged_schedules_go_on(change):
    """A modulation beside another amplitude, and a push along one axis beside another push."""
    field = {"kind": "corrugation", "amplitude": 0.05, "period": 1.0, "on": ["tip"]}
    corrugated = tribo.Pulled(stiffness=1.0, speed=0.1)
    pushed = tribo.Pushed(force=(0.1, [[0, 0], [10, 1]]), rate=(0.02, 0.0))

    def scene(drive, duration, fields=()):
        tip = tribo.Surface("tip", asperite={"kappa": np.inf}, drive=drive)
        output = tribo.Output(samples=3, series=("forces", "energies"))
        return tribo.Scene([tip], [], duration, fields=fields, output=output)

    def both(drive, changed, fields=(), changed_fields=()):
        first = tribo.simulate(scene(drive, 5.0, fields), accuracy=1e-9)
        then = scene(changed, 10.0, changed_fields)
        return first, tribo.simulate(then, accuracy=1e-8, start=first.state())

    one, other = (
        field | {"amplitude": amplitude, "modulation": [[0, 0.1], [10, 1]]}
        for amplitude in (0.05, 0.05 * (1.0 + change))
    )
    first, then = both(corrugated, corrugated, [one], [other])
    energy = "field_energy"
    np.testing.assert_allclose(then.system[energy][0], first.system[energy][-1], rtol=1e-9)
    first, then = both(pushed, replace(pushed, force=(0.1 + change, pushed.force[1])))
    np.testing.assert_allclose(then["tip"].f2_y[:, 0], [0.5, 1.0], rtol=1e-12)
    # The ramp along x is another one then, and begins with the run.
    wanted = [0.2, 0.3] if change == 0.0 else [0.1, 0.2]
    np.testing.assert_allclose(then["tip"].f2_x[:, 0], wanted, rtol=1e-9)


@pytest.mark.parametrize("kind", ["steps", "linear"])
def test_temperature(kind):
    """<v^2> of free masses whose reservoir is heated: the closed form of an Ornstein-Uhlenbeck."""
    points = [[0, 0.2], [2.25, 1.0], [4.0, 0.0]]
    temperature = tribo.Schedule(points, kind=kind)
    gamma = 1.5
    langevin = tribo.Langevin(gamma, temperature)
    members = 1000
    many = {"shape": (members, 1), "spacing": (1.0, 0.0), "langevin": langevin}
    scene = replace(scene_of(tribo.Free(), duration=6.0, samples=7, **many), seed=3)
    result = tribo.simulate(scene, method="verlet", step=0.05)
    t = result.t
    rate = 2.0 * gamma / MASS
    fine = np.linspace(0.0, 6.0, 6001)
    v2 = np.zeros(fine.size)
    h = fine[1]
    gained = rate * temperature.at(fine[1:] - 0.5 * h) / MASS * h * np.exp(-0.5 * rate * h)
    for k in range(1, fine.size):
        v2[k] = v2[k - 1] * np.exp(-rate * h) + gained[k - 1]
    wanted = np.interp(t, fine, v2)
    v = result["tip"]["vx_cm"]
    found = np.mean(v**2, axis=1)
    error = np.std(v**2, axis=1) / np.sqrt(members)
    assert np.all(np.abs(found - wanted) <= 4.0 * error + 1e-12)
    lost = -np.mean(result["tip"]["heat"][-1])
    assert lost == pytest.approx(MASS * wanted[-1], abs=0.1)


@pytest.mark.parametrize("kind", ["steps", "linear"])
def test_temperature_of_a_block(kind):
    """A block of one asperite moves as the asperite does, and stays at rest until it is heated."""
    cold_first = [[0, 0.0], [2.0, 0.0], [2.0, 1.5], [4.0, 0.5]]
    langevin = tribo.Langevin(1.5, tribo.Schedule(cold_first, kind=kind))
    alone, block = (
        tribo.simulate(scene_of(drive, langevin=langevin), method="verlet", step=0.05)
        for drive in (tribo.Free(), tribo.Free(block=True))
    )
    for name in ("x_cm", "y_cm", "vx_cm", "heat"):
        np.testing.assert_allclose(block["tip"][name], alone["tip"][name], atol=1e-12)
    moved = np.abs(block["tip"]["vx_cm"][:, 0])
    assert np.all(moved[block.t <= 2.0] == 0.0) and np.all(moved[block.t > 2.0] > 0.0)


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
    data = tribo.sweep(scene, {"tip.drive.speed.1.1": values}, keep=["tip.w2"], progress=False)
    for k, value in enumerate(values):
        points = [list(point) for point in POINTS]
        points[1][1] = value
        run = tribo.simulate(scene_of(tribo.Pulled(stiffness=STIFFNESS, speed=points)))
        found = data["tip.w2"].values.ravel()[k]
        assert found == pytest.approx(run["tip"]["w2"][-1, 0], abs=1e-8)


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


@pytest.mark.parametrize(
    "settings",
    [
        {"method": "gauss-radau-15", "accuracy": 1e-10},
        {"method": "rkn8", "accuracy": 1e-10},
        {"method": "kahan-li-8", "step": 0.02},
    ],
)
@pytest.mark.parametrize("velocity", [0.0, 0.3])
def test_modulated_field(settings, velocity):
    """A pendulum's equation with a strength that changes; and the energy that this puts in."""
    modulation = tribo.Schedule([[0.0, 1.0], [2.3, 1.8], [5.0, 0.2], [8.0, 0.5]])
    field = tribo.Field(
        tribo.Corrugation(0.4, 2.0), on=["tip"], velocity=(velocity, 0.0), modulation=modulation
    )
    scene = replace(scene_of(tribo.Free(), initial={"x": 0.3}), fields=[field])
    result = tribo.simulate(scene, **settings)

    def rates(t, y):
        force = -0.4 * np.pi * np.sin(np.pi * (y[0] - velocity * t)) * modulation.at(t)
        return y[1], force / MASS

    x, v = np.array([0.3]), np.zeros(1)
    state = [0.3, 0.0]
    for begin, end in ((0.0, 2.3), (2.3, 5.0), (5.0, 8.0)):
        inside = np.arange(np.floor(begin) + 1.0, end + 1e-9)
        stops = np.unique([*inside, end])
        found = solve_ivp(rates, (begin, end), state, "DOP853", stops, rtol=1e-12, atol=1e-12)
        whole = np.isin(stops, inside)
        x = np.append(x, found.y[0, whole])
        v = np.append(v, found.y[1, whole])
        state = found.y[:, -1]
    np.testing.assert_allclose(result["tip"]["x_cm"][:, 0], x, atol=1e-8)
    system = result.system
    np.testing.assert_allclose(system["total_energy_change"], system["applied_work"], atol=1e-8)
    assert np.max(np.abs(system["applied_work"])) > 0.01


def test_members_in_a_modulated_field():
    """Lanes with steps of their own, and with equal ones, agree with single runs."""
    sine = tribo.Schedule.sine(1.0, 0.5, 3.0)
    field = tribo.Field(tribo.Corrugation(0.4, 2.0), on=["tip"], modulation=sine)
    scene = replace(scene_of(tribo.Free(), initial={"x": 0.2}), fields=[field])
    starts = [0.1, 0.3, 0.5]
    for numerics in (
        tribo.Numerics(accuracy=1e-9, method="rkn8"),
        tribo.Numerics(method="verlet", step=0.01),
    ):
        own = replace(scene, numerics=numerics)
        data = tribo.ensemble(
            own, 3, {"tip.x": starts}, keep=["tip.x_cm", "applied_work"], progress=False
        )
        for k, start in enumerate(starts):
            run = tribo.simulate(replace(own, surfaces=[tip(tribo.Free(), initial={"x": start})]))
            for name, found in (
                ("tip.x_cm", run["tip"]["x_cm"][-1, 0]),
                ("applied_work", run.system["applied_work"][-1]),
            ):
                assert data[name].values.ravel()[k] == pytest.approx(found, abs=1e-7)


def test_field_from_a_state():
    sine = tribo.Schedule.sine(1.0, 0.5, 3.0)
    field = tribo.Field(tribo.Corrugation(0.4, 2.0), on=["tip"], modulation=sine)
    scene = replace(scene_of(tribo.Free(), initial={"x": 0.3}), fields=[field])
    state = tribo.simulate(scene, method="rkn8").state()
    longer = replace(scene, duration=12.0)
    rest = tribo.simulate(longer, start=state, method="rkn8")
    whole = tribo.simulate(longer, method="rkn8")
    assert rest["tip"]["x_cm"][-1, 0] == pytest.approx(whole["tip"]["x_cm"][-1, 0], abs=1e-7)
    # With another velocity or amplitude the factor goes on; another factor begins.
    series = tribo.Output(samples=2, series=("forces",))
    then = 1.0 + 0.5 * np.sin(2.0 * np.pi * state.t / 3.0)
    for change, factor in (
        ({"velocity": (0.1, 0.0)}, then),
        ({"potential": tribo.Corrugation(0.3, 2.0)}, 0.75 * then),
        ({"modulation": tribo.Schedule.sine(1.0, 0.4, 3.0)}, 1.0),
    ):
        other = replace(longer, output=series, fields=[replace(field, **change)])
        goes_on = tribo.simulate(other, start=state, method="rkn8")["tip"]
        x = goes_on["x_bob"][0, 0]
        wanted = -0.4 * np.pi * np.sin(np.pi * x) * factor
        assert goes_on["f_field_x"][0, 0] == pytest.approx(wanted, rel=1e-9)


MORSE = tribo.Morse(D=0.3, alpha=2.0, r0=1.2)
WALL = tribo.Surface("wall", facing="up", drive="bars", asperite=RIGID)


@pytest.mark.parametrize(
    "settings",
    [
        {"method": "gauss-radau-15", "accuracy": 1e-10},
        {"method": "rkn8", "accuracy": 1e-10},
        {"method": "kahan-li-8", "step": 0.05},
    ],
)
def test_given_motion(settings):
    """A tip that is pressed in and pulled back: its motion, its forces and its work."""
    along = tribo.Schedule.sine(0.0, 0.2, 5.0, phase=0.5)
    down = tribo.Schedule([[0.0, -0.1], [9.5, -0.1], [10.5, 0.1]])
    start = 0.2 * np.sin(0.5)
    drive = tribo.Moved(speed=[along, down])
    surface = tip(drive, bob=(0.0, 2.0), velocity=(start, -0.1))
    output = tribo.Output(samples=41, series=["forces", "energies"])
    scene = tribo.Scene([surface, WALL], MORSE, 20.0, output=output)
    result = tribo.simulate(scene, **settings)
    series = result["tip"]
    x, y = along.integral(result.t), 2.0 + down.integral(result.t)
    np.testing.assert_allclose(series["x_bob"][:, 0], x, atol=1e-8)
    np.testing.assert_allclose(series["y_bob"][:, 0], y, atol=1e-8)
    r = np.hypot(x, y)
    e = np.exp(-2.0 * (r - 1.2))
    force = 2.0 * 0.3 * 2.0 * (e * e - e)  # repulsion
    np.testing.assert_allclose(series["f1_y"][:, 0], force * y / r, atol=1e-7)
    omega = 2.0 * np.pi / 5.0
    pull = MASS * 0.2 * omega * np.cos(omega * result.t + 0.5)
    np.testing.assert_allclose(series["f2_x"][:, 0], pull - series["f1_x"][:, 0], atol=1e-7)
    energy = result.system["contact_energy"] + series["k_trans"][:, 0]
    np.testing.assert_allclose(series["w2"][:, 0], energy - energy[0], atol=1e-7)
    system = result.system
    np.testing.assert_allclose(system["total_energy_change"], system["applied_work"], atol=1e-7)


def test_given_motion_of_springs_and_members():
    """Springs and fields do not change a given motion; lanes have the bits of runs alone."""
    speed = tribo.Schedule([[0.0, 0.3], [3.25, 0.3], [4.25, -0.1]])
    row = tribo.Surface(
        "row",
        shape=(3, 1),
        spacing=(1.0, 0.0),
        velocity=(0.3, 0.0),
        drive=tribo.Moved(speed=[speed, 0.0]),
        springs=tribo.Springs(stiffness=2.0),
        asperite=tribo.Asperite(m1=[1.0, 2.0, 3.0], kappa=np.inf),
    )
    warm = tribo.Surface(
        "warm",
        facing="up",
        drive=tribo.Pulled(stiffness=1.0, speed=0.0),
        asperite=RIGID,
        langevin=tribo.Langevin(0.5, 0.1),
    )
    field = tribo.Field(tribo.Corrugation(0.4, 1.7), on=["row", "warm"])
    numerics = tribo.Numerics(method="verlet", step=0.125)
    scene = tribo.Scene(
        [row, warm], [], 8.0, fields=[field], numerics=numerics, output=tribo.Output(samples=9)
    )
    result = tribo.simulate(scene)
    wanted = np.arange(3) + speed.integral(result.t)[:, None]
    np.testing.assert_allclose(result["row"]["x_bob"], wanted, atol=1e-12)
    alone = replace(scene, output=replace(scene.output, series=["forces"]))
    keep = ["row.w2", "warm.x_cm", "row.x_cm"]
    one, other = (
        tribo.ensemble(each, 9, keep=keep, at="samples", seed=5, progress=False)
        for each in (scene, alone)
    )
    for name in keep:
        np.testing.assert_array_equal(one[name].values, other[name].values)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"drive": tribo.Moved(speed=[0.1, 0.0])}, "velocity: must be .*0.1, 0.0.*at t = 0"),
        ({"bars": "free", "asperite": tribo.Asperite()}, 'bars: must be "clamped"'),
        ({"langevin": {"gamma": 1.0}}, "langevin.on: must be"),
        ({"initial": {"vx": 0.1}}, "gives their motion"),
        ({"initial": {"temperature": 0.1}}, "initial.temperature: cannot go"),
    ],
)
def test_refused_given_motion(settings, message):
    given = {"drive": tribo.Moved(speed=[0.0, 0.0]), "asperite": RIGID} | settings
    with pytest.raises(tribo.InputError, match=message):
        tribo.Scene([tribo.Surface("tip", **given)], [], 1.0)


def test_refused_steps_of_a_motion():
    with pytest.raises(tribo.InputError, match=r"speed\[1\]: must have no steps"):
        tribo.Moved(speed=[0.0, tribo.Schedule([[0, 0.1], [1, 0.2]], kind="steps")])
