"""The fastest motion of a scene, which bounds the steps of a run, and what would slow it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tribo.accuracy.encounter_estimate import steps_towards
from tribo.kernels.records import INERTIA, L1, MASS
from tribo.layout.layout import Layout
from tribo.loops import resolution


class Motion(NamedTuple):
    """A motion that steps have to resolve: its frequency, what moves, and what would slow it."""

    # Of encounters the steps that they take for each unit of time [rad / time].
    frequency: float
    name: str
    cure: str


def fastest_motion(layout: Layout) -> Motion:
    """The motion for which a run of a scene takes the shortest steps."""
    return max(Motion(frequency(layout), name, cure) for frequency, name, cure in MOTIONS)


def _encounters(layout: Layout) -> float:
    return steps_towards(layout) / layout.scene.duration


def _contact(layout: Layout) -> float:
    """The largest angular frequency of a bob in the minimum of a potential that declares one."""
    table = layout.constants
    mobility = 2.0 * float(np.max(1.0 / table[MASS] + table[L1] ** 2 / table[INERTIA]))
    # Without their cutoffs.
    inner = (getattr(i.potential, "potential", i.potential) for i in layout.scene.interactions)
    curvatures = (float(each.minimum()[2]) for each in inner if hasattr(each, "minimum"))
    return math.sqrt(max(0.0, 0.0, *curvatures) * mobility)


MOTIONS = (
    (resolution.pendulum_frequency, "pendulums", "a smaller kappa or a larger inertia"),
    (
        resolution.spring_frequency,
        "bars on springs",
        "a smaller stiffness of springs and drives, or heavier bars",
    ),
    (
        resolution.bath_frequency,
        "oscillators of the bath",
        "a bath without its highest frequencies, or langevin in its place",
    ),
    (
        resolution.corrugation_frequency,
        "bobs in the corrugation",
        "a smaller amplitude or a longer period",
    ),
    (
        _contact,
        "bobs in the minimum of a contact",
        "a potential that is less deep or longer in range, or a larger inertia",
    ),
    (resolution.user_frequency, "bars under a plug-in's force", "a force that varies less"),
    (
        _encounters,
        "encounters of bobs",
        "a larger gap, a smaller velocity, or a potential that is softer at short distances",
    ),
)
