"""A corrugation slows the diffusion of adsorbed particles.

Overdamped particles on a corrugation -A cos(2 pi x / a) diffuse at a temperature T with

    D = T / (gamma I_0(A / T)^2) ,

where I_0 is the modified Bessel function.  For A = 0 this is Einstein's relation.

S. Lifson, J. L. Jackson, J. Chem. Phys. 36 (1962) 2410.
"""

import numpy as np
from scipy.special import i0

import tribo
from tribo.results.averages import interval

# The period is 1; the amplitude [energy] makes the largest curvature of the corrugation 1.
AMPLITUDE = 1.0 / (2.0 * np.pi) ** 2
# Damping [mass / time] of a mass of 1: inertia changes D by about 1 %.
GAMMA, POINT = 10.0, tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf)
# Amplitudes relative to the temperature, A / T; groups of particles, each with a value of D.
BARRIERS, GROUPS = np.array([0.25, 1.0, 2.0]), 40


def diffusion(particles):
    """D gamma / T for each A / T, and the half-width of its 95 % interval."""
    surfaces = [
        tribo.Surface(
            f"barrier {100.0 * barrier:g} %",
            shape=(particles, 1),
            asperite=POINT,
            drive=tribo.Free(),
            langevin=tribo.Langevin(GAMMA, temperature=AMPLITUDE / barrier),
        )
        for barrier in BARRIERS
    ]
    washboard = tribo.Field(tribo.Corrugation(AMPLITUDE, 1.0), on=[s.name for s in surfaces])
    scene = tribo.Scene(surfaces, [], 250.0, fields=[washboard], output=tribo.Output(samples=6))
    result = tribo.simulate(scene, method="verlet", step=0.05)
    paths = np.array([result[s.name].x_bob.reshape(6, GROUPS, -1) for s in surfaces])
    squares = paths.var(axis=3, ddof=1)
    rate = (squares[:, -1] - squares[:, 1]) / (result.t[-1] - result.t[1])
    found = 0.5 * rate * GAMMA / AMPLITUDE * BARRIERS[:, None]
    return np.array([interval(groups) for groups in found]).T


def main(folder=".", particles=8000):
    """D gamma / T at each A / T, and the half-width at the largest."""
    found, half_width = diffusion(particles)
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.4)
        barrier = np.linspace(0.0, 2.5, 200)
        ax.plot(barrier, 1.0 / i0(barrier) ** 2, color="#d55e00", label="closed form")
        look = {"fmt": "o", "ms": 3, "capsize": 2, "color": tribo.plotting.INK}
        ax.errorbar(BARRIERS, found, half_width, label="simulation", **look)
        ax.set(xlabel="$A / T$", ylabel=r"$D\,\gamma / T$", ylim=(0.0, 1.1))
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/diffusion.png")
    shown = {f"D gamma / T at A / T = {b:g}": d for b, d in zip(BARRIERS, found, strict=True)}
    return shown | {"half-width at A / T = 2": half_width[-1]}


if __name__ == "__main__":
    print(main())
