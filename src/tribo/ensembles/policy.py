"""How members of a scene are run: what all policies share, and each member as a run of its own."""

from __future__ import annotations

import tomllib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np

from tribo.accuracy.choose_method import check_resolved
from tribo.ensembles.kept_values import MISSED, REFUSED, UNKNOWN, Kept, KeptValues, set_notes
from tribo.ensembles.members import Members, is_random
from tribo.kernels.status import Status
from tribo.model.scene_file import scene_from
from tribo.prepared import Simulation
from tribo.result import Result
from tribo.simulation import from_settings, prepare
from tribo.validation import InputError


class Policy(ABC):
    """Runs members of an ensemble, and keeps `kept` of each; it can be pickled.

    The simulation has the settings of all members.  The keys `own_numbers` are of what they differ
    in beside initial angles and rates.
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
        return self.run_alone(members, self.compute(members))

    def run_alone(self, members: Members, found: KeptValues) -> KeptValues:
        """Run those whose status is UNKNOWN: with the given step, or with settings of their own.

        The settings are searched for, for each member.  Returns `found`, with these.
        """
        simulation, kept = self.simulation, self.kept
        for index in np.flatnonzero(found["status"] == UNKNOWN).tolist():
            scene = members.scene(index, simulation.scene, with_start=True)
            found["level"][index] = found["error"][index] = np.nan
            try:
                if simulation.accuracy is None:
                    own = from_settings(scene, simulation.settings)
                else:
                    name = simulation.method.name
                    own = prepare(scene, simulation.accuracy, name, progress=False, threads=1)
            except InputError as error:  # the accuracy is out of reach
                found["status"][index] = REFUSED if kept.with_errors else MISSED
                set_notes(found, index, str(error) if kept.with_errors else "")
                for name in kept.names:
                    found[name][index] = np.nan
            else:
                kept.fill_in(found, index, own.compute_first())
        return found


def _restored(
    kind: type[Policy], scene: str, settings: Any, kept: Kept, own_numbers: Sequence[str], plan: Any
) -> Policy:
    runs = kind(from_settings(scene_from(tomllib.loads(scene)), settings), kept, own_numbers)
    runs.plan = plan
    return runs


class SingleRuns(Policy):
    """Runs members of any scene one by one, first by the settings of its simulation."""

    chunk = 1

    def compute(self, members: Members) -> KeptValues:
        """Run some members by the settings of all.

        Those that miss their accuracy have the status UNKNOWN, unless errors are kept too.
        """
        found = self.kept.without_runs(members.numbers.size)
        for index in range(members.numbers.size):
            result = self._run(members, index)
            missed = result.status == Status.COMPLETED and result.met is False
            if not missed or self.kept.with_errors:
                self.kept.fill_in(found, index, result)
        return found

    def _run(self, members: Members, index: int) -> Result:
        simulation = self.simulation
        if not members.values and members.seeds[index] == simulation.scene.seed:
            return simulation.compute_first()
        if self.own_numbers or is_random(simulation.scene):
            scene = members.scene(index, simulation.scene)
            simulation = from_settings(scene, simulation.settings)
            step, method = simulation.plan.setting, simulation.method
            if simulation.plan.tuned is None and isinstance(step, float) and method.splits:
                check_resolved(simulation.layout, method, step)
        # The errors of sums are those of some members, which are run again.
        estimate = self.kept.with_errors or not self.kept.counts
        return simulation.compute(members.start(index), estimate=estimate)
