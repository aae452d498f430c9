"""The flow of a scene from its start to its end, and by how much it changes volumes."""

from collections.abc import Callable

import numpy as np

import tribo
from tribo.loops.saved_state import state_of

# Step of central differences of fourth order: their errors are 1e-10 in smooth scenes.
EPSILON = 1e-4


def flow_of(
    scene: tribo.Scene, **settings
) -> tuple[Callable[[np.ndarray], np.ndarray], np.ndarray]:
    """The map of all coordinates and velocities, and the scene's start.

    The settings of :func:`tribo.prepare` fix the steps, so that the map is smooth.
    """
    simulation = tribo.prepare(scene, **settings)
    layout = simulation.layout
    method = simulation.method.name

    def flow(y: np.ndarray) -> np.ndarray:
        run = simulation.integrator(simulation.plan.setting, layout.times, y)
        assert run.status == "completed"
        return state_of(layout, method, run).y

    return flow, layout.start


def volume_ratio(scene: tribo.Scene, **settings) -> float:
    """The determinant of the flow's derivative at the scene's start."""
    flow, start = flow_of(scene, **settings)
    rows = []
    for unit in np.eye(start.size):
        one, two = (flow(start + k * unit) - flow(start - k * unit) for k in (EPSILON, 2 * EPSILON))
        rows.append((8.0 * one - two) / (12.0 * EPSILON))
    return float(np.linalg.det(np.array(rows)))
