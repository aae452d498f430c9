"""A million encounters of case A over initial phase and energy, and their time: for ensembles.md.

    python docs/measure_ensembles.py

Draws docs/measured/million.png, and prints the seconds of the one call of tribo.ensemble, without
the time to compile.
"""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray

import tribo
from tribo.paper import scene as paper_scene
from tribo.plotting.style import WIDE, drawing_on, save

FOLDER = Path(__file__).resolve().parent / "measured"
# Points along each axis.
POINTS = 1000
# Largest initial energy of the swing [energy].
MOST_ENERGY = 1.0
NAMES = ("upper.delta_e_int", "lower.delta_e_int")


def encounters(points: int) -> xarray.Dataset:
    """The gains of energy (energy, phase) of both asperites, and the seconds of the ensemble."""
    scene = replace(paper_scene("A"), numerics=tribo.Numerics(accuracy=1e-6))
    phases = np.linspace(0.0, 2.0 * np.pi, points, endpoint=False)
    energies = np.linspace(0.0, MOST_ENERGY, points)
    energy, phase = (each.ravel() for each in np.meshgrid(energies, phases, indexing="ij"))
    swing = scene.surfaces[0].asperite.for_each(1)
    vary = {
        "upper.theta": np.sqrt(2.0 * energy / swing["kappa"]) * np.cos(phase),
        "upper.omega": np.sqrt(2.0 * energy / swing["inertia"]) * np.sin(phase),
    }
    tribo.ensemble(scene, 2, {"upper.theta": [0.0, 0.1], "upper.omega": [0.0, 0.1]}, keep=NAMES)
    began = time.perf_counter()
    data = tribo.ensemble(scene, vary=vary, keep=NAMES)
    seconds = time.perf_counter() - began
    assert set(data["status"].values) == {"completed"}
    gain = sum(data[name].values.reshape(points, points) for name in NAMES)
    return xarray.Dataset(
        {"gain": (("energy", "phase"), gain)},
        {"energy": energies, "phase": phases},
        {"seconds": seconds, "notes": data.attrs["notes"]},
    )


def draw(data: xarray.Dataset, path: Path) -> None:
    """The gain of internal energy by phase and energy."""
    with drawing_on(None, WIDE, 0.62 * WIDE) as ax:
        image = ax.pcolormesh(
            data["phase"] / np.pi,
            data["energy"],
            data["gain"],
            cmap="viridis",
            rasterized=True,
        )
        ax.figure.colorbar(image, label="internal energy gained")
        ax.set(xlabel=r"initial phase / $\pi$", ylabel="initial energy of the swing")
    save(ax, str(path))


def main() -> None:
    """Run and draw."""
    FOLDER.mkdir(exist_ok=True)
    data = encounters(POINTS)
    draw(data, FOLDER / "million.png")
    print(f"{POINTS**2:,} encounters took {data.attrs['seconds']:.1f} s", data.attrs["notes"])


if __name__ == "__main__":
    main()
