"""An elastic body of rigid tips that a load presses on a flat wall of springs."""

from typing import NamedTuple

import numpy as np

from tribo import Asperite, Elastic, Field, Free, Langevin, Output, Periodic, Scene, Surface


class Wall(NamedTuple):
    """A flat wall below y = 0 of tips that are springs."""

    stiffness: float  # [force / length]

    def energy_at(self, x, y):
        return 0.5 * self.stiffness * max(-y, 0.0) ** 2

    def force_at(self, x, y):
        return 0.0, self.stiffness * max(-y, 0.0)


def pressed_body(gaps, elastic: Elastic, load, wall, friction, duration) -> Scene:
    """A body with these gaps over a wall of some stiffness, (n, n) cells of 1 [length].

    Friction lets it come to rest; the result has the wall's forces on the tips.
    """
    side = len(gaps)
    body = Surface(
        "body",
        shape=(side, side),
        spacing=(1.0, 1.0),
        heights=np.ravel(gaps),
        asperite=Asperite(m1=0.5, m2=0.5, kappa=np.inf),
        elastic=elastic,
        drive=Free(block=True, load=load),
        langevin=Langevin(friction),
    )
    field = Field(Wall(wall), on=("body",))
    output = Output(samples=2, series=("forces",), ledger="none")
    periodic = Periodic(x=side, z=side)
    return Scene((body,), (), duration, fields=(field,), periodic=periodic, output=output)
