"""The fastest motion of a scene, which bounds the steps of a run, and what would slow it."""

from __future__ import annotations

import math

import numpy as np

from tribo.accuracy.encounter_estimate import steps_towards
from tribo.kernels.records import INERTIA, L1, MASS
from tribo.layout.layout import Layout
from tribo.loops import resolution

# The phase of the fastest motion in a step [rad] that is still well resolved.
RESOLVED = 0.1
# What would slow each motion.
CURES = {
    "pendulums": "a smaller kappa or a larger inertia",
    "bars on springs": "a smaller stiffness of springs and drives, or heavier bars",
    "oscillators of the bath": "a bath without its highest frequencies, or langevin in its place",
    "bobs in the corrugation": "a smaller amplitude or a longer period",
    "bobs in the minimum of a contact": (
        "a potential that is less deep or longer in range, or a larger inertia"
    ),
    "bars under a plug-in's force": "a force that varies less",
    "encounters of bobs": (
        "a larger gap, a smaller velocity, or a potential that is softer at short distances"
    ),
}


def frequencies(layout: Layout) -> dict[str, float]:
    """Those of all motions; of encounters the steps that they take per unit of time."""
    return {
        "pendulums": resolution.pendulum_frequency(layout),
        "bars on springs": resolution.spring_frequency(layout),
        "oscillators of the bath": resolution.bath_frequency(layout),
        "bobs in the corrugation": resolution.corrugation_frequency(layout),
        "bobs in the minimum of a contact": _contact_frequency(layout),
        "bars under a plug-in's force": resolution.user_frequency(layout),
        "encounters of bobs": steps_towards(layout) / layout.scene.duration,
    }


def slow_motion(layout: Layout, step: float | None) -> str:
    """The motion for which a run takes the shortest steps, and what would allow longer ones."""
    frequency, name = max((frequency, name) for name, frequency in frequencies(layout).items())
    if frequency == 0.0:
        return ""
    cure = f"{CURES[name]} would allow longer steps"
    if step is not None and step * frequency < RESOLVED:
        cure = f"a step of {RESOLVED / frequency:.2g}, not {step:.2g}, resolves it"
    return (
        f"the fastest motion is that of {name}, at {frequency:.3g} rad per unit of time, for "
        f"{frequency * layout.scene.duration:.2g} rad in all; {cure}"
    )


def _contact_frequency(layout: Layout) -> float:
    """The largest of a bob in the minimum of a potential, without its cutoff, that declares one."""
    table = layout.constants
    mobility = 2.0 * float(np.max(1.0 / table[MASS] + table[L1] ** 2 / table[INERTIA]))
    inner = (getattr(i.potential, "potential", i.potential) for i in layout.scene.interactions)
    curvatures = (float(each.minimum()[2]) for each in inner if hasattr(each, "minimum"))
    return math.sqrt(max(0.0, 0.0, *curvatures) * mobility)
