"""Friction of a tip decreases with temperature.

At T = 0 a pulled bob sticks until its equilibrium vanishes, and then jumps.  At a temperature T,
noise carries it over the remaining barrier earlier, so the pull does less work.  The reservoir
moves with the stage, so it adds no drag to the mean.

S. Yu. Krylov et al., Phys. Rev. E 71 (2005) 065101.
"""

import numpy as np

import tribo
from tribo.results.averages import interval

# Curvature of the corrugation (amplitude and period 1) over K; speed of the stage; rod's length.
ETA, SPEED, ROD = 4.0, 0.05, 10.0
# Stiffness of the pulling spring and the torsion spring in series [force / length].
K = (2.0 * np.pi) ** 2 / ETA
# Runs at each temperature [energy], and samples in each of the three periods of the pull.
COLOURS, MEMBERS, SAMPLES = {0.01: "#0b62a4", 0.1: "#1f8a70", 0.3: "#d55e00"}, 48, 60


def runs(temperature):
    """An ensemble of pulls over three periods, with means and intervals of its work."""
    asperite = tribo.Asperite(m1=1.0, m2=1.0, length=ROD, kappa=2.0 * K * ROD**2)
    drive = tribo.Pulled(stiffness=2.0 * K, speed=SPEED)
    reservoir = tribo.Langevin(K**0.5, temperature, velocity=(SPEED, 0.0))
    tip = tribo.Surface("tip", asperite=asperite, drive=drive, langevin=reservoir)
    corrugation = tribo.Field(tribo.Corrugation(1.0, 1.0), on=["tip"])
    output = tribo.Output(samples=3 * SAMPLES + 1)
    scene = tribo.Scene([tip], [], 3.0 / SPEED, fields=[corrugation], output=output)
    return tribo.ensemble(scene, MEMBERS)


def friction(data):
    """Mean friction over the last period, and the half-width of its 95 % interval."""
    work = data["tip.w2"]
    return tuple(float(each) for each in interval((work[:, -1] - work[:, -1 - SAMPLES]).values))


def main(folder="."):
    """The friction at each temperature, and the half-width of its interval."""
    shown = {}
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.WIDE, 2.8)
        for temperature, colour in COLOURS.items():
            data = runs(temperature)
            distance, mean, half = SPEED * data.time, data["tip.w2_mean"], data["tip.w2_half_width"]
            ax.fill_between(distance, mean - half, mean + half, color=colour, alpha=0.35, lw=0.0)
            ax.plot(distance, mean, color=colour, label=f"$T = {temperature:g}\\,A$")
            shown[f"friction at T = {temperature:g}"], half = friction(data)
            shown[f"half-width at T = {temperature:g}"] = half
        ax.set(xlabel="distance of the stage / $a$", ylabel="work of the pull / $A$")
        ax.legend(loc="upper left")
    tribo.plotting.save(ax, f"{folder}/thermal_friction.png")
    return shown


if __name__ == "__main__":
    print(main())
