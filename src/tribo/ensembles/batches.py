"""Members that one compiled loop runs together: how many, and what is kept of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tribo.ensembles.kept_values import STATUS_TYPE, UNKNOWN, Kept, KeptValues
from tribo.ensembles.members import Members, values_at_start
from tribo.kernels.status import EVALUATIONS, STEPS, Status
from tribo.layout.initial_state import InitialState
from tribo.layout.member_numbers import member_numbers
from tribo.ledger.ledger import assemble
from tribo.ledger.passing import passed_through
from tribo.ledger.runaway import grows
from tribo.ledger.separation import PART, parted
from tribo.loops.batch import MemberRuns, MemberStarts, padded
from tribo.loops.lane_loop import fit_lanes
from tribo.prepared import Simulation

# Members that are run in one call, at most: of a pair some 30 ms, after which an interrupt is
# answered.
CHUNK = 8192
# Work of a call for members of larger scenes [force evaluations x asperites], one by one and in
# lanes: some 0.05 s, to which the ledgers of all its members add a few milliseconds.
CHUNK_WORK, CHUNK_WORK_IN_LANES = 1e6, 4e6
# Samples of all members of one call, at most: 20 MB.
MOST_SAMPLES = 2**17
# Numbers in the samples of all members of a call, at most: 16 MB.
MOST_NUMBERS = 2**21


def starts_of(
    simulation: Simulation, initial: InitialState, members: Members, own_numbers: Sequence[str]
) -> MemberStarts:
    """Some members before their runs, with the numbers in which they differ beside their starts."""
    y = initial.of_members(values_at_start(members.values), members.seeds)
    numbers = member_numbers(simulation.layout, len(y), members.values) if own_numbers else None
    return MemberStarts(y, members.seeds, numbers)


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
    ledger, found = assemble(runs.layout, runs.samples), {}
    for name in kept.names:
        series = kept.of_asperites(ledger.series(name)[0])
        each = series.reshape(-1, runs.samples.runs, *series.shape[1:])
        found[name] = np.moveaxis(each, 0, 1) if kept.at_samples else each[-1]
    return found


def delivered(kept: Kept, runs: MemberRuns, level: float, guarded: bool = False) -> KeptValues:
    """What is kept of some runs; those that did not complete have the status UNKNOWN.

    With `guarded`, those whose energy grows without bound count as not completed too.
    """
    members = len(runs.counts)
    found = KeptValues.without_runs(kept, members)
    found.values = kept_series(kept, runs)
    stopped = passed_through(runs.layout, runs.samples)
    if guarded:
        stopped = stopped | grows(runs.layout, runs.samples)
    complete = runs.complete & ~stopped.reshape(-1, members).any(axis=0)
    found.status = np.where(complete, str(Status.COMPLETED), UNKNOWN).astype(STATUS_TYPE)
    found.steps, found.evaluations = (runs.counts[:, k].copy() for k in (STEPS, EVALUATIONS))
    found.level[:] = level
    if kept.counts:
        found.note = np.where(parted(runs.layout, runs.samples), f"surfaces {PART}", "")
    return found
