"""The fastest motion of a scene, which bounds the steps of a run, and what would slow it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tribo.accuracy.encounter_estimate import steps_towards
from tribo.kernels.records import INERTIA, L1, MASS
from tribo.layout.layout import Layout
from tribo.loops.resolution import (
    bath_frequency,
    corrugation_frequency,
    pendulum_frequency,
    spring_frequency,
    user_frequency,
)


class Motion(NamedTuple):
    """A motion that steps have to resolve: its frequency, what moves, and what would slow it."""

    # Of encounters the steps that they take for each unit of time [rad / time].
    frequency: float
    name: str
    cure: str


def fastest_motion(layout: Layout) -> Motion:
    """The motion for which a run of a scene takes the shortest steps."""
    encounters = steps_towards(layout) / layout.scene.duration
    return max(
        Motion(pendulum_frequency(layout), "pendulums", "a smaller kappa or a larger inertia"),
        Motion(
            spring_frequency(layout),
            "bars on springs",
            "a smaller stiffness of springs and drives, or heavier bars",
        ),
        Motion(
            bath_frequency(layout),
            "oscillators of the bath",
            "a bath without its highest frequencies, or langevin in its place",
        ),
        Motion(
            corrugation_frequency(layout),
            "bobs in the corrugation",
            "a smaller amplitude or a longer period",
        ),
        Motion(
            _contact_frequency(layout),
            "bobs in the minimum of a contact",
            "a potential that is less deep or longer in range, or a larger inertia",
        ),
        Motion(user_frequency(layout), "bars under a plug-in's force", "a force that varies less"),
        Motion(
            encounters,
            "encounters of bobs",
            "a larger gap, a smaller velocity, or a potential that is softer at short distances",
        ),
    )


def _contact_frequency(layout: Layout) -> float:
    """The largest angular frequency of a bob in the minimum of a potential that declares one."""
    table = layout.constants
    mobility = 2.0 * float(np.max(1.0 / table[MASS] + table[L1] ** 2 / table[INERTIA]))
    fastest = 0.0
    for item in layout.scene.interactions:
        potential = getattr(item.potential, "potential", item.potential)  # without its cutoff
        if hasattr(potential, "minimum"):
            curvature = float(potential.minimum()[2])
            fastest = max(fastest, math.sqrt(max(curvature, 0.0) * mobility))
    return fastest
