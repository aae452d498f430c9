"""Warm tips slip: how friction falls with temperature, by means over many noisy runs.

A bob rides on a corrugation -A cos(2 pi x / a); its bar hangs on a spring to a stage that moves
along.  Cold, it sticks until its place of rest ends, and jumps.  A reservoir at a temperature T
kicks it over what is left of the barrier before that, the sooner the warmer, and the pull does less
work.  No two runs are alike; the mean over many is known as well as their number makes it.

E. Gnecco et al., Phys. Rev. Lett. 84 (2000) 1172;
S. Yu. Krylov et al., Phys. Rev. E 71 (2005) 065101.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from tribo import Asperite, Output, Pulled, Scene, Surface, ensemble, plotting
from tribo.ensembles.intervals import interval
from tribo.model.bath import Langevin
from tribo.model.fields import Corrugation, Field

A = PERIOD = 1.0
ETA, ROD, SPEED = 4.0, 10.0, 0.05
K = (2.0 * np.pi / PERIOD) ** 2 * A / ETA  # of the two springs in series, as in stick_slip.py
MEMBERS, SAMPLES = 48, 60  # samples in each of the three periods pulled
COLOURS = {0.01: "#0b62a4", 0.1: "#8a6f00", 0.3: "#d55e00"}  # by temperature


def scene(temperature):
    """A tip that is pulled over three periods."""
    tip = Surface(
        "tip",
        asperite=Asperite(m1=1.0, m2=1.0, length=ROD, kappa=2.0 * K * ROD**2),
        drive=Pulled(stiffness=2.0 * K, speed=SPEED),
        langevin=Langevin(np.sqrt(K), temperature),
    )
    corrugation = Field(Corrugation(A, PERIOD), on=["tip"])
    output = Output(samples=3 * SAMPLES + 1)
    return Scene([tip], [], 3.0 * PERIOD / SPEED, fields=[corrugation], output=output)


def friction(data):
    """Mean friction over the last period, and the half-width of its 95 % interval.

    The work in a period is a difference of two times, whose errors go together: so the interval is
    made from the members' own differences.
    """
    work = data["tip.w2"]
    each = (work[:, -1] - work[:, -1 - SAMPLES]).values / PERIOD
    return tuple(float(value) for value in interval(each))


def draw(path, runs):
    """The mean work over the way of the stage, each with its band."""
    with plotting.style():
        ax = plotting.axes(plotting.WIDE, 2.8)
        for temperature, data in runs.items():
            way, mean = SPEED * data["time"], data["tip.w2_mean"]
            half, colour = data["tip.w2_half_width"], COLOURS[temperature]
            ax.fill_between(way, mean - half, mean + half, color=colour, alpha=0.35, lw=0.0)
            ax.plot(way, mean, color=colour, label=f"$T = {temperature:g}\\,A$")
        ax.set(xlabel="way of the stage / $a$", ylabel="work of the pull / $A$", xlim=(0.0, 3.0))
        ax.legend(loc="upper left", frameon=False)
        ax.get_figure().savefig(path)


def main(folder=None):
    """The friction at each temperature, and how well it is known."""
    cold = scene(min(COLOURS))
    (tip,) = cold.surfaces
    runs = {}
    for temperature in COLOURS:
        warm = replace(tip, langevin=replace(tip.langevin, temperature=temperature))
        runs[temperature] = ensemble(replace(cold, surfaces=(warm,)), MEMBERS)
    if folder is not None:
        draw(Path(folder) / "thermal_friction.png", runs)
    shown = {}
    for temperature, data in runs.items():
        shown[f"friction at T = {temperature:g}"], half = friction(data)
        shown[f"half-width at T = {temperature:g}"] = half
    return shown


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:40} {value:.6g}")
