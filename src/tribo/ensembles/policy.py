"""How members of a scene are run: what all policies have in common."""

from __future__ import annotations

import tomllib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np

from tribo.ensembles.kept_values import MISSED, REFUSED, UNKNOWN, Kept, KeptValues, set_note
from tribo.ensembles.members import Members
from tribo.model.scene_file import scene_from
from tribo.prepared import Simulation
from tribo.simulation import from_settings, prepare
from tribo.validation import InputError


class Policy(ABC):
    """Runs members of an ensemble; it can be pickled, with the scene as text.

    Parameters
    ----------
    simulation : Simulation
        The scene, with the settings of all members.
    kept : Kept
        What is kept of each.
    own_numbers : sequence of str
        The keys of what members differ in beside initial angles and rates.
    """

    chunk: int  # members that are run in one call
    plan: Any = None  # what was found for all members, beside the settings of the simulation

    def __init__(self, simulation: Simulation, kept: Kept, own_numbers: Sequence[str]) -> None:
        self.simulation, self.kept, self.own_numbers = simulation, kept, own_numbers

    @abstractmethod
    def compute(self, members: Members) -> KeptValues:
        """Run some members; those that need a run with settings of their own have UNKNOWN."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the scene as text, from which plug-ins are loaded."""
        scene, settings = self.simulation.scene.to_toml(), self.simulation.settings
        return _restored, (type(self), scene, settings, self.kept, self.own_numbers, self.plan)

    def complete(self, members: Members) -> KeptValues:
        """Run some members in this thread, also those that need settings of their own."""
        found = self.compute(members)
        self.run_alone(members, found)
        return found

    def run_alone(self, members: Members, found: KeptValues) -> None:
        """Run those whose status is UNKNOWN: with the given step, or with settings of their own.

        The settings are searched for, for each member.
        """
        simulation, kept = self.simulation, self.kept
        for index in np.flatnonzero(found["status"] == UNKNOWN).tolist():
            scene = members.member(index).scene(simulation.scene, with_start=True)
            found["level"][index] = found["error"][index] = np.nan
            try:
                if simulation.accuracy is None:
                    own = from_settings(scene, simulation.settings)
                else:
                    name = simulation.method.name
                    own = prepare(scene, simulation.accuracy, name, progress=False, threads=1)
            except InputError as error:  # the accuracy is out of reach
                found["status"][index] = REFUSED if kept.with_errors else MISSED
                set_note(found, index, str(error) if kept.with_errors else "")
                for name in kept.names:
                    found[name][index] = np.nan
            else:
                kept.fill_in(found, index, own.compute_first())


def _restored(
    kind: type[Policy], scene: str, settings: Any, kept: Kept, own_numbers: Sequence[str], plan: Any
) -> Policy:
    runs = kind(from_settings(scene_from(tomllib.loads(scene)), settings), kept, own_numbers)
    runs.plan = plan
    return runs
