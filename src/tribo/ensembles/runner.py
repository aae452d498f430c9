"""Runs of the members of an ensemble: by one policy, in threads of this process or by an engine.

A policy says how members are run and checked: all with the step of the plan (StepRuns), with one
setting in batches and finer ones where needed (CheckedRuns), or each on its own (SingleRuns).
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tribo import interrupts
from tribo.accuracy.levels import work
from tribo.ensembles.batches import Policy, SingleRuns, StepRuns
from tribo.ensembles.checked_runs import CheckedPlan, CheckedRuns, checked_plan
from tribo.ensembles.common_step import with_common_step
from tribo.ensembles.engines import Engine, in_threads, run_tasks
from tribo.ensembles.kept_values import Kept, KeptValues
from tribo.ensembles.members import Members, Variation
from tribo.ensembles.request import Request
from tribo.ensembles.stores import Store
from tribo.layout.own_numbers import can_differ
from tribo.ledger.sinks import exceeds_memory
from tribo.loops.batch import has_batches
from tribo.loops.lane_loop import fit_lanes
from tribo.prepared import Simulation
from tribo.threads.shared_run import wanted_threads
from tribo.validation import must_be

# Work of a member in batches with an accuracy, at most [force evaluations x asperites]: 4 ms, as a
# result takes.  Of longer runs, those that choose the setting take longer than what batches save.
MOST_WORK = 3e4
# Ensembles that a process of an engine has ready at the same time.
MOST_READY = 4


class Execution(NamedTuple):
    """What runs the members, and what is told."""

    engine: Engine | None = None  # runs them in other processes
    threads: int = 1  # of this process, without an engine
    progress: Callable[[int], None] | None = None  # takes the number of members so far

    @classmethod
    def checked(cls, engine: Engine | None, threads: int | None) -> Execution:
        """What runs members, with so many threads.  Raises InputError."""
        if engine is not None and not (hasattr(engine, "submit") or hasattr(engine, "map")):
            raise must_be("engine", "an executor, with submit or map", engine)
        return cls(engine, wanted_threads(threads)[0])

    def collect(self, chunks: Iterable[KeptValues], store: Store) -> bool:
        """Take in the next members, in order, and tell how many there are; whether interrupted."""
        try:
            for found in chunks:
                store.add(found)
                if self.progress is not None:
                    self.progress(store.done)
        except KeyboardInterrupt:
            interrupts.answer()
            return True
        return False


class Runs(NamedTuple):
    """Members that are run: how, which they are, and by what."""

    policy: Policy
    variation: Variation
    how: Execution

    def chunks(self, numbers: range | np.ndarray) -> Iterator[KeptValues]:
        """What is kept of members with some numbers, which ascend, in order, chunk by chunk."""
        policy = self.policy
        how = self.how
        firsts = range(0, len(numbers), policy.chunk)
        # Values are drawn in this thread: distributions need not be safe in others.
        chunks = (self.variation.members(np.asarray(numbers[k : k + policy.chunk])) for k in firsts)
        if how.engine is not None:
            content = pickle.dumps(policy)
            yield from run_tasks(how.engine, _run_task, ((content, some) for some in chunks))
            return
        threads = 1 if isinstance(policy, SingleRuns) else how.threads  # Python runs between these

        def compute(some: Members) -> tuple[Members, KeptValues]:
            return some, policy.compute(some)

        for some, found in in_threads(compute, chunks, threads):
            yield policy.run_alone(some, found)

    def fill(self, store: Store, count: int) -> bool:
        """Run the members that a store of `count` does not have; whether that was interrupted."""
        return self.how.collect(self.chunks(range(store.done, count)), store)


def planned(
    request: Request,
    simulation: Simulation,
    kept: Kept,
    variation: Variation,
    count: int,
    how: Execution,
) -> Runs:
    """The runs of an ensemble of `count` members, by the policy that suits it.

    Raises InputError if the accuracy is out of reach.
    """
    searched = simulation.plan.pilot is None
    if not searched and not in_batches(simulation, variation.own_numbers):
        simulation = request.search(simulation)
        searched = True
    policy = policy_of(simulation, kept, variation.own_numbers)
    if simulation.plan.automatic:
        policy = with_common_step(policy, variation, count)
    if isinstance(policy, CheckedRuns):
        policy.plan = checked_plan(policy, variation, count, how.threads)
        # Levels are far above the accuracy, unless small errors grow.
        if not searched and policy.plan.level < policy.strictest:
            request.search(simulation)
    return Runs(policy, variation, how)


def policy_of(
    simulation: Simulation, kept: Kept, own_numbers: Sequence[str], plan: CheckedPlan | None = None
) -> Policy:
    """The fastest way to run members of a scene, with the plan of all if that is known."""
    if plan is None and not in_batches(simulation, own_numbers):
        return SingleRuns(simulation, kept, own_numbers)
    if simulation.accuracy is None:
        return StepRuns(simulation, kept, own_numbers)
    policy: Policy = CheckedRuns(simulation, kept, own_numbers)
    policy.plan = plan
    return policy


def in_batches(simulation: Simulation, own_numbers: Sequence[str]) -> bool:
    """Whether members are run in batches: in lanes, also those with some numbers of their own."""
    layout = simulation.layout
    pair = simulation.integrator.pair
    if layout.scene.output.series or exceeds_memory(layout, layout.times.size):
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


_ready = lru_cache(MOST_READY)(pickle.loads)


def _run_task(task: tuple[bytes, Members]) -> KeptValues:
    """Run some members, in a process that may not have the scene yet."""
    policy: Policy = _ready(task[0])
    return policy.complete(task[1])
