"""Friction loops, slips and force-distance curves, against closed forms and another integrator."""

from dataclasses import replace
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest
import xarray
from scipy.integrate import solve_ivp

import tribo
from tribo import Asperite, Corrugation, Field, InputError, Langevin, Output, Pulled, Scene, Surface
from tribo.results.slips import _note as slips_note
from tribo.results.stage import pull_of, turning_points

AMPLITUDE, STIFFNESS, PERIOD, SPEED, DAMPING = 0.1, 0.5, 1.0, 0.02, 4.0
MASS = 2.0
# Half a stroke and the angular frequency of a stage that goes forth and back.
STROKE, FREQUENCY = 2.0, 0.02


class Sine(NamedTuple):
    """A spring to a stage at STROKE sin(FREQUENCY t)."""

    stiffness: float
    stroke: float
    frequency: float

    drives_along_x = True
    depends_on_velocity = False

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return self.stiffness * (self.stroke * np.sin(self.frequency * t) - x), -fy


def tip(drive, duration, samples, run_in=0.0, amplitude=AMPLITUDE):
    """A rigid tip in a corrugation, which a reservoir without noise damps."""
    surface = Surface(
        "upper",
        drive=drive,
        asperite=Asperite(kappa=np.inf, m1=0.5 * MASS, m2=0.5 * MASS),
        langevin=Langevin(DAMPING, 0.0),
    )
    field = Field(Corrugation(amplitude, PERIOD), on=("upper",))
    output = Output(samples=samples, series=("forces",), run_in=run_in)
    return Scene((surface,), (), duration, fields=(field,), output=output)


def path(stage, times):
    """The place of the same tip over time, by another program."""

    def rates(t, state):
        x, v = state
        wave = 2.0 * np.pi / PERIOD
        force = STIFFNESS * (stage(t) - x) - AMPLITUDE * wave * np.sin(wave * x) - DAMPING * v
        return [v, force / MASS]

    start = [0.0, 0.0]
    return solve_ivp(rates, times[[0, -1]], start, "LSODA", times, rtol=1e-9, atol=1e-10).y[0]


@pytest.fixture(scope="module")
def pulled():
    drive = Pulled(stiffness=STIFFNESS, speed=SPEED)
    return tribo.simulate(tip(drive, 300.0, 3001, run_in=100.0), accuracy=1e-7)


@pytest.fixture(scope="module")
def swung():
    """Two and a quarter cycles of the stage: four turns."""
    duration = 2.25 * 2.0 * np.pi / FREQUENCY
    drive = tribo.Custom(force=Sine(STIFFNESS, STROKE, FREQUENCY))
    return tribo.simulate(tip(drive, duration, 4001), accuracy=1e-7)


def test_slips_of_prandtl_and_tomlinson(pulled):
    """One for each period; forces and energies are those of another integration."""
    found = pulled.slips("upper")
    table = found.table
    assert table.sizes["slip"] == 4 and found.note == ""
    assert np.diff(table["time"]) == pytest.approx(PERIOD / SPEED, abs=0.11)
    x = path(lambda t: SPEED * t, pulled.t)
    force = STIFFNESS * (SPEED * pulled.t - x)
    for slip in range(4):
        one = table.isel(slip=slip)
        ends = float(one.time), float(one.time + one.duration)
        i, j = (int(np.argmin(abs(pulled.t - t))) for t in ends)
        near = slice(i - 20, j + 20)
        assert float(one.force_before) == pytest.approx(force[near].max(), abs=1e-5)
        assert float(one.force_after) == pytest.approx(force[near].min(), abs=1e-5)
        assert float(one.size) == pytest.approx(x[j] - x[i], abs=1e-5)
        energies = 0.5 * force[[i, j]] ** 2 / STIFFNESS
        assert float(one.energy) == pytest.approx(energies[0] - energies[1], abs=1e-5)
    # The spring holds the tip at least up to where it would become unstable at rest.
    ratio = 4.0 * np.pi**2 * AMPLITUDE / (STIFFNESS * PERIOD**2)
    static = 2.0 * np.pi * AMPLITUDE / PERIOD * np.sqrt(1.0 - ratio**-2)
    assert np.all(table["force_before"] > static) and np.all(table["force_before"] < 1.1 * static)
    alone = pulled.slips("upper", asperite=0).table
    assert np.allclose(alone["energy"], table["energy"], rtol=1e-12)
    means = found.mean("force_before")
    assert abs(means.mean - table["force_before"].mean()) < 1e-15 and means.half_width < 1e-4


def test_distributions_of_slips(pulled):
    """Shares add up to one; Clopper and Pearson's interval of 1 of 4 is known."""
    found = pulled.slips("upper").distribution("time", 4)
    assert found["share"].values == pytest.approx([0.25] * 4)
    assert found["share_low"].values == pytest.approx([0.0063094] * 4, rel=1e-4)
    assert found["share_high"].values == pytest.approx([0.8058796] * 4, rel=1e-4)


def test_oscillations_after_a_slip_are_no_slips(pulled):
    """Of a tip with little damping, as many falls of the force are slips as it gets ahead."""
    (surface,) = pulled.scene.surfaces
    soft = replace(surface, langevin=Langevin(0.5, 0.0))
    result = tribo.simulate(replace(pulled.scene, surfaces=(soft,)), accuracy=1e-6)
    table = result.slips("upper", least=0.1).table
    force = result["upper"].pull_force
    falls = turning_points(force[result.t >= 100.0], 0.1)
    assert falls.size > 3 * table.sizes["slip"]
    assert np.all(table["size"] > 0.5 * PERIOD)


def test_falls_close_to_the_least_one_are_noted():
    """A fall of 1 counts by chance if the least that counts is 0.9; falls of 2 do not."""
    drops = {"duration": ("slip", [9.0] * 4), "drop": ("slip", [1.0, 2.0, 2.0, 2.0])}
    result = SimpleNamespace(t=np.arange(5.0))
    assert "1 of 4 falls are close" in slips_note(result, xarray.Dataset(drops), 0.9)


def test_a_loop_is_that_of_another_integration(swung):
    """Its area is the work of the stage, and what the damping takes; a cycle lacks nothing."""
    stage = STROKE * np.sin(FREQUENCY * swung.t)
    found = swung.loop("upper", position=stage)
    assert found.cycles.sizes["cycle"] == 2 and np.isfinite(found.area.half_width)
    force = STIFFNESS * (stage - path(lambda t: STROKE * np.sin(FREQUENCY * t), swung.t))
    assert np.max(np.abs(found.force - force)) < 1e-4
    quarter = 0.5 * np.pi / FREQUENCY
    one = (swung.t >= 5.0 * quarter) & (swung.t <= 7.0 * quarter)
    other = (swung.t >= 7.0 * quarter) & (swung.t <= 9.0 * quarter)
    area = np.trapezoid(force[one], stage[one]) + np.trapezoid(force[other], stage[other])
    last = found.cycles.isel(cycle=-1)
    assert float(last.area) == pytest.approx(area, rel=1e-3)
    assert float(last.stroke) == pytest.approx(2.0 * STROKE, rel=1e-3)
    assert float(last.forward - last.backward) == pytest.approx(
        float(last.area / last.stroke), rel=1e-9
    )
    assert float(last.forward) > 0.2 > -0.2 > float(last.backward)
    axes = swung.plot.loop("upper", position=stage)
    assert "area" in axes.get_title() and axes.get_ylabel() == "force on upper"
    inner = swung.loop("upper", position=stage, margin=0.25)
    assert inner.forward.mean > found.forward.mean  # without the springs' turn
    assert inner.area.mean == found.area.mean


def test_a_held_bar_makes_no_loop_of_its_own(pulled, swung):
    """Runs without a turn, without a stage, and without forces are refused by name."""
    with pytest.raises(InputError, match="does not turn back after t = 100"):
        pulled.loop("upper")
    with pytest.raises(InputError, match=r"springs to a stage pull.*give the position"):
        swung.loop("upper")
    with pytest.raises(InputError, match="surface: must be one that springs to a stage pull"):
        swung.slips("upper")
    with pytest.raises(InputError, match="surface: must be one of upper"):
        pulled.slips("lower")
    with pytest.raises(InputError, match="must slip"):
        pulled.slips("upper", least=10.0)
    quiet = tribo.simulate(replace(swung.scene, output=Output(samples=11)), accuracy=1e-3)
    with pytest.raises(InputError, match=r'output\.series: does not contain "forces"'):
        quiet.loop("upper", position=np.sin(quiet.t))


def test_bars_that_are_moved_make_a_loop():
    """Its area is the work by which they are moved in a cycle."""
    speed = tribo.Schedule.sine(0.0, 0.6, period=20.0, phase=0.5 * np.pi), 0.0
    drag = Langevin(1.0, on="swing")
    place = {"bob": (0.0, 1.3), "velocity": (0.6, 0.0), "shape": (2, 1), "spacing": (1.3, 0.0)}
    tip = Surface("tip", drive=tribo.Moved(speed=speed), langevin=drag, **place)
    below = {"bob": (-5.0, 0.0), "shape": (12, 1), "spacing": (1.0, 0.0)}
    row = Surface("row", facing="up", drive="bars", **below)
    output = Output(samples=4001, series=("forces",), run_in=20.0)
    contact = tribo.Gaussian(0.2, 0.5).with_cutoff(2.0)
    result = tribo.simulate(Scene((tip, row), contact, 81.0, output=output), accuracy=1e-8)
    found = result.loop("tip")
    assert found.stroke.mean == pytest.approx(0.6 * 20.0 / np.pi, rel=1e-3)
    work = np.sum(result["tip"].w2, axis=1)
    cycles = found.cycles
    for begin, end, area in zip(*(cycles[n].values for n in ("begin", "end", "area")), strict=True):
        done = np.interp([begin, end], result.t, work)
        assert area == pytest.approx(done[1] - done[0], rel=0.01)


TURNS = {"points": [[0, 0.2], [15, 0.2], [15, -0.2], [30, -0.2]]}
BLOCK = {"stiffness": 3.0, "speed": TURNS, "load": 0.4, "block": True}


@pytest.mark.parametrize(
    "settings",
    [
        pytest.param({"drive": Pulled(stiffness=STIFFNESS, speed=TURNS)}, id="each bar"),
        pytest.param(
            {"drive": Pulled(**BLOCK), "asperite": Asperite(kappa=4.0)},
            marks=pytest.mark.thorough,
            id="block of pendulums",
        ),
        pytest.param(
            {"drive": Pulled(**BLOCK), "elastic": {"modulus": 2.0, "poisson": 0.3}},
            marks=pytest.mark.thorough,
            id="block on a body with free edges",
        ),
    ],
)
def test_a_loop_needs_no_forces(settings):
    """A run that records what is recorded by default has the pull of one that records forces."""
    grid = {"shape": (3, 2), "spacing": (1.2, 1.2), "asperite": Asperite(kappa=np.inf)}
    upper = Surface("upper", bob=(0.3, 1.0), velocity=(0.1, 0.0), **grid | settings)
    grid["shape"] = (9, 2)
    lower = Surface("lower", facing="up", bob=(-3.0, 0.0), drive="bars", **grid)
    contact = tribo.Hertz(2.0, 1.0)
    runs = []
    for series in (["forces"], []):
        output = Output(samples=201, series=series)
        scene = Scene((upper, lower), contact, 30.0, output=output)
        runs.append(tribo.simulate(scene, method="dop853", accuracy=1e-6))
    told, quiet = runs
    found = [each.loop("upper") for each in runs]
    assert np.max(np.abs(told["upper"]["pull_force"])) > 0.1
    assert np.max(np.abs(found[1].force - told["upper"]["pull_force"])) < 1e-11
    assert np.array_equal(found[0].position, found[1].position)
    moved = tribo.Schedule(**TURNS).integral(quiet.t)
    assert found[1].position == pytest.approx(1.5 + moved, abs=1e-12)
    assert found[1].area.mean == pytest.approx(found[0].area.mean, abs=1e-9)
    later = replace(quiet.scene, duration=40.0)
    after = tribo.simulate(later, start=quiet.state(), method="dop853", accuracy=1e-6)
    moved = tribo.Schedule(**TURNS).integral(after.t)
    assert pull_of(after, "upper").position == pytest.approx(1.5 + moved, abs=1e-12)


def test_the_pull_of_a_body_with_unequal_rods_needs_no_forces():
    """Bars of one block on an elastic body, whose rods are of several lengths."""
    drive = Pulled(stiffness=3.0, speed=0.2, load=0.4, block=True)
    tips = Asperite(kappa=np.inf, length=np.array([0.8, 1.0, 1.3]))
    row = {"spacing": (1.2, 1.2)}
    body = {"elastic": {"modulus": 2.0, "poisson": 0.3}, "asperite": tips, "shape": (3, 1)}
    upper = Surface("upper", bob=(0.3, 1.0), drive=drive, **body, **row)
    row |= {"shape": (9, 1), "asperite": Asperite(kappa=np.inf)}
    lower = Surface("lower", facing="up", bob=(-3.0, 0.0), drive="bars", **row)
    told, quiet = (
        tribo.simulate(
            Scene((upper, lower), tribo.Hertz(2.0, 1.0), 4.0, output=output),
            method="dop853",
            accuracy=1e-6,
        )
        for output in (Output(samples=21, series=["forces"]), Output(samples=21))
    )
    force = told["upper"].pull_force
    assert np.max(np.abs(force)) > 0.1
    assert np.max(np.abs(pull_of(quiet, "upper").force - force)) < 1e-10


def test_the_pull_of_a_run_that_continues_with_another_speed():
    """Its new schedule begins at the state, and so does the stage from which the pull follows."""

    def scene(speed, series, duration):
        drive = Pulled(stiffness=2.0, speed=speed)
        return replace(tip(drive, duration, 41), output=Output(samples=41, series=series))

    first = tribo.simulate(scene(0.1, [], 4.0), method="verlet", step=0.02)
    faster = [[0.0, 0.3], [10.0, 0.5]]
    told, quiet = (
        tribo.simulate(scene(faster, series, 8.0), start=first.state(), method="verlet", step=0.02)
        for series in (["forces"], [])
    )
    assert pull_of(quiet, "upper").force == pytest.approx(told["upper"].pull_force, abs=1e-9)


def test_the_loop_of_a_damped_block_that_goes_on():
    """The stage is where an earlier run left it; the force that is recorded has the damper's."""
    points = [[0, 0.2], [10, 0.2], [10, -0.2], [20, -0.2], [20, 0.2], [30, 0.2]]
    drive = Pulled(stiffness=0.6, speed=points, load=0.05, block=True, damping=0.6)
    upper = Surface("upper", bob=(0.4, 0.8), velocity=(0.1, 0.0), drive=drive)
    row = {"shape": (9, 1), "spacing": (1.0, 0.0), "bob": (-3.0, 0.0), "drive": "bars"}
    scene = Scene((upper, Surface("lower", facing="up", **row)), tribo.Gaussian(0.4, 0.5), 30.0)
    scene = replace(scene, output=Output(samples=601, series=["forces"]))
    first = tribo.simulate(replace(scene, duration=6.0, output=Output(samples=121)), accuracy=1e-6)
    whole = tribo.simulate(scene, accuracy=1e-6)
    later = tribo.simulate(scene, start=first.state(), accuracy=1e-6)
    one, other = later.loop("upper"), whole.loop("upper", after=6.0)
    position = 0.4 + tribo.Schedule(points).integral(later.t)
    assert one.position == pytest.approx(position, abs=1e-12)
    assert one.cycles.area.values == pytest.approx(other.cycles.area.values, rel=1e-5)
    assert one.area.mean > 0.1


def test_turning_points():
    """Extremes that a series turns back from, with its ends."""
    t = np.linspace(0.0, 4.0, 41)
    triangle = np.abs((t + 0.5) % 2.0 - 1.0)
    assert turning_points(triangle, 0.1).tolist() == [0, 5, 15, 25, 35, 40]
    assert turning_points(np.zeros(5), 0.1).tolist() == [0, 4]
    assert turning_points(np.array([0.5, 0.0, 3.0, 1.0]), 1.0).tolist() == [0, 1, 2, 3]


def test_force_over_distance():
    """Bars that come down: the force at each distance is that of the potential."""
    upper = Surface(
        "upper",
        bob=(0.0, 2.0),
        velocity=(0.0, -0.2),
        drive=tribo.DrivenBars(),
        asperite=Asperite(kappa=1e4),
    )
    lower = Surface("lower", facing="up", drive=tribo.DrivenBars(), asperite=Asperite(kappa=1e4))
    potential = tribo.LennardJones(0.1, 1.0)
    scene = Scene((upper, lower), potential, 5.0, output=Output(samples=101, series=("forces",)))
    result = tribo.simulate(scene, accuracy=1e-7)
    curve = result.force_distance("upper")
    rods = 2.0 * scene.surfaces[0].asperite.length
    expected = potential.force(curve["distance"].values - rods)
    assert np.allclose(curve["force"], expected, rtol=1e-6, atol=1e-9)
    assert curve["force"][-1] > 0.0 > curve["force"].min()
    assert np.all(curve["leg"] == -1) and np.isnan(curve.attrs["pull_off"])
    level = replace(upper, velocity=(0.1, 0.0))
    with pytest.raises(InputError, match="keeps its height"):
        tribo.simulate(replace(scene, surfaces=(level, lower))).force_distance("upper")
