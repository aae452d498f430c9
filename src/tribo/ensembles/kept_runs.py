"""Runs of the members of which named quantities are kept: in threads, or by an engine."""

from __future__ import annotations

import pickle
import tomllib
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tribo import interrupts
from tribo.accuracy.levels import work
from tribo.accuracy.plan import Plan
from tribo.ensembles.checked_plan import checked_plan
from tribo.ensembles.checked_runs import CheckedPlan, CheckedRuns
from tribo.ensembles.engines import Engine, in_threads, run_jobs
from tribo.ensembles.kept_values import Kept, KeptValues
from tribo.ensembles.members import Members, Variation, is_random
from tribo.ensembles.single_runs import SingleRuns, run_alone
from tribo.ensembles.step_runs import StepRuns
from tribo.ensembles.stores import Store
from tribo.layout.member_numbers import can_differ
from tribo.loops.batch_general import has_batches
from tribo.loops.lane_loop import fit_lanes
from tribo.model.scene_file import scene_from
from tribo.prepared import Simulation
from tribo.simulation import from_settings

KeptRuns = CheckedRuns | StepRuns | SingleRuns

# Work of a member in batches with an accuracy, at most [force evaluations x asperites]: 4 ms, which
# a result takes too.  Of longer runs, those by which the setting is chosen would take longer than
# what batches save.
MOST_WORK = 3e4
# Ensembles that a process of an engine has ready at the same time.
MOST_READY = 4


class Setup(NamedTuple):
    """All that a process of an engine needs to run members; it can be pickled."""

    scene: str  # as text, from which plug-ins are loaded there
    plan: Plan
    kept: Kept
    own_numbers: Sequence[str]
    checked: CheckedPlan | None


def kept_runs(
    simulation: Simulation,
    kept: Kept,
    own_numbers: Sequence[str],
    plan: CheckedPlan | None = None,
) -> KeptRuns:
    """The fastest way to run members of a scene, with the plan of all if that is known.

    They differ in starts and seeds, and in numbers with the keys `own_numbers`.
    """
    if plan is None and not _in_batches(simulation, own_numbers):
        return SingleRuns(simulation, kept, bool(own_numbers) or is_random(simulation.scene))
    if simulation.accuracy is None:
        return StepRuns(simulation, kept, own_numbers)
    runs = CheckedRuns(simulation, kept, own_numbers)
    if plan is not None:
        runs.plan = plan
    return runs


def _in_batches(simulation: Simulation, own_numbers: Sequence[str]) -> bool:
    """Whether members are run in batches: in lanes, also those with some numbers of their own."""
    layout, pair = simulation.layout, simulation.integrator.pair
    if layout.scene.output.series:
        return False  # forces and energies as series, and their averages, are of single runs
    if own_numbers and not can_differ(layout, own_numbers, pair is not None):
        return False
    if pair is not None or not has_batches(layout):
        return pair is not None
    if own_numbers and not fit_lanes(layout, simulation.method):
        return False
    tuned = simulation.plan.tuned
    if tuned is None:
        return True
    # Without adaptive steps, their number does not tell which members to check.
    found = simulation.method.adaptive and bool(tuned.runs)
    return found and work(layout, simulation.finest) <= MOST_WORK


def planned_runs(
    simulation: Simulation, kept: Kept, variation: Variation, count: int, threads: int
) -> KeptRuns:
    """Runs of an ensemble of `count` members."""
    runs = kept_runs(simulation, kept, variation.own_numbers)
    if isinstance(runs, CheckedRuns):
        runs.plan = checked_plan(runs, variation, count, threads)
    return runs


def run_members(
    runs: KeptRuns,
    variation: Variation,
    count: int,
    store: Store,
    engine: Engine | None,
    threads: int,
    progress: Callable[[int], None] | None,
) -> bool:
    """Run the members from `store.done` to `count`, in order; whether they were interrupted.

    Parameters
    ----------
    runs : CheckedRuns, StepRuns or SingleRuns
        Runs them.
    variation : Variation
        The differences between members.
    count : int
        Of members.
    store : Store
        Takes the members.  After an interrupt it has those that are complete.
    engine : executor, optional
        Runs them in other processes.
    threads : int
        Of this process, which run them without an engine.
    progress : callable, optional
        Called with the number of members that the store has.
    """
    chunks = range(store.done, count, runs.chunk)
    # Values are drawn in this thread: distributions need not be safe in others.
    members = (variation.members(np.arange(k, min(k + runs.chunk, count))) for k in chunks)
    try:
        for some, found in _parts(runs, variation, members, engine, threads):
            store.add(some, found)
            if progress is not None:
                progress(store.done)
    except KeyboardInterrupt:
        interrupts.answer()
        return True
    return False


def _parts(
    runs: KeptRuns,
    variation: Variation,
    members: Iterator[Members],
    engine: Engine | None,
    threads: int,
) -> Iterator[tuple[Members, KeptValues]]:
    """Chunks of members and what is kept of them, in order."""
    if engine is not None:
        text, plan = runs.simulation.scene.to_toml(), runs.simulation.settings
        setup = pickle.dumps(Setup(text, plan, runs.kept, variation.own_numbers, runs.plan))
        yield from run_jobs(engine, run_job, ((setup, some) for some in members))
        return
    if isinstance(runs, SingleRuns):
        threads = 1  # Python runs between its members

    def compute(some: Members) -> tuple[Members, KeptValues]:
        return some, runs.compute(some)

    for some, found in in_threads(compute, members, threads):
        run_alone(runs.simulation, runs.kept, some, found)
        yield some, found


def run_job(job: tuple[bytes, Members]) -> tuple[Members, KeptValues]:
    """Run some members, in a process that may not have the scene yet."""
    setup, members = job
    return members, complete(_ready(setup), members)


def complete(runs: KeptRuns, members: Members) -> KeptValues:
    """Run some members in this thread, also those that need settings of their own."""
    found = runs.compute(members)
    run_alone(runs.simulation, runs.kept, members, found)
    return found


@lru_cache(MOST_READY)
def _ready(setup: bytes) -> KeptRuns:
    scene, plan, kept, own_numbers, checked = pickle.loads(setup)
    simulation = from_settings(scene_from(tomllib.loads(scene)), plan)
    return kept_runs(simulation, kept, own_numbers, checked)
