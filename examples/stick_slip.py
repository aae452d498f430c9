"""A Prandtl-Tomlinson tip slides without friction on a weak corrugation and jumps on a strong one.

A bob moves in a corrugation -A cos(2 pi x / a); a spring k ties its bar to a stage that moves
slowly.  For a long rod the spring and the pendulum act in series, 1/K = 1/k + length^2/kappa.  The
bob can rest at several positions if eta = 4 pi^2 A / (K a^2) > 1.  For eta < 1 the work of a slow
pull vanishes.  For eta > 1 each jump dissipates the energy difference of two equilibria.  The
reservoir moves with the stage, so it adds no drag to the mean force.

L. Prandtl, Z. angew. Math. Mech. 8 (1928) 85; G. A. Tomlinson, Phil. Mag. 7 (1929) 905.
"""

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

import tribo

# Amplitude [energy], wave number [rad / length] for a period of 1, and length of the rod.
A, Q, ROD = 1.0, 2.0 * np.pi, 10.0
ETAS, SAMPLES = np.array([0.7, 1.1, 1.6, 2.5, 4.0]), 400


def pull(eta, speed, damping=1.0):
    """Positions of the stage, forces, and the work of the pull in the last period."""
    K = Q**2 * A / eta
    k, asperite = 2.0 * K, tribo.Asperite(m1=1.0, m2=1.0, length=ROD, kappa=2.0 * K * ROD**2)
    reservoir = tribo.Langevin(damping * np.sqrt(K), velocity=(speed, 0.0))
    drive = tribo.Pulled(stiffness=k, speed=speed)
    tip = tribo.Surface("tip", asperite=asperite, drive=drive, langevin=reservoir)
    corrugation = tribo.Field(tribo.Corrugation(A, 2.0 * np.pi / Q), on=["tip"])
    output = tribo.Output(samples=3 * SAMPLES + 1)
    scene = tribo.Scene([tip], [], 3.0 / abs(speed), fields=[corrugation], output=output)
    result = tribo.simulate(scene, accuracy=1e-4)
    stage, work = speed * result.t, result["tip"].w2[:, 0]
    return stage, k * (stage - result["tip"].x_bar[:, 0]), work[-1] - work[-1 - SAMPLES]


def jump_energy(eta):
    """Energy that an infinitely slow pull loses in every period."""
    if eta <= 1.0:
        return 0.0
    K, edge = Q**2 * A / eta, np.arccos(-1.0 / eta) / Q  # where the equilibrium ends
    stage = edge + Q * A / K * np.sin(Q * edge)
    target = brentq(lambda x: K * (stage - x) - Q * A * np.sin(Q * x), 1.0 - edge, 1.0 + edge)
    before, after = (0.5 * K * (stage - x) ** 2 - A * np.cos(Q * x) for x in (edge, target))
    return before - after


def main(folder="."):
    """Work in a period for the smallest eta, and relative to a jump for the largest."""
    pulls = [pull(eta, speed=0.002) for eta in ETAS]
    works, fine = np.array([each[2] for each in pulls]), np.linspace(0.4, ETAS[-1], 500)
    with tribo.plotting.style():
        figure = Figure(figsize=(tribo.plotting.PAGE, 2.5), layout="constrained")
        saw, loss = figure.subplots(1, 2)
        for k in (-1, 0):
            saw.plot(pulls[k][0], pulls[k][1] / (Q * A), label=rf"$\eta = {ETAS[k]}$")
        saw.set(xlabel="stage / $a$", ylabel=r"pull / $(2\pi A/a)$", xlim=(0, 3), ylim=(-1.2, 1.5))
        saw.legend(ncol=2)
        loss.plot(
            fine, [jump_energy(eta) / A for eta in fine], color="#d55e00", label="closed form"
        )
        loss.plot(ETAS, works / A, "o", ms=4, color=tribo.plotting.INK, label="simulation")
        loss.set(xlabel=r"$\eta$", ylabel="work in a period / $A$")
        loss.legend()
    tribo.plotting.save(figure, f"{folder}/stick_slip.png")
    return {"work for eta = 0.7": works[0], "work / jump for eta = 4": works[-1] / jump_energy(4.0)}


if __name__ == "__main__":
    print(main())
