"""An ensemble as a labelled data set: series, means, intervals, and what all members share."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.ensembles.intervals import CONFIDENCE, Interval, interval
from tribo.ensembles.members import VELOCITY, Member
from tribo.ensembles.runner import INTERRUPTED, Outcome, Second
from tribo.model.scene_writer import scene_text
from tribo.run.quantities import ASPERITE_QUANTITIES, OPTIONAL_QUANTITIES
from tribo.simulation import Simulation

if TYPE_CHECKING:
    import xarray


@dataclass(eq=False)
class Collected:
    """All that is known of the members of an ensemble."""

    simulation: Simulation  # of the scene itself
    names: list[str]
    members: list[Member]
    outcomes: list[Outcome]
    second: Second
    sizes: dict[str, int]  # numbers of each varied quantity
    seed: int
    first: int | None  # complete members whose spread decided how many there are
    needed: float  # complete members that the accuracy takes
    accuracy: Mapping[str, float] | None
    interrupted: bool

    @cached_property
    def values(self) -> np.ndarray:
        """(members, names, times); NaN where a member had stopped."""
        return np.array([outcome.values for outcome in self.outcomes])

    @property
    def complete(self) -> np.ndarray:
        """(members,) which of them reached the end."""
        return np.array([outcome.completed for outcome in self.outcomes])

    @property
    def means(self) -> Interval:
        """Means over the complete members, and their intervals."""
        return interval(self.values[self.complete], self.first)

    @property
    def bias(self) -> Interval | None:
        """Means at the step less those at half of it, of the same members; None if not known."""
        halved = self.second.halved
        if len(halved) < 2:
            return None
        return interval(np.array([self.values[k] - values for k, values in halved.items()]))

    def error(self, name: str) -> float | None:
        """The largest estimate of a quantity's error in a single run; of a sum, all terms'."""
        surface, _, kind = name.rpartition(".")
        terms = 1
        if kind in ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES:
            part = self.simulation.layout.parts[surface]
            terms = part.stop - part.start
        found = [outcome.errors[kind] for outcome in self.second.errors]
        return max((terms * error for error in found if error is not None), default=None)


def dataset(collected: Collected, seconds: float) -> xarray.Dataset:
    """The data set of an ensemble that took so many seconds."""
    import xarray

    variables: dict[str, Any] = {}
    means, bias = collected.means, collected.bias
    for k, name in enumerate(collected.names):
        variables[name] = (("member", "time"), collected.values[:, k])
        for suffix, found in (("", means), ("_bias", bias)):
            if found is not None:
                variables[name + (suffix or "_mean")] = (("time",), found.mean[k])
                variables[f"{name}{suffix}_half_width"] = (("time",), found.half_width[k])
        error = collected.error(name)
        if error is not None:
            variables[f"{name}_error"] = ((), error)
    times = collected.simulation.scene.times
    return xarray.Dataset(variables, {"time": times} | _own(collected), _about(collected, seconds))


def _own(collected: Collected) -> dict[str, Any]:
    """What each member has of its own, as coordinates."""
    coordinates: dict[str, Any] = {
        "member": [member.number for member in collected.members],
        "seed": (("member",), [member.seed for member in collected.members]),
        "status": (("member",), np.array([o.status for o in collected.outcomes])),
    }
    for key, size in collected.sizes.items():
        values = [np.broadcast_to(m.values[key], (size,)) for m in collected.members]
        surface, _, quantity = key.rpartition(".")
        axis = "axis" if quantity == VELOCITY else f"{surface}_asperite"
        coordinates[key] = (("member", axis), np.array(values))
        if quantity == VELOCITY:
            coordinates["axis"] = ["x", "y"]
    return coordinates


def _about(collected: Collected, seconds: float) -> dict[str, Any]:
    """What all members share."""
    from tribo import __version__

    settings = collected.simulation.settings
    step = settings.setting if settings.tuned is None else None
    return {
        "tribo_version": __version__,
        "numpy_version": np.__version__,
        "scene": scene_text(collected.simulation.scene),
        "status": INTERRUPTED if collected.interrupted else "completed",
        "method": settings.method,
        "step": json.dumps(step),
        "accuracy_of_each": json.dumps(settings.accuracy),
        "seed": str(collected.seed),
        "confidence": CONFIDENCE,
        "accuracy": json.dumps(collected.accuracy),
        "notes": json.dumps(_notes(collected)),
        "seconds": seconds,
    }


def _notes(collected: Collected) -> list[str]:
    """What one should know of the means."""
    complete, everybody = int(np.count_nonzero(collected.complete)), len(collected.members)
    notes = list(dict.fromkeys(collected.outcomes[0].notes))
    if complete < everybody:
        stopped = sorted({o.status for o in collected.outcomes} - {"completed"})
        notes.append(
            f"{everybody - complete} of {everybody} members stopped early ({', '.join(stopped)}), "
            "and are in no mean: it is one of those that did not"
        )
    if complete < collected.needed:
        notes.append(f"the accuracy takes {collected.needed:.0f} members that reach their end")
    rule = "Student's, of all"
    if collected.first is not None:
        rule = f"Stein's, by the spread of the first {collected.first}"
    notes.append(f"half-widths are {rule}, of {complete} members, for each time by itself")
    return notes + _of_settings(collected.second)


def _of_settings(second: Second) -> list[str]:
    """What the step or the tolerances may have to do with the means."""
    if second.errors:
        missed = sum(not outcome.met for outcome in second.errors)
        if not missed:
            return []
        return [f"{missed} of the first {len(second.errors)} members miss the accuracy of each"]
    if len(second.halved) < 2:
        return ["what the step or the tolerances have to do with the means was not looked at"]
    return [
        f"bias is the mean at the step less that at half of it, of {len(second.halved)} members; "
        "where it is below its half-width it cannot be told from chance"
    ]
