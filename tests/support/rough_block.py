"""A rough rigid body of ten unlike asperites, on a row that stands on driven bars.

Ten fill one pack of eight, and a part of one.
"""

import math

import numpy as np

from tribo import Asperite, Coulomb, DrivenBars, Output, Scene, Surface

COUNT = 10
DRAWN = np.random.default_rng(5)
UNLIKE = {
    "m1": DRAWN.uniform(0.5, 1.5, COUNT),
    "m2": DRAWN.uniform(0.5, 1.5, COUNT),
    "i2": DRAWN.uniform(0.5, 1.5, COUNT),
    "length": DRAWN.uniform(0.7, 1.2, COUNT),
}
PENDULUMS = Asperite(kappa=DRAWN.uniform(0.5, 3.0, COUNT), **UNLIKE)
RIGID = Asperite(kappa=math.inf, **UNLIKE)
HEIGHTS = tuple(DRAWN.uniform(0.0, 0.4, COUNT))


def rough_block(asperite, drive, duration=6.0, below=None, fields=(), **upper):
    """The block with some settings over the row, with those of `below`."""
    block = {
        "bob": (0.1, 1.2),
        "velocity": (0.4, 0.0),
        "shape": (COUNT, 1),
        "spacing": (0.9, 0.0),
        "heights": HEIGHTS,
        "asperite": asperite,
        "drive": drive,
    }
    row = {"shape": (COUNT, 1), "spacing": (1.0, 0.0), "drive": DrivenBars()}
    surfaces = (
        Surface("block", **block | upper),
        Surface("table", facing="up", **row | (below or {})),
    )
    output = Output(samples=13, series=("forces",))
    return Scene(surfaces, Coulomb(0.1), duration, fields=fields, output=output)
