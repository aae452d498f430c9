"""Members of a scene of two asperites: run by one compiled loop, checked, and refined.

All members are run by one method with one setting: the cheapest of those with which the members of
a sample agree with finer runs, in the quantities that are kept.  Methods are the pair's collocation
and, where the ledger follows from the motion by conservation of energy, explicit ones with members
in lanes.

Then members are run again with a finer setting: the sample, and those that took the most
evaluations, batch by batch, until a batch has none that misses its accuracy.  A member that does is
delivered from the finer run, once that agrees with a still finer one, or else from a run of its own
with a search for its settings.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property, partial
from typing import NamedTuple, Protocol

import numpy as np

from tribo import interrupts
from tribo.accuracy.cheapest_setting import NEAR_ALONE
from tribo.accuracy.comparison import strictest
from tribo.accuracy.levels import setting_at
from tribo.accuracy.members import FineMembers
from tribo.accuracy.scales import FLOOR, ToleranceScales, tolerance_scales
from tribo.ensembles.end_values import MISSED, STATUS_TYPE, EndValues
from tribo.ensembles.members import Variation
from tribo.ensembles.threads import in_threads
from tribo.integrators.nystrom_tableaux import RKN8, RKN12
from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import COMPLETED, Status
from tribo.pair.members import CODE, EVALUATIONS, STEPS
from tribo.prepared import Simulation
from tribo.run.initial_state import InitialState
from tribo.run.lane_members import PairLanes, has_lanes
from tribo.run.ledger import assemble
from tribo.run.members import MemberRuns, MemberSamples, PairMembers
from tribo.simulation import prepare

# Members that a thread runs in one call: some 30 ms, after which it can be interrupted.
CHUNK = 8192
# Members by which the setting is chosen, the first ones: their share of a million is nothing.
SAMPLE = 64
# Levels that are tried, from the loosest, in units of the accuracy.
LEVELS = 2.0 ** np.arange(14.0, -24.0, -0.5)
# Level of a run that checks another, relative to that or to the accuracy: its error is two digits
# smaller.
FINER = 1e-2
# Largest difference of a run from a finer one, in units of the accuracy: the rest is for the error
# of the finer run.
KEPT = 0.9
# The same of the members by which the setting is chosen: others may have larger errors.
CHOSEN = 0.5
# Members that are checked at least, by their evaluations: one in so many, which takes 2 % of the
# time.
CHECKED = 256
# Longest step of members in lanes, as a fraction of the time to the next encounter.
NEAR_IN_LANES = 1.25
# Time of an evaluation of all forces in lanes, relative to that of the collocation: 7 and 15 ns, as
# measured on cases A and C of the paper.
COST_IN_LANES = 0.47
# Times that a member is refined before it gets a run of its own.
REFINEMENTS = 3


class Loop(Protocol):
    """Runs members with a setting."""

    def run(self, tolerance: Tolerance, starts: np.ndarray) -> MemberRuns:
        """Run members from `starts` (members, 2 coordinates), in this thread."""


class Way(NamedTuple):
    """A way to run members.

    Attributes
    ----------
    method : str
        Its name.
    loop : Loop
        Runs them.
    near : float
        The longest step, as a fraction of the time to the next encounter.
    cost : float
        Time of an evaluation, relative to that of the collocation.
    """

    method: str
    loop: Loop
    near: float
    cost: float


class Common(NamedTuple):
    """The setting of all members: a way to run them, and its level."""

    way: Way
    level: float


class Part(NamedTuple):
    """The runs of one chunk of members, of which the kept quantities are known.

    Attributes
    ----------
    values : list of ndarray
        (members, asperites) or (members,) for each name.
    counts : ndarray, (members, 3)
        Columns of :mod:`tribo.pair.members`.
    """

    values: list[np.ndarray]
    counts: np.ndarray


class PairRuns:
    """Runs the members of an ensemble of a scene of two asperites.

    Parameters
    ----------
    simulation : Simulation
        Of the ensemble's scene, with the loop of a pair.
    variation : Variation
        The differences between members, in initial angles and rates.
    names : sequence of str
        Of the quantities that are kept, "upper.w1".
    threads : int
        That run members at the same time.
    progress : callable, optional
        Called with the number of members that have been run.
    """

    def __init__(
        self,
        simulation: Simulation,
        variation: Variation,
        names: Sequence[str],
        threads: int,
        progress: Callable[[int], None] | None,
    ) -> None:
        assert simulation.integrator.pair is not None and simulation.accuracy is not None
        self._simulation = simulation
        asked = simulation.accuracy
        self._accuracy = asked if isinstance(asked, Mapping) else dict.fromkeys(names, asked)
        self._variation = variation
        self._names = names
        self._threads = threads
        self._progress = progress
        self._layout = simulation.layout
        pair, duration = simulation.integrator.pair, simulation.scene.duration
        collocation = PairMembers(pair, np.array([0.0, duration]))
        self._exact = Way(simulation.method.name, collocation, NEAR_ALONE, 1.0)
        self._ways = [self._exact]
        if has_lanes(pair):
            self._ways += [
                Way(name, PairLanes(pair, method, duration), NEAR_IN_LANES, COST_IN_LANES)
                for name, method in (("rkn8", RKN8), ("rkn12", RKN12))
            ]
        self._initial = InitialState(self._layout)
        self._tolerances: dict[tuple[float, float], Tolerance] = {}

    def run(self, count: int) -> EndValues:
        """Run the members from 0 to `count`; after an interrupt those that are complete are kept.

        Raises KeyboardInterrupt if there are fewer than two.
        """
        parts: list[Part] = []
        interrupted = False
        chunks = [range(k, min(k + CHUNK, count)) for k in range(0, count, CHUNK)]
        try:
            common = self._common(count)
            # Values are drawn in this thread: distributions need not be safe in others.
            starts = map(self._starts, chunks)
            for part in in_threads(partial(self._run_chunk, common), starts, self._threads):
                parts.append(part)
                self._report(sum(len(each.counts) for each in parts))
        except KeyboardInterrupt:
            interrupts.answer()
            interrupted = True
            if not parts:
                raise
        found = self._collected(parts, common)
        found.interrupted = interrupted
        if not interrupted:
            self._check(found, np.concatenate([part.counts for part in parts]), common)
        return found

    def _run(self, way: Way, level: float, starts: np.ndarray) -> MemberRuns:
        tolerance = self._tolerances.get((level, way.near))
        if tolerance is None:
            tolerance = tolerance_at(self._simulation, self._scales, level, way.near)
            self._tolerances[level, way.near] = tolerance
        return way.loop.run(tolerance, starts)

    def _report(self, done: int) -> None:
        if self._progress is not None:
            self._progress(done)

    @cached_property
    def _scales(self) -> ToleranceScales:
        return tolerance_scales(self._layout, self._simulation.finest.samples)

    def _starts(self, numbers: np.ndarray | range) -> np.ndarray:
        """The states at t = 0 of some members, (members, 2 coordinates)."""
        first, last = int(numbers[0]), int(numbers[-1])
        values = {key: self._variation.rows(key, first, last + 1) for key in self._variation.sizes}
        starts = self._initial.of_members(last + 1 - first, values)
        return starts[np.asarray(numbers) - first]

    def _run_chunk(self, common: Common, starts: np.ndarray) -> Part:
        runs = self._run(*common, starts)
        return Part(self._values(runs.samples), runs.counts)

    def _values(self, samples: MemberSamples) -> list[np.ndarray]:
        """The kept quantities at the end."""
        ledger, members = assemble(self._layout, samples), samples.members
        return [ledger.series(name)[0][-members:] for name in self._names]

    def _common(self, count: int) -> Common:
        """The cheapest setting that keeps the accuracy of the sample."""
        starts = self._starts(range(min(SAMPLE, count)))
        exact = self._run(self._exact, LEVELS[-1] * strictest(self._accuracy), starts)
        known = exact.counts[:, CODE] == COMPLETED
        fine = self._fine(exact)
        finest = Common(self._exact, max(FLOOR, FINER * strictest(self._accuracy)))
        best, cost = finest, np.inf
        for way in self._ways:
            common, evaluations = self._loosest(way, fine, known, starts)
            if way.cost * evaluations < cost:
                best, cost = common, way.cost * evaluations
        return best

    def _loosest(
        self, way: Way, fine: FineMembers, known: np.ndarray, starts: np.ndarray
    ) -> tuple[Common, float]:
        """The loosest setting that all `known` members of the sample allow, and its cost.

        The cost is in evaluations.
        """
        levels = np.maximum(LEVELS * strictest(self._accuracy), FLOOR)
        evaluations = np.inf
        too_loose, good = -1, levels.size - 1
        while good - too_loose > 1:
            k = (good + too_loose) // 2
            runs = self._run(way, levels[k], starts)
            if np.all(_excess(fine, runs)[known] <= CHOSEN):
                good, evaluations = k, float(runs.counts[:, EVALUATIONS].sum())
            else:
                too_loose = k
        return Common(way, float(levels[good])), evaluations

    def _fine(self, runs: MemberRuns) -> FineMembers:
        return FineMembers(self._layout, runs.samples, self._accuracy)

    def _collected(self, parts: list[Part], common: Common) -> EndValues:
        """The parts side by side."""
        counts = np.concatenate([part.counts for part in parts])
        values = {
            name: np.concatenate([part.values[k] for part in parts])
            for k, name in enumerate(self._names)
        }
        members = len(counts)
        status = np.full(members, str(Status.COMPLETED), dtype=STATUS_TYPE)
        unknown = np.full(members, np.nan)
        attributes: dict[str, str | float] = {
            "method": common.way.method,
            "scales": json.dumps(list(vars(self._scales).values())),
        }
        levels = np.full(members, common.level)
        return EndValues(values, status, counts[:, STEPS], levels, unknown, attributes)

    def _check(self, found: EndValues, counts: np.ndarray, common: Common) -> None:
        """Check members against finer runs, and refine those that miss their accuracy."""
        stopped = np.flatnonzero(counts[:, CODE] != COMPLETED)
        for numbers in self._batches(counts):
            missed = self._refine(found, numbers, common)
            if not missed:
                break
        self._run_alone(found, stopped)

    def _batches(self, counts: np.ndarray) -> Iterator[np.ndarray]:
        """Members to check: the sample and those that took most, then ever more."""
        complete = counts[:, CODE] == COMPLETED
        evaluations = np.where(complete, counts[:, EVALUATIONS], -1)
        order = np.argsort(-evaluations, kind="stable")[: int(complete.sum())]
        sample = np.flatnonzero(complete[:SAMPLE])
        order = np.concatenate([sample, order[~np.isin(order, sample)]])
        size = sample.size + max(SAMPLE, len(counts) // CHECKED)
        while order.size:
            yield np.sort(order[:size])
            order, size = order[size:], 2 * size

    def _refine(self, found: EndValues, numbers: np.ndarray, common: Common) -> int:
        """Check some members and refine those that miss; how many did."""
        chunks = [numbers[k : k + CHUNK] for k in range(0, numbers.size, CHUNK)]
        members = ((chunk, self._starts_of(chunk)) for chunk in chunks)
        refine = partial(self._refine_chunk, found, common)
        missed = sum(in_threads(refine, members, self._threads))
        self._run_alone(found, numbers[found.status[numbers] == MISSED])
        return missed

    def _refine_chunk(
        self, found: EndValues, common: Common, members: tuple[np.ndarray, np.ndarray]
    ) -> int:
        """Refine members, by numbers and starts; how many missed.  Those that still do get MISSED.

        Threads write to different members of `found`.
        """
        now, starts = members
        accuracy = strictest(self._accuracy)
        missed = 0
        coarse = self._run(*common, starts)
        level = min(common.level, accuracy)
        for k in range(REFINEMENTS + 1):
            level = max(FLOOR, FINER * level)
            fine = self._run(self._exact, level, starts)
            excess = _excess(self._fine(fine), coarse)
            excess[fine.counts[:, CODE] != COMPLETED] = np.inf
            bad = ~(excess <= KEPT)
            missed = int(bad.sum()) if k == 0 else missed
            found.error[now] = np.where(np.isfinite(excess), excess * accuracy, np.nan)
            now, starts = now[bad], starts[bad]
            if not now.size:
                break
            coarse = MemberRuns(fine.samples.of_members(bad), fine.counts[bad])
            for name, values in zip(self._names, self._values(coarse.samples), strict=True):
                found.values[name][now] = values
            found.level[now], found.steps[now] = level, coarse.counts[:, STEPS]
        found.status[now] = MISSED
        return missed

    def _starts_of(self, numbers: np.ndarray) -> np.ndarray:
        """The states at t = 0 of members with any numbers, ascending."""
        cuts = np.flatnonzero(np.diff(numbers // CHUNK)) + 1
        return np.concatenate([self._starts(part) for part in np.split(numbers, cuts)])

    def _run_alone(self, found: EndValues, numbers: np.ndarray) -> None:
        """Run members one by one, each with a search for its own settings."""
        shared = self._simulation
        for number in numbers:
            member = self._variation.member(int(number))
            scene = member.scene_with_start(shared.scene)
            simulation = prepare(scene, shared.accuracy, shared.method.name)
            result = simulation.compute_first()
            if result.status == Status.INTERRUPTED:
                raise KeyboardInterrupt
            kept = result.status == Status.COMPLETED and result.met is not False
            missed = result.status == Status.COMPLETED and not kept
            found.status[number] = MISSED if missed else str(result.status)
            found.steps[number] = result.cost.steps
            found.level[number] = found.error[number] = np.nan
            for name in self._names:
                end = result.ledger.series(name)[0][-1]
                found.values[name][number] = end if kept else np.nan


def _excess(fine: FineMembers, runs: MemberRuns) -> np.ndarray:
    """The largest difference of each member, in units of its accuracy; infinite if unknown."""
    excess = fine.excess(runs.samples)
    return np.where((runs.counts[:, CODE] == COMPLETED) & np.isfinite(excess), excess, np.inf)


def tolerance_at(
    simulation: Simulation, scales: ToleranceScales, level: float, near: float
) -> Tolerance:
    """The setting of members at a level of their errors."""
    setting = setting_at(simulation.layout, simulation.method, scales, level, near)
    assert isinstance(setting, Tolerance)
    return setting
