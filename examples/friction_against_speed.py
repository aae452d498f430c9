"""Friction of a warm tip grows with its speed as Kramers' rate of escape predicts.

At a temperature T, noise carries a pulled tip over a barrier before the barrier vanishes; a slower
pull leaves the noise more time.  Kramers' rate of escape at each position of the stage gives the
mean loss in a slip.  Between successive speeds the friction grows by 0.094, 0.109 and 0.127
(2 pi A / a) per decade, faster than the logarithm.  The intervals of the simulation are too wide to
show this.  The reservoir moves with the stage, so it adds no drag.

E. Gnecco et al., Phys. Rev. Lett. 84 (2000) 1172; H. A. Kramers, Physica 7 (1940) 284.
"""

import numpy as np
from scipy.integrate import cumulative_simpson

import tribo
from tribo.results.averages import interval

# Corrugation of period 1 and curvature 1; pulling spring; damping of a mass of 1; temperature.
Q, A = 2.0 * np.pi, 1.0 / (2.0 * np.pi) ** 2
K, GAMMA, T = 1.0 / 3.0, 2.0, 0.1 * A
SPEEDS, TIP = (3e-5, 1e-4, 3e-4, 1e-3), tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf)


def friction(speed, tips=40):
    """Work of the stage in its third period: mean over tips, and its half-width."""
    drive, bath = tribo.Pulled(stiffness=K, speed=speed), tribo.Langevin(GAMMA, T, (speed, 0.0))
    tip = tribo.Surface("tip", shape=(tips, 1), asperite=TIP, drive=drive, langevin=bath)
    fields, output = [tribo.Field(tribo.Corrugation(A, 1.0), on=["tip"])], tribo.Output(samples=4)
    scene = tribo.Scene([tip], [], 3.0 / speed, fields=fields, output=output)
    work = tribo.simulate(scene, method="verlet", step=0.2)["tip"].w2
    return interval(work[-1] - work[-2])


def kramers(speed):
    """Mean loss in a slip: the loss at each stage X, by the probability of a slip there."""
    edge = np.arccos(-K) / Q  # where the equilibrium ends
    X, x = np.linspace(0.35, edge + A * Q / K * np.sin(Q * edge), 4000), []
    for ends in ((0.05, edge), (1.0 - edge, edge), (1.0 - edge, 1.2)):  # well, barrier, next well
        equilibria = np.linspace(*ends, 4000)
        stages = equilibria + A * Q / K * np.sin(Q * equilibria)
        x.append(np.interp(X, np.sort(stages), equilibria[np.argsort(stages)]))
    energy = [0.5 * K * (X - each) ** 2 - A * np.cos(Q * each) for each in x]
    well, top = (np.sqrt(np.abs(K + np.cos(Q * each))) for each in x[:2])
    rate = well / (2.0 * np.pi) * np.exp((energy[0] - energy[1]) / T)
    rate *= (np.sqrt(0.25 * GAMMA**2 + top**2) - 0.5 * GAMMA) / np.maximum(top, 1e-9)
    kept = np.exp(-cumulative_simpson(rate, x=X, initial=0.0) / speed)
    return (energy[0] - energy[2])[1:] @ -np.diff(np.append(kept[:-1], 0.0))


def main(folder="."):
    """Friction by simulation and by Kramers' rate, in units of the friction at T = 0."""
    found, half_width = np.transpose([friction(v) for v in SPEEDS]) / (Q * A)
    fine = np.geomspace(SPEEDS[0], SPEEDS[-1], 31)
    theory = np.array([kramers(v) for v in fine]) / (Q * A)
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.4)
        ax.semilogx(fine, theory, color="#d55e00", label="Kramers' rate")
        look = {"fmt": "o", "ms": 3, "capsize": 2, "color": tribo.plotting.INK}
        ax.errorbar(SPEEDS, found, half_width, label="simulation", **look)
        ax.set(xlabel="speed", ylabel=r"friction / $(2\pi A/a)$", ylim=(0.1, 0.32))
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/friction_against_speed.png")
    ratio = found / np.interp(SPEEDS, fine, theory)
    return {f"friction / Kramers at {v:g}": r for v, r in zip(SPEEDS, ratio, strict=True)}


if __name__ == "__main__":
    print(main())
