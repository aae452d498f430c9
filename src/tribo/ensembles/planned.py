"""The plan of an ensemble's scene."""

from __future__ import annotations

from tribo.kernels.status import Status
from tribo.model.scene import Scene
from tribo.prepared import Simulation
from tribo.simulation import prepare
from tribo.validation import InputError


def planned(scene: Scene, method: str | None, step: float | None) -> Simulation:
    """The scene, with the method and settings of all members.  Raises InputError."""
    simulation = prepare(scene, method=method, step=step)
    if simulation.accuracy is None:
        return simulation
    result = simulation.compute_first()
    if result.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    if not result.met:
        completed = result.status == Status.COMPLETED
        why = result.notes[-1] if completed else f"the run ends by {result.status}"
        raise InputError(
            "step",
            f"is missing, and accuracy does not find one: {why}; give a method and a step, or an "
            "accuracy that can be kept in the scene's numerics",
        )
    return simulation
