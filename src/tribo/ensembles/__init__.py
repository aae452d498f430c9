"""Means over many seeded starts: for motion of which no digit survives, but whose averages do.

A scene is planned once.  Its members differ in initial values, velocities and seeds.  Their number
is given, or found by a rule from the spread of the first; what is given back is a data set of the
series of surfaces as wholes and of the system, of their means, of the intervals that these are
known to, and of what the step or the tolerances may have to do with it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from tribo.ensembles.dataset import Collected, dataset
from tribo.ensembles.intervals import members_needed
from tribo.ensembles.members import Variation
from tribo.ensembles.runner import (
    FIRST,
    INTERRUPTED,
    Runner,
    Second,
    bulk_names,
    check_engine,
    sum_names,
)
from tribo.model.scene import Scene
from tribo.simulation import Simulation, prepare
from tribo.validation import POSITIVE, InputError, inside, integer, number, short_repr

if TYPE_CHECKING:
    import xarray

MOST = 10_000  # members that an accuracy may take, where n does not say


def ensemble(
    scene: Scene,
    n: int | None = None,
    vary: Mapping[str, Any] | None = None,
    seed: int = 0,
    engine: Any = None,
    accuracy: Mapping[str, float] | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Callable[[int], None] | None = None,
) -> xarray.Dataset:
    """Run a scene from many starts; means of the surfaces' and the system's ledgers over time.

    Works that are reported of asperites, as "upper.w2", are summed over their surface.

    `n` is how many members there are.  Without it, or with it as the most, `accuracy` names
    quantities of surfaces as wholes or of the system, as ``{"upper.W": 1e-2}``, whose mean's 95 %
    interval is to have at most that half-width at all recorded times, in units of the scale of
    energies.  `vary` maps "surface.theta" (or phi, omega, nu) and "surface.velocity" to an array,
    (n,) or (n, asperites) or (n, 2), or to a distribution of scipy.stats, from which every member
    and every asperite draws its own.  Every member has a seed of its own too, for noise and thermal
    starts, which is made from `seed` and its number; heights are everybody's.  `engine` is an
    executor as of concurrent.futures; without one all are run here.  `method` and `step` are as for
    :func:`prepare`, and are needed where no accuracy of single runs can be kept.  `progress` is
    told how many members have been run.  Raises InputError.

    Variables are (member, time) as ``upper.W``, and over time ``upper.W_mean``,
    ``upper.W_half_width`` and what says how far the step or the tolerances may be to blame,
    ``upper.W_bias`` and ``upper.W_bias_half_width``, or ``upper.W_error``.
    """
    began = time.perf_counter()
    if not isinstance(scene, Scene):
        raise InputError("scene", f"must be a tribo.Scene, got {short_repr(scene)}")
    scene = scene.with_heights()
    wanted = None if accuracy is None else _statistical(scene, accuracy)
    variation = Variation(scene, {} if vary is None else vary, integer("seed", seed, 0))
    most = _most(n, wanted, variation)
    check_engine(engine)
    runner = Runner(_planned(scene, method, step), variation, engine, progress)
    first, needed = None, 0.0
    if wanted is None:
        runner.add(most)
    else:
        _check_kept(runner, wanted)
        runner.add(min(FIRST, most))
        first = runner.completed
        if not runner.interrupted:
            needed = _enough(runner, wanted, most)
    collected = Collected(
        simulation=runner.simulation,
        names=runner.names,
        members=runner.members,
        outcomes=runner.outcomes,
        second=Second() if runner.interrupted else runner.look_again(),
        sizes=variation.sizes,
        seed=seed,
        first=first,
        needed=needed,
        accuracy=wanted,
        interrupted=runner.interrupted,
    )
    return dataset(collected, time.perf_counter() - began)


def _statistical(scene: Scene, accuracy: Any) -> dict[str, float]:
    """The half-widths asked for, in units of the scale of energies, by name."""
    if not isinstance(accuracy, Mapping) or not accuracy:
        raise InputError(
            "accuracy", f'must name quantities, as {{"upper.W": 1e-2}}, got {short_repr(accuracy)}'
        )
    known = bulk_names(scene) + sum_names(scene)
    for name in accuracy:
        if name not in known:
            raise InputError(f"accuracy.{name}", f"names no mean; there are {', '.join(known)}")
    with inside("accuracy"):
        return {name: number(name, value, POSITIVE) for name, value in accuracy.items()}


def _most(n: int | None, wanted: Any, variation: Variation) -> int:
    """How many members there may be; arrays have to last for them."""
    if n is None and wanted is None:
        raise InputError("n", 'is missing; give it, or accuracy={"surface.W": 1e-2}')
    lengths = variation.lengths
    most = min([MOST, *lengths.values()]) if n is None else integer("n", n, 2)
    for key, length in lengths.items():
        if length != most:
            raise InputError(f"vary.{key}", f"has values for {length} members, not for {most}")
    return integer("n", most, 2)


def _planned(scene: Scene, method: str | None, step: float | None) -> Simulation:
    """Method and settings of all members; complains where single runs cannot be trusted."""
    help_ = "give a method and a step, or the scene's numerics an accuracy that can be kept"
    simulation = prepare(scene, method=method, step=step)
    if simulation.accuracy is None:
        return simulation
    found = simulation.compute_first()
    if found.status == INTERRUPTED:
        raise KeyboardInterrupt
    if not found.met:
        why = found.notes[-1] if found.status == "completed" else f"the run ends by {found.status}"
        raise InputError("step", f"is missing, and accuracy does not find one: {why}; {help_}")
    return simulation


def _check_kept(runner: Runner, wanted: Mapping[str, float]) -> None:
    """Complain about quantities whose series no member keeps."""
    for name in wanted:
        if name not in runner.names:
            raise InputError(
                f"accuracy.{name}",
                "is a sum over asperites, whose series are too long to keep; give fewer samples",
            )


def _enough(runner: Runner, wanted: Mapping[str, float], most: int) -> float:
    """Add as many members as the spread of the first ones says, by Stein's rule; how many."""
    scale = max(outcome.scale for outcome in runner.outcomes if outcome.completed)
    first = runner.complete
    needed = {
        name: members_needed(first[:, runner.names.index(name)], value * scale)
        for name, value in wanted.items()
    }
    name = max(needed, key=lambda key: needed[key])
    if needed[name] > most:
        raise InputError(
            f"accuracy.{name}",
            f"would take {needed[name]:.0f} members, as the spread of the first {len(first)} says, "
            f"and {most} are the most; ask for less, or give a larger n",
        )
    while runner.completed < needed[name] and len(runner.members) < most and not runner.interrupted:
        missing = int(needed[name]) - runner.completed
        runner.add(min(missing, most - len(runner.members)))
    return needed[name]
