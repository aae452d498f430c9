"""A rough contact of 256 by 256 asperites on as many, coloured by the work done: for many.md.

    python docs/measure_contact.py

Draws docs/measured/contact.png.
"""

import time
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

import tribo
from tribo.plotting import PAGE, save, style

FOLDER = Path(__file__).resolve().parent / "measured"
SIDE, SPACING = 256, 1.5
# Of the upper surface over the lower one, and how far it is dragged.
GAP, SPEED, WAY = 1.6, 0.3, 6.0
STEP = 0.01


def surface(name: str, seed: int, **settings: Any) -> tribo.Surface:
    """A rough grid with heights drawn by a seed."""
    return tribo.Surface(
        name,
        shape=(SIDE, SIDE),
        spacing=(SPACING, SPACING),
        heights=tribo.Roughness(rms=0.3, hurst=0.8, seed=seed),
        asperite=tribo.Asperite(kappa=4.0),
        **settings,
    )


def main() -> None:
    """Drag and draw."""
    upper = surface("upper", 1, bob=(0.75, GAP), velocity=(SPEED, 0.0))
    lower = surface("lower", 2, facing="up")
    repulsion = tribo.WeeksChandlerAndersen(epsilon=0.05, sigma=1.0)
    box = tribo.Periodic(x=SIDE * SPACING, z=SIDE * SPACING)
    output = tribo.Output(samples=3)
    scene = tribo.Scene((upper, lower), repulsion, WAY / SPEED, periodic=box, output=output)
    simulation = tribo.prepare(scene, method="verlet", step=STEP)
    began = time.perf_counter()
    result = simulation.run()
    seconds = time.perf_counter() - began
    with style():
        figure = Figure(figsize=(PAGE, 0.42 * PAGE), layout="constrained")
        heights, works = figure.subplots(1, 2)
        result.plot.map("height", "lower", ax=heights)
        result.plot.map("w1", "lower", ax=works)
        heights.set_title("height")
        works.set_title("work of contact")
    save(figure, FOLDER / "contact.png")
    touched = (abs(result["lower"].w1[-1]) > 1e-6).mean()
    print(f"{seconds:.0f} s; contact touches {touched:.0%} of the lower asperites")


if __name__ == "__main__":
    main()
