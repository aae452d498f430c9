"""Friction peaks where the corrugation shakes pendulums at their natural frequency.

Bars move at a speed v over a corrugation -A cos(q x), which shakes their bobs at the frequency
w = q v.  Pendulums of stiffness kappa, inertia I and damping g absorb energy.  For small swings of
a rod of length 1 the friction force is

    F = (A q)^2 / (2 v) Re Y ,   Y = 1 / (g - i (w I - kappa / w)) ,

which peaks near w^2 = kappa / I if the damping is weak.

J. B. Sokoloff, Phys. Rev. B 42 (1990) 760.
"""

import numpy as np

import tribo

# Corrugation: amplitude [energy] and wave number [rad / length]; damping [torque time].
AMPLITUDE, Q, DAMPING = 0.0005, 2.0 * np.pi, 0.2
# The inertia about the bar's centre and the stiffness are 1, and so is the resonant frequency.
PENDULUM = tribo.Asperite(m1=1.0, kappa=1.0, length=1.0)
FREQUENCIES = np.linspace(0.4, 1.8, 15)


def friction(frequency):
    """Work of the bar's drive per length over the last five periods."""
    speed, period = frequency / Q, 2.0 * np.pi / frequency
    drive, reservoir = tribo.DrivenBars(), tribo.Langevin(DAMPING, on="swing")
    settings = {"asperite": PENDULUM, "velocity": (speed, 0.0)}
    bar = tribo.Surface("bar", drive=drive, langevin=reservoir, **settings)
    corrugation = tribo.Field(tribo.Corrugation(AMPLITUDE, 2.0 * np.pi / Q), on=["bar"])
    output = tribo.Output(times=[20.0 * period, 25.0 * period])
    scene = tribo.Scene([bar], [], 25.0 * period, fields=[corrugation], output=output)
    work = tribo.simulate(scene, method="verlet", step=period / 200.0)["bar"].w2[:, 0]
    return (work[-1] - work[-2]) / (5.0 * period * speed)


def closed_form(frequency):
    """Friction to lowest order in the amplitude."""
    mobility = 1.0 / (DAMPING - 1j * (frequency - 1.0 / frequency))
    return (AMPLITUDE * Q) ** 2 / (2.0 * frequency / Q) * mobility.real


def main(folder="."):
    """Friction at the resonance, in units of the closed form."""
    found = np.array([friction(w) for w in FREQUENCIES])
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.4)
        fine = np.linspace(FREQUENCIES[0], FREQUENCIES[-1], 300)
        ax.plot(fine, closed_form(fine) / closed_form(1.0), color="#d55e00", label="closed form")
        ax.plot(
            FREQUENCIES,
            found / closed_form(1.0),
            "o",
            ms=4,
            color=tribo.plotting.INK,
            label="simulation",
        )
        ax.set(xlabel=r"$q v / \sqrt{\kappa / I}$", ylabel="friction / closed form at the peak")
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/washboard_resonance.png")
    peak = np.argmin(np.abs(FREQUENCIES - 1.0))
    return {"friction / closed form at the resonance": found[peak] / closed_form(1.0)}


if __name__ == "__main__":
    print(main())
