"""Vibrations inside a free block slow it on a corrugation.

A block slides at the speed V over a corrugation -A cos(q x), which shakes it at the frequency q V.
The oscillators of its bath absorb energy.  To lowest order in A, the friction force is

    F = (A q)^2 / (2 V) Re Y(q V) ,   Y(w) = 1 / (-i w M + sum_n K_n(w)) ,

where Y is the mobility of a block of mass M, and K_n is the force per velocity of each oscillator.

J. B. Sokoloff, Phys. Rev. B 42 (1990) 760.
"""

import numpy as np
from scipy.integrate import solve_ivp

import tribo

# Corrugation: amplitude [energy] and wave number [rad / length].  Speed of the block.
AMPLITUDE, Q, SPEED = 0.012, 2.0 * np.pi, 0.4
# Frequencies of the oscillators [rad / time]; their masses damp a mass of 1 at a rate of 1.
GAP = 0.03
FREQUENCIES = np.arange(0.5, 3.5, GAP)
MASSES = 2.0 * GAP / (np.pi * FREQUENCIES**2)
TOTAL = 1.0 + MASSES.sum()


def simulated_speed():
    """Times, speed of block and oscillators together, and positions of the block."""
    settings = {"bob": (0.25, 0.0), "velocity": (SPEED, 0.0), "drive": tribo.Free()}
    point, bath = tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf), tribo.Bath(MASSES, FREQUENCIES)
    block = tribo.Surface("block", asperite=point, bath=bath, **settings)
    corrugation = tribo.Field(tribo.Corrugation(AMPLITUDE, 2.0 * np.pi / Q), on=["block"])
    scene = tribo.Scene([block], [], 150.0, fields=[corrugation], output=tribo.Output(samples=1501))
    result = tribo.simulate(scene, method="verlet", step=0.02)
    speed = np.sqrt(SPEED**2 + 2.0 * result["block"].delta_K / TOTAL)
    return result.t, speed, result["block"].x_bob[:, 0]


def deceleration(t, speed):
    """-F / total mass; a complex frequency broadens the oscillators to a continuum."""
    w = Q * speed[0] + 2.0j * GAP
    bath = np.sum(MASSES * FREQUENCIES**2 * 1j * w / (w**2 - FREQUENCIES**2))
    return -((AMPLITUDE * Q) ** 2) / (2.0 * speed * TOTAL) * (1.0 / (bath - 1j * w)).real


def main(folder="."):
    """Speed lost, as a mean over the last tenth of the run, and the same by the closed form."""
    t, speed, place = simulated_speed()
    expected = solve_ivp(deceleration, (0.0, t[-1]), [SPEED], t_eval=t, rtol=1e-8).y[0]
    passes = np.interp(np.arange(place[0], place[-1], 2.0 * np.pi / Q), place, t)
    middle, mean = 0.5 * (passes[1:] + passes[:-1]), 2.0 * np.pi / Q / np.diff(passes)
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.4)
        ax.plot(t, speed, color="0.8", lw=0.5, label="block and oscillators")
        ax.plot(t, expected, color="#d55e00", label="closed form")
        ax.plot(
            middle[::2],
            mean[::2],
            "o",
            ms=2.5,
            color=tribo.plotting.INK,
            label="mean over a period",
        )
        ax.set(xlabel="$t$", ylabel="speed of the block")
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/free_block.png")
    late = t > 0.9 * t[-1]
    lost = [SPEED - each[late].mean() for each in (speed, expected)]
    return {"speed lost": lost[0], "speed lost by the closed form": lost[1]}


if __name__ == "__main__":
    print(main())
