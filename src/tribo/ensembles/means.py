"""Means of all sums over time: of a number of members, or of as many as a half-width takes."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from tribo import interrupts
from tribo.accuracy.scales import TOTALS
from tribo.ensembles import kept_values
from tribo.ensembles.batches import SingleRuns
from tribo.ensembles.dataset import members_dataset, settings_attributes
from tribo.ensembles.runner import Runs, policy_of
from tribo.ensembles.stores import MemberStore, Target
from tribo.kernels.status import MEANINGS, Status
from tribo.ledger.separation import PART
from tribo.model.scene import Scene
from tribo.results.averages import CONFIDENCE, interval, members_needed
from tribo.results.notes import NO_WORK, run_notes
from tribo.results.result_file import Variable
from tribo.simulation import from_settings
from tribo.validation import POSITIVE, InputError, inside, number, one_of, short_repr

if TYPE_CHECKING:
    import xarray

# Members whose spread determines the number of all, and which are run again to check the settings:
# at 15 degrees of freedom the quantile of Student's distribution is 9 % above that of the normal.
FIRST_STAGE = 16
HALF_WIDTH = "half-width of the 95 % interval of the "


def mean_dataset(
    runs: Runs,
    target: Target,
    half_width: dict[str, float] | None,
    most: int,
    of_scene: Sequence[str],
) -> xarray.Dataset:
    """The means of `most` members, or of as many as a half-width takes.

    Their notes begin with those `of_scene`.  Raises InputError.
    """
    store = MemberStore(target.frames)
    first_stage = None
    needed = 0.0
    first = most if half_width is None else max(store.done, min(FIRST_STAGE, most))
    found, interrupted = _up_to(runs, store, first)
    if half_width is not None:
        first_stage = int(np.count_nonzero(kept_values.completed(found)[:FIRST_STAGE]))
        needed = 0.0 if interrupted else _needed(runs.policy.kept, found, half_width, most)
    while not interrupted and store.done < most:
        missing = int(needed - np.count_nonzero(kept_values.completed(found)))
        if missing <= 0:
            break
        found, interrupted = _up_to(runs, store, min(store.done + missing, most))
    numbers = np.flatnonzero(kept_values.completed(found))[:FIRST_STAGE]
    check = None if interrupted else _again(runs, numbers)
    means = _Means(runs, found, numbers, check, first_stage, needed)
    notes = dict.fromkeys([*of_scene, *means.notes()])
    attributes = target.attributes(check is None, notes)
    attributes |= settings_attributes(runs) | {
        "confidence": CONFIDENCE,
        "half_width": json.dumps(half_width),
        "doubtful": means.doubtful,
    }
    members = runs.variation.members(np.arange(found["status"].size))
    return target.saved(means.added_to(members_dataset(runs.policy, members, found, attributes)))


def _up_to(runs: Runs, store: MemberStore, count: int) -> tuple[kept_values.KeptValues, bool]:
    """So many members, of which those that the store does not have are run, or fewer."""
    interrupted = runs.fill(store, count)
    found = store.values()
    complete = np.count_nonzero(kept_values.completed(found))
    if complete < 2:
        if interrupted:
            raise KeyboardInterrupt
        statuses = sorted({*found["status"].tolist()} - {str(Status.COMPLETED)})
        meanings = "; ".join(f"{name}: {MEANINGS.get(name, name)}" for name in statuses)
        few = f"{complete} of {found['status'].size} members, where a mean takes two"
        raise InputError("scene", f"is completed by {few}; {meanings}")
    return found, interrupted


def _again(runs: Runs, numbers: np.ndarray) -> kept_values.KeptValues | None:
    """Members with half the step, or with error estimates of single runs; None if interrupted."""
    policy = runs.policy
    simulation = runs.policy.simulation
    try:
        if simulation.accuracy is None:
            half = from_settings(simulation.scene, simulation.settings.at_half_step())
            again = policy_of(half, policy.kept, policy.own_numbers)
        else:
            kept = replace(policy.kept, with_errors=True)
            again = SingleRuns(simulation, kept, policy.own_numbers)
        return kept_values.joined(list(runs._replace(policy=again).chunks(numbers)))
    except KeyboardInterrupt:
        interrupts.answer()
        return None


def checked_half_width(scene: Scene, half_width: object) -> dict[str, float]:
    """The half-widths wanted, by quantity.  Raises InputError."""
    if not isinstance(half_width, Mapping) or not half_width:
        wanted = 'must map quantities, as {"upper.W": 1e-2}'
        raise InputError("half_width", f"{wanted}, got {short_repr(half_width)}")
    known = kept_values.total_names(scene) + kept_values.sum_names(scene)
    for name in half_width:
        one_of("half_width", name, known)
    with inside("half_width"):
        return {name: number(name, value, POSITIVE) for name, value in half_width.items()}


def check_series(kept: kept_values.Kept, half_width: Mapping[str, float]) -> None:
    """Refuse quantities whose series members do not keep.  Raises InputError."""
    for name in half_width:
        if name not in kept.names:
            raise InputError(
                f"half_width.{name}",
                "is a sum over asperites, whose series are too long to keep; give fewer samples",
            )


def _needed(
    kept: kept_values.Kept, found: kept_values.KeptValues, half_width: dict[str, float], most: int
) -> float:
    """The members that Stein's rule requires, by the spread of the first.  Raises InputError."""
    first = np.flatnonzero(kept_values.completed(found)[:FIRST_STAGE])
    totals = [name for name in kept.names if name.rpartition(".")[2] in TOTALS]
    scale = max(float(np.abs(found[name][first]).max()) for name in totals)
    needed = {
        name: members_needed(found[name][first], value * scale)
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


@dataclass
class _Means:
    """The means of members, and how far they depend on the settings of the runs."""

    runs: Runs
    found: kept_values.KeptValues
    numbers: np.ndarray  # of the members of `check`
    check: kept_values.KeptValues | None  # with other settings
    first_stage: int | None
    needed: float  # complete members

    def added_to(self, data: xarray.Dataset) -> xarray.Dataset:
        """The data set of the members with their means."""
        added: dict[str, Variable] = {}
        for name in self.runs.policy.kept.names:
            units, meaning = (data[name].attrs[key] for key in ("units", "long_name"))
            mean = interval(self.found[name][kept_values.completed(self.found)], self.first_stage)
            values = {"_mean": (mean.mean, "mean of: ")}
            values["_half_width"] = mean.half_width, f"{HALF_WIDTH}mean of: "
            for ending, (value, of) in (values | self._effect_of_settings(name)).items():
                about = {"units": units, "long_name": of + meaning}
                added[f"{name}{ending}"] = ("time",) * np.ndim(value), value, about
        return data.assign(added)

    def _effect_of_settings(self, name: str) -> dict[str, tuple[np.ndarray, str]]:
        """The mean at the step less that at half of it, or the largest error of a member."""
        if self.check is None:
            return {}
        off = self.found[name][self.numbers] - self.check[name]
        if self.runs.policy.simulation.accuracy is not None:
            bounds = np.abs(off).max(axis=1) + self.check[f"{name}{kept_values.ERROR}"]
            known = bounds[np.isfinite(bounds)]
            of = "bound on the error of a member's: "
            return {kept_values.ERROR: (known.max(), of)} if known.size else {}
        if self._checked < 2:
            return {}
        bias = interval(off[kept_values.completed(self.check)])
        of = "bias of the step in: "
        return {"_bias": (bias.mean, of), "_bias_half_width": (bias.half_width, HALF_WIDTH + of)}

    @property
    def _checked(self) -> int:
        """The members that reached their end with other settings."""
        return 0 if self.check is None else int(np.count_nonzero(kept_values.completed(self.check)))

    @property
    def doubtful(self) -> int:
        """Members that completed, if others ran away with the same given step."""
        plan = self.runs.policy.simulation.plan
        if plan.accuracy is not None or plan.automatic:
            return 0
        return kept_values.doubtful(Counter(self.found["status"].tolist()))

    def notes(self) -> Iterator[str]:
        """What a reader of the means has to know: members left out, half-widths, bias."""
        simulation = self.runs.policy.simulation
        status = self.found["status"]
        complete = kept_values.completed(self.found)
        note = self.found["note"]
        number = int(np.count_nonzero(complete))
        total = complete.size
        step = simulation.plan.setting.step if simulation.accuracy is None else None
        counted = (PART, NO_WORK)  # in all members, below
        lines = str(note[0]).splitlines()
        of_first = [line for line in lines if not any(words in line for words in counted)]
        of_scene = run_notes(simulation.layout, simulation.method, step)
        yield from dict.fromkeys([*of_scene, *of_first])
        if number < total:
            stopped = ", ".join(sorted({*status[~complete].tolist()}))
            early = f"{total - number} of {total} members stopped early ({stopped})"
            yield f"{early}; means are over the others"
        if step is not None and not simulation.plan.automatic:
            statuses = Counter(status.tolist())
            known = self.found["excess"][~np.isnan(self.found["excess"])]
            yield from kept_values.step_notes(
                statuses, float(np.mean(known)) if known.size else 0.0, step
            )
        missing = sum(NO_WORK in line for line in note[complete].tolist())
        yield from kept_values.missing_note(missing, total)
        if parted := sum(PART in line for line in note[complete].tolist()):
            yield (
                f"in {parted} of {total} members surfaces {PART}; means include them, and the "
                "series time_without_contact tells which they are"
            )
        if number < self.needed:
            yield f"the half-width takes {self.needed:.0f} complete members, got {number}"
        rule = "Student's rule"
        if self.first_stage is not None:
            rule = f"Stein's rule, from the spread of the first {self.first_stage}"
        yield f"half-widths are by {rule}, for {number} members, at each time separately"
        if self.check is not None and simulation.accuracy is not None:
            if missed := np.count_nonzero(self.check["status"] == kept_values.MISSED):
                yield f"{missed} of the first {self.numbers.size} members miss their accuracy"
        elif self._checked < 2:
            yield "the effect of the step or of the tolerances on the means was not measured"
        else:
            yield (
                f"bias is the mean at the step less that at half of it, of {self._checked} "
                "members; where it is below its half-width it may be chance"
            )
