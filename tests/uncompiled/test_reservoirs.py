"""Reservoirs, drag and torsional baths, against closed forms."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.linalg import expm

import tribo
from support.scene_tables import scene_from
from support.uncompiled.ledger import ALL, simulate
from support.uncompiled.scenes import COULOMB, LOWER
from support.uncompiled.start import start_of

WEAK = COULOMB | {"strength": 1e-15}


@pytest.mark.parametrize(
    ("method", "step", "tolerance"), [("gauss-8", 0.2, 1e-8), ("kahan-li-6", 0.1, 1e-6)]
)
def test_torsional_oscillators(method, step, tolerance):
    """A bar with torsional oscillators and its pendulum, without other forces, is linear."""
    surface = ALL["twisting"]["surface"][1]
    table = ALL["twisting"] | {"interaction": WEAK}
    run = simulate(table, method=method, step=step)["lower"]
    a = surface["asperite"]
    initial = surface["initial"]
    mass = a["m1"] * a["m2"] / (a["m1"] + a["m2"])
    springs = [(o["inertia"], o["frequency"]) for o in surface["bath"]["torsional"]]
    inertia = np.array([mass * a["length"] ** 2, a["i2"], *(i for i, _ in springs)])
    stiffness = np.zeros((4, 4))
    ties = [(0, 1, a["kappa"]), *((2 + n, 1, i * w * w) for n, (i, w) in enumerate(springs))]
    for one, other, k in ties:
        stiffness[[one, other], [one, other]] += k
        stiffness[[one, other], [other, one]] -= k
    x = np.array([initial["theta"] - np.pi, *3 * [initial["phi"]]])
    v = np.array([initial["omega"], initial["nu"], 0.0, 0.0])
    generator = np.zeros((8, 8))
    generator[:4, 4:] = np.eye(4)
    generator[4:, :4] = -stiffness / inertia[:, None]
    end = expm(generator) @ np.concatenate([x, v])
    found = [run[q][-1, 0] for q in ("theta", "phi", "omega", "nu")]
    truth = [end[0] + np.pi, end[1], end[4], end[5]]
    assert np.allclose(found, truth, 0.0, tolerance)


ON_BAR = {"gamma": 4.0, "temperature": 0.5}
ON_SWING = {"gamma": 3.0, "temperature": 0.2, "on": "swing"}


@pytest.mark.parametrize("reservoirs", [[ON_BAR], [ON_SWING], [ON_BAR, ON_SWING]])
def test_thermal_kicks(reservoirs):
    """Reservoirs on bars and swings give pendulums at rest the covariance of linear friction."""
    count = 1000
    step = 0.1
    asperite = LOWER["asperite"] | {"kappa": 0.0}
    surface = {
        "name": "upper",
        "asperite": asperite,
        "shape": [count, 1],
        "spacing": [1.0, 0.0],
        "drive": "free",
        "initial": {"theta": 0.7},
        "langevin": reservoirs,
    }
    far = LOWER | {"depth": 10.0}
    table = {"duration": step, "interaction": WEAK, "surface": [surface, far]}
    run = simulate(table | {"output": {"samples": 2}}, method="verlet", step=step)
    vx, vy, omega = (run["upper"][name][-1] for name in ("vx_cm", "vy_cm", "omega"))
    # At the kick, with half a step of rest before and after.
    tx = np.cos(0.7)
    ty = np.sin(0.7)
    found = np.array([tx * vx + ty * vy, tx * vy - ty * vx, omega])
    expected = covariance(reservoirs, step, *(asperite[name] for name in ("m1", "m2", "length")))
    deviation = np.sqrt(np.diag(expected)) + 1e-12  # of the weak contact
    assert np.all(abs(np.mean(found, axis=1)) <= 5.0 * deviation / np.sqrt(count))
    off = abs(found @ found.T / count - expected)
    assert np.all(off <= 5.0 * np.sqrt(2.0 / count) * np.outer(deviation, deviation))


def covariance(reservoirs, step, m1, m2, length):
    """Of three velocities after a step: the integral of exp(-A t) Q exp(-A^T t).

    Of the velocity v of the centre of mass along the arc, across it, and of the rate omega: with
    the force F = -gamma (v - l2 omega) + noise on the bar, M v' = F and I omega' = -l2 F + T, where
    T = -gamma omega + noise is the torque of a reservoir on the swing.
    """
    l2 = length * m1 / (m1 + m2)
    inverse = np.diag([1.0 / (m1 + m2), 1.0 / (m1 + m2), (m1 + m2) / (m1 * m2 * length**2)])
    friction, noise = np.zeros((2, 3, 3))
    for reservoir in reservoirs:
        arms = np.array([[1.0, 0.0, -l2], [0.0, 1.0, 0.0]])
        if reservoir.get("on") == "swing":
            arms = np.array([[0.0, 0.0, 1.0]])
        friction += reservoir["gamma"] * arms.T @ arms
        noise += 2.0 * reservoir["gamma"] * reservoir["temperature"] * arms.T @ arms
    a = inverse @ friction
    q = inverse @ noise @ inverse
    both = expm(step * np.block([[-a, q], [np.zeros((3, 3)), a.T]]))  # after van Loan
    return both[:3, 3:] @ both[:3, :3].T


@pytest.mark.parametrize("method", ["midpoint", "verlet"])
def test_friction(method):
    """A short step changes the momentum by -gamma (velocity of the bar - that of the reservoir)."""
    step = 1e-4
    table = ALL["open"] | {"duration": step, "field": [], "interaction": WEAK}
    start = start_of(table)
    run = simulate(table, method=method, step=step)
    for surface, part in zip(table["surface"], start.parts, strict=True):
        reservoir = surface["langevin"]
        slip = start.bar_velocity[:, part] - np.array(reservoir["velocity"])[:, None]
        wanted = -reservoir["gamma"] * slip / start.mass[part]
        own = run[surface["name"]]
        found = np.array([np.diff(own[q], axis=0)[0] for q in ("vx_cm", "vy_cm")]) / step
        if surface["name"] == "lower":  # which its drive keeps at its velocity along x
            found[0] = 0.0
            wanted[0] = 0.0
        assert np.allclose(found, wanted, 0.0, 1e-3), surface["name"]


class DraggedByHand(NamedTuple):
    """The free drive with the friction of a reservoir, as a plug-in."""

    gamma: float
    x: float  # velocity of the reservoir
    y: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """f2."""
        return -self.gamma * (vx - self.x), -fy - self.gamma * (vy - self.y)


# Verlet kicks with the drive and with the reservoir in two ways, of second order.
@pytest.mark.parametrize(("method", "tolerance"), [("midpoint", 1e-12), ("verlet", 5e-5)])
def test_drag(method, tolerance):
    """A drive that is friction moves the surfaces as a reservoir does."""
    upper, lower = ALL["open"]["surface"]
    scene = scene_from(ALL["open"] | {"field": [], "surface": [upper, lower | {"drive": "free"}]})
    by_hand = replace(scene, surfaces=tuple(map(dragged, scene.surfaces)))
    one, other = (tribo.simulate(s, method=method, step=0.05) for s in (scene, by_hand))
    for name in ("upper", "lower"):
        for quantity in ("theta", "omega", "x_cm", "y_cm", "vx_cm", "vy_cm"):
            values = one[name][quantity]
            assert np.allclose(values, other[name][quantity], 0, tolerance), f"{name}: {quantity}"


def dragged(surface):
    """The surface without its reservoir, and with a drive instead."""
    drag = DraggedByHand(surface.langevin.gamma, *surface.langevin.velocity)
    return replace(surface, langevin=None, drive=tribo.Custom(force=drag))
