"""How members of a scene are run: each as a run of its own, or many by one compiled loop."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np

from tribo.accuracy.choose_method import check_damped_step, check_resolved
from tribo.ensembles.kept_values import MISSED, REFUSED, UNKNOWN, Kept, KeptValues, set_notes
from tribo.ensembles.members import Members, is_random, values_at_start
from tribo.integrators.methods import Method, refusal
from tribo.kernels.status import EVALUATIONS, STEPS, Status
from tribo.layout.layout import Layout
from tribo.layout.own_numbers import member_numbers
from tribo.ledger.guards import MOST_MISSED, lost_samples, missed_energy, passed_through
from tribo.ledger.ledger import assemble
from tribo.ledger.separation import PART, parted
from tribo.loops.batch import MemberRuns, MemberStarts, padded
from tribo.loops.lane_loop import fit_lanes
from tribo.loops.resolution import longest_damped_step
from tribo.model.identity import as_sent, received
from tribo.model.scene import Scene
from tribo.prepared import Simulation
from tribo.result import Result
from tribo.results import notes as notes_on
from tribo.simulation import from_settings, prepare
from tribo.validation import InputError

# Members that are run in one call, at most: of a pair some 30 ms, which delay an interrupt.
CHUNK = 8192
# Work of a call for members of larger scenes [force evaluations x asperites], one by one and in
# lanes: some 0.05 s, to which the ledgers of all its members add a few milliseconds.
CHUNK_WORK = 1e6
CHUNK_WORK_IN_LANES = 4e6
# Samples of all members of one call, at most: 20 MB.
MOST_SAMPLES = 2**17
# Numbers in the samples of all members of a call, at most: 16 MB.
MOST_NUMBERS = 2**21


class Policy(ABC):
    """Runs members by the settings of a simulation, and keeps `kept` of each; it can be pickled.

    The keys `own_numbers` are of what members differ in beside initial angles and rates.
    """

    chunk: int  # members that are run in one call
    plan: Any = None  # what was found for all members, beside the settings of the simulation

    def __init__(self, simulation: Simulation, kept: Kept, own_numbers: Sequence[str]) -> None:
        self.simulation = simulation
        self.kept = kept
        self.own_numbers = own_numbers

    @abstractmethod
    def compute(self, members: Members) -> KeptValues:
        """Run some members; those that need a run with settings of their own have UNKNOWN."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the scene as text, with the sources from which plug-ins are loaded."""
        scene = as_sent(self.simulation.scene)
        settings = self.simulation.settings
        given = type(self), scene, settings, self.kept, self.own_numbers
        return _restored, given, {"plan": self.plan}

    def begin(self, members: Members) -> MemberStarts:
        """Members before their runs, with the numbers in which they differ beside their starts."""
        simulation = self.simulation
        angles = values_at_start(members.values)
        numbers = None
        y = simulation.initial_state.of_members(angles, members.seeds)
        if self.own_numbers:
            numbers = member_numbers(simulation.layout, len(y), members.values)
        return MemberStarts(y, members.seeds, numbers)

    def complete(self, members: Members) -> KeptValues:
        """Run some members in this thread, also those that need settings of their own."""
        return self.run_alone(members, self.compute(members))

    def run_alone(self, members: Members, found: KeptValues) -> KeptValues:
        """`found`, where UNKNOWN members are run: with the given step, or with their own search."""
        simulation = self.simulation
        kept = self.kept
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


def _restored(kind: type[Policy], scene: Any, settings: Any, *others: Any) -> Policy:
    return kind(from_settings(received(*scene), settings), *others)


class SingleRuns(Policy):
    """Runs members of any scene one by one, first by the settings of its simulation.

    Members with effects for which the tolerances of the scene have no numbers are UNKNOWN.
    """

    chunk = 1

    def compute(self, members: Members) -> KeptValues:
        """Run some members; those that miss their accuracy are UNKNOWN, unless errors are kept."""
        found = self.kept.without_runs(members.numbers.size)
        for index in range(members.numbers.size):
            result = self._run(members, index)
            if result is None:
                continue
            missed = result.status == Status.COMPLETED and result.met is False
            if not missed or self.kept.with_errors:
                self.kept.fill_in(found, index, result)
        return found

    def _run(self, members: Members, index: int) -> Result | None:
        """The result of a member by the settings of the scene; None where these do not fit it."""
        simulation = self.simulation
        if not members.values and members.seeds[index] == simulation.scene.seed:
            return simulation.compute_first()
        if self.own_numbers or is_random(simulation.scene):
            scene = members.scene(index, simulation.scene)
            _check_method(simulation.method, scene)
            simulation = from_settings(scene, simulation.settings)
            if self._differs(simulation.layout):
                return None
            step = simulation.plan.setting.step
            method = simulation.method
            if simulation.plan.tuned is None and step is not None and method.splits:
                check_resolved(simulation.layout, method, step)
        # The errors of sums are those of some members, which are run again.
        estimate = self.kept.with_errors or not self.kept.counts
        return simulation.compute(members.start(index), estimate=estimate)

    def _differs(self, layout: Layout) -> bool:
        """Whether the tolerances of the scene, if it has some, are of other numbers."""
        of_scene = self.simulation
        adaptive = of_scene.plan.setting.tolerance is not None
        return adaptive and layout.numbering != of_scene.layout.numbering


def _check_method(method: Method, scene: Scene) -> None:
    """Refuse members with effects that the scene, for which the method was chosen, does not have.

    Raises InputError.
    """
    why = refusal(method, scene)
    if why is not None:
        raise InputError(
            "vary",
            f"gives members effects that the scene does not have: method {why}; give the scene "
            "itself such values, as a temperature above 0",
        )


def chunk_of(simulation: Simulation, evaluations: float | None) -> int:
    """Members that are run in one call, by a member's evaluations of all forces; None of a pair."""
    layout = simulation.layout
    if evaluations is None:
        return max(1, min(CHUNK, MOST_SAMPLES // layout.times.size))
    numbers = layout.times.size * (2 * layout.core + layout.accounts)
    in_lanes = fit_lanes(layout, simulation.method)
    work = CHUNK_WORK_IN_LANES if in_lanes else CHUNK_WORK
    quick = work / (evaluations * layout.asperites.size)
    members = max(1, int(min(CHUNK, quick, MOST_NUMBERS / numbers)))
    return padded(members) if in_lanes else members


def kept_series(kept: Kept, runs: MemberRuns) -> dict[str, np.ndarray]:
    """The kept quantities, (members, [times,] [asperites])."""
    ledger = assemble(runs.layout, runs.samples)
    found = {}
    for name in kept.names:
        series = kept.of_asperites(ledger.series(name)[0])
        each = series.reshape(-1, runs.samples.runs, *series.shape[1:])
        found[name] = np.moveaxis(each, 0, 1) if kept.at_samples else each[-1]
    return found


def complete_members(runs: MemberRuns, guarded: bool = False) -> np.ndarray:
    """Which members completed; not those that passed, or, if `guarded`, whose energy runs away."""
    complete = runs.complete & ~passed_members(runs)
    if guarded:
        complete &= ~_at_any_time(runs, lost_samples(runs.layout, runs.samples))
    return np.asarray(complete)


def passed_members(runs: MemberRuns) -> np.ndarray:
    """Which members have a surface that passed another one, (members,)."""
    return _at_any_time(runs, passed_through(runs.layout, runs.samples))


def _at_any_time(runs: MemberRuns, found: np.ndarray) -> np.ndarray:
    """Where something was found in members, by rows of their samples: (members,)."""
    return np.asarray(found.reshape(-1, len(runs.counts)).any(axis=0))


def delivered(kept: Kept, runs: MemberRuns, level: float, complete: np.ndarray) -> KeptValues:
    """What is kept of some runs; all that are not `complete` are UNKNOWN."""
    members = len(runs.counts)
    found = kept.without_runs(members) | kept_series(kept, runs)
    found["status"][complete] = str(Status.COMPLETED)
    found["steps"] = runs.counts[:, STEPS].copy()
    found["force_evaluations"] = runs.counts[:, EVALUATIONS].copy()
    found["level"][:] = level
    if kept.counts:
        found["note"] = np.where(parted(runs.layout, runs.samples), f"surfaces {PART}", "")
    return found


class StepRuns(Policy):
    """Runs members in batches with the given step of the simulation, also with noise."""

    def __init__(self, simulation: Simulation, kept: Kept, own_numbers: Sequence[str]) -> None:
        super().__init__(simulation, kept, own_numbers)
        layout = simulation.layout
        self._batch = simulation.integrator.batch(bool(own_numbers))
        self._setting = simulation.plan.setting
        self._step = self._setting.of_equal_steps()
        self.chunk = chunk_of(simulation, layout.scene.duration / self._step + layout.times.size)

    def compute(self, members: Members) -> KeptValues:
        """Run some members; those that do not complete have UNKNOWN.  Raises InputError."""
        starts = self.begin(members)
        runs = self._run(starts)
        found = delivered(self.kept, runs, math.nan, self._resolved(runs))
        if runs.stiffness is not None and self.simulation.scene.is_noisy:
            found["excess"] = runs.stiffness.excess(self._step)
            missed, through = self._missed_energy(runs)
            for index in np.flatnonzero(missed > MOST_MISSED * through).tolist():
                own = notes_on.missed_energy(float(missed[index]), float(through[index]))
                set_notes(found, index, "\n".join(filter(None, [str(found["note"][index]), own])))
        return found

    def run(self, members: Members) -> MemberRuns:
        """Run some members with the step of the plan."""
        return self._run(self.begin(members))

    def misses_energy(self, runs: MemberRuns) -> bool:
        """Whether no work accounts for too much of the energy of some runs together."""
        missed, through = self._missed_energy(runs)
        return bool(np.sum(missed) > MOST_MISSED * np.sum(through))

    def _missed_energy(self, runs: MemberRuns) -> tuple[np.ndarray, np.ndarray]:
        """As `missed_energy`, of the runs that completed; zeros of the others."""
        ledger = assemble(runs.layout, runs.samples)
        missed, through = missed_energy(runs.layout, ledger, len(runs.counts))
        complete = complete_members(runs)
        return np.where(complete, missed, 0.0), np.where(complete, through, 0.0)

    def shorter_step(self, runs: MemberRuns) -> float | None:
        """A shorter step, if that of the plan does not resolve the motion of some runs.

        Those in which a surface passed another one would do so with any step.
        """
        stiffness = runs.stiffness
        assert stiffness is not None
        if not np.all(self._resolved(runs) | passed_members(runs)):
            return stiffness.shorter(self._step)
        together = stiffness.together()
        return together.shorter(self._step) if together.exceeds(self._step) else None

    def _run(self, starts: MemberStarts) -> MemberRuns:
        """Run some members with the step of the plan."""
        simulation = self.simulation
        own = starts.numbers
        if own is not None and simulation.method.splits:  # refuse a step too long for some member
            check_damped_step(longest_damped_step(simulation.layout, own), self._step)
            check_resolved(simulation.layout, simulation.method, self._step, own)
        return self._batch.run(self._setting, starts)

    def _resolved(self, runs: MemberRuns) -> np.ndarray:
        """Which members completed, with a step that resolves their motion if it was chosen."""
        complete = complete_members(runs, guarded=True)
        if self.simulation.plan.automatic and runs.stiffness is not None:
            complete &= ~runs.stiffness.exceeds(self._step)
        return complete
