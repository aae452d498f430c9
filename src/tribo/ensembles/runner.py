"""Running the members of an ensemble, in this process or in those of an executor."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from tribo import interrupts
from tribo.accuracy.plan import Plan
from tribo.accuracy.scales import reported_scales
from tribo.ensembles.engines import Engine, run_jobs
from tribo.ensembles.members import Member, Variation
from tribo.kernels.status import MEANINGS, Status
from tribo.layout.further_series import further_series, system_names
from tribo.ledger.quantities import (
    BLOCK_QUANTITIES,
    FURTHER_OF_SURFACES,
    SYSTEM_QUANTITIES,
    needs_accounts,
)
from tribo.ledger.sinks import exceeds_memory
from tribo.model.scene import Scene
from tribo.model.scene_file import scene_from
from tribo.model.surface import Surface
from tribo.prepared import Simulation
from tribo.result import Result
from tribo.simulation import from_settings
from tribo.validation import InputError

# Members whose spread determines the number of all, and which are run again to check the settings:
# at 15 degrees of freedom the quantile of Student's distribution is 9 % above that of the normal.
FIRST_STAGE = 16
# Jobs that members are divided into for an executor.
JOBS = 32
# Works of each asperite whose sums over a surface are kept.
WORKS = ("w1", "w2", "wL", "wR", "w_int")


class Outcome(NamedTuple):
    """The part of a member's result that is kept."""

    status: Status
    values: np.ndarray  # (names, times); NaN after it stopped
    scale: float  # of totals, by tribo.accuracy.scales.reported_scales
    errors: dict[str, float | None]  # as a result's error_estimate
    met: bool | None
    notes: tuple[str, ...]

    @property
    def completed(self) -> bool:
        """Whether it reached its end."""
        return self.status == Status.COMPLETED


class SettingsCheck(NamedTuple):
    """Second runs of some members, by which the settings are checked; empty if interrupted."""

    at_half_step: Mapping[int, np.ndarray] = {}  # values (names, times) by the members' numbers
    with_estimates: Sequence[Outcome] = ()  # with error estimates of single runs


class Job(NamedTuple):
    """Some members and how they are run; it can be pickled."""

    scene: str  # as text
    plan: Plan
    names: list[str]
    members: list[Member]
    own_scenes: bool
    estimate: bool


def total_names(scene: Scene) -> list[str]:
    """Names of the series of the surfaces as wholes and of the system."""
    blocks = [
        f"{surface.name}.{name}"
        for surface in scene.surfaces
        for name in (*BLOCK_QUANTITIES, *_further(scene, surface))
    ]
    return _kept(scene, [*blocks, *SYSTEM_QUANTITIES, *system_names(scene)])


def _further(scene: Scene, surface: Surface) -> list[str]:
    """Names of the series of a surface as a whole that the scene's output asks for."""
    asked = further_series(scene, surface)
    return [name for name in FURTHER_OF_SURFACES if name in asked]


def _kept(scene: Scene, names: list[str]) -> list[str]:
    """The names that do not need a ledger which the scene does without."""
    none = scene.output.ledger == "none"
    return [name for name in names if not (none and needs_accounts(name.rpartition(".")[2]))]


def sum_names(scene: Scene) -> list[str]:
    """Names of the works and heats of asperites that are summed over their surface."""
    names = []
    for surface in scene.surfaces:
        fields = any(surface.name in item.on for item in scene.fields)
        kinds = WORKS + ("w_field",) * fields + ("w_T", "heat") * bool(surface.reservoirs)
        names += [f"{surface.name}.{kind}" for kind in kinds]
    return _kept(scene, names)


class Runner:
    """Runs members and keeps their outcomes.

    Parameters
    ----------
    simulation
        of the ensemble's scene; all members are run by its plan
    variation
        the differences between members
    engine
        runs the members; None for this process
    progress
        called with the number of members that have been run

    Attributes
    ----------
    names
        of the series that are kept
    members, outcomes
        those that have been run, in order
    interrupted
        whether an interrupt ended the runs
    """

    def __init__(
        self,
        simulation: Simulation,
        variation: Variation,
        engine: Engine | None,
        progress: Callable[[int], None] | None,
    ) -> None:
        self.simulation = simulation
        self.variation = variation
        self.names = total_names(simulation.scene)
        if not exceeds_memory(simulation.layout, simulation.scene.times.size):
            self.names += sum_names(simulation.scene)
        self.members: list[Member] = []
        self.outcomes: list[Outcome] = []
        self.interrupted = False
        self._engine = engine
        self._progress = progress

    @property
    def completed(self) -> int:
        """The number of members that reached their end."""
        return sum(outcome.completed for outcome in self.outcomes)

    @property
    def complete_values(self) -> np.ndarray:
        """(complete members, names, times) values."""
        return np.array([o.values for o in self.outcomes if o.completed])

    def add(self, count: int) -> None:
        """Run `count` more members.  After an interrupt those that are complete are kept.

        Raises InputError if fewer than two members reach their end.
        """
        start = len(self.members)
        members = [self.variation.member(k) for k in range(start, start + count)]
        runs = self._run(members, self.simulation.settings, False)
        try:
            for member in members:
                outcome = next(runs)
                if outcome.status == Status.INTERRUPTED:
                    raise KeyboardInterrupt
                self.members.append(member)
                self.outcomes.append(outcome)
                if self._progress is not None:
                    self._progress(len(self.members))
        except KeyboardInterrupt:
            interrupts.answer()
            self.interrupted = True
            if self.completed < 2:
                raise
        if self.completed < 2:
            statuses = sorted({o.status for o in self.outcomes} - {Status.COMPLETED})
            raise InputError(
                "scene",
                f"is completed by {self.completed} of {len(self.outcomes)} members, and a mean "
                "takes at least two; "
                + "; ".join(f"{status}: {MEANINGS[status]}" for status in statuses),
            )

    def check_settings(self) -> SettingsCheck:
        """Run the first members again, with half the step or with error estimates."""
        complete = [m for m, o in zip(self.members, self.outcomes, strict=True) if o.completed]
        first = complete[:FIRST_STAGE]
        plan = self.simulation.settings
        estimate = plan.tuned is not None
        try:
            again = list(self._run(first, plan if estimate else plan.at_half_step(), estimate))
            if any(o.status == Status.INTERRUPTED for o in again):
                raise KeyboardInterrupt
        except KeyboardInterrupt:
            interrupts.answer()
            self.interrupted = True
            return SettingsCheck()
        if estimate:
            return SettingsCheck(with_estimates=again)
        numbered = zip(first, again, strict=True)
        return SettingsCheck(at_half_step={m.number: o.values for m, o in numbered if o.completed})

    def _run(self, members: list[Member], plan: Plan, estimate: bool) -> Iterator[Outcome]:
        """Outcomes in the members' order."""
        own_scenes = self.variation.own_scenes
        if self._engine is not None:
            size = -(-len(members) // JOBS)
            text = self.simulation.scene.to_toml()  # from which plug-ins are loaded there
            jobs = [
                Job(text, plan, self.names, members[k : k + size], own_scenes, estimate)
                for k in range(0, len(members), size)
            ]
            for outcomes in run_jobs(self._engine, run_job, jobs):
                yield from outcomes
            return
        simulation = from_settings(self.simulation.scene, plan)
        for member in members:
            yield run_member(simulation, self.names, member, own_scenes, estimate)


def run_job(job: Job) -> list[Outcome]:
    """Run the members of a job, in a process that may not have the scene yet."""
    simulation = from_settings(scene_from(tomllib.loads(job.scene)), job.plan)
    return [
        run_member(simulation, job.names, member, job.own_scenes, job.estimate)
        for member in job.members
    ]


def run_member(
    simulation: Simulation, names: list[str], member: Member, own_scene: bool, estimate: bool
) -> Outcome:
    """Run one member.

    Parameters
    ----------
    simulation
        of the ensemble's scene
    names
        of the series that are kept
    member
        its initial values, velocities and seed
    own_scene
        whether members differ in more than initial angles and rates
    estimate
        whether to estimate the run's errors
    """
    if own_scene:
        simulation = from_settings(member.scene(simulation.scene), simulation.settings)
    result = simulation.compute(member.start, estimate=estimate)
    return Outcome(
        result.status,
        _values(result, names),
        reported_scales(simulation.layout, result.ledger).total,
        result.error_estimate,
        result.met,
        result.notes,
    )


def _values(result: Result, names: list[str]) -> np.ndarray:
    """(names, times) series of a result at the times of its scene, summed over asperites."""
    times = result.scene.times
    found = [result.ledger.series(name)[0] for name in names]
    series = [item if item.ndim == 1 else np.sum(item, axis=1) for item in found]
    values = np.full((len(series), times.size), np.nan)
    values[:, np.isin(times, result.t)] = np.array(series)[:, np.isin(result.t, times)]
    return values
