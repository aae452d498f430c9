"""A rough surface of 16 x 16 asperites obeys a law of friction between those of points and planes.

Springs pull the bars of a rough surface, and a load presses each of them down.  A Drude bath takes
up the energy of the bars.  The bars of the surface below are held, and its swings are damped.  The
work of the springs becomes contact energy, motion, and heat in the bath and in the swings.  Lines:
a power law through the points, and the sums of the energies.

B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840.
"""

import numpy as np
from matplotlib.figure import Figure

import tribo

LOADS, SPEED, STEP = np.array([0.1, 0.2, 0.4]), 0.3, 0.02
GRID = {"shape": (16, 16), "spacing": (1.5, 1.5), "asperite": tribo.Asperite(kappa=4.0)}


def pull(load):
    """The result of a run under a load on each asperite."""
    upper = tribo.Surface(
        "upper",
        bob=(0.75, 2.0),
        velocity=(SPEED, 0.0),
        heights=tribo.Roughness(rms=0.3, hurst=0.8, seed=1),
        drive=tribo.Pulled(stiffness=2.0, speed=SPEED, load=load),
        springs=tribo.Springs(5.0, wrap=True),
        bath=tribo.Bath(spectrum=tribo.Spectrum("drude", gamma=1.0, cutoff=4.0, n=16)),
        **GRID,
    )
    lower = tribo.Surface(
        "lower",
        facing="up",
        heights=tribo.Roughness(rms=0.3, hurst=0.8, seed=2),
        drive=tribo.DrivenBars(),
        langevin=tribo.Langevin(gamma=1.0, on="swing"),
        **GRID,
    )
    output = tribo.Output(samples=301, ledger="surfaces", series=["energies"])
    box, contact = {"x": 24.0, "z": 24.0}, tribo.WeeksChandlerAndersen(epsilon=0.2, sigma=1.0)
    scene = tribo.Scene((upper, lower), contact, 60.0, periodic=box, output=output)
    return tribo.simulate(scene, method="verlet", step=STEP)
