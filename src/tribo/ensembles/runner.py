"""Running the members of an ensemble, one like the other, here or by an executor's processes."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from tribo.accuracy import scales as acc
from tribo.accuracy.plan import Plan
from tribo.ensembles.members import Member, Variation
from tribo.kernels.status import MEANINGS, Status
from tribo.model.scene import Scene
from tribo.model.scene_file import scene_from
from tribo.model.scene_writer import scene_text
from tribo.run.quantities import BLOCK_QUANTITIES, SYSTEM_QUANTITIES
from tribo.run.result import Result
from tribo.run.streamed_ledger import exceeds_memory
from tribo.simulation import Simulation, from_settings
from tribo.validation import InputError, short_repr

FIRST = 16  # members, whose spread decides how many there will be, and which are run again
CHUNKS = 32  # that an executor is handed at a time
INTERRUPTED = "Interrupted"
WORKS = ("w1", "w2", "wL", "wR", "w_int")  # of every asperite


class Outcome(NamedTuple):
    """What is kept of one member's run."""

    status: Status
    values: np.ndarray  # (names, times); NaN after it stopped
    scale: float  # of energies, by tribo.accuracy.scales.reported_scales
    errors: dict[str, float | None]  # as a result's error_estimate
    met: bool | None
    notes: tuple[str, ...]

    @property
    def completed(self) -> bool:
        """Whether it reached its end."""
        return self.status == "completed"


class Second(NamedTuple):
    """What was found by running some members once more; empty if that was interrupted."""

    halved: Mapping[int, np.ndarray] = {}  # values at half the step, by the members' numbers
    errors: Sequence[Outcome] = ()  # with estimates of the errors of single runs


def bulk_names(scene: Scene) -> list[str]:
    """Names of the series of the surfaces as wholes and of the system."""
    blocks = [f"{s.name}.{name}" for s in scene.surfaces for name in BLOCK_QUANTITIES]
    return [*blocks, *SYSTEM_QUANTITIES]


def sum_names(scene: Scene) -> list[str]:
    """Names of works that are reported of asperites, whose sums over a surface have means too."""
    names = []
    for surface in scene.surfaces:
        fields = any(surface.name in item.on for item in scene.fields)
        kinds = WORKS + ("w_field",) * fields + ("w_T", "heat") * bool(surface.langevin)
        names += [f"{surface.name}.{kind}" for kind in kinds]
    return names


def check_engine(engine: Any) -> None:
    """Complain about what takes no jobs; None is nobody, and will do."""
    if engine is not None and not (hasattr(engine, "submit") or hasattr(engine, "map")):
        raise InputError(
            "engine", f"must have submit or map, as an executor has, got {short_repr(engine)}"
        )


class Runner:
    """The members that have been run, and how."""

    def __init__(
        self, simulation: Simulation, variation: Variation, engine: Any, progress: Any
    ) -> None:
        """Nobody has been run yet."""
        self.simulation = simulation
        self.names = bulk_names(simulation.scene)
        if not exceeds_memory(simulation.layout, simulation.scene.times.size):
            self.names += sum_names(simulation.scene)
        self.members: list[Member] = []
        self.outcomes: list[Outcome] = []
        self.interrupted = False
        self._variation = variation
        self._engine = engine
        self._progress = progress
        self._anew = variation.random or variation.moves

    @property
    def completed(self) -> int:
        """How many members reached their end."""
        return sum(outcome.completed for outcome in self.outcomes)

    @property
    def complete(self) -> np.ndarray:
        """(complete members, names, times) values."""
        return np.array([o.values for o in self.outcomes if o.completed])

    def add(self, count: int) -> None:
        """Run that many members more.  After an interrupt those that are complete are kept."""
        start = len(self.members)
        members = [self._variation.member(k) for k in range(start, start + count)]
        runs = self._run(members, self.simulation.settings, False)
        try:
            for member in members:
                outcome = next(runs)
                if outcome.status == INTERRUPTED:
                    raise KeyboardInterrupt
                self.members.append(member)
                self.outcomes.append(outcome)
                if self._progress is not None:
                    self._progress(len(self.members))
        except KeyboardInterrupt:
            self.interrupted = True
            if self.completed < 2:
                raise
        if self.completed < 2:
            statuses = sorted({o.status for o in self.outcomes} - {"completed"})
            raise InputError(
                "scene",
                f"is completed by {self.completed} of {len(self.outcomes)} members, and a mean "
                "is of two at least; "
                + "; ".join(f"{status}: {MEANINGS[status]}" for status in statuses),
            )

    def look_again(self) -> Second:
        """The first members once more, at half the step or for the estimates of their errors."""
        some = [m for m, o in zip(self.members, self.outcomes, strict=True) if o.completed][:FIRST]
        settings = self.simulation.settings
        estimate = settings.tuned is not None
        if not estimate:
            settings = settings.at_half_step()
        try:
            again = list(self._run(some, settings, estimate))
        except KeyboardInterrupt:
            return Second()
        if any(o.status == INTERRUPTED for o in again):
            return Second()
        if estimate:
            return Second(errors=again)
        numbered = zip(some, again, strict=True)
        return Second(halved={m.number: o.values for m, o in numbered if o.completed})

    def _run(self, members: list[Member], settings: Plan, estimate: bool) -> Iterator[Outcome]:
        """Outcomes in the members' order."""
        if self._engine is None:
            here = from_settings(self.simulation.scene, settings)
            return (
                run_member(here, self.names, member, self._anew, estimate) for member in members
            )
        return self._sent(members, settings, estimate)

    def _sent(self, members: list[Member], settings: Plan, estimate: bool) -> Iterator[Outcome]:
        """The same by the engine; a scene travels as its file, whose plug-ins are loaded there."""
        size = -(-len(members) // CHUNKS)
        text = scene_text(self.simulation.scene)
        jobs = [
            (text, settings, self.names, members[k : k + size], self._anew, estimate)
            for k in range(0, len(members), size)
        ]
        if not hasattr(self._engine, "submit"):
            for outcomes in self._engine.map(run_chunk, jobs):
                yield from outcomes
            return
        futures = [self._engine.submit(run_chunk, job) for job in jobs]
        try:
            for future in futures:
                yield from future.result()
        finally:
            for future in futures:
                future.cancel()


def run_chunk(job: tuple[str, Plan, list[str], list[Member], bool, bool]) -> list[Outcome]:
    """Run some members in a process that knows nothing of the scene yet."""
    text, settings, names, members, anew, estimate = job
    simulation = from_settings(scene_from(tomllib.loads(text)), settings)
    return [run_member(simulation, names, member, anew, estimate) for member in members]


def run_member(
    simulation: Simulation, names: list[str], member: Member, anew: bool, estimate: bool
) -> Outcome:
    """One member; `anew` where more of its scene is its own than initial angles and rates."""
    if anew:
        simulation = from_settings(member.scene(simulation.scene), simulation.settings)
    result = simulation.compute(member.start, estimate=estimate)
    return Outcome(
        result.status,
        _values(result, names),
        acc.reported_scales(simulation.layout, result.ledger).energy,
        result.error_estimate,
        result.met,
        result.notes,
    )


def _values(result: Result, names: list[str]) -> np.ndarray:
    """(names, times) series of a result at the times of its scene, asperites' summed."""
    times = result.scene.times
    found = [result.ledger.series(name)[0] for name in names]
    series = [item if item.ndim == 1 else np.sum(item, axis=1) for item in found]
    values = np.full((len(series), times.size), np.nan)
    values[:, np.isin(times, result.t)] = np.array(series)[:, np.isin(result.t, times)]
    return values
