"""A tip slides over a measured surface: its heights come from the file of an instrument.

The scan beside this file is synthetic: self-affine roughness on a tilted plane with a scratch, 4 um
by 4 um, as `write_scan` makes it.  tribo reads it with SurfaceTopography, subtracts the plane, and
interpolates the heights at the asperites of a surface.  A row of tips is pulled along it.

It needs pip install "tribo[topography]".
T. D. B. Jacobs et al., Surf. Topogr.: Metrol. Prop. 10 (2022) 035034.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import tribo
from tribo import plotting
from tribo.model.roughness import draw

SCAN = Path(__file__).with_name("scan.x3p")

# Pixels along each side of the scan, and its side [um].
PIXELS, SIDE = 64, 4.0

# Asperites along each side of the surface, and their spacing [um].
ASPERITES, SPACING = 24, 0.15

# Place of the tips along x [um], stiffness of their springs, and speed of the stage.
FIRST, STIFFNESS, SPEED = 0.6, 0.5, 0.02


def write_scan(path):
    """Write the synthetic scan; needs SurfaceTopography."""
    from SurfaceTopography import Topography

    spacing = SIDE / PIXELS
    roughness = tribo.Roughness(0.02, hurst=0.8, shortest=4 * spacing, seed=1)
    heights = draw(roughness, (PIXELS, PIXELS), (spacing, spacing), np.random.default_rng(0))
    x = spacing * np.arange(PIXELS)
    scratch = -0.05 * np.exp(-(((x[:, None] - 0.3 * x - 1.5) / 0.15) ** 2))
    scan = heights.reshape(PIXELS, PIXELS).T + 0.03 * x[:, None] - 0.01 * x + scratch
    Topography(np.round(scan, 5), (SIDE, SIDE), unit="um").to_x3p(str(path))


def scene():
    """Tips on springs over the scanned surface, whose asperites are rigid."""
    rigid = tribo.Asperite(kappa=np.inf)
    lower = tribo.Surface(
        "lower",
        facing="up",
        shape=(ASPERITES, ASPERITES),
        spacing=(SPACING, SPACING),
        heights={"topography": SCAN, "unit": "um"},
        drive="bars",
        asperite=rigid,
    )
    tips = tribo.Surface(
        "tips",
        bob=(FIRST, 0.25),
        depth=0.3,
        shape=(1, 6),
        spacing=(0.0, 0.6),
        drive=tribo.Pulled(stiffness=STIFFNESS, speed=SPEED, load=0.02),
        langevin=tribo.Langevin(gamma=1.0),
        asperite=rigid,
    )
    contact = tribo.with_cutoff(tribo.SoftSphere(0.02, 0.2, 6), 0.5)
    return tribo.Scene([tips, lower], contact, 100.0, title="Tips on a measured surface")


def draw_figure(heights, result, force, path):
    """The heights of the asperites, and the force along the way."""
    with plotting.style():
        figure = Figure(figsize=(6.9, 2.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        side = ASPERITES * SPACING
        grid = heights.reshape(ASPERITES, ASPERITES)
        image = left.imshow(grid, origin="lower", extent=(0.0, side, 0.0, side))
        figure.colorbar(image, label="height")
        left.set(xlabel="x", ylabel="z")
        right.plot(result.t, force, color=plotting.INK)
        right.set(xlabel="time", ylabel="force per tip")
    plotting.save(figure, path)


def main(folder=None):
    """Relax the tips onto the surface, pull them along, and draw the force of the springs."""
    pulled = scene()
    start = tribo.relax(pulled)
    result = tribo.simulate(pulled, method="verlet", step=0.02, start=start)
    tips, heights = result["tips"], pulled.surfaces[1].heights
    force = STIFFNESS * np.mean(FIRST + SPEED * result.t[:, None] - tips.x_bar, axis=1)
    if folder is not None:
        draw_figure(heights, result, force, Path(folder) / "measured_surface.png")
    return {
        "rms of the scan without its plane": float(np.std(heights)),
        "work of the drive": float(tips.w2[-1].sum()),
        "heat": float(tips.heat[-1].sum()),
        "force at the start": float(abs(force[0])),
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:40} {value:.6g}")
