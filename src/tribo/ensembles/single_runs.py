"""Members of any scene, each a run of its own, and the plan that they share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tribo.accuracy.choose_method import check_resolved
from tribo.ensembles.kept_values import MISSED, REFUSED, UNKNOWN, Kept, KeptValues
from tribo.ensembles.members import Member, Members, is_random
from tribo.kernels.status import Status
from tribo.prepared import Simulation
from tribo.result import Result
from tribo.simulation import from_settings, prepare
from tribo.validation import InputError


class SingleRuns:
    """Runs members of an ensemble one by one, first by the settings of its simulation.

    `own_numbers` are keys of what members differ in beside initial angles and rates.  There is no
    plan beside that of the simulation.
    """

    chunk = 1
    plan = None

    def __init__(self, simulation: Simulation, kept: Kept, own_numbers: Sequence[str]) -> None:
        self.simulation = simulation
        self.kept = kept
        self._own_scenes = bool(own_numbers) or is_random(simulation.scene)

    def compute(self, members: Members) -> KeptValues:
        """Run some members by the settings of all.

        Those that miss their accuracy have the status UNKNOWN, unless errors are kept too.
        """
        found = KeptValues.without_runs(self.kept, members.numbers.size)
        for index in range(members.numbers.size):
            result = self._run(members.member(index))
            missed = result.status == Status.COMPLETED and result.met is False
            if not missed or self.kept.with_errors:
                found.set_alone(index, result, self.kept)
        return found

    def _run(self, member: Member) -> Result:
        simulation = self.simulation
        if not member.values and member.seed == simulation.scene.seed:
            return simulation.compute_first()
        if self._own_scenes:
            scene = member.scene(simulation.scene)
            simulation = from_settings(scene, simulation.settings)
            _check_step(simulation)
        # The errors of sums are those of some members, which are run again.
        estimate = self.kept.with_errors or not self.kept.counts
        return simulation.compute(member.start, estimate=estimate)


def _check_step(simulation: Simulation) -> None:
    """Refuse a given step that does not resolve a member's own scene.  Raises InputError."""
    step, method = simulation.plan.setting, simulation.method
    if simulation.plan.tuned is None and isinstance(step, float) and method.splits:
        check_resolved(simulation.layout, method, step)


def run_alone(simulation: Simulation, kept: Kept, members: Members, found: KeptValues) -> None:
    """Run the members whose status is UNKNOWN: with the given step, or with settings of their own.

    The settings are searched for, for each member.
    """
    asked = simulation.accuracy
    for index in np.flatnonzero(found.status == UNKNOWN):
        scene = members.member(int(index)).scene(simulation.scene, with_start=True)
        found.level[index] = found.error[index] = np.nan
        try:
            if asked is None:
                own = from_settings(scene, simulation.settings)
            else:
                own = prepare(scene, asked, simulation.method.name, threads=1)
        except InputError as error:  # the accuracy is out of reach
            found.status[index] = REFUSED if kept.with_errors else MISSED
            found.note = found.note.astype(object)
            found.note[index] = str(error) if kept.with_errors else ""
            found.note = found.note.astype(str)
            for values in found.values.values():
                values[index] = np.nan
        else:
            found.set_alone(int(index), own.compute_first(), kept)
