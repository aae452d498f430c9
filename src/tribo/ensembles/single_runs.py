"""Members of any scene, each a run of its own, of which only the end is kept."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from tribo import interrupts
from tribo.accuracy.plan import Plan
from tribo.ensembles.end_values import MISSED, STATUS_TYPE, EndValues
from tribo.ensembles.members import Member, Variation
from tribo.ensembles.runner import JOBS, Engine, run_jobs
from tribo.kernels.status import Status
from tribo.model.scene_file import scene_from
from tribo.model.scene_writer import scene_text
from tribo.prepared import Simulation
from tribo.run.result import Result
from tribo.simulation import from_settings, prepare


class End(NamedTuple):
    """The end of one member's run.

    Attributes
    ----------
    status : str
        How it ended.
    values : list of ndarray
        (asperites,) or a number for each name; NaN where the run did not complete.
    steps : int
        Of the run.
    """

    status: str
    values: list[np.ndarray]
    steps: int


class EndJob(NamedTuple):
    """Some members and how they are run; it can be pickled."""

    scene: str  # as text
    plan: Plan
    names: list[str]
    members: list[Member]
    own_scenes: bool


class SingleRuns:
    """Runs the members of an ensemble one by one, in this process or by an engine.

    Parameters
    ----------
    simulation : Simulation
        Of the ensemble's scene; its plan is tried first for every member.
    variation : Variation
        The differences between members.
    names : sequence of str
        Of the quantities that are kept.
    engine : executor, optional
        Runs the members.
    progress : callable, optional
        Called with the number of members that have been run.
    """

    def __init__(
        self,
        simulation: Simulation,
        variation: Variation,
        names: Sequence[str],
        engine: Engine | None,
        progress: Callable[[int], None] | None,
    ) -> None:
        self._simulation = simulation
        self._variation = variation
        self._names = list(names)
        self._engine = engine
        self._progress = progress

    def run(self, count: int) -> EndValues:
        """Run the members from 0 to `count`; after an interrupt those that are complete are kept.

        Raises KeyboardInterrupt if there are none.
        """
        ends: list[End] = []
        interrupted = False
        try:
            for end in self._ends(count):
                if end.status == Status.INTERRUPTED:
                    raise KeyboardInterrupt
                ends.append(end)
                if self._progress is not None:
                    self._progress(len(ends))
        except KeyboardInterrupt:
            interrupts.answer()
            interrupted = True
            if not ends:
                raise
        unknown = np.full(len(ends), np.nan)
        return EndValues(
            {name: np.array([end.values[k] for end in ends]) for k, name in enumerate(self._names)},
            np.array([end.status for end in ends], dtype=STATUS_TYPE),
            np.array([end.steps for end in ends]),
            unknown,
            unknown.copy(),
            interrupted=interrupted,
        )

    def _ends(self, count: int) -> Iterator[End]:
        """The ends of the members' runs, in the members' order."""
        plan, own_scenes = self._simulation.settings, self._variation.own_scenes
        if self._engine is None:
            simulation = from_settings(self._simulation.scene, plan)
            for number in range(count):
                yield end_of(simulation, self._names, self._variation.member(number), own_scenes)
            return
        members = [self._variation.member(number) for number in range(count)]
        text, size = scene_text(self._simulation.scene), -(-count // JOBS)
        jobs = [
            EndJob(text, plan, self._names, members[k : k + size], own_scenes)
            for k in range(0, count, size)
        ]
        yield from run_jobs(self._engine, run_end_job, jobs)


def run_end_job(job: EndJob) -> list[End]:
    """Run the members of a job, in a process that may not have the scene yet."""
    simulation = from_settings(scene_from(tomllib.loads(job.scene)), job.plan)
    return [end_of(simulation, job.names, member, job.own_scenes) for member in job.members]


def end_of(simulation: Simulation, names: list[str], member: Member, own_scene: bool) -> End:
    """Run one member; with a search for its own settings where those of all miss its accuracy."""
    shared = simulation
    if own_scene:
        simulation = from_settings(member.scene(simulation.scene), simulation.settings)
    result = simulation.compute(member.start)
    if result.status == Status.COMPLETED and result.met is False:
        scene = member.scene_with_start(shared.scene)
        result = prepare(scene, shared.accuracy, shared.method.name).compute_first()
    status = str(result.status)
    if result.status == Status.COMPLETED and result.met is False:
        status = MISSED
    return End(status, _values(result, names, status), result.cost.steps)


def _values(result: Result, names: list[str], status: str) -> list[np.ndarray]:
    """The quantities at the end; NaN where the run did not complete."""
    ledger = result.ledger.at_end()
    values = [np.asarray(ledger.series(name)[0][-1]) for name in names]
    if status != Status.COMPLETED:
        return [np.full_like(value, np.nan) for value in values]
    return values
