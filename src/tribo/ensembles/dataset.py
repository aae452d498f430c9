"""Ensembles as labelled data sets: series, means, intervals, and how the members were run."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from tribo.ensembles.intervals import Interval, interval
from tribo.ensembles.members import VELOCITY
from tribo.ensembles.runner import Runner, SettingsCheck
from tribo.kernels.status import Status
from tribo.ledger.quantities import ASPERITE_QUANTITIES, EVERY_QUANTITY, OPTIONAL_QUANTITIES, UNITS
from tribo.ledger.separation import PART
from tribo.model.initial import UNITS as UNITS_OF_START
from tribo.results.dataset import Variable
from tribo.results.intervals import CONFIDENCE

if TYPE_CHECKING:
    import xarray

# Quantities of asperites, whose sums over a surface are kept.
SUMMED = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES


@dataclass(eq=False)
class Collected:
    """The results of an ensemble.

    Attributes
    ----------
    runner
        has run the members
    check
        second runs of some of them
    half_width
        that was asked for, by quantity
    first_stage
        complete members whose spread determined the number of all; None if that was given
    needed
        complete members that the half-width takes
    """

    runner: Runner
    check: SettingsCheck
    half_width: Mapping[str, float] | None
    first_stage: int | None
    needed: float

    @cached_property
    def values(self) -> np.ndarray:
        """(members, names, times); NaN after a member stopped."""
        return np.array([outcome.values for outcome in self.runner.outcomes])

    @property
    def means(self) -> Interval:
        """Means over the complete members, and their intervals."""
        return interval(self.runner.complete_values, self.first_stage)

    @property
    def bias(self) -> Interval | None:
        """Means at the step less those at half of it, of the same members; None if not known."""
        halved = self.check.at_half_step
        if len(halved) < 2:
            return None
        return interval(np.array([self.values[k] - values for k, values in halved.items()]))

    def error(self, name: str) -> float | None:
        """The largest error estimate of a quantity in a single run, times the terms of a sum."""
        surface, _, kind = name.rpartition(".")
        terms = 1
        if kind in SUMMED:
            part = self.runner.simulation.layout.parts[surface]
            terms = part.stop - part.start
        errors = [outcome.errors.get(kind) for outcome in self.check.with_estimates]
        return max((terms * error for error in errors if error is not None), default=None)


def dataset(collected: Collected, seconds: float) -> xarray.Dataset:
    """The data set of an ensemble that took `seconds`."""
    import xarray

    variables: dict[str, Variable] = {}
    for k, name in enumerate(collected.runner.names):
        variables |= _series(collected, k, name)
    return xarray.Dataset(variables, _coordinates(collected), _attributes(collected, seconds))


def _series(collected: Collected, k: int, name: str) -> dict[str, Variable]:
    """The variables of the quantity with index `k` and name `name`."""
    kind = name.rpartition(".")[2]
    quantity = EVERY_QUANTITY[kind]
    meaning = quantity.long_name + ", summed over asperites" * (kind in SUMMED)

    def variable(values: np.ndarray | float, *dimensions: str, of: str = "") -> Variable:
        return dimensions, values, {"units": quantity.units, "long_name": of + meaning}

    variables = {name: variable(collected.values[:, k], "member", "time")}
    means, bias, error = collected.means, collected.bias, collected.error(name)
    half = "half-width of the 95 % interval of the "
    variables[f"{name}_mean"] = variable(means.mean[k], "time", of="mean of: ")
    variables[f"{name}_half_width"] = variable(means.half_width[k], "time", of=f"{half}mean of: ")
    if bias is not None:
        variables[f"{name}_bias"] = variable(bias.mean[k], "time", of="bias of the step in: ")
        variables[f"{name}_bias_half_width"] = variable(
            bias.half_width[k], "time", of=f"{half}bias of the step in: "
        )
    if error is not None:
        variables[f"{name}_error"] = variable(error, of="bound on the error of a member's: ")
    return variables


def _coordinates(collected: Collected) -> dict[str, Variable]:
    """The times; and the number, the seed, the status and the varied values of each member."""
    runner = collected.runner
    members = runner.members
    columns = {
        "member": ([member.number for member in members], "member"),
        "seed": ([member.seed for member in members], "seed of the member"),
        "status": ([str(outcome.status) for outcome in runner.outcomes], "end of its run"),
    }
    coordinates: dict[str, Variable] = {
        key: (("member",), np.array(values), {"long_name": meaning})
        for key, (values, meaning) in columns.items()
    }
    times = runner.simulation.scene.times
    coordinates["time"] = (("time",), times, {"units": "time", "long_name": "time"})
    values = {
        key: np.array([np.broadcast_to(m.values[key], (size,)) for m in members])
        for key, size in runner.variation.sizes.items()
    }
    return coordinates | varied_coordinates(values)


def varied_coordinates(varied: Mapping[str, np.ndarray]) -> dict[str, Variable]:
    """The varied values (members, size) of each quantity."""
    coordinates: dict[str, Variable] = {}
    for key, values in varied.items():
        surface, _, kind = key.rpartition(".")
        if kind == VELOCITY:
            about = {"units": UNITS["velocity"], "long_name": "initial velocity of the surface"}
            coordinates[key] = (("member", "axis"), values, about)
            coordinates["axis"] = (("axis",), np.array(["x", "y"]), {"long_name": "axis"})
        elif kind not in UNITS_OF_START:
            coordinates[key] = (("member",), values[:, 0], {"long_name": key})
        else:
            quantity = EVERY_QUANTITY["theta" if kind == "swing" else kind]
            about = {"units": quantity.units, "long_name": f"initial {quantity.long_name}"}
            coordinates[key] = (("member", f"{surface}_asperite"), values, about)
    return coordinates


def _attributes(collected: Collected, seconds: float) -> dict[str, str | float]:
    """Properties of the whole ensemble; text is JSON where it is no word."""
    from tribo import __version__

    runner = collected.runner
    plan = runner.simulation.settings
    return {
        "tribo_version": __version__,
        "numpy_version": np.__version__,
        "scene": runner.simulation.scene.to_toml(),
        "status": str(Status.INTERRUPTED if runner.interrupted else Status.COMPLETED),
        "method": plan.method,
        "step": json.dumps(plan.setting if plan.tuned is None else None),
        "accuracy": json.dumps(plan.accuracy),
        "seed": str(runner.variation.seed),
        "confidence": CONFIDENCE,
        "half_width": json.dumps(collected.half_width),
        "notes": json.dumps(_notes(collected)),
        "seconds": seconds,
    }


def _notes(collected: Collected) -> list[str]:
    """Limitations of the means."""
    runner, first_stage = collected.runner, collected.first_stage
    complete, total = runner.completed, len(runner.members)
    notes = list(dict.fromkeys(runner.outcomes[0].notes))
    if complete < total:
        stopped = sorted({o.status for o in runner.outcomes} - {Status.COMPLETED})
        notes.append(
            f"{total - complete} of {total} members stopped early ({', '.join(stopped)}); means "
            "are over the others"
        )
    parted = sum(any(PART in note for note in o.notes) for o in runner.outcomes if o.completed)
    if parted:
        notes.append(
            f"in {parted} of {total} members surfaces {PART}; means include them, and the series "
            "time_without_contact tells which they are"
        )
    if complete < collected.needed:
        notes.append(
            f"the half-width takes {collected.needed:.0f} complete members, got {complete}"
        )
    rule = "Student's rule"
    if first_stage is not None:
        rule = f"Stein's rule, from the spread of the first {first_stage}"
    notes.append(f"half-widths are by {rule}, for {complete} members, at each time separately")
    return notes + _notes_on_settings(collected.check)


def _notes_on_settings(check: SettingsCheck) -> list[str]:
    """The effect of the step or of the tolerances on the means."""
    if check.with_estimates:
        missed = sum(not outcome.met for outcome in check.with_estimates)
        if not missed:
            return []
        return [f"{missed} of the first {len(check.with_estimates)} members miss their accuracy"]
    if len(check.at_half_step) < 2:
        return ["the effect of the step or of the tolerances on the means was not measured"]
    return [
        f"bias is the mean at the step less that at half of it, of {len(check.at_half_step)} "
        "members; where it is below its half-width it may be chance"
    ]
