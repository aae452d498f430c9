"""A rough grid carries its load on a few asperites, nearly as Greenwood and Williamson predict.

A flat grid of 64 × 64 asperites moves down onto a rough grid, each asperite above one of the other
grid.  Asperites in contact repel each other like elastic spheres of diameter D (Hertz).  For
heights of normal density phi, and the flat grid at a distance d + D from their mean, theory gives

    share in contact = integral over z > d of phi(z) ,
    load per asperite = (5 A / 2 D) integral over z > d of ((z - d) / D)^(3/2) phi(z) .

The drawn heights are one sample, with wavelengths of up to 6 spacings.

J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. Lond. A 295 (1966) 300.
"""

import numpy as np
from matplotlib.figure import Figure
from scipy import integrate, stats

import tribo

# Asperites a side, their spacing and diameter [length], and the energy of Hertz's potential.
SIDE, SPACING, DIAMETER, A = 64, 1.5, 1.0, 10.0
RMS, SPEED = 0.1, 0.01
RIGID, HELD = tribo.Asperite(kappa=np.inf), tribo.DrivenBars()
GRID = {"shape": (SIDE, SIDE), "spacing": (SPACING, SPACING), "asperite": RIGID, "drive": HELD}


def pressed():
    """Run of a flat grid that moves down until half of the asperites are in contact."""
    heights = tribo.Roughness(RMS, hurst=0.8, longest=6.0 * SPACING, seed=1)
    top = DIAMETER + 4.0 * RMS
    flat = tribo.Surface("flat", bob=(0.0, top), velocity=(0.0, -SPEED), **GRID)
    rough = tribo.Surface("rough", facing="up", heights=heights, **GRID)
    output = tribo.Output(samples=41, ledger="surfaces", series=("forces",))
    scene = tribo.Scene([flat, rough], tribo.Hertz(A, DIAMETER), 4.0 * RMS / SPEED, output=output)
    return tribo.simulate(scene, method="verlet", step=1.0)


def theory(d):
    """Load and share in contact per asperite by Greenwood and Williamson."""
    phi, unit = stats.norm(0.0, RMS), 2.5 * A / DIAMETER
    z = np.linspace(0.0, 8.0 * RMS, 2001)  # above d
    force = unit * (z / DIAMETER) ** 1.5 * phi.pdf(z + np.reshape(d, (-1, 1)))
    return integrate.simpson(force, x=z), phi.sf(d)


def main(folder="."):
    """The share in contact relative to theory, and its growth when the load doubles."""
    result = pressed()
    repulsion = -result["rough"].f1_y
    load, share = repulsion.mean(axis=1), (repulsion > 0.0).mean(axis=1)
    loads, shares = theory(np.linspace(4.0 * RMS, 0.0, 81))
    k = int(np.argmin(np.abs(share - 0.1)))
    z, x = SPACING * np.argwhere(repulsion[k].reshape(SIDE, SIDE) > 0.0).T
    with tribo.plotting.style():
        figure = Figure(figsize=(tribo.plotting.PAGE, 2.6), layout="constrained")
        above, law = figure.subplots(1, 2)
        result.plot.map("height", "rough", ax=above)
        above.plot(x, z, "s", ms=1.5, color="#d55e00")
        law.plot(loads, shares, color="#d55e00", label="Greenwood and Williamson")
        law.plot(load, share, "o", ms=3, color=tribo.plotting.INK, label="simulation")
        law.set(xlabel="load per asperite", ylabel="share in contact", xlim=0, ylim=0)
        law.legend()
    tribo.plotting.save(figure, f"{folder}/rough_grid.png")
    doubled = np.interp([load[k], 2.0 * load[k]], load, share)
    return {
        "share in contact / theory": share[k] / np.interp(load[k], loads, shares),
        "share in contact, load doubled / single": doubled[1] / doubled[0],
    }


if __name__ == "__main__":
    print(main())
