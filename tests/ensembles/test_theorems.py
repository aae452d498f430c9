"""Theorems of statistical mechanics as tests of the code, and dynamics for which they fail.

No force on swings depends on a rate, so the flow of angles and rates preserves volume.  Then the
mean of exp(-w / T) is 1 over starts at the temperature T, where w is the gain of energy, whatever
the coupling, at every time (Bochkov and Kuzovlev; Jarzynski).
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import tribo
from support.gibbs import MOST, TEMPERATURE, deviation, gain, rows
from tribo import paper


class Dragged(NamedTuple):
    """f2 = -f1 with a drag on the velocity of the bar, which contracts volumes."""

    gamma: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        return -fx - self.gamma * (vx - 0.5), -fy


FORCED, DRIVEN = rows(), rows(drive=tribo.DrivenBars())
STEPS = {"method": "verlet", "step": 0.02}


@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        pytest.param(rows((1, 1)), {}, id="a pair"),
        pytest.param(rows((1, 1), tribo.DrivenBars()), {}, id="a pair on driven bars"),
        pytest.param(FORCED, STEPS, id="verlet"),
        pytest.param(DRIVEN, STEPS, id="verlet, driven bars"),
        *(
            pytest.param(FORCED, {"method": name, "step": 0.02}, id=name, marks=pytest.mark.slow)
            for name in ("rk4", "kahan-li-6")
        ),
    ],
)
def test_integral_theorem(scene, settings):
    """Methods, drives, several asperites; bobs are in contact at the end."""
    w = gain(scene, 4096, **settings)
    assert abs(deviation(np.exp(-w / TEMPERATURE))) < MOST
    assert np.std(w) > 0.1 and w.mean() > -3.0 * w.std() / 64.0


def test_a_velocity_that_is_not_drawn_breaks_the_theorem():
    """A free surface has a velocity beside its swing, which is not from a Gibbs start."""
    w = gain(rows((1, 1), tribo.Free()), 4096)
    assert abs(deviation(np.exp(-w / TEMPERATURE))) > 2.0 * MOST


@pytest.mark.slow
def test_a_drag_breaks_the_theorem():
    """Bars that a user's force slows contract volumes."""
    scene = rows((1, 1))
    for gamma, broken in ((0.0, False), (0.3, True)):
        drive = tribo.Custom(force=Dragged(gamma))
        surfaces = tuple(replace(s, drive=drive) for s in scene.surfaces)
        w = gain(replace(scene, surfaces=surfaces), 2048, method="rk4", step=0.02)
        assert (abs(deviation(np.exp(-w / TEMPERATURE))) > 2.0 * MOST) == broken


def test_detailed_theorem():
    """Case A from -D to +D is its own mirror image with time reversed: the slope is 1."""
    scene = replace(paper.scene("A"), numerics=tribo.Numerics(accuracy=1e-6))
    w = gain(scene, 8192) / TEMPERATURE
    both = (w < 0.0) - np.where(w > 0.0, np.exp(-w), 0.0)
    assert abs(both.mean() / both.std() * np.sqrt(w.size)) < MOST
    # A start that never gets beyond the other bob has another mirror image.
    half = gain(replace(scene, duration=21.0), 8192) / TEMPERATURE
    both = (half < 0.0) - np.where(half > 0.0, np.exp(-half), 0.0)
    assert abs(both.mean() / both.std() * np.sqrt(w.size)) > 2.0 * MOST


def test_two_temperatures():
    """Unlike pendulums: both theorems hold for the sum of gains over their own temperatures."""
    scene = replace(paper.scene("A"), numerics=tribo.Numerics(accuracy=1e-6))
    upper, lower = scene.surfaces
    light = tribo.Asperite(m1=0.6, m2=1.7, kappa=1.1, length=1.6)
    scene = replace(scene, surfaces=(replace(upper, asperite=light), lower))
    temperatures = {"upper": 3.0, "lower": 1.0}
    starts = {f"{k}.swing_state": tribo.Canonical(value) for k, value in temperatures.items()}
    keep = [f"{k}.delta_e_int" for k in temperatures]
    data = tribo.ensemble(scene, 8192, starts, seed=2, keep=keep)
    gains = np.array([data[name].values[:, 0] for name in keep])
    own, exchanged = gains[0] / 3.0 + gains[1], gains[0] + gains[1] / 3.0
    assert abs(deviation(np.exp(-own))) < MOST
    missed = []
    for w in (own, exchanged):
        both = (w < 0.0) - np.where(w > 0.0, np.exp(-w), 0.0)
        missed.append(abs(both.mean() / both.std() * np.sqrt(w.size)))
    assert missed[0] < MOST and missed[1] > 2.0 * MOST


def test_jarzynski_of_dragged_tips():
    """Prandtl-Tomlinson tips, from equilibrium with their springs, dragged by one period.

    The work is that of the stage, the pull's force times its speed.  The work of the pull at the
    bar, w2, leaves out the energy of the spring and fails.
    """
    period, height, stiffness, speed, temperature, count = 1.0, 0.4, 2.0, 2.0, 2.0, 20_000
    x = np.linspace(-12.0, 12.0, 8001)
    energy = 0.5 * stiffness * x**2 - height * np.cos(2.0 * np.pi * x / period)
    weights = np.exp(-energy / temperature)
    rng = np.random.default_rng(3)
    start = np.interp(rng.random(count), np.cumsum(weights) / weights.sum(), x)
    tips = tribo.Surface(
        "tips",
        shape=(count, 1),
        spacing=(period, 0.0),
        drive=tribo.Pulled(stiffness=stiffness, speed=speed),
        asperite=tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf),
        initial=tribo.Initial(x=start, vx=rng.normal(0.0, np.sqrt(temperature), count)),
    )
    field = tribo.Field(tribo.Corrugation(height, period), on=("tips",))
    scene = tribo.Scene((tips,), (), period / speed, fields=(field,))
    end = tribo.simulate(scene, method="verlet", step=0.005)["tips"]
    moved = end.x_bar[-1] - end.x_bar[0]
    pull = end.w2[-1]
    stage = pull + 0.5 * stiffness * ((start + moved - period) ** 2 - start**2)
    assert abs(deviation(np.exp(-stage / temperature))) < MOST
    assert abs(deviation(np.exp(-pull / temperature))) > 2.0 * MOST
