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
FAST, SLOW = 0.02, 0.001  # speeds of the stage
SAMPLES = 400  # in each of the three periods pulled


def tip(eta, speed, share=0.5, damping=1.0):
    """One asperite on the corrugation; the torsion spring has `share` of the compliance 1/K."""
    K = Q**2 * A / eta
    surface = Surface(
        "tip",
        asperite=Asperite(m1=1.0, m2=1.0, length=ROD, kappa=K * ROD**2 / share),
        drive=Pulled(stiffness=K / (1.0 - share), speed=speed),
        langevin=Langevin(gamma=damping * np.sqrt(K), velocity=(0.0, 0.0)),
    )
    field = Field(Corrugation(A, PERIOD), on=["tip"])
    output = Output(samples=3 * SAMPLES + 1)
    return Scene([surface], [], 3.0 * PERIOD / abs(speed), fields=[field], output=output)


def pull(eta, speed):
    """Stage positions, pulling forces, and the work of the pull in the last period."""
    scene = tip(eta, speed)
    result = simulate(scene, accuracy=1e-5)
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


def draw(path, loops, works):
    """Left the loops of force against stage, right the work in a period against eta."""
    from matplotlib.figure import Figure

    with plotting.style():
        figure = Figure(figsize=(6.9, 2.7), layout="constrained")
        left, right = figure.subplots(1, 2)
        blue, red = (plotting.WORKS[name][1] for name in ("w1", "w2"))
        for (eta, (forth, back)), colour in zip(loops.items(), (blue, red), strict=True):
            x = np.linspace(0.0, 5.0 * PERIOD, 2000)
            left.plot(x + eta / Q * np.sin(Q * x), np.sin(Q * x), ":", lw=0.7, color=colour)
            left.plot(forth[0], forth[1] / (Q * A), color=colour, label=rf"$\eta = {eta}$")
            left.plot(back[0] + 4.0 * PERIOD, back[1] / (Q * A), color=colour)
        left.set(xlim=(PERIOD, 3.0 * PERIOD), ylim=(-1.35, 1.35), xlabel="stage position $/a$")
        left.set_ylabel(r"pulling force $/\,(2\pi A/a)$")
        left.legend(loc="upper center", ncols=2, frameon=False)
        fine = np.linspace(ETAS[0], ETAS[-1], 500)
        right.plot(fine, [cost_of_a_jump(eta) / A for eta in fine], color=red, label="statics")
        for (speed, work), fill in zip(works.items(), ("none", plotting.INK), strict=True):
            label = f"stage speed {speed}"
            right.plot(ETAS, work / A, "o", ms=3.5, mfc=fill, color=plotting.INK, label=label)
        right.axvline(1.0, color="0.6", lw=0.5, zorder=0)
        right.set(xlabel=r"$\eta$", ylabel="work in a period $/A$")
        right.legend(frameon=False)
        figure.savefig(path)


def main(folder=None):
    """Work in a period on either side of eta = 1, and how far it is from the statics."""
    works = {v: np.array([pull(eta, v)[2] for eta in ETAS]) for v in (FAST, SLOW)}
    if folder is not None:
        loops = {eta: [pull(eta, v) for v in (SLOW, -SLOW)] for eta in (0.7, 4.0)}
        draw(Path(folder) / "stick_slip.png", loops, works)
    slow = dict(zip(ETAS, works[SLOW], strict=True))
    return {
        "work in a period, eta = 0.7": slow[0.7],
        "the same at a speed of 0": cost_of_a_jump(0.7),
        "work in a period, eta = 4": slow[4.0],
        "the same by statics": cost_of_a_jump(4.0),
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:40} {value:.6g}")
