"""The runs of the points of a sweep: one run each, or an ensemble each."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np

from tribo.ensembles import ensemble
from tribo.ensembles.engines import Engine, run_jobs
from tribo.ensembles.intervals import interval
from tribo.ensembles.kept_ensemble import END, Wanted
from tribo.ensembles.kept_values import MISSED, Kept
from tribo.ensembles.members import Source, Variation
from tribo.ensembles.runner import total_names
from tribo.kernels.status import Status
from tribo.layout.layout import lay_out
from tribo.ledger.ledger import assemble
from tribo.ledger.samples import Samples
from tribo.model.scene import Scene
from tribo.model.scene_file import scene_from
from tribo.simulation import prepare
from tribo.validation import InputError, is_list, short_repr

# Statuses of which a point has values.
WITH_VALUES = (str(Status.COMPLETED), MISSED)


class Members(NamedTuple):
    """The members of each point.

    Attributes
    ----------
    number : int
        How many there are.
    vary : dict
        What differs between them.
    seed : int
        Of the ensembles.
    """

    number: int
    vary: dict[str, Source]
    seed: int

    def drawn(self, scene: Scene) -> dict[str, Any]:
        """The values that are drawn for the members, as JSON."""
        variation = Variation(scene, self.vary, self.seed)
        return {key: variation.rows(key, np.arange(self.number)).tolist() for key in self.vary}


@dataclass(frozen=True)
class Found:
    """What is kept of a point; all of it can be JSON.

    Attributes
    ----------
    status : str
        How its run ended; of members, "completed" or the first other status.
    values : dict
        Name -> numbers, of the shape ([members,] [asperites]).
    errors : dict
        Name -> a bound on the error of a single run.
    counts : dict
        Steps, force evaluations and seconds.
    note : str
        Why there are no values, or what else to know.
    """

    # Statuses of points without a result.
    INTERRUPTED: ClassVar[str] = str(Status.INTERRUPTED)
    REFUSED: ClassVar[str] = "Refused"

    status: str
    values: dict[str, Any] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)
    counts: dict[str, float] = field(default_factory=dict)
    note: str = ""


class Job(NamedTuple):
    """A point and how it is run; it can be pickled."""

    scene: str  # as text
    names: Sequence[str]
    group: Members | None


def kept_names(scene: Scene, keep: Sequence[str] | None) -> list[str]:
    """The names of the quantities that are kept, each once.  Raises InputError."""
    keep = scene.output.keep if keep is None else keep
    if keep is None:
        return total_names(scene)
    if not is_list(keep) or len(keep) == 0:
        raise InputError("keep", f'must list quantities, as ["upper.W"], got {short_repr(keep)}')
    layout = lay_out(_recording(scene, list(map(str, keep))))
    ledger = assemble(layout, Samples.at_zero(layout))
    for name in map(str, keep):
        surface, _, kind = name.rpartition(".")
        if kind not in (ledger.of(surface) if surface in layout.parts else ledger.system):
            first = scene.surfaces[0].name
            raise InputError(
                f"keep.{name}",
                f'must be a quantity of a surface, as "{first}.W" or "{first}.w1", or one of the '
                'system, as "contact_energy"',
            )
    return list(dict.fromkeys(map(str, keep)))


def _recording(scene: Scene, keep: Sequence[str]) -> Scene:
    """The scene with the times and the series that the kept quantities need."""
    output = Wanted(keep, END, False, None, False).scene(scene).output
    return replace(scene, output=replace(output, ledger=scene.output.ledger))


def found_at(
    scenes: Sequence[Scene], names: Sequence[str], group: Members | None, engine: Engine | None
) -> Iterator[Found]:
    """What is found at each point, in order."""
    if engine is None:
        for scene in scenes:
            yield run_point(scene, names, group)
        return
    jobs = [Job(scene.to_toml(), names, group) for scene in scenes]
    yield from run_jobs(engine, run_job, jobs)


def run_job(job: Job) -> Found:
    """Run a point in a process that may not have its scene yet."""
    return run_point(scene_from(tomllib.loads(job.scene)), job.names, job.group)


def run_point(scene: Scene, names: Sequence[str], group: Members | None) -> Found:
    """Run a point."""
    try:
        return _single(scene, names) if group is None else _several(scene, names, group)
    except InputError as error:
        return Found(Found.REFUSED, note=str(error))
    except KeyboardInterrupt:
        return Found(Found.INTERRUPTED)


def _single(scene: Scene, names: Sequence[str]) -> Found:
    """One run."""
    simulation = prepare(_recording(scene, names), threads=1)
    kept = Kept.checked(simulation, names, False)
    result = simulation.compute_first()
    status = str(result.status)
    if result.status == Status.COMPLETED and result.met is False:
        status = MISSED
    counts = {name: getattr(result.cost, name) for name in ("steps", "force_evaluations")}
    counts["seconds"] = result.cost.wall_seconds
    if status not in WITH_VALUES:
        return Found(status, counts=counts, note=result.shortcoming)
    found = kept.values_of(result, result.ledger.at_end())
    values = {name: np.asarray(each).tolist() for name, each in found.items()}
    bounds = result.error_estimate
    errors = {name: bounds.get(name, bounds.get(name.rpartition(".")[2])) for name in values}
    known = {name: bound for name, bound in errors.items() if bound is not None}
    note = result.shortcoming or "; ".join(result.notes)
    return Found(status, values, known, counts, note)


def _several(scene: Scene, names: Sequence[str], group: Members) -> Found:
    """An ensemble."""
    data = ensemble(scene, group.number, group.vary, group.seed, progress=False, keep=list(names))
    others = [str(status) for status in data["status"].values if status != Status.COMPLETED]
    every = json.loads(data.attrs["keep"])
    kept = {name: f"{name}_end" if f"{name}_end" in data else name for name in every}
    return Found(
        others[0] if others else str(Status.COMPLETED),
        {name: data[own].values.tolist() for name, own in kept.items()},
        counts={"steps": int(data["steps"].sum()), "seconds": data.attrs["seconds"]},
        note=f"{len(others)} of {group.number} members have no values" if others else "",
    )


def mean_and_half_width(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean over the members (the first axis) that have values, and its interval; else NaN."""
    complete = values[~np.isnan(values).reshape(len(values), -1).any(axis=1)]
    if len(complete) < 2:
        nothing = np.full(values.shape[1:], np.nan)
        return nothing, nothing
    found = interval(complete)
    return found.mean, found.half_width
