"""A Prandtl-Tomlinson tip glides without friction on a weak corrugation and jumps on a strong one.

A bob moves in a corrugation -A cos(2 pi x / a); a spring k ties its bar to a stage that moves
slowly.  The bob feels two springs in series, the pulling spring and the torsion spring of its
pendulum,

    1/K = 1/k + length^2/kappa        (small swings: the rod is ten periods long)

and has several positions of equilibrium if the curvature of the corrugation exceeds K:

    eta = 4 pi^2 A / (K a^2) > 1.

For eta < 1 the work of a slow pull vanishes.  For eta > 1 every jump loses an energy that follows
from the equilibria, however slow the pull.  A reservoir at T = 0 takes the heat.

L. Prandtl, Z. angew. Math. Mech. 8 (1928) 85; G. A. Tomlinson, Phil. Mag. 7 (1929) 905.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

from tribo import Asperite, Output, Pulled, Scene, Surface, plotting, simulate
from tribo.model.fields import Corrugation, Field
from tribo.model.langevin import Langevin

# Amplitude [energy] and period [length] of the corrugation.
A = PERIOD = 1.0

# Wave number of the corrugation [rad / length], and length of the rod.
Q, ROD = 2.0 * np.pi / PERIOD, 10.0 * PERIOD

ETAS = np.array([0.4, 0.7, 0.9, 1.0, 1.1, 1.3, 1.6, 2.0, 2.5, 3.0, 3.5, 4.0])

# Speeds of the stage [length / time].
FAST, SLOW = 0.02, 0.002

# Samples in each of the three periods of the pull.
SAMPLES = 400


def pull(eta, speed, damping=1.0):
    """Positions of the stage, pulling forces, and the work of the pull in the last period."""
    K = Q**2 * A / eta
    k, kappa = 2.0 * K, 2.0 * K * ROD**2
    tip = Surface(
        "tip",
        asperite=Asperite(m1=1.0, m2=1.0, length=ROD, kappa=kappa),
        drive=Pulled(stiffness=k, speed=speed),
        langevin=Langevin(gamma=damping * np.sqrt(K)),  # at rest
    )
    corrugation = Field(Corrugation(A, PERIOD), on=["tip"])
    output = Output(samples=3 * SAMPLES + 1)
    scene = Scene([tip], [], 3.0 * PERIOD / abs(speed), fields=[corrugation], output=output)
    result = simulate(scene, accuracy=1e-4)
    stage, work = speed * result.t, result["tip"].w2[:, 0]
    return stage, k * (stage - result["tip"].x_bar[:, 0]), work[-1] - work[-1 - SAMPLES]


def jump_energy(eta):
    """Energy that is lost in every period of an infinitely slow pull."""
    if eta <= 1.0:
        return 0.0
    K, edge = Q**2 * A / eta, np.arccos(-1.0 / eta) / Q  # where the equilibrium ends
    stage = edge + Q * A / K * np.sin(Q * edge)
    target = brentq(lambda x: K * (stage - x) - Q * A * np.sin(Q * x), PERIOD - edge, PERIOD + edge)
    before, after = (0.5 * K * (stage - x) ** 2 - A * np.cos(Q * x) for x in (edge, target))
    return before - after


def draw(path, works):
    """Draw loops of force against position of the stage, and work in a period against eta."""
    blue, red, ink = "#0b62a4", "#d55e00", plotting.INK
    with plotting.style():
        figure = Figure(figsize=(6.9, 2.7), layout="constrained")
        left, right = figure.subplots(1, 2)
        for eta, colour in ((0.7, blue), (4.0, red)):
            x = np.linspace(0.0, 5.0, 2000) * PERIOD
            left.plot(x + eta / Q * np.sin(Q * x), np.sin(Q * x), ":", lw=0.7, color=colour)
            for speed, shift in ((SLOW, 0.0), (-SLOW, 4.0 * PERIOD)):
                stage, force, _ = pull(eta, speed)
                (line,) = left.plot(stage + shift, force / (Q * A), color=colour)
            line.set_label(rf"$\eta = {eta}$")
        left.set(xlim=(PERIOD, 3.0 * PERIOD), ylim=(-1.4, 1.4), xlabel="stage position $/a$")
        left.set(xticks=np.arange(1.0, 3.1, 0.5), ylabel=r"pulling force $/\,(2\pi A/a)$")
        fine = np.linspace(ETAS[0], ETAS[-1], 500)
        right.plot(fine, [jump_energy(eta) / A for eta in fine], color=red, label="equilibria")
        for (speed, work), fill in zip(works.items(), ("none", ink), strict=True):
            right.plot(ETAS, work / A, "o", ms=3.5, mfc=fill, color=ink, label=f"speed {speed}")
        right.set(xlabel=r"$\eta$", ylabel="work in a period $/A$")
        left.legend(loc="upper center", ncols=2, frameon=False)
        right.legend(frameon=False)
    plotting.save(figure, path)


def main(folder=None):
    """Compute the work in a period below and above eta = 1, by slow pulls and by equilibria."""
    works = {v: np.array([pull(eta, v)[2] for eta in ETAS]) for v in (FAST, SLOW)}
    if folder is not None:
        draw(Path(folder) / "stick_slip.png", works)
    slow = dict(zip(ETAS, works[SLOW], strict=True))
    numbers = {f"work in a period, eta = {eta}": slow[eta] for eta in (0.7, 4.0)}
    return numbers | {
        f"the same by equilibria, eta = {eta}": jump_energy(eta) for eta in (0.7, 4.0)
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:40} {value:.6g}")
