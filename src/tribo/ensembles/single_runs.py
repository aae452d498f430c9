"""Members of any scene, each a run of its own."""

from __future__ import annotations

from collections.abc import Sequence

from tribo.accuracy.choose_method import check_resolved
from tribo.ensembles.kept_values import Kept, KeptValues
from tribo.ensembles.members import Member, Members, is_random
from tribo.ensembles.policy import Policy
from tribo.kernels.status import Status
from tribo.prepared import Simulation
from tribo.result import Result
from tribo.simulation import from_settings


class SingleRuns(Policy):
    """Runs members of an ensemble one by one, first by the settings of its simulation."""

    chunk = 1

    def __init__(self, simulation: Simulation, kept: Kept, own_numbers: Sequence[str]) -> None:
        super().__init__(simulation, kept, own_numbers)
        self._own_scenes = bool(own_numbers) or is_random(simulation.scene)

    def compute(self, members: Members) -> KeptValues:
        """Run some members by the settings of all.

        Those that miss their accuracy have the status UNKNOWN, unless errors are kept too.
        """
        found = self.kept.without_runs(members.numbers.size)
        for index in range(members.numbers.size):
            result = self._run(members.member(index))
            missed = result.status == Status.COMPLETED and result.met is False
            if not missed or self.kept.with_errors:
                self.kept.fill_in(found, index, result)
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
