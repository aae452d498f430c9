"""Ensembles of which named quantities are kept, in memory or in a file, or their statistics."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tribo.accuracy.choose_method import choose
from tribo.ensembles.engines import Engine
from tribo.ensembles.kept_runs import planned_runs, run_members
from tribo.ensembles.kept_values import Kept, attributes_of
from tribo.ensembles.member_file import MemberFile, identity_in, opened
from tribo.ensembles.members import Variation
from tribo.ensembles.statistics_store import StatisticsStore
from tribo.ensembles.stores import About, InMemory, Store, Target
from tribo.files import netcdf_target
from tribo.integrators.methods import noisy
from tribo.integrators.step_control import count_of_steps
from tribo.layout.layout import lay_out
from tribo.ledger.quantities import FURTHER
from tribo.loops.journal import PART
from tribo.model.identity import Identity, identity_of, refuse_other, settings_of, version
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.prepared import Simulation
from tribo.validation import (
    POSITIVE,
    InputError,
    as_path,
    boolean,
    choice,
    inside,
    is_list,
    number,
)

if TYPE_CHECKING:
    import xarray

# When quantities are kept.
END, SAMPLES = "end", "samples"


class Wanted(NamedTuple):
    """What is kept, and where; the fields are arguments of :func:`tribo.ensemble`."""

    keep: Sequence[str]
    at: str
    statistics: bool
    out: str | Path | None
    resume: bool

    def scene(self, scene: Scene) -> Scene:
        """The scene with the times, and with the further series, that the quantities need."""
        given = self.keep if is_list(self.keep) else ()  # refused later
        names = [str(name).rpartition(".")[2] for name in given]
        series = tuple(word for word, group in FURTHER.items() if any(n in group for n in names))
        output = replace(scene.output, series=series, keep=None)
        at_end = choice("at", self.at, (END, SAMPLES)) == END
        if at_end and "forces" not in series:  # forces are averages over times
            output = Output(samples=2, series=series)
        return replace(scene, output=output)

    def step(self, scene: Scene, method: str | None, step: float | None) -> float | None:
        """The step of members with noise: as in a run that records all times of the scene.

        Equal steps end at the sample times, and a member's path depends on its steps.
        """
        intervals, given = np.diff(scene.times), scene.numerics
        if self.at != END or not noisy(scene) or np.ptp(intervals) > 1e-9 * intervals[0]:
            return step
        if step is None:
            with inside("numerics"):
                found = choose(lay_out(scene), given.accuracy, method or given.method, given.step)
            step = found.step
        else:
            step = number("step", step, POSITIVE)
        assert step is not None  # there is one wherever there is noise
        return float(intervals[0] / count_of_steps(intervals[0], step))

    @staticmethod
    def check_absent(at: str, statistics: bool, out: object, resume: bool) -> None:
        """Refuse arguments that mean nothing without kept quantities."""
        given = {"at": at != END, "statistics": statistics, "out": out is not None}
        for name, there in (given | {"resume": resume}).items():
            if there:
                raise InputError(name, 'needs keep, as keep=["upper.w1"]')


def kept_ensemble(
    simulation: Simulation,
    variation: Variation,
    count: int,
    wanted: Wanted,
    engine: Engine | None,
    threads: int,
    progress: Callable[[int], None] | None,
) -> xarray.Dataset:
    """The data set of `count` members, or of those that are complete after an interrupt.

    Raises KeyboardInterrupt if there are none.
    """
    began = time.perf_counter()
    kept = Kept.checked(simulation, wanted.keep, wanted.at == SAMPLES)
    statistics, resume = boolean("statistics", wanted.statistics), boolean("resume", wanted.resume)
    target = _target(simulation, variation, count, wanted)
    if target is None and resume:
        raise InputError("resume", "needs out, the file to continue")
    if target is not None and resume and target.path.exists() and not target.part.exists():
        refuse_other(target.path, identity_in(target.path), target.identity)
        return opened(target.path)
    runs = planned_runs(simulation, kept, variation, count, threads)
    attributes = attributes_of(simulation, variation.seed) | {
        "n": count,
        "keep": json.dumps(kept.names),
        "own_numbers": json.dumps(variation.own_numbers),
    }
    if runs.plan is not None:
        attributes |= runs.plan.attributes
    store = _store(About(simulation, kept, count, attributes), target, statistics, resume)
    interrupted = run_members(runs, variation, count, store, engine, threads, progress)
    return store.dataset(interrupted, time.perf_counter() - began)


def _store(about: About, target: Target | None, statistics: bool, resume: bool) -> Store:
    if statistics:
        return StatisticsStore(about, target, resume)
    return InMemory(about) if target is None else MemberFile(about, target, resume)


def _target(
    simulation: Simulation, variation: Variation, count: int, wanted: Wanted
) -> Target | None:
    """The files, and what tells the ensemble from others; None without `out`."""
    if wanted.out is None:
        return None
    path = netcdf_target("out", as_path(wanted.out))
    part = path.with_name(path.name + PART)
    plan = simulation.plan
    step = plan.setting if plan.accuracy is None and isinstance(plan.setting, float) else None
    settings: Identity = {
        "seed": variation.seed,
        "n": count,
        "keep": list(wanted.keep),
        "at": wanted.at,
        "statistics": wanted.statistics,
        "vary": variation.identity(),
        **settings_of(plan.method, plan.accuracy, step, None),
    }
    identity = identity_of(simulation.scene, settings, version())
    return Target(path, part, json.loads(json.dumps(identity)))
