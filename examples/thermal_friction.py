"""Friction of a tip decreases with temperature, as means over many runs with noise show.

A bob moves in a corrugation -A cos(2 pi x / a); a spring ties its bar to a stage that moves.  At
T = 0 the bob sticks until its equilibrium ends, and then jumps.  At a temperature T the noise of
the reservoir takes it over the rest of the barrier before that, the earlier the higher T is, and
the pull does less work.  Every run is different; the error of the mean decreases with the number of
runs.

E. Gnecco et al., Phys. Rev. Lett. 84 (2000) 1172;
S. Yu. Krylov et al., Phys. Rev. E 71 (2005) 065101.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from tribo import Asperite, Output, Pulled, Scene, Surface, ensemble, plotting
from tribo.ensembles.intervals import interval
from tribo.model.fields import Corrugation, Field
from tribo.model.langevin import Langevin

# Amplitude [energy] and period [length] of the corrugation.
A = PERIOD = 1.0

# Curvature of the corrugation relative to the springs, as in stick_slip.py.
ETA = 4.0

# Length of the rod [length], and speed of the stage [length / time].
ROD, SPEED = 10.0, 0.05

# Stiffness of the two springs in series, as in stick_slip.py [force / length].
K = (2.0 * np.pi / PERIOD) ** 2 * A / ETA

# Runs at each temperature, and samples in each of the three periods of the pull.
MEMBERS, SAMPLES = 48, 60

# Colours by temperature [energy].
COLOURS = {0.01: "#0b62a4", 0.1: "#8a6f00", 0.3: "#d55e00"}


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

    Works at two times are correlated, so the interval is that of the differences of the members.
    """
    work = data["tip.w2"]
    each = (work[:, -1] - work[:, -1 - SAMPLES]).values / PERIOD
    return tuple(float(value) for value in interval(each))


def draw(path, runs):
    """Draw mean works with their intervals against the distance of the stage."""
    with plotting.style():
        ax = plotting.axes(plotting.WIDE, 2.8)
        for temperature, data in runs.items():
            distance, mean = SPEED * data["time"], data["tip.w2_mean"]
            half, colour = data["tip.w2_half_width"], COLOURS[temperature]
            ax.fill_between(distance, mean - half, mean + half, color=colour, alpha=0.35, lw=0.0)
            ax.plot(distance, mean, color=colour, label=f"$T = {temperature:g}\\,A$")
        ax.set(
            xlabel="distance of the stage / $a$", ylabel="work of the pull / $A$", xlim=(0.0, 3.0)
        )
        ax.legend(loc="upper left", frameon=False)
    plotting.save(ax, path)


def main(folder=None):
    """Compute the friction at each temperature, and half the width of its 95 % interval."""
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
