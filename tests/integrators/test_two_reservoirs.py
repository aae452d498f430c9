"""Reservoirs on the bars and on the swings of one surface, against the linear system's solution.

Swings are so small that the motion is linear: along x the bar hangs on a spring, and friction
couples it to the swing.
"""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm, solve_continuous_lyapunov

import tribo
from support.scene_tables import scene_from
from tribo import Asperite, Initial, InputError, Langevin, Output, Pulled, Pushed, Scene, Surface

STEP = 0.1
STIFFNESS = 1.0
HOT = 3e-5
FORCE = 0.4
EACH = Asperite().for_each(1)
MASS, INERTIA, LEVER, KAPPA = (float(EACH[k][0]) for k in ("mass", "inertia", "l2", "kappa"))
# Velocity and rate from a force on the bar, and from a torque on the swing.
ON_BAR = np.array([1.0 / MASS, -LEVER / INERTIA])
ON_SWING = np.array([0.0, 1.0 / INERTIA])


def surface(gammas, temperatures=(0.0, 0.0), n=1, **settings):
    """A bar on a spring at rest, with both reservoirs."""
    settings = {"drive": Pulled(stiffness=STIFFNESS, speed=0.0, load=0.0), **settings}
    reservoirs = [
        Langevin(gamma, temperature, on=on)
        for gamma, temperature, on in zip(gammas, temperatures, ("bar", "swing"), strict=True)
    ]
    rows = {"shape": (1, n), "spacing": (0.0, 5.0)} if n > 1 else {}
    return Surface("bar", **rows, langevin=reservoirs, **settings)


def run(part, times, method="verlet", **settings):
    """The table of the surface."""
    scene = Scene([part], [], times[-1], output=Output(times=times))
    return tribo.simulate(scene, method=method, **settings or {"step": STEP})["bar"]


def linear(gammas):
    """The matrix of the rates of change of x, theta, and their velocities."""
    force = STIFFNESS * np.array([1.0, -LEVER])  # of the spring, and its torque
    stiff = np.outer(ON_BAR, force) + np.outer(ON_SWING, [0.0, KAPPA])
    friction = np.outer(ON_BAR, gammas[0] * np.array([1.0, -LEVER]))
    friction += np.outer(ON_SWING, [0.0, gammas[1]])
    return np.block([[np.zeros((2, 2)), np.eye(2)], [-stiff, -friction]])


def covariance(gammas, temperatures):
    """That of x, theta, and their velocities, in the steady state."""
    noise = np.zeros((4, 4))
    for gamma, temperature, way in zip(gammas, temperatures, (ON_BAR, ON_SWING), strict=True):
        noise[2:, 2:] += 2.0 * gamma * temperature * np.outer(way, way)
    return solve_continuous_lyapunov(linear(gammas), -noise)


def assert_mean(each, expected):
    """The mean over asperites is as expected, within 4 standard errors."""
    assert np.mean(each) == pytest.approx(expected, abs=4.0 * np.std(each) / np.sqrt(len(each)))


def assert_closed(table):
    """The identities of the ledger hold to round-off."""
    works = sum(np.max(np.abs(w)) for w in (table.w2, table.wL, table.w_T))
    assert np.max(np.abs(table.w - table.w_ps - table.delta_e_int)) < 1e-11 * works
    assert np.max(np.abs(table.w_ps - table.delta_k_trans)) < 1e-11 * works


@pytest.mark.parametrize("z", [(0.01, 0.01), (0.01, 1.0), (1.0, 1.0), (20.0, 1.0), (1.0, 20.0)])
def test_decay_without_noise(z):
    """A small swing decays as the exponential of the linear system, and both heats are exact."""
    gammas = z[0] * MASS / STEP, z[1] * INERTIA / STEP
    times = np.linspace(0.0, 16.0, 33)
    table = run(surface(gammas, initial=Initial(theta=1e-4, omega=3e-5)), times)
    start = np.array([table.x_cm[0, 0], 1e-4, table.vx_cm[0, 0], 3e-5])
    exact = np.array([expm(t * linear(gammas)) @ start for t in times])
    found = np.column_stack([table.x_cm, table.theta, table.vx_cm, table.omega])
    assert np.max(np.abs(found - exact) / np.ptp(exact, axis=0)) < 2e-3
    slips = np.array([[0.0, 0.0, 1.0, -LEVER], [0.0, 0.0, 0.0, 1.0]])
    generator = linear(gammas)
    end = exact[-1]
    heats = []
    for gamma, slip in zip(gammas, slips, strict=True):
        # The integral S of exp(L't) slip slip' exp(L t) follows from L' S + S L = change.
        square = np.outer(slip, slip)
        integral = solve_continuous_lyapunov(generator.T, -square)
        heats.append(gamma * (start @ integral @ start - end @ integral @ end))
    assert table.heat[-1, 0] == pytest.approx(sum(heats), rel=5e-3)
    assert table.heat_swing[-1, 0] == pytest.approx(heats[1], rel=5e-3)
    assert_closed(table)


def test_other_methods():
    """At T = 0 every method that takes friction has both reservoirs, and both heats."""
    part = surface((30.0, 27.0), initial=Initial(theta=0.4, omega=0.3))
    times = np.linspace(0.0, 8.0, 9)
    table = run(part, times)
    other = run(part, times, "dop853", accuracy=1e-8)
    for name in ("x_cm", "theta", "w2", "heat", "heat_swing"):
        right = getattr(other, name)
        assert np.max(np.abs(getattr(table, name) - right)) < 0.01 * np.ptp(right), name


@pytest.mark.parametrize("z", [0.03, 1.0, 3.0])
@pytest.mark.parametrize("cold", [1.0, 1.0 / 3.0, 0.0])
def test_steady_state(z, cold):
    """Covariances are those of the Lyapunov equation, and heat flows from hot to cold as they say.

    At one temperature this is equipartition, and no heat flows.
    """
    gammas = (z * MASS / STEP, z * INERTIA / STEP)
    temperatures = (HOT, cold * HOT)
    times = np.linspace(0.0, 480.0, 4)
    table = run(surface(gammas, temperatures, 800), times)
    exact = covariance(gammas, temperatures)
    if cold == 1.0:
        energies = np.diag(exact)[1:] * (KAPPA, MASS, INERTIA)
        assert energies == pytest.approx([HOT, HOT, HOT])
    moved = table.x_cm - table.x_cm[0]
    found = np.stack([moved, table.theta, table.vx_cm, table.omega])[:, 2:].reshape(4, -1)
    for a in range(4):
        for b in range(4):
            scale = np.sqrt(exact[a, a] * exact[b, b])
            assert_mean(found[a] * found[b] / scale, exact[a, b] / scale)
    flow = gammas[1] * (exact[3, 3] - temperatures[1] / INERTIA)
    largest = gammas[1] * HOT / INERTIA  # what the reservoir gives and takes
    assert (flow > 0.05 * largest) == (cold < 1.0)
    swing = (table.heat_swing[-1] - table.heat_swing[1]) / (times[-1] - times[1])
    total = (table.heat[-1] - table.heat[1]) / (times[-1] - times[1])
    for found, expected in ((swing, flow), (total, 0.0)):
        error = np.std(found) / np.sqrt(found.size)
        assert np.mean(found) == pytest.approx(expected, abs=4.0 * error + 1e-3 * largest)
    assert_closed(table)


@pytest.mark.parametrize("z", [0.1, 1.0, 20.0])
def test_drift_under_a_force(z):
    """Bars drift at F / gamma and spread by T / gamma, whatever damps their swings."""
    gammas = z * MASS / STEP, z * INERTIA / STEP
    part = surface(gammas, (HOT, HOT), 1500, drive=Pushed(force=(FORCE, 0.0)))
    times = np.array([0.0, 40.0, 60.0])
    table = run(part, times)
    moved = table.x_bar[2] - table.x_bar[1]
    assert np.mean(moved) == pytest.approx(20.0 * FORCE / gammas[0], rel=0.01)
    # The velocity keeps its direction for the time M / gamma.
    lost = MASS / gammas[0] * -np.expm1(-20.0 * gammas[0] / MASS)
    squares = (moved - np.mean(moved)) ** 2
    assert_mean(squares, 2.0 * HOT / gammas[0] * (20.0 - lost))
    assert_closed(table)


def test_members_in_lanes():
    """Members that differ in all four numbers take the paths and the heats of single runs."""
    part = surface((3.0, 2.0), (0.3, 0.1), n=3)
    scene = Scene([part], [], 2.0, output=Output(samples=3))
    values = {
        "bar.langevin.bar.gamma": np.array([1.0, 5.0, 9.0]),
        "bar.langevin.swing.gamma": np.array([8.0, 2.0, 1.0]),
        "bar.langevin.bar.temperature": np.array([0.1, 0.3, 0.0]),
        "bar.langevin.swing.temperature": np.array([0.1, 0.0, 0.3]),
    }
    keep = ["bar.x_cm", "bar.theta", "bar.w_T", "bar.heat", "bar.heat_swing"]
    data = tribo.ensemble(scene, vary=values, keep=keep, method="verlet", step=STEP, seed=4)
    for member in range(3):
        gammas, temperatures = (
            [values[f"bar.langevin.{on}.{name}"][member] for on in ("bar", "swing")]
            for name in ("gamma", "temperature")
        )
        own = replace(
            scene,
            surfaces=[surface(gammas, temperatures, n=3)],
            seed=int(data.seed[member]),
        )
        table = tribo.simulate(own, method="verlet", step=STEP)["bar"]
        for name in keep:
            found = data[name].values[member]
            assert found == pytest.approx(table[name.removeprefix("bar.")][-1], rel=1e-9), name


def test_means_of_both_heats():
    """The heat on the swing is among the series of an ensemble, summed over the surface."""
    scene = Scene([surface((3.0, 2.0), (0.3, 0.1), n=3)], [], 2.0, output=Output(samples=3))
    data = tribo.ensemble(scene, 3, method="verlet", step=STEP, seed=4)
    for member in range(3):
        own = replace(scene, seed=int(data.seed[member]))
        table = tribo.simulate(own, method="verlet", step=STEP)["bar"]
        for name in ("heat", "heat_swing"):
            found = data[f"bar.{name}"].values[member]
            assert found == pytest.approx(getattr(table, name).sum(axis=1), rel=1e-9), name
    assert np.ptp(data["bar.heat_swing_mean"].values) > 0.0


def test_scene_files_and_keys():
    """A list of tables is written and read."""
    part = surface((3.0, 2.0), (0.3, 0.1))
    scene = Scene([part], [], 1.0)
    assert scene_from(tomllib.loads(scene.to_toml())) == scene
    turned = replace(part, langevin=part.langevin[::-1])
    assert turned == part
    assert Surface("one", langevin=[{"gamma": 1.0}]).langevin == Langevin(1.0)
    assert Surface("one", langevin=[]).langevin is None


@pytest.mark.parametrize(
    ("langevin", "sentence"),
    [
        ([{"gamma": 1}, {"gamma": 2}], r'langevin\[1\].on: cannot be "bar" twice'),
        ([{"gamma": 1}, {"gamma": 0, "on": "swing"}], r"langevin\[1\].gamma: must be positive"),
    ],
)
def test_refused(langevin, sentence):
    """Two on one degree of freedom, or two of which one is absent."""
    with pytest.raises(InputError, match=sentence):
        Surface("one", langevin=langevin)


def test_keys_of_one_reservoir():
    """They do not say on what it acts, and those of two do."""
    two = Scene([surface((3.0, 2.0))], [], 1.0)
    one = Scene([Surface("bar", langevin=Langevin(1.0))], [], 1.0)
    with pytest.raises(InputError, match=r'did you mean "bar.langevin.bar.gamma"'):
        tribo.sweep(two, {"bar.langevin.gamma": [1.0]})
    with pytest.raises(InputError, match=r'did you mean "bar.langevin.gamma"'):
        tribo.sweep(one, {"bar.langevin.swing.gamma": [1.0]})
