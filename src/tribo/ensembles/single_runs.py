"""Members of any scene, each a run of its own, and the plan that they share."""

from __future__ import annotations

import numpy as np

from tribo.ensembles.kept_values import MISSED, STATUS_TYPE, UNKNOWN, Kept, KeptValues
from tribo.ensembles.members import Members
from tribo.kernels.status import Status
from tribo.model.scene import Scene
from tribo.prepared import Simulation
from tribo.result import Result
from tribo.simulation import from_settings, prepare
from tribo.validation import InputError


def planned(scene: Scene, method: str | None, step: float | None) -> Simulation:
    """The scene, with the method and settings of all members.  Raises InputError."""
    simulation = prepare(scene, method=method, step=step, threads=1)
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


class SingleRuns:
    """Runs members of an ensemble one by one.

    Parameters
    ----------
    simulation : Simulation
        Of the ensemble's scene; its settings are tried first for every member.
    kept : Kept
        What is kept.
    own_scenes : bool
        Whether members differ in more than initial angles and rates.

    Attributes
    ----------
    chunk : int
        Members that are run in one call.
    plan : None
        There is none beside that of the simulation.
    """

    chunk = 1
    plan = None

    def __init__(self, simulation: Simulation, kept: Kept, own_scenes: bool) -> None:
        self.simulation = simulation
        self.kept = kept
        self._own_scenes = own_scenes

    def compute(self, members: Members) -> KeptValues:
        """Run some members by the settings of all.

        Those that miss their accuracy have the status UNKNOWN.
        """
        found = nothing(self.kept, members.numbers.size)
        for index in range(members.numbers.size):
            member, simulation = members.member(index), self.simulation
            if self._own_scenes:
                scene = member.scene(simulation.scene)
                simulation = from_settings(scene, simulation.settings)
            result = simulation.compute(member.start)
            if result.status != Status.COMPLETED or result.met is not False:
                _take(found, index, result, self.kept)
        return found


def nothing(kept: Kept, members: int) -> KeptValues:
    """The values of members that have not been run."""
    shapes = zip(kept.names, kept.shapes, strict=True)
    return KeptValues(
        {name: np.full((members, *shape), np.nan) for name, shape in shapes},
        np.full(members, UNKNOWN, dtype=STATUS_TYPE),
        np.zeros(members, np.int64),
        np.full(members, np.nan),
        np.full(members, np.nan),
    )


def run_alone(simulation: Simulation, kept: Kept, members: Members, found: KeptValues) -> None:
    """Run the members whose status is UNKNOWN: with the given step, or with settings of their own.

    The settings are searched for, for each member.
    """
    for index in np.flatnonzero(found.status == UNKNOWN):
        scene = members.member(int(index)).scene_with_start(simulation.scene)
        found.level[index] = found.error[index] = np.nan
        try:
            own = _alone(simulation, scene)
        except InputError:  # the accuracy is out of reach
            found.status[index] = MISSED
            for values in found.values.values():
                values[index] = np.nan
        else:
            _take(found, int(index), own.compute_first(), kept)


def _alone(simulation: Simulation, scene: Scene) -> Simulation:
    if simulation.accuracy is None:
        return from_settings(scene, simulation.settings)
    return prepare(scene, simulation.accuracy, simulation.method.name, threads=1)


def _take(found: KeptValues, index: int, result: Result, kept: Kept) -> None:
    """Fill in one member.  Raises KeyboardInterrupt if its run was interrupted."""
    if result.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    completed = result.status == Status.COMPLETED
    found.status[index] = MISSED if completed and result.met is False else str(result.status)
    found.steps[index] = result.cost.steps
    known = found.status[index] == Status.COMPLETED
    values = kept.values_of(result, result.ledger.at_end()) if known else {}
    for name in kept.names:
        found.values[name][index] = values.get(name, np.nan)
