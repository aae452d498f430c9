"""A growing load squeezes a liquid out between two asperites, layer by layer.

The molecules of a liquid between two surfaces form layers.  The energy at a gap r then oscillates:

    U = A cos(2 pi r / s) exp(-r / l) ,

with the thickness s of a layer and the decay length l.  The load breaks one layer after another,
each where the repulsion is largest, at 2 pi r_k / s = 2 atan(2 pi l / s) - pi / 2 + 2 pi k:

    F_k = (2 pi A / s) exp(-r_k / l) ,

so that each layer bears exp(s / l) times the load of the one before it.

R. G. Horn, J. N. Israelachvili, J. Chem. Phys. 75 (1981) 1400.
"""

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

import tribo


class Layers(NamedTuple):
    """The energy of a gap that a layered liquid fills."""

    depth: float  # A [energy]
    thickness: float  # s [length]
    decay: float  # l [length]

    def energy(self, r):
        """Energy of a gap r."""
        return self.depth * np.cos(2.0 * np.pi * r / self.thickness) * np.exp(-r / self.decay)


LIQUID = Layers(depth=1.0, thickness=1.0, decay=1.5)
POINT, Q = tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf), 2.0 * np.pi / LIQUID.thickness
# Gaps at which layers break, in the order of the breaks; their loads, and the rate of the load.
GAPS = (2.0 * np.arctan(Q * LIQUID.decay) - 0.5 * np.pi + 2.0 * np.pi * np.arange(4, 1, -1)) / Q
STRENGTHS, RATE = Q * LIQUID.depth * np.exp(-GAPS / LIQUID.decay), 1e-3


def pressed():
    """A load that grows slowly, and the gap under it."""
    drive, damping = tribo.Pushed(rate=(0.0, -RATE)), tribo.Langevin(gamma=6.0)
    upper = tribo.Surface("upper", bob=(0.0, 4.45), asperite=POINT, drive=drive, langevin=damping)
    lower = tribo.Surface("lower", facing="up", asperite=POINT, drive=tribo.DrivenBars())
    scene = tribo.Scene([upper, lower], LIQUID, 1700.0, output=tribo.Output(samples=3401))
    result = tribo.simulate(scene, method="verlet", step=0.05)
    return RATE * result.t, result["upper"].y_bob[:, 0]


def main(folder="."):
    """The loads at which layers break, relative to the closed form."""
    load, gap = pressed()
    broken = np.array([load[np.argmax(gap < each)] for each in GAPS])
    r = np.linspace(0.8, 5.0, 500)
    with tribo.plotting.style():
        figure = Figure(figsize=(tribo.plotting.PAGE, 2.5), layout="constrained")
        energy, steps = figure.subplots(1, 2)
        energy.plot(r, LIQUID.energy(r), color="#0b62a4")
        energy.set(xlabel="gap $r$", ylabel="energy $U$")
        steps.plot(load, gap, color=tribo.plotting.INK, label="simulation")
        steps.plot(STRENGTHS, GAPS, "o", ms=4, color="#d55e00", label="a layer breaks, closed form")
        steps.set(xlabel="load", ylabel="gap $r$", xlim=(0.0, load[-1]))
        steps.legend()
    tribo.plotting.save(figure, f"{folder}/squeezed_layers.png")
    ratios = zip(("first", "second", "third"), broken / STRENGTHS, strict=True)
    return {f"load of the {k} break / closed form": ratio for k, ratio in ratios}


if __name__ == "__main__":
    print(main())
