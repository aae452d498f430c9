"""Members of a scene of two asperites: run by one compiled loop, checked, and refined.

All members are run by one method with one setting (:mod:`tribo.ensembles.pair_plan`).  The first
members, one in so many of the others, and all that took more evaluations than the plan says, are
run again with a finer setting.
A member that misses its accuracy is delivered from the finer run, once that agrees with a still
finer one, or else from a run of its own with a search for its settings.

What is delivered of a member depends on the plan and on the member alone, not on the members that
are run beside it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import NamedTuple, Protocol, Self

import numpy as np

from tribo.accuracy.cheapest_setting import NEAR_ALONE
from tribo.accuracy.comparison import strictest
from tribo.accuracy.levels import setting_at
from tribo.accuracy.members import FineMembers
from tribo.accuracy.scales import FLOOR, ToleranceScales
from tribo.ensembles.kept_values import STATUS_TYPE, UNKNOWN, Kept, KeptValues
from tribo.ensembles.members import Members
from tribo.integrators.nystrom_tableaux import RKN8, RKN12
from tribo.integrators.step_control import Tolerance
from tribo.kernels.status import COMPLETED, Status
from tribo.pair.members import CODE, EVALUATIONS, STEPS
from tribo.prepared import Simulation
from tribo.run.initial_state import InitialState
from tribo.run.lane_members import PairLanes, has_lanes
from tribo.run.ledger import assemble
from tribo.run.members import MemberRuns, MemberSamples, PairMembers

# Members that are run in one call, at most: some 30 ms, after which it can be interrupted.
CHUNK = 8192
# Samples of all members of one call, at most: 20 MB.
MOST_SAMPLES = 2**17
# Members by which the setting is chosen, the first ones, which are all checked: their share of a
# million is nothing.
SAMPLE = 64
# One member in so many is checked beside them, whatever its evaluations: 2 % of the time.
CHECKED = 256
# Level of a run that checks another, relative to that or to the accuracy: its error is two digits
# smaller.
FINER = 1e-2
# Largest difference of a run from a finer one, in units of the accuracy: the rest is for the error
# of the finer run.
KEPT = 0.9
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
    loop : Loop
        Runs them.
    near : float
        The longest step, as a fraction of the time to the next encounter.
    cost : float
        Time of an evaluation, relative to that of the collocation.
    """

    loop: Loop
    near: float
    cost: float


class PairPlan(NamedTuple):
    """How all members are run.

    Attributes
    ----------
    method : str
        The way to run them.
    level : float
        Of their tolerances.
    most_evaluations : int
        Members that take more are checked.
    scales : tuple of float
        Of the tolerances: fields of :class:`tribo.accuracy.scales.ToleranceScales`.
    """

    method: str
    level: float
    most_evaluations: int
    scales: tuple[float, ...]

    @property
    def attributes(self) -> dict[str, str | float]:
        """The plan as attributes of a data set."""
        return {
            "method": self.method,
            "level": self.level,
            "most_evaluations": self.most_evaluations,
            "scales": json.dumps(self.scales),
        }

    @classmethod
    def from_attributes(cls, attributes: Mapping[str, str | float]) -> Self:
        """The plan in the attributes of a data set."""
        method, level, evaluations, scales = (attributes[name] for name in cls._fields)
        numbers = tuple(json.loads(str(scales)))
        return cls(str(method), float(level), int(evaluations), numbers)


class PairRuns:
    """Runs members of an ensemble of a scene of two asperites.

    Parameters
    ----------
    simulation : Simulation
        Of the ensemble's scene, with the loop of a pair and an accuracy.
    kept : Kept
        What is kept.

    Attributes
    ----------
    plan : PairPlan
        How all members are run; it has to be set.
    ways : dict
        The ways to run members, by method; the first is the collocation, which is exact.
    """

    plan: PairPlan

    def __init__(self, simulation: Simulation, kept: Kept) -> None:
        assert simulation.integrator.pair is not None and simulation.accuracy is not None
        self.simulation = simulation
        self.kept = kept
        asked = simulation.accuracy
        self._accuracy = asked if isinstance(asked, Mapping) else dict.fromkeys(kept.names, asked)
        pair = simulation.integrator.pair
        times = simulation.layout.times
        self.exact = simulation.method.name
        self.ways = {self.exact: Way(PairMembers(pair, times), NEAR_ALONE, 1.0)}
        if has_lanes(pair) and times.size == 2:
            self.ways |= {
                name: Way(PairLanes(pair, method, times[-1]), NEAR_IN_LANES, COST_IN_LANES)
                for name, method in (("rkn8", RKN8), ("rkn12", RKN12))
            }
        self._initial = InitialState(simulation.layout)

    @property
    def chunk(self) -> int:
        """Members that are run in one call."""
        return max(1, min(CHUNK, MOST_SAMPLES // self.simulation.layout.times.size))

    @property
    def strictest(self) -> float:
        """The smallest accuracy that is asked for."""
        return strictest(self._accuracy)

    def compute(self, members: Members) -> KeptValues:
        """Run some members, check and refine them.

        Those that need a search for their own settings have the status UNKNOWN.
        """
        plan = self.plan
        starts = self.starts(members)
        runs = self.run(plan.method, plan.level, plan.scales, starts)
        complete = runs.counts[:, CODE] == COMPLETED
        found = KeptValues(
            dict(zip(self.kept.names, self._values(runs.samples), strict=True)),
            np.where(complete, str(Status.COMPLETED), UNKNOWN).astype(STATUS_TYPE),
            runs.counts[:, STEPS].copy(),
            np.full(complete.size, plan.level),
            np.full(complete.size, np.nan),
        )
        many = runs.counts[:, EVALUATIONS] > plan.most_evaluations
        some = (members.numbers < SAMPLE) | (members.numbers % CHECKED == 0)
        checked = complete & (many | some)
        if checked.any():
            self._refine(found, np.flatnonzero(checked), runs, starts)
        return found

    def starts(self, members: Members) -> np.ndarray:
        """The states of some members at t = 0, (members, 2 coordinates)."""
        return self._initial.of_members(members.numbers.size, members.values)

    def run(
        self, method: str, level: float, scales: tuple[float, ...], starts: np.ndarray
    ) -> MemberRuns:
        """Run members by one way with tolerances of one level."""
        way = self.ways[method]
        tolerance = tolerance_at(self.simulation, ToleranceScales(*scales), level, way.near)
        return way.loop.run(tolerance, starts)

    def excess(self, fine: MemberRuns, runs: MemberRuns) -> np.ndarray:
        """The largest difference of each member from a finer run, in units of its accuracy.

        Infinite where either run did not complete.
        """
        exact = FineMembers(self.simulation.layout, fine.samples, self._accuracy)
        excess = exact.excess(runs.samples)
        complete = (runs.counts[:, CODE] == COMPLETED) & (fine.counts[:, CODE] == COMPLETED)
        return np.where(complete & np.isfinite(excess), excess, np.inf)

    def finer(self, level: float) -> float:
        """The level of runs that check those of another level."""
        return max(FLOOR, FINER * min(level, self.strictest))

    def _values(self, samples: MemberSamples) -> list[np.ndarray]:
        """The kept quantities, (members, [times,] [asperites])."""
        ledger = assemble(self.simulation.layout, samples)
        found = []
        for name in self.kept.names:
            series = ledger.series(name)[0]
            each = series.reshape(-1, samples.members, *series.shape[1:])
            found.append(np.moveaxis(each, 0, 1) if self.kept.at_samples else each[-1])
        return found

    def _refine(
        self, found: KeptValues, now: np.ndarray, runs: MemberRuns, starts: np.ndarray
    ) -> None:
        """Check members with some places, and deliver those that miss from finer runs."""
        coarse, level = _of_members(runs, now), self.plan.level
        for _ in range(REFINEMENTS + 1):
            level = self.finer(level)
            fine = self.run(self.exact, level, self.plan.scales, starts[now])
            excess = self.excess(fine, coarse)
            known = np.isfinite(excess)
            found.error[now] = np.where(known, excess * self.strictest, np.nan)
            bad = ~(excess <= KEPT)
            now, coarse = now[bad], _of_members(fine, bad)
            if not now.size:
                return
            for name, values in zip(self.kept.names, self._values(coarse.samples), strict=True):
                found.values[name][now] = values
            found.level[now], found.steps[now] = level, coarse.counts[:, STEPS]
        found.status[now] = UNKNOWN


def _of_members(runs: MemberRuns, selected: np.ndarray) -> MemberRuns:
    return MemberRuns(runs.samples.of_members(selected), runs.counts[selected])


def tolerance_at(
    simulation: Simulation, scales: ToleranceScales, level: float, near: float
) -> Tolerance:
    """The setting of members at a level of their errors."""
    setting = setting_at(simulation.layout, simulation.method, scales, level, near)
    assert isinstance(setting, Tolerance)
    return setting
