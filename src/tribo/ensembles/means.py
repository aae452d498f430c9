"""Means of all sums over time: of a number of members, or of as many as a half-width takes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from tribo import interrupts
from tribo.accuracy.scales import TOTALS
from tribo.ensembles.dataset import (
    COUNTS,
    Attributes,
    attributes_of,
    coordinates_of,
    counts_of,
    times_of,
)
from tribo.ensembles.kept_values import MISSED, Kept, KeptValues, sum_names, total_names
from tribo.ensembles.members import Variation
from tribo.ensembles.runner import Execution, Policy, collect, policy_of, run_members
from tribo.ensembles.single_runs import SingleRuns
from tribo.ensembles.stores import MemberStore
from tribo.kernels.status import MEANINGS, Status
from tribo.ledger.quantities import EVERY_QUANTITY
from tribo.ledger.separation import PART
from tribo.model.scene import Scene
from tribo.prepared import Simulation
from tribo.results.dataset import Variable
from tribo.results.intervals import CONFIDENCE, Interval, interval, members_needed
from tribo.results.notes import run_notes
from tribo.simulation import from_settings
from tribo.validation import POSITIVE, InputError, inside, must_be_one_of, number, short_repr

# Members whose spread determines the number of all, and which are run again to check the settings:
# at 15 degrees of freedom the quantile of Student's distribution is 9 % above that of the normal.
FIRST_STAGE = 16

HalfWidths = Mapping[str, float]


@dataclass
class MeanRuns:
    """Runs of the members whose means are computed."""

    runs: Policy
    variation: Variation
    store: MemberStore
    how: Execution
    interrupted: bool = False

    def up_to(self, count: int) -> KeptValues:
        """So many members, of which those that the store does not have are run.

        Raises InputError if fewer than two members reach their end.
        """
        left = range(self.store.done, count)
        chunks = run_members(self.runs, self.variation, left, self.how)
        self.interrupted = collect(chunks, self.store, self.how.progress)
        found = self.store.values()
        complete = np.count_nonzero(_completed(found))
        if complete < 2:
            if self.interrupted:
                raise KeyboardInterrupt
            statuses = sorted({*found.status.tolist()} - {str(Status.COMPLETED)})
            meanings = (f"{name}: {MEANINGS.get(name, name)}" for name in statuses)
            raise InputError(
                "scene",
                f"is completed by {complete} of {found.status.size} members, and a mean takes at "
                "least two; " + "; ".join(meanings),
            )
        return found

    def again(self, found: KeptValues) -> tuple[np.ndarray, KeptValues | None]:
        """The numbers of the first members that completed, and their runs with other settings.

        With half the step, or with error estimates of single runs; None after an interrupt.
        """
        numbers = np.flatnonzero(_completed(found))[:FIRST_STAGE]
        simulation, kept, own = self.runs.simulation, self.runs.kept, self.variation.own_numbers
        try:
            runs: Policy
            if simulation.accuracy is None:
                half = from_settings(simulation.scene, simulation.settings.at_half_step())
                runs = policy_of(half, kept, own)
            else:
                runs = SingleRuns(simulation, replace(kept, with_errors=True), own)
            chunks = run_members(runs, self.variation, numbers, self.how)
            return numbers, KeptValues.joined(list(chunks))
        except KeyboardInterrupt:
            interrupts.answer()
            self.interrupted = True
            return numbers, None


def means(
    runs: MeanRuns, half_width: HalfWidths | None, most: int
) -> tuple[dict[str, Variable], dict[str, Variable], Attributes]:
    """Variables, coordinates and attributes of means.

    Without a half-width that is wanted, `most` is the number of members.
    """
    first_stage, needed = None, 0.0
    if half_width is None:
        found = runs.up_to(most)
    else:
        found = runs.up_to(max(runs.store.done, min(FIRST_STAGE, most)))
        first_stage = int(np.count_nonzero(_completed(found)[:FIRST_STAGE]))
        if not runs.interrupted:
            needed = _needed(runs.runs.kept, found, half_width, most)
        while not runs.interrupted:
            missing = int(needed - np.count_nonzero(_completed(found)))
            if missing <= 0 or runs.store.done >= most:
                break
            found = runs.up_to(min(runs.store.done + missing, most))
    numbers, check = (np.empty(0, int), None) if runs.interrupted else runs.again(found)
    members = runs.variation.members(np.arange(found.status.size))
    simulation, kept = runs.runs.simulation, runs.runs.kept
    whole = _Means(simulation, kept, found, numbers, check, first_stage)
    coordinates = coordinates_of(members, found) | times_of(kept, simulation.scene)
    status = Status.INTERRUPTED if runs.interrupted else Status.COMPLETED
    attributes = attributes_of(runs.runs, runs.variation) | {
        "status": str(status),
        "confidence": CONFIDENCE,
        "half_width": json.dumps(None if half_width is None else dict(half_width)),
        "notes": json.dumps(whole.notes(needed)),
    }
    return whole.variables(), coordinates, attributes


def checked_half_width(scene: Scene, half_width: HalfWidths) -> dict[str, float]:
    """The half-widths wanted, by quantity.  Raises InputError."""
    if not isinstance(half_width, Mapping) or not half_width:
        raise InputError(
            "half_width",
            f'must map quantities, as {{"upper.W": 1e-2}}, got {short_repr(half_width)}',
        )
    known = total_names(scene) + sum_names(scene)
    for name in half_width:
        if name not in known:
            raise must_be_one_of("half_width", known, name)
    with inside("half_width"):
        return {name: number(name, value, POSITIVE) for name, value in half_width.items()}


def check_series(kept: Kept, half_width: HalfWidths) -> None:
    """Refuse quantities whose series members do not keep.  Raises InputError."""
    for name in half_width:
        if name not in kept.names:
            raise InputError(
                f"half_width.{name}",
                "is a sum over asperites, whose series are too long to keep; give fewer samples",
            )


def _needed(kept: Kept, found: KeptValues, half_width: HalfWidths, most: int) -> float:
    """The members that Stein's rule requires, by the spread of the first.  Raises InputError."""
    first = np.flatnonzero(_completed(found)[:FIRST_STAGE])
    totals = [name for name in kept.names if name.rpartition(".")[2] in TOTALS]
    scale = max(float(np.abs(found.values[name][first]).max()) for name in totals)
    needed = {
        name: members_needed(found.values[name][first], value * scale)
        for name, value in half_width.items()
    }
    name = max(needed, key=lambda key: needed[key])
    if needed[name] > most:
        raise InputError(
            f"half_width.{name}",
            f"would take {needed[name]:.0f} members by the spread of the first {first.size}, and "
            f"at most {most} are allowed; give a larger half-width or more members",
        )
    return needed[name]


def _completed(found: KeptValues) -> np.ndarray:
    return np.asarray(found.status == str(Status.COMPLETED))


@dataclass
class _Means:
    """The means of members, and how far they depend on the settings of the runs."""

    simulation: Simulation
    kept: Kept
    found: KeptValues
    numbers: np.ndarray  # of the members of `check`
    check: KeptValues | None
    first_stage: int | None

    @property
    def complete(self) -> np.ndarray:
        """Which members completed, (members,)."""
        return _completed(self.found)

    def variables(self) -> dict[str, Variable]:
        """The series of all members, their means, and numbers of each run."""
        variables: dict[str, Variable] = {}
        for name in self.kept.names:
            variables |= self._series(name)
        for name, values in counts_of(self.found).items():
            variables[name] = ("member",), values, {"long_name": COUNTS[name]}
        return variables

    def _series(self, name: str) -> dict[str, Variable]:
        quantity = EVERY_QUANTITY[name.rpartition(".")[2]]
        summed = name in sum_names(self.simulation.scene)
        meaning = quantity.long_name + ", summed over asperites" * summed

        def variable(values: np.ndarray | float, *dimensions: str, of: str = "") -> Variable:
            return dimensions, values, {"units": quantity.units, "long_name": of + meaning}

        half = "half-width of the 95 % interval of the "
        mean = interval(self.found.values[name][self.complete], self.first_stage)
        variables = {
            name: variable(self.found.values[name], "member", "time"),
            f"{name}_mean": variable(mean.mean, "time", of="mean of: "),
            f"{name}_half_width": variable(mean.half_width, "time", of=f"{half}mean of: "),
        }
        if (bias := self._bias(name)) is not None:
            variables[f"{name}_bias"] = variable(bias.mean, "time", of="bias of the step in: ")
            variables[f"{name}_bias_half_width"] = variable(
                bias.half_width, "time", of=f"{half}bias of the step in: "
            )
        if (error := self._error(name)) is not None:
            variables[f"{name}_error"] = variable(error, of="bound on the error of a member's: ")
        return variables

    @property
    def _halved(self) -> KeptValues | None:
        """The runs at half the step that reached their end; None of fewer than two."""
        estimated = self.simulation.accuracy is not None
        if self.check is None or estimated or np.count_nonzero(_completed(self.check)) < 2:
            return None
        return self.check

    def _bias(self, name: str) -> Interval | None:
        """The mean at the step less that at half of it, of the same members."""
        halved = self._halved
        if halved is None:
            return None
        off = self.found.values[name][self.numbers] - halved.values[name]
        return interval(off[_completed(halved)])

    def _error(self, name: str) -> float | None:
        """The largest error of a member that was run again with an error estimate."""
        if self.check is None or name not in self.check.errors:
            return None
        off = np.abs(self.found.values[name][self.numbers] - self.check.values[name])
        bounds = off.max(axis=1) + self.check.errors[name]
        known = np.isfinite(bounds)
        return float(bounds[known].max()) if known.any() else None

    def notes(self, needed: float) -> list[str]:
        """Limitations of the means."""
        simulation, total = self.simulation, self.complete.size
        step = simulation.plan.setting if simulation.accuracy is None else None
        assert step is None or isinstance(step, float)
        first = str(self.found.note[0]).splitlines()
        parted = [note for note in self.found.note[self.complete].tolist() if PART in note]
        of_first = [note for note in first if PART not in note]
        notes = list(
            dict.fromkeys([*run_notes(simulation.layout, simulation.method, step), *of_first])
        )
        complete = np.count_nonzero(self.complete)
        if complete < total:
            stopped = sorted({*self.found.status[~self.complete].tolist()})
            notes.append(
                f"{total - complete} of {total} members stopped early ({', '.join(stopped)}); "
                "means are over the others"
            )
        if parted:
            notes.append(
                f"in {len(parted)} of {total} members surfaces {PART}; means include them, and the "
                "series time_without_contact tells which they are"
            )
        if complete < needed:
            notes.append(f"the half-width takes {needed:.0f} complete members, got {complete}")
        rule = "Student's rule"
        if self.first_stage is not None:
            rule = f"Stein's rule, from the spread of the first {self.first_stage}"
        notes.append(f"half-widths are by {rule}, for {complete} members, at each time separately")
        return notes + self._notes_on_settings()

    def _notes_on_settings(self) -> list[str]:
        """The effect of the step or of the tolerances on the means."""
        if self.check is not None and self.check.errors:
            missed = np.count_nonzero(self.check.status == MISSED)
            first = f"{missed} of the first {self.numbers.size} members"
            return [f"{first} miss their accuracy"] if missed else []
        if self._halved is None:
            return ["the effect of the step or of the tolerances on the means was not measured"]
        return [
            "bias is the mean at the step less that at half of it, of "
            f"{np.count_nonzero(_completed(self._halved))} members; where it is below its "
            "half-width it may be chance"
        ]
