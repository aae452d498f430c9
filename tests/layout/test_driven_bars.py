"""Where driven bars start: the bar is the reference, whatever the initial angle and its mass."""

import math
from dataclasses import replace

import ase.io
import numpy as np
import pytest

import tribo
from tribo import Asperite, DrivenBars, Free, Initial, Morse, Output, Scene, Springs, Surface
from tribo.export import to_lammps

EQUAL_STEPS = {"method": "verlet", "step": 0.01}
ANGLES = (0.3, -0.2)
# With each of them bars are the reference; two rows whose springs are at rest, and bars that turn.
KINDS = {
    "alone": {},
    "springs": {"springs": Springs(1.5)},
    "turning": {"bars": "free"},
}


def sliding(m2=2.0, upper=None, lower=None, **settings):
    """Two asperites pass over one, on bars of a mass; the initial values are settings."""
    row = {"shape": (2, 1), "spacing": (1.1, 0.0)}
    common = {"drive": DrivenBars(), "asperite": Asperite(m2=m2)} | settings
    surfaces = (
        Surface("upper", bob=(-1.5, 0.6), velocity=(0.5, 0.0), **row, **common, **upper or {}),
        Surface("lower", facing="up", **common, **lower or {}),
    )
    scene = Scene(surfaces, Morse(D=0.1, alpha=2.0, r0=0.5), 2.0, output=Output(samples=5))
    return replace(scene, seed=3)


def paths(result):
    """Where all bobs and bars are at all times."""
    names = "x_bob", "y_bob", "x_bar", "y_bar", "theta"
    return np.hstack([result[surface][name] for surface in ("upper", "lower") for name in names])


@pytest.mark.parametrize("kind", KINDS)
def test_bar_masses_change_no_motion(kind):
    """Both bars start over the resting bobs, and the bobs a rod away at the initial angles."""
    start = {"upper": {"initial": Initial(theta=ANGLES)}, "lower": {"initial": Initial(swing=0.4)}}
    runs = [
        tribo.simulate(sliding(m2, **start, **KINDS[kind]), **EQUAL_STEPS) for m2 in (0.5, 2.0, 8.0)
    ]
    for result in runs[1:]:
        assert paths(result) == pytest.approx(paths(runs[0]), abs=1e-12)
    upper, lower = (runs[1][name] for name in ("upper", "lower"))
    assert upper.x_bar[0] == pytest.approx([-1.5, -0.4])
    assert upper.y_bar[0] == pytest.approx([2.6, 2.6])
    assert upper.x_bob[0] == pytest.approx([-1.5, -0.4] + 2.0 * np.sin(ANGLES))
    assert upper.y_bob[0] == pytest.approx(2.6 - 2.0 * np.cos(ANGLES))
    assert [lower.x_bar[0, 0], lower.y_bar[0, 0]] == pytest.approx([0.0, -2.0])
    assert lower.x_bob[0] == pytest.approx(-2.0 * math.sin(0.4))
    # The velocity of the centre of mass is that of the bar and l2 omega along the swing.
    l2 = 2.0 / 3.0
    assert upper.vx_cm == pytest.approx(0.5 + l2 * upper.omega * np.cos(upper.theta))
    assert upper.vy_cm == pytest.approx(l2 * upper.omega * np.sin(upper.theta))


@pytest.mark.parametrize("kind", KINDS)
def test_angles_in_every_way(kind):
    """By the scene, a prepared run, members in lanes and one by one: the same motion."""

    def alone(angles):
        scene = sliding(upper={"initial": Initial(theta=angles)}, **KINDS[kind])
        return tribo.simulate(scene, **EQUAL_STEPS)

    plain = sliding(**KINDS[kind])
    started = tribo.prepare(plain, **EQUAL_STEPS).run({"upper.theta": ANGLES})
    assert np.array_equal(paths(started), paths(alone(ANGLES)))
    vary = {"upper.theta": np.array([ANGLES, (0.0, 0.0), (-0.1, 0.2)])}
    keep = ("upper.x_bob", "upper.y_bob", "upper.x_bar")
    for masses in ({}, {"upper.asperite.m2": np.array([2.0, 0.5, 8.0])}):
        data = tribo.ensemble(plain, 3, vary | masses, keep=keep, **EQUAL_STEPS)
        for m, angles in enumerate(vary["upper.theta"]):
            expected = alone(angles)["upper"]
            for name in keep:
                found = data[name].values[m]
                last = expected[name.removeprefix("upper.")][-1]
                assert np.ravel(found) == pytest.approx(last, abs=1e-12)


def test_drawn_angles_are_those_given_by_number():
    """A thermal start continues as that of the angles and rates that it has drawn."""
    warm = sliding(upper={"initial": Initial(temperature=0.1)})
    drawn = tribo.simulate(warm, **EQUAL_STEPS)
    first = {name: drawn["upper"][name][0] for name in ("theta", "omega")}
    assert np.all(first["theta"] != 0.0)
    given = tribo.simulate(sliding(upper={"initial": Initial(**first)}), **EQUAL_STEPS)
    assert paths(given) == pytest.approx(paths(drawn), abs=1e-13)


@pytest.mark.parametrize("facing", ["down", "up"])
@pytest.mark.parametrize("m2", [0.5, 8.0])
def test_swings_at_the_frequency_of_a_pendulum_on_its_bar(facing, m2):
    """sqrt(kappa / (m1 length^2)), about the bar's place, whatever the bar's mass."""
    asperite = Asperite(m1=0.7, m2=m2, kappa=3.0, length=1.3)
    driven = {"drive": DrivenBars(), "asperite": asperite, "velocity": (0.25, 0.5)}
    surface = Surface("a", facing=facing, bob=(0.2, 0.1), initial=Initial(swing=0.2), **driven)
    scene = Scene([surface], [], 20.0, output=Output(samples=41))
    result = tribo.simulate(scene, method="verlet", step=0.02)
    swing = 0.2 * np.cos(math.sqrt(3.0 / (0.7 * 1.3**2)) * result.t)
    sign = 1.0 if facing == "down" else -1.0
    bar = 0.2 + 0.25 * result.t, 0.1 + sign * 1.3 + 0.5 * result.t
    assert result["a"].x_bar[:, 0] == pytest.approx(bar[0], abs=1e-12)
    assert result["a"].y_bar[:, 0] == pytest.approx(bar[1], abs=1e-12)
    assert result["a"].x_bob[:, 0] == pytest.approx(bar[0] + sign * 1.3 * np.sin(swing), abs=1e-7)
    assert result["a"].y_bob[:, 0] == pytest.approx(bar[1] - sign * 1.3 * np.cos(swing), abs=1e-7)


def test_equilibria_and_exported_atoms_have_the_same_bars(tmp_path):
    """A relaxed scene forgets its initial angles; atoms of LAMMPS start at the bobs."""
    turned = {"upper": {"initial": Initial(theta=ANGLES)}, "lower": {"initial": Initial(swing=0.4)}}
    states = [tribo.relax(sliding(m2, **start)) for m2, start in ((2.0, {}), (8.0, turned))]
    for name in ("upper", "lower"):
        swings = [state.surfaces[name]["swing"] for state in states]
        assert swings[0] == pytest.approx(swings[1], abs=1e-7)
    scene = sliding(**turned)
    result = tribo.simulate(scene, **EQUAL_STEPS)
    atoms = ase.io.read(to_lammps(scene, tmp_path).data, format="lammps-data")
    for axis, name in enumerate(("x_bob", "y_bob")):
        bobs = np.hstack([result[surface][name][0] for surface in ("upper", "lower")])
        assert atoms.positions[:, axis] == pytest.approx(bobs)


def test_other_drives_keep_their_centres_of_mass():
    """Bars of free asperites start displaced, so that the centres of mass are over the bobs."""
    start = {"initial": Initial(theta=ANGLES)}
    result = tribo.simulate(sliding(drive=Free(), upper=start), **EQUAL_STEPS)["upper"]
    assert result.x_cm[0] == pytest.approx([-1.5, -0.4])
    assert result.x_bar[0] == pytest.approx([-1.5, -0.4] - 2.0 / 3.0 * np.sin(ANGLES))
