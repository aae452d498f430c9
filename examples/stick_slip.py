"""Stick-slip: where the Prandtl-Tomlinson tip stops gliding and begins to jump.

A bob rides on a corrugation -A cos(2 pi x / a); its bar hangs on a spring k to a stage that creeps
along.  The bob feels two springs in series, the pull and the torsion of its own pendulum,

    1/K = 1/k + length^2/kappa        (small swings: the rod is ten periods long)

and has several places of rest for one of the stage once the corrugation is more curved than K:

    eta = 4 pi^2 A / (K a^2) > 1.

Below, slow enough a pull costs nothing; above, every jump costs what the statics say, however
slow the pull.  A reservoir at T = 0 takes up the heat.

L. Prandtl, Z. angew. Math. Mech. 8 (1928) 85; G. A. Tomlinson, Phil. Mag. 7 (1929) 905.
"""

from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from tribo import Asperite, Output, Pulled, Scene, Surface, plotting, simulate
from tribo.fields import Corrugation, Field
from tribo.langevin import Langevin

A, PERIOD, ROD = 1.0, 1.0, 10.0
Q = 2.0 * np.pi / PERIOD
ETAS = np.array([0.4, 0.7, 0.9, 1.0, 1.1, 1.3, 1.6, 2.0, 2.5, 3.0, 3.5, 4.0])
FAST, SLOW = 0.02, 0.002  # speeds of the stage
SAMPLES = 400  # in each of the three periods pulled


def tip(eta, speed, damping=1.0):
    """One asperite on the corrugation; pull and torsion have half of the compliance 1/K each."""
    K = Q**2 * A / eta
    surface = Surface(
        "tip",
        asperite=Asperite(m1=1.0, m2=1.0, length=ROD, kappa=2.0 * K * ROD**2),
        drive=Pulled(stiffness=2.0 * K, speed=speed),
        langevin=Langevin(gamma=damping * np.sqrt(K)),  # at rest, as the surface is at first
    )
    field = Field(Corrugation(A, PERIOD), on=["tip"])
    output = Output(samples=3 * SAMPLES + 1)
    return Scene([surface], [], 3.0 * PERIOD / abs(speed), fields=[field], output=output)


def pull(eta, speed, damping=1.0):
    """Stage positions, pulling forces, and the work of the pull in the last period."""
    scene = tip(eta, speed, damping)
    result = simulate(scene, accuracy=1e-4)
    stage, series = speed * result.t, result["tip"]
    force = scene.surfaces[0].drive.stiffness * (stage - series.x_bar[:, 0])
    return stage, force, series.w2[-1, 0] - series.w2[-1 - SAMPLES, 0]


def cost_of_a_jump(eta):
    """The energy that an infinitely slow stage loses in every period."""
    if eta <= 1.0:
        return 0.0
    K, edge = Q**2 * A / eta, np.arccos(-1.0 / eta) / Q  # where the place of rest ends
    stage = edge + Q * A / K * np.sin(Q * edge)
    target = brentq(lambda x: K * (stage - x) - Q * A * np.sin(Q * x), PERIOD - edge, PERIOD + edge)
    before, after = (0.5 * K * (stage - x) ** 2 - A * np.cos(Q * x) for x in (edge, target))
    return before - after


def draw(path, works):
    """Left the loops of force against stage, right the work in a period against eta."""
    blue, red = (plotting.WORKS[name][1] for name in ("w1", "w2"))
    with plotting.style():
        left, right = plotting.panels(1, 2)
        figure.savefig(path)
