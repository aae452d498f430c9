"""Averages over many runs from seeded starts, and confidence intervals of the averages.

They serve chaotic motion and thermal noise, where single trajectories are not reproducible.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from tribo.ensembles.dataset import Collected, dataset
from tribo.ensembles.end_values import checked_names, end_dataset
from tribo.ensembles.intervals import members_needed
from tribo.ensembles.members import Source, Variation
from tribo.ensembles.pair_runs import PairRuns
from tribo.ensembles.runner import (
    FIRST_STAGE,
    Engine,
    Runner,
    SettingsCheck,
    check_engine,
    sum_names,
    total_names,
)
from tribo.ensembles.single_runs import SingleRuns
from tribo.kernels.status import Status
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.prepared import Simulation
from tribo.simulation import prepare
from tribo.validation import POSITIVE, InputError, inside, integer, number, short_repr

if TYPE_CHECKING:
    import xarray

# Most members that a half-width may take where `n` is not given.
MOST_MEMBERS = 10_000


def ensemble(
    scene: Scene,
    n: int | None = None,
    vary: Mapping[str, Source] | None = None,
    seed: int = 0,
    engine: Engine | None = None,
    half_width: Mapping[str, float] | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Callable[[int], None] | None = None,
    keep: Sequence[str] | None = None,
    threads: int | None = None,
) -> xarray.Dataset:
    """Run a scene from many starts, and average its ledger over the members or keep its end.

    Parameters
    ----------
    scene : Scene
        The scene.  All members share its heights; each has a seed of its own for noise and thermal
        starts.
    n : int, optional
        Number of members, at least 2.  With `half_width`, the largest number.
    vary : mapping, optional
        What differs between members: "surface.theta" (or phi, omega, nu), "surface.velocity", or a
        number of the scene as "surface.asperite.kappa", "surface.langevin.temperature" (or of its
        drive or bath) or "interaction.strength" ->
        an array of shape (n,), (n, asperites) or, for velocities, (n, 2); or a distribution with
        ``rvs(size=, random_state=)``, as those of scipy.stats, from which each asperite of each
        member draws.
    seed : int
        The seed of the ensemble.  A member depends on it and on the member's number alone.
    engine : executor, optional
        Runs the members; it has ``submit`` or ``map`` as concurrent.futures defines them.  Without
        it they are run in this process.
    half_width : mapping, optional
        Quantity of a surface as a whole or of the system, as "upper.W" -> the largest half-width
        of the 95 % interval of its mean, at any recorded time, in units of the scale of energies.
        It determines the number of members.
    method, step
        As for :func:`prepare`.  Required where no accuracy of single runs can be kept.
    progress : callable, optional
        Called with the number of members that have been run.
    keep : sequence of str, optional
        Quantities of which each member's value at the end is kept, and nothing else: "upper.w1" or
        "contact_energy".  It makes the members of a scene of one asperite on one run thousands of
        times faster.
    threads : int, optional
        Threads that run such members; by default one for each core.  Values do not depend on it.

    Returns
    -------
    xarray.Dataset
        With `keep`, each quantity under its name (member, asperite) or (member,), and for each
        member its ``status``, ``steps``, ``level`` of the tolerances, and ``error`` where it was
        measured.  Values of members that did not complete are NaN.  A quantity whose start is
        varied is ``upper.theta_end``.

        Without `keep`, for each quantity, as ``upper.W`` (member, time): ``upper.W_mean`` and
        ``upper.W_half_width`` (time,).  The effect of the step or of the tolerances on the mean is
        ``upper.W_bias`` and ``upper.W_bias_half_width`` (time,), or ``upper.W_error``.  Works that
        are reported of asperites, as ``upper.w2``, are summed over their surface.

    Raises
    ------
    InputError
        An argument cannot be used, the half-width takes too many members, or fewer than two
        members reach the end.
    """
    began = time.perf_counter()
    if not isinstance(scene, Scene):
        raise InputError("scene", f"must be a tribo.Scene, got {short_repr(scene)}")
    scene = scene.with_heights()
    wanted = None if half_width is None else _check_half_width(scene, half_width)
    variation = Variation(scene, {} if vary is None else vary, integer("seed", seed, 0))
    most = _most_members(n, wanted, variation)
    check_engine(engine)
    if keep is not None:
        if half_width is not None:
            raise InputError("half_width", "cannot go with keep; give one or the other")
        return _end_values(scene, variation, most, keep, method, step, engine, threads, progress)
    runner = Runner(_prepared(scene, method, step), variation, engine, progress)
    first_stage, needed = _run_members(runner, wanted, most)
    check = SettingsCheck() if runner.interrupted else runner.check_settings()
    collected = Collected(runner, check, wanted, first_stage, needed)
    return dataset(collected, time.perf_counter() - began)


def _end_values(
    scene: Scene,
    variation: Variation,
    count: int,
    keep: Sequence[str],
    method: str | None,
    step: float | None,
    engine: Engine | None,
    threads: int | None,
    progress: Callable[[int], None] | None,
) -> xarray.Dataset:
    """The kept quantities at the ends of all members."""
    began = time.perf_counter()
    threads = os.cpu_count() or 1 if threads is None else integer("threads", threads, 1)
    simulation = _prepared(replace(scene, output=Output(samples=2)), method, step)
    names = checked_names(simulation, keep)
    runs: PairRuns | SingleRuns
    if simulation.integrator.pair is not None and not variation.own_scenes:
        runs = PairRuns(simulation, variation, names, threads, progress)
    else:
        runs = SingleRuns(simulation, variation, names, engine, progress)
    found = runs.run(count)
    return end_dataset(simulation, variation, found, time.perf_counter() - began)


def _run_members(
    runner: Runner, half_width: Mapping[str, float] | None, most: int
) -> tuple[int | None, float]:
    """Run as many members as are wanted; members of the first stage, and the number needed."""
    if half_width is None:
        runner.add(most)
        return None, 0.0
    _check_series(runner, half_width)
    runner.add(min(FIRST_STAGE, most))
    first_stage = runner.completed
    return first_stage, 0.0 if runner.interrupted else _add_second_stage(runner, half_width, most)


def _check_half_width(scene: Scene, half_width: Mapping[str, float]) -> dict[str, float]:
    """The half-widths wanted, by quantity.  Raises InputError."""
    if not isinstance(half_width, Mapping) or not half_width:
        raise InputError(
            "half_width",
            f'must map quantities, as {{"upper.W": 1e-2}}, got {short_repr(half_width)}',
        )
    known = total_names(scene) + sum_names(scene)
    for name in half_width:
        if name not in known:
            raise InputError(f"half_width.{name}", f"must be one of {', '.join(known)}")
    with inside("half_width"):
        return {name: number(name, value, POSITIVE) for name, value in half_width.items()}


def _most_members(
    n: int | None, half_width: Mapping[str, float] | None, variation: Variation
) -> int:
    """The largest number of members, for which arrays have values.  Raises InputError."""
    if n is None and half_width is None:
        raise InputError("n", 'is missing; give it, or half_width={"surface.W": 1e-2}')
    lengths = variation.lengths
    most = min([MOST_MEMBERS, *lengths.values()]) if n is None else integer("n", n, 2)
    for key, length in lengths.items():
        if length != most:
            raise InputError(f"vary.{key}", f"must have values for {most} members, got {length}")
    return integer("n", most, 2)


def _prepared(scene: Scene, method: str | None, step: float | None) -> Simulation:
    """The scene, with the method and settings of all members.  Raises InputError."""
    simulation = prepare(scene, method=method, step=step)
    if simulation.accuracy is None:
        return simulation
    result = simulation.compute_first()
    if result.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    if not result.met:
        completed = result.status == Status.COMPLETED
        why = result.notes[-1] if completed else f"the run ends by {result.status}"
        raise InputError(
            "step",
            f"is missing, and accuracy does not find one: {why}; give a method and a step, or an "
            "accuracy that can be kept in the scene's numerics",
        )
    return simulation


def _check_series(runner: Runner, half_width: Mapping[str, float]) -> None:
    """Refuse quantities whose series members do not keep."""
    for name in half_width:
        if name not in runner.names:
            raise InputError(
                f"half_width.{name}",
                "is a sum over asperites, whose series are too long to keep; give fewer samples",
            )


def _add_second_stage(runner: Runner, half_width: Mapping[str, float], most: int) -> float:
    """Add as many members as Stein's rule requires by the spread of the first; their number."""
    scale = max(outcome.scale for outcome in runner.outcomes if outcome.completed)
    first = runner.complete_values
    needed = {
        name: members_needed(first[:, runner.names.index(name)], value * scale)
        for name, value in half_width.items()
    }
    name = max(needed, key=lambda key: needed[key])
    if needed[name] > most:
        raise InputError(
            f"half_width.{name}",
            f"would take {needed[name]:.0f} members by the spread of the first {len(first)}, and "
            f"at most {most} are allowed; give a larger half-width or a larger n",
        )
    while runner.completed < needed[name] and len(runner.members) < most and not runner.interrupted:
        missing = int(needed[name]) - runner.completed
        runner.add(min(missing, most - len(runner.members)))
    return needed[name]
