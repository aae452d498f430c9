"""Reservoirs with any damping of a step: mobility, Einstein's relation, decay, temperature, works.

z is gamma h / M of a step h, or gamma h / inertia on the swing.
"""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import (
    Asperite,
    Bath,
    DrivenBars,
    Free,
    Initial,
    InputError,
    Langevin,
    Output,
    Pulled,
    Pushed,
    Scene,
    Surface,
)
from tribo.accuracy.choose_method import choose
from tribo.layout.layout import lay_out
from tribo.loops.resolution import longest_step

STEP = 0.1
TEMPERATURE = 0.3
FORCE = 0.4
RIGID = Asperite(kappa=np.inf)
SOFT = Asperite()
MASS = 3.0
INERTIA = SOFT.for_each(1)["inertia"][0]
ABOUT_BAR = 4.0
DAMPING = (0.01, 0.1, 1.0, 5.0, 20.0)


def run(surface, times, method="verlet", **settings):
    """The table of the only surface of a run."""
    scene = Scene([surface], [], times[-1], output=Output(times=times))
    return tribo.simulate(scene, method=method, **settings or {"step": STEP})[surface.name]


def assert_closed(table):
    """The identities of the ledger hold to round-off."""
    works = np.max(np.abs(table.w1)) + np.max(np.abs(table.w2)) + np.max(np.abs(table.w_T)) + 1.0
    assert np.max(np.abs(table.w - table.w_ps - table.delta_e_int)) < 1e-12 * works
    assert np.max(np.abs(table.w_ps - table.delta_k_trans)) < 1e-12 * works


def assert_mean(each, expected):
    """The mean over asperites is as expected, within 4 standard errors."""
    assert np.mean(each) == pytest.approx(expected, abs=4.0 * np.std(each) / np.sqrt(len(each)))


@pytest.mark.parametrize("z", DAMPING)
def test_drift_and_decay_are_exact(z):
    """A rigid bar without noise: F / gamma, the heat of the drift, exponential decay, stopping."""
    gamma = z * MASS / STEP
    times = np.linspace(0.0, 8.0, 9)
    pushed = Surface(
        "bar", asperite=RIGID, drive=Pushed(force=(FORCE, 0.0)), langevin=Langevin(gamma)
    )
    table = run(pushed, times)
    kept = np.exp(-gamma / MASS * times)
    drift = FORCE / gamma
    x = drift * (times - MASS / gamma * (1.0 - kept))
    assert table.vx_cm[:, 0] == pytest.approx(drift * (1.0 - kept), rel=1e-12, abs=0.0)
    assert table.x_cm[:, 0] - table.x_cm[0, 0] == pytest.approx(x, rel=1e-10)
    assert table.w2[:, 0] == pytest.approx(FORCE * x, rel=1e-3)  # but for half of the last jump
    if z >= 1.0:
        assert np.diff(table.heat[-2:, 0]) == pytest.approx(FORCE * drift, rel=1e-6)
    moving = Surface(
        "bar",
        asperite=RIGID,
        drive=Free(load=0.0),
        initial=Initial(vx=1.0, vy=-0.5),
        langevin=Langevin(gamma),
    )
    table = run(moving, times)
    assert table.vx_cm[:, 0] == pytest.approx(kept, rel=1e-12, abs=1e-15)
    assert table.vy_cm[:, 0] == pytest.approx(-0.5 * kept, rel=1e-12, abs=1e-15)
    stopping = MASS / gamma * (1.0 - kept)
    assert table.x_cm[:, 0] - table.x_cm[0, 0] == pytest.approx(stopping, rel=1e-12, abs=0.0)
    assert table.heat[:, 0] == pytest.approx(0.625 * MASS * (1.0 - kept**2), rel=1e-12, abs=0.0)
    assert_closed(table)


SWINGING = {
    "pushed": (Pushed(force=(0.3, 0.1)), "bar", MASS),
    "pulled": (Pulled(stiffness=1.0, speed=0.5, load=0.1), "bar", MASS),
    "swing": (Pulled(stiffness=1.0, speed=0.5), "swing", INERTIA),
    "driven": (DrivenBars(), "swing", ABOUT_BAR),
}


@pytest.mark.parametrize("kind", SWINGING)
@pytest.mark.parametrize("z", [0.1, 1.0, 20.0])
def test_swings_are_those_of_another_method(kind, z):
    """Damped pendulums without noise move as by dop853, wide swings and turning bars too.

    Errors are below 2 % of the range of each quantity.  With friction in the kick alone they are 7
    to 500 % at z = 1 and more, and those of the work of the left end 10 to 1000 times its range.
    """
    drive, on, mass = SWINGING[kind]
    turning = {"nu": 0.3} if on == "swing" else {}
    surface = Surface(
        "bar",
        drive=drive,
        initial=Initial(theta=0.4, omega=0.3, **turning),
        langevin=Langevin(z * mass / STEP, on=on),
    )
    times = np.linspace(0.0, 16.0, 33)
    table = run(surface, times)
    other = run(surface, times, "dop853", accuracy=1e-8)
    for name in ("x_cm", "y_cm", "theta", "w2", "heat", "delta_e_int"):
        right = getattr(other, name)
        scale = np.ptp(right) + (0.02 if name in ("w2", "heat", "delta_e_int") else 0.0)
        assert np.max(np.abs(getattr(table, name) - right)) < 0.02 * scale + 1e-12, name
    assert np.max(np.abs(table.wL - other.wL)) < 1e-3 + 2e-3 * np.ptp(other.wL)
    assert_closed(table)


ROW = {"shape": (1, 1500), "spacing": (0.0, 5.0)}


@pytest.mark.parametrize(("asperite", "z"), [*((RIGID, z) for z in DAMPING), (SOFT, 0.3)])
def test_drift_diffusion_and_temperature(asperite, z):
    """With noise: the mean and the variance of displacements, <M v^2>, and the works' means."""
    gamma = z * MASS / STEP
    surface = Surface(
        "bar",
        **ROW,
        asperite=asperite,
        drive=Pushed(force=(FORCE, 0.0)),
        initial=Initial(temperature=TEMPERATURE),
        langevin=Langevin(gamma, TEMPERATURE),
    )
    end = max(20.0, 5.0 * MASS / gamma)
    table = run(surface, np.linspace(0.0, end, 3))
    time = end - MASS / gamma * -np.expm1(-gamma * end / MASS)
    moved = table.x_bar[-1] - table.x_bar[0]
    squares = (moved - moved.mean()) ** 2
    assert_mean(moved, FORCE / gamma * time)
    if asperite is RIGID:
        assert_mean(squares, 2.0 * TEMPERATURE / gamma * time)
        across = table.y_bar[-1] - table.y_bar[0]
        assert_mean(across**2, 2.0 * TEMPERATURE / gamma * time)
        assert_mean(table.w2[-1] - FORCE * moved, 0.0)
    drift = FORCE / gamma * -np.expm1(-gamma * end / MASS)
    assert_mean(MASS * (table.vx_cm[-1] - drift) ** 2, TEMPERATURE)
    assert_mean(MASS * table.vy_cm[-1] ** 2, TEMPERATURE)
    if asperite is SOFT:
        assert_mean(INERTIA * table.omega[-1] ** 2, TEMPERATURE)
        assert_mean(SOFT.kappa * table.theta[-1] ** 2, TEMPERATURE)
    assert_closed(table)


@pytest.mark.parametrize("kind", ["pulled", "swing", "driven"])
def test_equilibrium_takes_no_heat(kind):
    """Strong damping at a temperature: equipartition, and neither work nor heat on average.

    Works along the path alone have no trend: with those of the mean velocities of the kicks, the
    spring to the stage would give k T h / (4 M) to the reservoir, here 0.6 in all.
    """
    drive = {
        "pulled": Pulled(stiffness=1.0, speed=0.0, load=0.0),
        "swing": Free(),
        "driven": DrivenBars(),
    }[kind]
    on, mass = ("bar", MASS) if kind == "pulled" else ("swing", ABOUT_BAR)
    surface = Surface(
        "bar",
        **ROW,
        asperite=RIGID if kind == "pulled" else SOFT,
        drive=drive,
        initial=Initial(temperature=TEMPERATURE),
        langevin=Langevin(5.0 * mass / STEP, TEMPERATURE, on=on),
    )
    table = run(surface, np.array([0.0, 160.0, 240.0]))
    heat = table.heat[2] - table.heat[1]
    assert_mean(heat, 0.0)
    assert np.std(heat) / np.sqrt(heat.size) < 0.02
    if kind == "pulled":
        assert_mean(table.w2[2] - table.w2[1], 0.0)
        stretched = table.x_bar[2] - table.x_bar[0]
        assert_mean(stretched**2, TEMPERATURE)
    else:
        assert_mean(SOFT.kappa * table.theta[2] ** 2, TEMPERATURE)
    assert_closed(table)


def test_members_in_lanes():
    """Members that differ in gamma decay exactly, each with its own drift."""
    surface = Surface(
        "bar",
        asperite=RIGID,
        drive=Pushed(force=(FORCE, 0.0)),
        langevin=Langevin(1.0, 1e-30),
    )
    scene = Scene([surface], [], 8.0, output=Output(samples=2))
    gammas = np.array(DAMPING) * MASS / STEP
    data = tribo.ensemble(
        scene,
        vary={"bar.langevin.gamma": gammas},
        keep=["bar.x_cm", "bar.vx_cm"],
        method="verlet",
        step=STEP,
    )
    kept = np.exp(-gammas / MASS * 8.0)
    drift = FORCE / gammas
    x = drift * (8.0 - MASS / gammas * (1.0 - kept))
    moved = data["bar.x_cm"].values.squeeze()
    assert moved - moved[-1] == pytest.approx(x - x[-1], rel=1e-9)
    assert data["bar.vx_cm"].values.squeeze() == pytest.approx(drift * (1.0 - kept), rel=1e-9)


@pytest.mark.parametrize("step", [None, 0.07])
def test_members_kept_at_the_end_take_the_same_path(step):
    """Their steps are those of runs that record all times."""
    surface = Surface(
        "bar", asperite=RIGID, drive=Pushed(force=(FORCE, 0.0)), langevin=Langevin(3.0, TEMPERATURE)
    )
    scene = Scene([surface], [], 8.0, output=Output(samples=1601 if step is None else 81))
    settings = {"members": 8, "keep": ["bar.x_cm"], "seed": 3, "step": step}
    ends = tribo.ensemble(scene, **settings)["bar.x_cm"].values
    paths = tribo.ensemble(scene, at="samples", **settings)["bar.x_cm"].values
    assert ends.ravel() == pytest.approx(paths[:, -1].ravel(), rel=1e-9)


def test_system_with_bath_and_reservoir():
    """The energy that a reservoir gives to a bath on the same bars is that of the bath."""
    surface = Surface(
        "bar",
        **ROW,
        asperite=RIGID,
        drive=Free(load=0.0),
        bath=Bath(masses=[1.0], frequencies=[1.0], temperature=TEMPERATURE),
        initial=Initial(temperature=TEMPERATURE),
        langevin=Langevin(5.0 * MASS / STEP, TEMPERATURE),
    )
    scene = Scene([surface], [], 60.0, output=Output(times=np.array([0.0, 60.0])))
    result = tribo.simulate(scene, method="verlet", step=STEP)
    missing = (result.system.applied_work - result.system.total_energy_change)[-1]
    assert abs(missing) / ROW["shape"][1] < 0.02 * TEMPERATURE


@pytest.mark.parametrize(("temperature", "most"), [(TEMPERATURE, 0.0163), (0.05, 0.04)])
def test_steps_that_heat_swings_are_refused(temperature, most):
    """The message names a step that would do; the automatic step is as short.

    The limit is 0.1 of z^2 T / kappa; at 0.05, z = 6 heats the swings by 9 %, not by 2 % as the
    product z T / kappa suggests (benchmarks/damped_swings.py).
    """
    surface = Surface("bar", drive=Free(load=0.0), langevin=Langevin(150.0, temperature))
    scene = Scene([surface], [], 100.0)
    with pytest.raises(InputError, match=rf"step: must be at most {most} for the damping"):
        tribo.simulate(scene, step=0.12)
    choice = choose(lay_out(scene), None, None, None)
    assert choice.step == pytest.approx(longest_step(lay_out(scene), most), rel=3e-3)
    given = choose(lay_out(scene), None, None, choice.step)
    assert given == replace(choice, automatic=False)
